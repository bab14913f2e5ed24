/*
 * Injects faults one by one, into memory, the FPU's mode, the schedule, the sensors and the track list, and prints what the
 * caller sees of each. faults.txt is what it prints on every platform; docs/integration.md says what to do about it.
 */
#include "cede.h"
#include "text.h"

#define STEP_US 100000u
#define STEP_S 0.1f
#define TRACK 17u
#define LEFT 0u
#define ONCOMING 1u
#define BITS(object) (8u * sizeof (object).storage)

/* The weights file, to be flashed: the one of the embedded policy. */
__asm__(".section .rodata.weights, \"a\"\n .balign 64\n .global weights_file\nweights_file:\n .incbin \"" WEIGHTS "\"\n"
        " .global weights_end\nweights_end:\n .previous");
extern const uint32_t weights_file[];
extern const uint32_t weights_end[];
#define MOST_WEIGHTS 8192u

static uint32_t weights[MOST_WEIGHTS]; /* a copy in RAM, of which bits can be flipped */
static uint32_t weights_words;
static cede_policy policy;
static cede_drive drive;
static cede_junction junction;
static cede_approach approach;
static cede_approach kept;
static cede_drive kept_drive;
static cede_policy kept_policy;
static cede_conflict conflict;

static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
static const cede_footprint car = {4.6f, 1.9f};

/* The scene: where the two are, and what was decided last. */
static cede_vehicle ego;
static cede_vehicle other;
static uint64_t now_us;
static cede_track tracks[CEDE_MAX_TRACKS + 1u];
static cede_observation seen;
static cede_decision decision;

static cede_status choose_contract(cede_contract *contract)
{
    const cede_status status = cede_contract_worst_case(contract);

    contract->jitter = 0.005f;
    contract->latency = 0.08f;
    contract->position_error = 0.1f;
    contract->speed_error = 0.1f;
    return status;
}

static cede_status make_drive(void)
{
    cede_contract contract;
    cede_status status = choose_contract(&contract);

    if (status == CEDE_STATUS_OK) {
        status = cede_policy_init(&policy, weights, 4u * weights_words);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, NULL);
    }
    return status;
}

