/* The functions of FreeRTOS's task.h that main.c calls. */
#ifndef INC_TASK_H
#define INC_TASK_H

typedef struct tskTaskControlBlock *TaskHandle_t;
typedef void (*TaskFunction_t)(void *);

TaskHandle_t xTaskCreateStatic(TaskFunction_t task, const char *name, configSTACK_DEPTH_TYPE words, void *argument,
                               UBaseType_t priority, StackType_t *stack, StaticTask_t *storage);
BaseType_t xTaskDelayUntil(TickType_t *last, TickType_t ticks);
TickType_t xTaskGetTickCount(void);
UBaseType_t uxTaskGetStackHighWaterMark(TaskHandle_t task);
void vTaskStartScheduler(void);
void vApplicationGetIdleTaskMemory(StaticTask_t **task, StackType_t **stack, configSTACK_DEPTH_TYPE *words);
void vApplicationStackOverflowHook(TaskHandle_t task, char *name);

#endif
