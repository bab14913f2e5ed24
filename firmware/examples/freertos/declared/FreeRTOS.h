/* What main.c uses of FreeRTOS V11: for a compiler where the kernel is not at hand. Nothing of it can be linked. */
#ifndef INC_FREERTOS_H
#define INC_FREERTOS_H

#include <stddef.h>
#include <stdint.h>

#define TICK_TYPE_WIDTH_32_BITS 1
#include "FreeRTOSConfig.h"

typedef uint32_t StackType_t;
typedef uint32_t TickType_t;
typedef long BaseType_t;
typedef unsigned long UBaseType_t;
typedef struct {
    uint32_t words[32];
} StaticTask_t;

#define configSTACK_DEPTH_TYPE StackType_t
#define pdMS_TO_TICKS(ms) ((TickType_t)(((uint64_t)(ms) * configTICK_RATE_HZ) / 1000u))

#endif