static cede_status make_junction(void)
{
    uint8_t path = 0u;
    cede_status status = cede_junction_init(&junction);

    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, mine, 5u, CEDE_CLASS_CAR, &car, &path, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_add_path(&junction, theirs, 2u, CEDE_CLASS_CAR, &car, &path, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_set_right_of_way(&junction, ONCOMING, LEFT, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_build(&junction, NULL);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_junction_conflict(&junction, LEFT, ONCOMING, &conflict);
    }
    return status;
}

static void observe(void)
{
    (void)cede_junction_pose(&junction, LEFT, ego.s, &ego.pose);
    (void)cede_junction_pose(&junction, ONCOMING, other.s, &other.pose);
    tracks[0].number = TRACK;
    tracks[0].vehicle_class = CEDE_CLASS_CAR;
    tracks[0].candidate_count = 1u;
    tracks[0].speed = other.speed;
    tracks[0].pose = other.pose;
    tracks[0].candidates[0].path = ONCOMING;
    tracks[0].candidates[0].s = other.s;
    seen.ego = ego;
    seen.tracks = tracks;
    seen.track_count = 1u;
}

static void advance(cede_vehicle *vehicle, float acceleration)
{
    float speed = vehicle->speed + acceleration * STEP_S;

    speed = speed > 0.0f ? speed : 0.0f;
    vehicle->s += 0.5f * (vehicle->speed + speed) * STEP_S;
    vehicle->speed = speed;
}

/* One period passes; the command is carried out. */
static void pass(void)
{
    advance(&ego, decision.acceleration);
    advance(&other, 0.0f);
    now_us += STEP_US;
}

static cede_status decide(void)
{
    return cede_approach_decide(&approach, now_us, &seen, &decision);
}

/* A new approach, and a few periods in which nothing is wrong. */
static cede_status begin(void)
{
    cede_status status = cede_approach_enter(&approach, &drive, &junction, LEFT, NULL);
    uint32_t step;

    ego = (cede_vehicle){.s = 15.0f, .speed = 6.0f};
    other = (cede_vehicle){.s = 0.0f, .speed = 6.0f};
    now_us = 1000000u;
    for (step = 0u; (step < 5u) && (status == CEDE_STATUS_OK); step++) {
        observe();
        status = decide();
        pass();
    }
    observe();
    return status;
}

static void put_fault_kind(const char *what, const cede_fault *fault)
{
    if (fault->kind != CEDE_FAULT_KIND_NONE) {
        put(what);
        put(cede_fault_text(fault->kind));
        if (fault->kind == CEDE_FAULT_KIND_INPUT) {
            put(" (");
            put(cede_subject_text(fault->subject));
            put(", ");
            put(cede_field_text(fault->field));
            put(")");
        }
    }
}

/* What the caller sees, without numbers that another policy would change. */
static void put_outcome(cede_status status)
{
    put(cede_status_text(status));
    put("; decided by the ");
    switch (decision.cause) {
    case CEDE_CAUSE_POLICY:
    case CEDE_CAUSE_SHIELDED:
        put("policy or the shield");
        break;
    case CEDE_CAUSE_FALLBACK:
        put("remembered plan");
        break;
    default:
        put("last resort");
        break;
    }
    put_fault_kind("; fallback: ", &decision.fallback);
    put_fault_kind("; fault: ", &decision.fault);
    if (decision.breach != CEDE_BREACH_NONE) {
        put("; breach: ");
        put(cede_breach_text(decision.breach));
    }
    put_line(decision.has_plan != 0u ? "; a plan" : "; no plan");
}

static void put_case(const char *what, cede_status status)
{
    put(what);
    put(": ");
    put_outcome(status);
}

static void put_count(const char *what, uint32_t count, uint32_t of, const char *outcome)
{
    put(what);
    put(": ");
    put_number((int32_t)count);
    put(" of ");
    put_number((int32_t)of);
    put(" ");
    put_line(outcome);
}

static uint32_t bits_of(float value)
{
    union {
        float value;
        uint32_t bits;
    } number;

    number.value = value;
    return number.bits;
}

static int is_finite(float value)
{
    return (value - value) == 0.0f;
}

/* Memory: weights, then the objects that hold policy, contract, plan and junction. */

static void flip(uint64_t *storage, uint32_t bit)
{
    storage[bit / 64u] ^= (uint64_t)1u << (bit % 64u);
}

static void damage_weights(void)
{
    uint32_t refused = 0u;
    uint32_t found = 0u;
    uint32_t tried = 0u;
    uint32_t word;

    for (word = 0u; word < weights_words; word += 16u) {
        const uint32_t bit = (uint32_t)1u << ((word / 16u) % 32u);
        cede_policy damaged;

        tried++;
        weights[word] ^= bit;
        refused += (uint32_t)(cede_policy_init(&damaged, weights, 4u * weights_words) != CEDE_STATUS_OK);
        found += (uint32_t)(cede_policy_check(&policy) != CEDE_STATUS_OK);
        weights[word] ^= bit;
    }
    put_count("a bit of the weights, when they are taken in", refused, tried, "refused by cede_policy_init");
    put_count("a bit of the weights, while they are in use", found, tried, "found by cede_policy_check");
}

static int in_zone(const cede_zone *zone)
{
    return (ego.s > zone->ego_from) && (ego.s < zone->ego_to) && (other.s > zone->other_from) && (other.s < zone->other_to);
}

/* Drives to the end; the number of periods in which something was not as the guarantee says. */
static uint32_t cross(void)
{
    uint32_t wrong = (uint32_t)(begin() != CEDE_STATUS_OK);
    uint32_t step;
    uint8_t zone;

    for (step = 0u; (step < 150u) && (other.s < 75.0f); step++) {
        observe();
        if ((decide() != CEDE_STATUS_OK) || !is_finite(decision.acceleration) || (decision.has_plan == 0u)) {
            wrong++;
        }
        for (zone = 0u; zone < conflict.zone_count; zone++) {
            wrong += (uint32_t)in_zone(&conflict.zones[zone]);
        }
        pass();
    }
    return wrong;
}

/* A bit of an exponent, which nobody has noticed: the policy is another one, the shield is not. */
static void drive_with_damaged_weights(void)
{
    uint32_t sound = 0u;
    uint32_t tried = 0u;
    uint32_t word;

    for (word = 64u; word < weights_words - 1u; word += 256u) {
        tried++;
        weights[word] ^= 0x40000000u;
        sound += (uint32_t)(cross() == 0u);
        weights[word] ^= 0x40000000u;
    }
    put_count("a bit of the weights, unnoticed", sound, tried, "crossings keep the guarantee");
}

/* Of an object's bits the last ones are room for versions to come: all up to the last one that is found have to be found. */
typedef struct {
    uint32_t tried;
    uint32_t found;
    uint32_t found_from_the_start;
} tally;

static void note(tally *bits, int is_found)
{
    bits->tried++;
    if (is_found != 0) {
        bits->found++;
        bits->found_from_the_start = bits->tried;
    }
}

static void put_tally(const char *what, const tally *bits, const char *outcome)
{
    put(what);
    put((bits->found > 0u) && (bits->found == bits->found_from_the_start) ? ": every one " : ": not every one ");
    put_line(outcome);
    put("measured: ");
    put_number((int32_t)bits->found); /* an object is smaller where pointers are */
    put_line(" bits");
}

static void damage_approach(void)
{
    tally bits = {0};
    uint32_t bit;

    kept = approach;
    for (bit = 0u; bit < BITS(approach); bit++) {
        cede_status status;

        flip(approach.storage, bit);
        status = decide();
        note(&bits, ((status == CEDE_STATUS_CORRUPT) || (status == CEDE_STATUS_NOT_INITIALISED)) &&
                        (decision.cause == CEDE_CAUSE_NONE) && (decision.acceleration == -CEDE_LAST_RESORT_BRAKING));
        approach = kept;
    }
    put_tally("a bit of an approach (contract, plan, tracks)", &bits, "found by cede_approach_decide, which brakes");
    put_case("the approach as it was", decide());
}

static void damage_others(void)
{
    tally of_drive = {0};
    tally of_policy = {0};
    tally of_junction = {0};
    uint32_t bit;
    cede_contract contract;

    (void)choose_contract(&contract);
    kept_drive = drive;
    for (bit = 0u; bit < BITS(drive); bit++) {
        flip(drive.storage, bit);
        note(&of_drive, cede_approach_enter(&kept, &drive, &junction, LEFT, NULL) != CEDE_STATUS_OK);
        drive = kept_drive;
    }
    put_tally("a bit of a drive (policy, contract)", &of_drive, "found by cede_approach_enter");
    kept_policy = policy;
    for (bit = 0u; bit < BITS(policy); bit++) {
        flip(policy.storage, bit);
        note(&of_policy, cede_drive_init(&kept_drive, &policy, &contract, CEDE_PART_LEFT, NULL) != CEDE_STATUS_OK);
        policy = kept_policy;
    }
    put_tally("a bit of a policy", &of_policy, "found by cede_drive_init");
    for (bit = 0u; bit < BITS(junction); bit += 9u) {
        flip(junction.storage, bit);
        note(&of_junction, cede_junction_check(&junction) != CEDE_STATUS_OK);
        flip(junction.storage, bit);
    }
    put_tally("a bit of a junction", &of_junction, "found by cede_junction_check");
    junction.storage[CEDE_JUNCTION_WORDS / 2u] ^= 1u;
    put_case("a bit of a junction, without cede_junction_check", decide());
    junction.storage[CEDE_JUNCTION_WORDS / 2u] ^= 1u;
}

/* The FPU. */

static void another_mode(const char *what, uint32_t mode)
{
    cede_status test;
    cede_status status;

    (void)begin();
    port_float_mode(mode);
    test = cede_self_test();
    status = decide();
    port_float_mode(0u);
    put(what);
    put(": cede_self_test: ");
    put(cede_status_text(test));
    put("; cede_approach_decide: ");
    put_outcome(status);
}

static void another_answer(void)
{
    uint32_t answer = 0u;
    cede_status status = cede_known_answer(&policy, &junction, &approach, &answer);

    put("the known answer: ");
    put(cede_status_text(status));
    put_line(answer == CEDE_EMBEDDED_ANSWER ? "; it is that of the host" : "; it is another one");
    (void)make_junction();
    port_float_mode(0x00c00000u);
    status = cede_known_answer(&policy, &junction, &approach, &answer);
    port_float_mode(0u);
    put("the known answer, rounding to zero: ");
    put_line(cede_status_text(status));
    (void)make_junction();
}

/* The schedule. */

static void call_at(const char *what, int32_t late_us)
{
    (void)begin();
    now_us = (uint64_t)((int64_t)now_us + late_us);
    put_case(what, decide());
    now_us = (uint64_t)((int64_t)now_us - late_us);
    pass();
    observe();
    put_case("  the next period, on time", decide());
}

/* Calls are left out; the others drive on, and the ego as it was told. */
static void leave_out(const char *what, uint32_t periods)
{
    uint32_t i;

    (void)begin();
    for (i = 0u; i < periods; i++) {
        pass();
    }
    observe();
    put_case(what, decide());
    pass();
    observe();
    put_case("  the next period, on time", decide());
}

static void call_again(void)
{
    cede_decision first;
    cede_status status;

    (void)begin();
    (void)decide();
    first = decision;
    status = decide();
    put("the same call twice: ");
    put(bits_of(first.acceleration) == bits_of(decision.acceleration) ? "the same command; " : "another command; ");
    put_outcome(status);
}

/* Sensors. */

static void damaged(const char *what, float *number, float value)
{
    const float was = *number;

    put(what);
    put(": ");
    *number = value;
    put_outcome(decide());
    *number = was;
}

static void dead_sensors(void)
{
    union {
        uint32_t bits;
        float value;
    } nan = {0x7fc00000u};
    struct {
        const char *what;
        float *number;
    } numbers[] = {
        {"NaN for the ego's s", &seen.ego.s},
        {"NaN for the ego's speed", &seen.ego.speed},
        {"NaN for the ego's x", &seen.ego.pose.position.x},
        {"NaN for the ego's direction", &seen.ego.pose.direction.y},
        {"NaN for a track's s", &tracks[0].candidates[0].s},
        {"NaN for a track's speed", &tracks[0].speed},
        {"NaN for a track's y", &tracks[0].pose.position.y},
        {"NaN for a track's direction", &tracks[0].pose.direction.x},
    };
    uint32_t i;

    for (i = 0u; i < sizeof numbers / sizeof numbers[0]; i++) {
        (void)begin();
        damaged(numbers[i].what, numbers[i].number, nan.value);
    }
    (void)begin();
    damaged("the ego's speed is out of its range", &seen.ego.speed, 200.0f);
    (void)begin();
    damaged("the ego is off its path by 20 m", &seen.ego.pose.position.y, -22.0f);
}

/* Periods until a sensor that gives the same again and again is noticed; 0 if it never is. */
static void stuck(const char *what, int ego_s, int ego_speed, int its_s)
{
    cede_vehicle frozen_ego;
    cede_vehicle frozen_other;
    uint32_t step;
    uint32_t noticed = 0u;
    cede_status status = begin();

    frozen_ego = ego;
    frozen_other = other;
    for (step = 1u; (step <= 40u) && (noticed == 0u); step++) {
        const cede_vehicle true_ego = ego;
        const cede_vehicle true_other = other;

        ego.s = (ego_s != 0) ? frozen_ego.s : ego.s;
        ego.speed = (ego_speed != 0) ? frozen_ego.speed : ego.speed;
        other.s = (its_s != 0) ? frozen_other.s : other.s;
        observe();
        status = decide();
        noticed = (decision.breach != CEDE_BREACH_NONE) ? step : 0u;
        ego = true_ego;
        other = true_other;
        pass();
    }
    put(what);
    put(", noticed in period ");
    put_number((int32_t)noticed);
    put(": ");
    put_outcome(status);
}

/* Tracks. */

static void many(const char *what, uint32_t count, uint8_t candidates)
{
    uint32_t i;

    (void)begin();
    for (i = 1u; i < count; i++) {
        tracks[i] = tracks[0];
        tracks[i].number = (uint16_t)(TRACK + i);
        tracks[i].candidate_count = candidates;
        tracks[i].candidates[0].s = 2.0f * (float)i;
        (void)cede_junction_pose(&junction, ONCOMING, tracks[i].candidates[0].s, &tracks[i].pose);
    }
    seen.track_count = count;
    put(what);
    put(": ");
    put_outcome(decide());
    if (decision.has_unwatched != 0u) {
        put_line("  one that matters is not watched: the ego stays out of its zones");
    }
}

static void twins(void)
{
    (void)begin();
    tracks[1] = tracks[0];
    seen.track_count = 2u;
    put_case("one number twice", decide());
}

int main(void)
{
    cede_status status;

    weights_words = (uint32_t)(weights_end - weights_file);
    if (weights_words > MOST_WEIGHTS) {
        return (int)CEDE_STATUS_TOO_LARGE;
    }
    for (uint32_t i = 0u; i < weights_words; i++) {
        weights[i] = weights_file[i];
    }
    status = make_drive();
    if (status == CEDE_STATUS_OK) {
        status = make_junction();
    }
    if (status == CEDE_STATUS_OK) {
        status = begin();
    }
    if (status != CEDE_STATUS_OK) {
        put_line(cede_status_text(status));
        return (int)status;
    }
    put_case("nothing is wrong", decide());

    put_line("- memory");
    damage_weights();
    drive_with_damaged_weights();
    (void)begin();
    damage_approach();
    damage_others();

    put_line("- the FPU");
    another_mode("it rounds up", 0x00400000u);
    another_mode("it rounds down", 0x00800000u);
    another_mode("it rounds to zero", 0x00c00000u);
    another_mode("it flushes subnormal numbers", 0x01000000u);
    another_answer();

    put_line("- the schedule");
    call_at("late by 4 ms, within the jitter", 4000);
    call_at("late by 30 ms", 30000);
    call_at("early by 30 ms", -30000);
    leave_out("one period left out", 1u);
    leave_out("five periods left out", 5u);
    leave_out("50 periods left out", 50u);
    call_again();
    call_at("the clock goes back by a second", -1000000);

    put_line("- the sensors");
    dead_sensors();
    stuck("the ego's s is stuck", 1, 0, 0);
    stuck("the ego's speed is stuck", 0, 1, 0);
    stuck("the ego's s and speed are stuck", 1, 1, 0);
    stuck("a track's s is stuck", 0, 0, 1);

    put_line("- the track list");
    many("as many as there is room for", CEDE_MAX_TRACKS, 1u);
    many("one more", CEDE_MAX_TRACKS + 1u, 1u);
    many("a track without a candidate", 2u, 0u);
    many("a track with too many candidates", 2u, CEDE_MAX_CANDIDATES + 1u);
    twins();
    return 0;
}
