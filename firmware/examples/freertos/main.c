/*
 * The task of ../c/task.c under FreeRTOS, at 10 Hz, beneath a task at 100 Hz that computes in another rounding mode: the FPU's
 * registers and its mode are each task's own. The status is that of the task, after 20 periods.
 */
#include "FreeRTOS.h"
#include "task.h"
#include "../c/task.h"
#include "../c/text.h"
#include "../c/vehicle.h"

#define PERIOD_MS 100u
#define PERIODS 20u
#define DECIDE_WORDS 2048u /* docs/integration.md: what a decision needs, the task's own frame, and a context of the FPU */
#define OTHER_WORDS 128u

void port_exit(uint32_t status); /* start.c's */

static StackType_t decide_stack[DECIDE_WORDS];
static StaticTask_t decide_task;
static StackType_t other_stack[OTHER_WORDS];
static StaticTask_t other_task;
static StackType_t idle_stack[configMINIMAL_STACK_SIZE];
static StaticTask_t idle_task;
static TickType_t last_wake;
static uint32_t periods;
static volatile float filtered;

int os_wait_for_period(void)
{
    (void)xTaskDelayUntil(&last_wake, pdMS_TO_TICKS(PERIOD_MS));
    periods++;
    return (periods <= PERIODS) ? 1 : 0;
}

/* A tick is a millisecond; its counter wraps after 49 days, which is longer than an approach takes. */
uint64_t os_clock_us(void)
{
    return (uint64_t)xTaskGetTickCount() * 1000u;
}

static void decide(void *unused)
{
    last_wake = xTaskGetTickCount();
    task_run(unused);
    put("measured: stack of the task that is left, bytes: ");
    put_number((int32_t)(sizeof(StackType_t) * uxTaskGetStackHighWaterMark(NULL)));
    put("\n");
    port_exit((uint32_t)vehicle_wrong());
}

static void filter(void *unused)
{
    TickType_t last = xTaskGetTickCount();

    (void)unused;
    port_float_mode(0x00c00000u);
    for (;;) {
        filtered = filtered * 0.9f + 0.1f;
        (void)xTaskDelayUntil(&last, pdMS_TO_TICKS(10u));
    }
}

void vApplicationGetIdleTaskMemory(StaticTask_t **task, StackType_t **stack, configSTACK_DEPTH_TYPE *words)
{
    *task = &idle_task;
    *stack = idle_stack;
    *words = configMINIMAL_STACK_SIZE;
}

void vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    put("the stack overflows: ");
    put_line(name);
    port_exit(1u);
}

int main(void)
{
    const cede_status status = task_init(); /* on the stack of main(), which nobody needs afterwards */

    if (status == CEDE_STATUS_OK) {
        (void)xTaskCreateStatic(decide, "decide", DECIDE_WORDS, NULL, 1u, decide_stack, &decide_task);
        (void)xTaskCreateStatic(filter, "filter", OTHER_WORDS, NULL, 2u, other_stack, &other_task);
        vTaskStartScheduler();
    }
    return (int)status;
}
