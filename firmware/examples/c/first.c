#include "cede.h"
#include "text.h"

/* The library allocates nothing: its objects live where the program puts them. */
static cede_policy policy;
static cede_drive drive;
static cede_junction junction;
static cede_approach approach;

/* From the map, in metres: the ego turns left, the oncoming vehicle goes straight on. */
static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
static const cede_footprint car = {4.6f, 1.9f};

int main(void)
{
    cede_contract contract;
    cede_detail wrong = {0}; /* what is refused, if anything: the field with its range */
    uint8_t left = 0u;
    uint8_t oncoming = 0u;
    cede_status s = cede_contract_worst_case(&contract);
    contract.ego_braking = 4.0f; /* this vehicle's brakes */

    if (s == CEDE_STATUS_OK) { s = cede_policy_init_embedded(&policy); }
    if (s == CEDE_STATUS_OK) { s = cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, &wrong); }
    if (s == CEDE_STATUS_OK) { s = cede_junction_init(&junction); }
    if (s == CEDE_STATUS_OK) { s = cede_junction_add_path(&junction, mine, 5u, CEDE_CLASS_CAR, &car, &left, &wrong); }
    if (s == CEDE_STATUS_OK) { s = cede_junction_add_path(&junction, theirs, 2u, CEDE_CLASS_CAR, &car, &oncoming, &wrong); }
    if (s == CEDE_STATUS_OK) { s = cede_junction_set_right_of_way(&junction, oncoming, left, &wrong); }
    if (s == CEDE_STATUS_OK) { s = cede_junction_build(&junction, &wrong); }
    if (s == CEDE_STATUS_OK) { s = cede_approach_enter(&approach, &drive, &junction, left, &wrong); }

    /* Every 100 ms, from localisation and tracking. */
    cede_track other = {.number = 17u, .candidate_count = 1u, .speed = 8.0f, .pose = {{20.0f, 2.0f}, {-1.0f, 0.0f}}};
    other.candidates[0].path = oncoming;
    other.candidates[0].s = 20.0f;
    cede_observation seen = {{15.0f, 6.0f, {{-25.0f, -2.0f}, {1.0f, 0.0f}}}, &other, 1u};
    cede_decision decision;
    if (s == CEDE_STATUS_OK) { s = cede_approach_decide(&approach, 1000000u, &seen, &decision); }
    wrong.status = s;
    put_refusal(&wrong);
    if (s == CEDE_STATUS_OK) { put_decision(&decision); } /* decision.acceleration goes to the actuator */
    return (int)s;
}
