/*
 * Drives with one policy, takes in another on the way, and refuses what is damaged, older, unsigned or decides otherwise.
 * The policy that is sent is the embedded one in integers; the junction is the one that is driven through.
 */
#include "text.h"
#include "update.h"

#define STEP_US 100000u
#define IN_USE 3u

/* The file that is sent. */
__asm__(".section .rodata.weights, \"a\"\n .balign 64\n .global sent_file\nsent_file:\n .incbin \"" WEIGHTS_I16 "\"\n"
        " .global sent_end\nsent_end:\n .previous");
extern const uint32_t sent_file[];
extern const uint32_t sent_end[];
#define MOST_WORDS 4096u

static uint32_t content[MOST_WORDS];
static update_header header;
static update_bench bench;
static cede_policy policy;
static cede_policy newer;
static cede_drive drive;
static cede_junction junction;
static cede_junction ahead;
static cede_approach approach;

static const cede_footprint car = {4.6f, 1.9f};
static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};

/* Stands in for a signature, to show what it covers. It protects against nobody: anyone can compute it. */
static uint32_t stand_in(const update_header *of, const uint32_t *words)
{
    uint32_t sum = of->kind;
    uint32_t i;

    sum = (sum * 31u) + of->version;
    sum = (sum * 31u) + of->bytes;
    sum = (sum * 31u) + of->answer;
    for (i = 0u; i < of->bytes / 4u; i++) {
        sum = (sum * 31u) + words[i];
    }
    return sum;
}

static int is_signed(const update_header *of, const uint32_t *words)
{
    const uint32_t sum = stand_in(of, words);

    return (of->signature[0] == (uint8_t)sum) && (of->signature[1] == (uint8_t)(sum >> 8u)) &&
           (of->signature[2] == (uint8_t)(sum >> 16u)) && (of->signature[3] == (uint8_t)(sum >> 24u));
}

static void sign(void)
{
    const uint32_t sum = stand_in(&header, content);

    header.signature[0] = (uint8_t)sum;
    header.signature[1] = (uint8_t)(sum >> 8u);
    header.signature[2] = (uint8_t)(sum >> 16u);
    header.signature[3] = (uint8_t)(sum >> 24u);
}

static const update sent = {&header, content, 4u * MOST_WORDS, is_signed};

/* What was sent, whole. */
static void send_policy(void)
{
    const uint32_t words = (uint32_t)(sent_end - sent_file);
    uint32_t i;

    for (i = 0u; (i < words) && (i < MOST_WORDS); i++) {
        content[i] = sent_file[i];
    }
    header = (update_header){UPDATE_POLICY, IN_USE + 1u, 4u * words, 0u, {0u}};
    if (cede_policy_init(&newer, content, header.bytes) == CEDE_STATUS_OK) {
        (void)cede_known_answer(&newer, &bench.junction, &bench.approach, &header.answer); /* on the host that sends it */
    }
    sign();
}

static void put_path(uint32_t *words, const cede_point *points, uint16_t count)
{
    const update_path head = {car, CEDE_CLASS_CAR, count};
    uint8_t *to = (uint8_t *)&content[*words];
    uint32_t i;

    for (i = 0u; i < sizeof head; i++) {
        to[i] = ((const uint8_t *)&head)[i];
    }
    for (i = 0u; i < count * sizeof *points; i++) {
        to[sizeof head + i] = ((const uint8_t *)points)[i];
    }
    *words += (uint32_t)(sizeof head / 4u) + (2u * (uint32_t)count);
}

static void send_junction(void)
{
    uint32_t words = 0u;

    put_path(&words, mine, 5u);
    put_path(&words, theirs, 2u);
    header = (update_header){UPDATE_JUNCTION, IN_USE + 1u, 4u * words, 0u, {0u}};
    sign();
}

static void put_result(const char *what, update_result result, cede_status status)
{
    static const char *const texts[] = {"taken in", "refused, truncated", "refused, of another kind", "refused, not newer",
                                        "refused, not signed", "refused by the library", "refused, it decides otherwise"};

    put(what);
    put(": ");
    put(texts[result]);
    put(": ");
    put_line(cede_status_text(status));
}

