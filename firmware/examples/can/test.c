/* Drives a left turn through the frames, in both directions: what the bus rounds is within the contract. */
#include "can.h"
#include "cede_can.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define STEP_S 0.1f
#define TRACK 17u

static cede_policy policy;
static cede_drive drive;
static cede_junction junction;
static cede_approach approach;
static int failures;

static const cede_point mine[] = {{-40.0f, -2.0f}, {-6.0f, -2.0f}, {0.0f, 0.0f}, {2.0f, 6.0f}, {2.0f, 40.0f}};
static const cede_point theirs[] = {{40.0f, 2.0f}, {-40.0f, 2.0f}};
static const cede_footprint car = {4.6f, 1.9f};

static void expect(int holds, const char *what)
{
    if (holds == 0) {
        failures++;
        (void)printf("can: %s\n", what);
    }
}

static int begin(void)
{
    cede_contract contract;
    uint8_t path;

    (void)cede_contract_worst_case(&contract);
    contract.position_error = 0.1f; /* of which the bus takes 0.005 */
    contract.speed_error = 0.1f;
    contract.ego_disturbance = 0.1f; /* of which the bus takes 0.005, too */
    contract.ego_acceleration = 2.5f;
    contract.ego_go = 2.5f;
    return (cede_policy_init_embedded(&policy) == CEDE_STATUS_OK) &&
           (cede_drive_init(&drive, &policy, &contract, CEDE_PART_LEFT, NULL) == CEDE_STATUS_OK) &&
           (cede_junction_init(&junction) == CEDE_STATUS_OK) &&
           (cede_junction_add_path(&junction, mine, 5u, CEDE_CLASS_CAR, &car, &path, NULL) == CEDE_STATUS_OK) &&
           (cede_junction_add_path(&junction, theirs, 2u, CEDE_CLASS_CAR, &car, &path, NULL) == CEDE_STATUS_OK) &&
           (cede_junction_build(&junction, NULL) == CEDE_STATUS_OK) &&
           (cede_approach_enter(&approach, &drive, &junction, 0u, NULL) == CEDE_STATUS_OK);
}

static void send_ego(const cede_vehicle *ego, uint8_t counter, uint8_t valid, uint8_t state[8], uint8_t position[8])
{
    struct cede_can_ego_state_t one = {0};
    struct cede_can_ego_position_t two = {0};
    float heading = atan2f(ego->pose.direction.y, ego->pose.direction.x);

    heading += (heading < 0.0f) ? 6.2831853f : 0.0f;
    one.s = cede_can_ego_state_s_encode(ego->s);
    one.speed = cede_can_ego_state_speed_encode(ego->speed);
    one.heading = cede_can_ego_state_heading_encode(heading) & 0x0fffu;
    one.valid = valid;
    one.counter = counter;
    two.x = cede_can_ego_position_x_encode(ego->pose.position.x);
    two.y = cede_can_ego_position_y_encode(ego->pose.position.y);
    two.counter = counter;
    (void)cede_can_ego_state_pack(state, &one, 8u);
    (void)cede_can_ego_position_pack(position, &two, 8u);
}

static void send_track(uint16_t number, uint8_t path, float s, float speed, uint8_t frame[8])
{
    struct cede_can_track_t track = {.number = number, .class = CEDE_CLASS_CAR, .path = path};

    track.s = cede_can_track_s_encode(s);
    track.speed = cede_can_track_speed_encode(speed);
    (void)cede_can_track_pack(frame, &track, 8u);
}

static void advance(cede_vehicle *vehicle, float acceleration)
{
    float speed = vehicle->speed + acceleration * STEP_S;

    speed = (speed > 0.0f) ? speed : 0.0f;
    vehicle->s += 0.5f * (vehicle->speed + speed) * STEP_S;
    vehicle->speed = speed;
}

