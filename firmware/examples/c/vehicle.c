/* Stands in for localisation, tracking, actuator and diagnostic memory: one oncoming vehicle, perfect sensors and brakes. */
#include "vehicle.h"
#include "task.h"

static cede_vehicle ego = {20.0f, 5.0f, {{-20.0f, -2.0f}, {1.0f, 0.0f}}};
static cede_track other = {
    .number = 17u,
    .candidate_count = 1u,
    .speed = 5.0f,
    .pose = {{30.0f, 2.0f}, {-1.0f, 0.0f}},
    .candidates = {{.s = 10.0f, .path = 1u}},
};
static int wrong;

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

int vehicle_wrong(void)
{
    return wrong;
}
