/*
 * Drives a left turn across an oncoming vehicle to the end and prints each decision with its reason.
 * Then it shows what a bad contract, a dead sensor and a damaged object are answered by.
 */
#include "cede.h"
#include "text.h"

#define STEP_US 100000u
#define STEP_S 0.1f
#define STEPS 400u
#define TRACK 17u
#define WATCHED 79.0f

static cede_policy policy;
static cede_drive drive;
static cede_junction junction;
static cede_approach approach;
static uint8_t left;
static uint8_t oncoming;

static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
static const cede_footprint car = {4.6f, 1.9f};

/* This vehicle's numbers; docs/integration.md says where each comes from. */
static cede_status choose_contract(cede_contract *contract)
{
    const cede_status status = cede_contract_worst_case(contract);

    contract->ego_braking = 4.0f;
    contract->latency = 0.08f;
    contract->position_error = 0.1f;
    contract->speed_error = 0.1f;
    return status;
}

static cede_status set_up(cede_detail *detail)
{
    cede_contract contract;
    cede_status status = cede_policy_init_embedded(&policy);

    if (status == CEDE_STATUS_OK) {
        status = choose_contract(&contract);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, detail);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_init(&junction);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, mine, 5u, CEDE_CLASS_CAR, &car, &left, detail);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, theirs, 2u, CEDE_CLASS_CAR, &car, &oncoming, detail);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_set_right_of_way(&junction, oncoming, left, detail);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_build(&junction, detail);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_approach_enter(&approach, &drive, &junction, left, detail);
    }
    return status;
}

/* A vehicle on one path, as perfect sensors see it. */
static cede_status see(uint8_t path, cede_vehicle *vehicle)
{
    return cede_junction_pose(&junction, path, vehicle->s, &vehicle->pose);
}

static cede_status observe(cede_vehicle *ego, cede_vehicle *other, cede_track *track, cede_observation *seen)
{
    cede_status status = see(left, ego);

    if (status == CEDE_STATUS_OK) {
        status = see(oncoming, other);
    }
    track->number = TRACK;
    track->vehicle_class = CEDE_CLASS_CAR;
    track->candidate_count = 1u;
    track->speed = other->speed;
    track->pose = other->pose;
    track->candidates[0].path = oncoming;
    track->candidates[0].s = other->s;
    seen->ego = *ego;
    seen->tracks = track;
    seen->track_count = 1u;
    if ((status == CEDE_STATUS_OK) && (other->s > WATCHED)) {
        seen->track_count = 0u; /* it has left the junction */
        status = cede_approach_forget(&approach, TRACK);
    }
    return status;
}

static void advance(cede_vehicle *vehicle, float acceleration)
{
    float speed = vehicle->speed + acceleration * STEP_S;

    speed = speed > 0.0f ? speed : 0.0f;
    vehicle->s += 0.5f * (vehicle->speed + speed) * STEP_S;
    vehicle->speed = speed;
}

static void put_vehicle(const char *name, const cede_vehicle *vehicle)
{
    put(name);
    put_fixed(vehicle->s);
    put(" m ");
    put_fixed(vehicle->speed);
    put(" m/s, ");
}

/* The way through the junction. */
static cede_status cross(cede_observation *seen, cede_track *track, uint64_t *now_us)
{
    cede_path_info path;
    cede_vehicle ego = {.s = 20.0f, .speed = 5.0f};
    cede_vehicle other = {.s = 5.0f, .speed = 5.0f};
    cede_decision decision;
    cede_status status = cede_junction_path(&junction, left, &path);
    uint32_t step;

    for (step = 0u; (step < STEPS) && (status == CEDE_STATUS_OK) && (ego.s < path.length - 5.0f); step++) {
        status = observe(&ego, &other, track, seen);
        if ((status == CEDE_STATUS_OK) && (step == 0u)) {
            status = cede_approach_ready(&approach, *now_us, seen, NULL); /* before control is handed over */
        }
        if (status == CEDE_STATUS_OK) {
            status = cede_approach_decide(&approach, *now_us, seen, &decision);
        }
        if (status == CEDE_STATUS_OK) {
            put_vehicle("ego ", &ego);
            put_vehicle("other ", &other);
            put_decision(&decision);
            advance(&ego, decision.acceleration);
            advance(&other, 0.0f);
        }
        *now_us += STEP_US;
    }
    return status;
}

/* What goes wrong is answered, never undefined. */
static int32_t break_things(cede_observation *seen, uint64_t now_us)
{
    cede_contract contract;
    cede_detail detail;
    cede_decision decision;
    int32_t unexpected = 0;

    (void)choose_contract(&contract);
    contract.ego_braking = 9.0f;
    unexpected += (int32_t)(cede_contract_check(&contract, &detail) != CEDE_STATUS_CONTRACT_OUT_OF_RANGE);
    put_refusal(&detail);

    seen->ego.speed = -50.0f; /* a dead sensor */
    unexpected += (int32_t)(cede_approach_decide(&approach, now_us, seen, &decision) != CEDE_STATUS_OK);
    put_decision(&decision);

    seen->track_count = 1u;
    seen->tracks = NULL; /* one track, and no place for it */
    detail.status = cede_approach_decide(&approach, now_us + STEP_US, seen, &decision);
    unexpected += (int32_t)(detail.status != CEDE_STATUS_NULL_POINTER);
    put(cede_status_text(detail.status));
    put(": ");
    put_decision(&decision);

    approach.storage[20] ^= 1u; /* one bit of memory */
    detail.status = cede_approach_decide(&approach, now_us + 2u * STEP_US, seen, &decision);
    unexpected += (int32_t)(detail.status != CEDE_STATUS_CORRUPT);
    put(cede_status_text(detail.status));
    put(": ");
    put_decision(&decision);
    return unexpected;
}

int main(void)
{
    cede_detail detail = {0};
    cede_track track = {0};
    cede_observation seen = {0};
    uint64_t now_us = 1000000u;
    cede_status status = CEDE_STATUS_OTHER;

    if (cede_abi_version() == CEDE_ABI_VERSION) {
        status = cede_self_test();
    }
    if (status == CEDE_STATUS_OK) {
        status = set_up(&detail);
    }
    if (status != CEDE_STATUS_OK) {
        detail.status = status;
        put_refusal(&detail);
        return (int)status;
    }
    status = cross(&seen, &track, &now_us);
    if (status != CEDE_STATUS_OK) {
        put_line(cede_status_text(status));
        return (int)status;
    }
    return (int)break_things(&seen, now_us);
}