static update_result take_policy(const char *what)
{
    cede_status status;
    const update_result result = update_policy(&sent, IN_USE, &bench, &newer, &status);

    put_result(what, result, status);
    return result;
}

static update_result take_junction(const char *what)
{
    cede_status status;
    const update_result result = update_junction(&sent, IN_USE, &ahead, &status);

    put_result(what, result, status);
    return result;
}

static cede_status begin(void)
{
    cede_contract contract;
    cede_status status = cede_contract_worst_case(&contract);

    if (status == CEDE_STATUS_OK) {
        status = cede_policy_init_embedded(&policy);
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, NULL);
    }
    send_junction();
    if ((status == CEDE_STATUS_OK) && (take_junction("the junction ahead") == UPDATE_DONE)) {
        status = update_junction(&sent, IN_USE, &junction, &status) == UPDATE_DONE ? CEDE_STATUS_OK : CEDE_STATUS_OTHER;
    }
    if (status == CEDE_STATUS_OK) {
        status = cede_approach_enter(&approach, &drive, &junction, 0u, NULL);
    }
    return status;
}

/* A period with perfect sensors; nobody else is there. */
static cede_status step(cede_vehicle *ego, uint64_t now_us, cede_decision *decision)
{
    cede_observation seen = {0};
    cede_status status = cede_junction_pose(&junction, 0u, ego->s, &ego->pose);
    float speed;

    seen.ego = *ego;
    if (status == CEDE_STATUS_OK) {
        status = cede_approach_decide(&approach, now_us, &seen, decision);
    }
    speed = ego->speed + (decision->acceleration * 0.1f);
    ego->s += 0.05f * (ego->speed + speed);
    ego->speed = speed;
    return status;
}

/* On the way, between two decisions. */
static int drive_on(void)
{
    cede_vehicle ego = {.s = 20.0f, .speed = 5.0f};
    cede_plan before = {0};
    cede_plan after = {0};
    cede_decision decision;
    uint32_t i;

    for (i = 0u; i < 20u; i++) {
        if (step(&ego, 1000000u + (uint64_t)i * STEP_US, &decision) != CEDE_STATUS_OK) {
            return 1;
        }
        if (i == 9u) {
            (void)cede_approach_plan(&approach, &before);
            if (cede_approach_set_policy(&approach, &newer) != CEDE_STATUS_OK) {
                return 1;
            }
            (void)cede_approach_plan(&approach, &after);
        }
    }
    put_line(((before.exists == 1u) && (after.exists == 1u) && (before.go == after.go)) ? "the plan is kept" : "no plan");
    put("after the update: ");
    put_line(cede_cause_text(decision.cause));
    return 0;
}

int main(void)
{
    if (begin() != CEDE_STATUS_OK) {
        return 1;
    }
    header.kind = UPDATE_POLICY;
    sign();
    (void)take_junction("a policy in place of a junction");
    send_junction();
    content[2] = 0xffff0000u; /* the number of points */
    sign();
    (void)take_junction("a junction with more points than it has");
    send_junction();
    content[3] = 0x7fc00000u;
    sign();
    (void)take_junction("a junction with a point that is no number");

    send_policy();
    header.bytes = 4u * MOST_WORDS + 4u;
    (void)take_policy("a file that is longer than its place");
    send_policy();
    content[100] ^= 1u;
    (void)take_policy("a flipped bit");
    sign();
    (void)take_policy("a flipped bit, signed");
    send_policy();
    header.version = IN_USE + 2u;
    (void)take_policy("another version than what was signed");
    header.version = IN_USE;
    sign();
    (void)take_policy("the version that is in use");
    send_policy();
    header.answer ^= 1u;
    sign();
    (void)take_policy("another known answer");
    send_policy();
    if (take_policy("the policy") != UPDATE_DONE) {
        return 1;
    }
    return drive_on();
}