static void drive_by_frames(void)
{
    cede_vehicle ego = {.s = 15.0f, .speed = 6.0f};
    cede_vehicle other = {.s = 0.0f, .speed = 6.0f};
    cede_decision decision;
    uint8_t step;

    for (step = 0u; step < 100u; step++) {
        uint8_t state[8], position[8], seen[8], commanded[8];
        cede_track tracks[CEDE_MAX_TRACKS];
        cede_observation observation = {.tracks = tracks};
        struct cede_can_cede_command_t command;
        cede_status status;

        (void)cede_junction_pose(&junction, 0u, ego.s, &ego.pose);
        send_ego(&ego, step & 15u, 1u, state, position);
        can_ego(state, position, &observation.ego);
        expect(fabsf(observation.ego.s - ego.s) < 0.0051f, "the ego's s");
        expect(fabsf(observation.ego.pose.position.y - ego.pose.position.y) < 0.0056f, "the ego's y");
        expect(fabsf(observation.ego.pose.direction.y - ego.pose.direction.y) < 0.002f, "the ego's direction");
        send_track(TRACK, 1u, other.s, other.speed, seen);
        expect(can_track(seen, &junction, tracks, &observation.track_count) == CEDE_STATUS_OK, "a track");
        status = cede_approach_decide(&approach, 1000000u + 100000u * step, &observation, &decision);
        expect(status == CEDE_STATUS_OK, cede_status_text(status));
        expect(decision.fault.kind == CEDE_FAULT_KIND_NONE, cede_fault_text(decision.fault.kind));
        expect(decision.breach == CEDE_BREACH_NONE, cede_breach_text(decision.breach));
        expect(decision.has_plan != 0u, "no plan");
        can_command(status, &decision, step, commanded);
        (void)cede_can_cede_command_unpack(&command, commanded, 8u);
        expect((command.status == 0u) && (command.counter == (step & 15u)) && (command.cause == decision.cause), "a command");
        advance(&ego, cede_can_cede_command_acceleration_decode(command.acceleration));
        advance(&other, 0.0f);
    }
    expect(ego.s > 40.0f, "the ego has not crossed");
}

static void carry_on_without_sensors(void)
{
    const cede_vehicle ego = {.s = 15.0f, .speed = 6.0f, .pose = {{-25.0f, -2.0f}, {1.0f, 0.0f}}};
    cede_track tracks[CEDE_MAX_TRACKS];
    cede_vehicle received;
    uint8_t state[8], position[8], frame[8];
    uint32_t count = 0u;
    uint8_t i;

    send_ego(&ego, 3u, 0u, state, position);
    can_ego(state, position, &received);
    expect(isnan(received.s) && isnan(received.speed), "what is not valid is NaN");
    send_ego(&ego, 3u, 1u, state, position);
    position[6] ^= 0x10u; /* its counter */
    can_ego(state, position, &received);
    expect(isnan(received.s), "two frames of different periods");
    for (i = 0u; i < CEDE_MAX_CANDIDATES; i++) {
        send_track(5u, i & 1u, (float)i, 4.0f, frame);
        expect(can_track(frame, &junction, tracks, &count) == CEDE_STATUS_OK, "a candidate");
    }
    expect((count == 1u) && (tracks[0].candidate_count == CEDE_MAX_CANDIDATES), "candidates of one track");
    expect(can_track(frame, &junction, tracks, &count) == CEDE_STATUS_CANDIDATE_COUNT, "one candidate more");
    for (i = 1u; i < CEDE_MAX_TRACKS; i++) {
        send_track(100u + i, 1u, (float)i, 4.0f, frame);
        expect(can_track(frame, &junction, tracks, &count) == CEDE_STATUS_OK, "many tracks");
    }
    send_track(200u, 1u, 1.0f, 4.0f, frame);
    expect(can_track(frame, &junction, tracks, &count) == CEDE_STATUS_TOO_MANY_TRACKS, "one track more");
}

int main(void)
{
    if (begin() == 0) {
        (void)printf("can: the contract or the junction is refused\n");
        return 1;
    }
    drive_by_frames();
    carry_on_without_sensors();
    (void)printf("can: 100 periods through the frames, %d failures\n", failures);
    return (failures == 0) ? 0 : 1;
}
