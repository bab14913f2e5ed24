/* Runs the task of task.c over a simulated approach, as an ECU would: nothing is printed. The status is that of the task. */
#include "task.h"

static cede_vehicle ego = {20.0f, 5.0f, {{-20.0f, -2.0f}, {1.0f, 0.0f}}};
static cede_track other = {
    .number = 17u,
    .candidate_count = 1u,
    .speed = 5.0f,
    .pose = {{30.0f, 2.0f}, {-1.0f, 0.0f}},
    .candidates = {{.s = 10.0f, .path = 1u}},
};
static uint32_t periods;
static int wrong;

int os_wait_for_period(void)
{
    periods++;
    return (periods <= 20u) ? 1 : 0;
}

uint64_t os_clock_us(void)
{
    return (uint64_t)periods * 100000u;
}

void vehicle_observe(cede_observation *seen)
{
    seen->ego = ego;
    seen->tracks = &other;
    seen->track_count = 1u;
}

void vehicle_command(float acceleration)
{
    const float speed = ego.speed + acceleration * 0.1f;
    const float distance = 0.05f * (ego.speed + speed);

    ego.s += distance;
    ego.pose.position.x += distance;
    ego.speed = speed;
    other.candidates[0].s += 0.5f;
    other.pose.position.x -= 0.5f;
}

void vehicle_diagnose(cede_status status, const cede_decision *decision)
{
    wrong = (status != CEDE_STATUS_OK) ? (int)status : (int)decision->fallback.kind;
}

int main(void)
{
    const cede_status status = task_init();

    if (status == CEDE_STATUS_OK) {
        task_run((void *)0);
    }
    return (status != CEDE_STATUS_OK) ? (int)status : wrong;
}
