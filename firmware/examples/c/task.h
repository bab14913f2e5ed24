/* A task that drives at 10 Hz, and what it needs of the vehicle and of the operating system. */
#ifndef TASK_H
#define TASK_H

#include "cede.h"

/* The task: made once, then run by the operating system, as FreeRTOS does with xTaskCreate(task_run, ...). */
cede_status task_init(void);
void task_run(void *unused);

/* Waits for the next period on a grid, as vTaskDelayUntil() does; 0 ends the task. */
int os_wait_for_period(void);

/* Microseconds of a clock that never goes back. */
uint64_t os_clock_us(void);

/* A copy of what localisation and tracking know, which nobody writes to during the call; NaN for what is missing. */
void vehicle_observe(cede_observation *seen);

/* To the longitudinal actuator, in m/s^2. */
void vehicle_command(float acceleration);

/* Something is not as it should be: to the diagnostic memory. */
void vehicle_diagnose(cede_status status, const cede_decision *decision);

#endif
