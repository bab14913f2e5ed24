/* Runs the task of task.c over a simulated approach, as an ECU would: nothing is printed. The status is that of the task. */
#include "task.h"
#include "vehicle.h"

static uint32_t periods;

int os_wait_for_period(void)
{
    periods++;
    return (periods <= 20u) ? 1 : 0;
}

uint64_t os_clock_us(void)
{
    return (uint64_t)periods * 100000u;
}

int main(void)
{
    const cede_status status = task_init();

    if (status == CEDE_STATUS_OK) {
        task_run((void *)0);
    }
    return (status != CEDE_STATUS_OK) ? (int)status : vehicle_wrong();
}
