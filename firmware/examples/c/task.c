#include "task.h"
#include <stddef.h>

static cede_policy policy;
static cede_drive drive;
static cede_junction junction;
static cede_approach approach;

static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
static const cede_footprint car = {4.6f, 1.9f};

static cede_status begin(void)
{
    cede_contract contract;
    cede_status status = cede_contract_worst_case(&contract);

    contract.jitter = 0.002f; /* of this scheduler */
    contract.latency = 0.08f; /* of these brakes */
    if (status == CEDE_STATUS_OK) {
        status = cede_policy_init_embedded(&policy);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, NULL);
    }
    return status;
}

/* The known answer, in the storage that is used later. */
static cede_status test(void)
{
    uint32_t answer = 0u;
    cede_status status = cede_known_answer(&policy, &junction, &approach, &answer);

    if ((status == CEDE_STATUS_OK) && (answer != CEDE_EMBEDDED_ANSWER)) {
        status = CEDE_STATUS_OTHER; /* not to be driven with */
    }
    return status;
}

static cede_status build(uint8_t *left)
{
    uint8_t oncoming = 0u;
    cede_status status = cede_junction_init(&junction);

    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, mine, 5u, CEDE_CLASS_CAR, &car, left, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, theirs, 2u, CEDE_CLASS_CAR, &car, &oncoming, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_set_right_of_way(&junction, oncoming, *left, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_build(&junction, NULL);
    }
    return status;
}

cede_status task_init(void)
{
    uint8_t left = 0u;
    cede_status status = (cede_abi_version() == CEDE_ABI_VERSION) ? begin() : CEDE_STATUS_OTHER;

    if (status == CEDE_STATUS_OK) {
        status = test();
    }
    if (status == CEDE_STATUS_OK) {
        status = build(&left);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_approach_enter(&approach, &drive, &junction, left, NULL);
    }
    return status;
}

void task_run(void *unused)
{
    cede_observation seen;
    cede_decision decision;
    cede_status status;

    (void)unused;
    while (os_wait_for_period() != 0) {
        vehicle_observe(&seen);
        status = cede_approach_decide(&approach, os_clock_us(), &seen, &decision);
        vehicle_command(decision.acceleration); /* finite and admissible, whatever the status */
        if ((status != CEDE_STATUS_OK) || (decision.cause == CEDE_CAUSE_FALLBACK)) {
            vehicle_diagnose(status, &decision);
        }
    }
}
