/* The signals themselves are taken apart and put together by what cantools generates of cede.dbc. */
#include "can.h"
#include "cede_can.h"
#include <math.h>
#include <stddef.h>

void can_ego(const uint8_t state[CAN_BYTES], const uint8_t position[CAN_BYTES], cede_vehicle *ego)
{
    struct cede_can_ego_state_t one;
    struct cede_can_ego_position_t two;
    float heading;
    int sound;

    (void)cede_can_ego_state_unpack(&one, state, CAN_BYTES);
    (void)cede_can_ego_position_unpack(&two, position, CAN_BYTES);
    sound = (one.valid == 1u) && (one.counter == two.counter) && cede_can_ego_state_speed_is_in_range(one.speed) &&
            cede_can_ego_position_x_is_in_range(two.x) && cede_can_ego_position_y_is_in_range(two.y);
    heading = cede_can_ego_state_heading_decode(one.heading);
    ego->s = sound ? cede_can_ego_state_s_decode(one.s) : NAN;
    ego->speed = sound ? cede_can_ego_state_speed_decode(one.speed) : NAN;
    ego->pose.position.x = cede_can_ego_position_x_decode(two.x);
    ego->pose.position.y = cede_can_ego_position_y_decode(two.y);
    ego->pose.direction.x = cosf(heading);
    ego->pose.direction.y = sinf(heading);
}

static cede_track *find(uint16_t number, cede_track *tracks, uint32_t count)
{
    uint32_t i;

    for (i = 0u; i < count; i++) {
        if (tracks[i].number == number) {
            return &tracks[i];
        }
    }
    return NULL;
}

cede_status can_track(const uint8_t frame[CAN_BYTES], const cede_junction *junction, cede_track *tracks, uint32_t *count)
{
    struct cede_can_track_t seen;
    cede_track *track;
    cede_candidate *candidate;
    cede_status status = CEDE_STATUS_OK;

    (void)cede_can_track_unpack(&seen, frame, CAN_BYTES);
    track = find(seen.number, tracks, *count);
    if (track == NULL) {
        if (*count >= CEDE_MAX_TRACKS) {
            return CEDE_STATUS_TOO_MANY_TRACKS;
        }
        track = &tracks[*count];
        *count += 1u;
        *track = (cede_track){.number = seen.number, .vehicle_class = seen.class};
        track->speed = cede_can_track_speed_decode(seen.speed);
        status = cede_junction_pose(junction, seen.path, cede_can_track_s_decode(seen.s), &track->pose);
    }
    if (track->candidate_count >= CEDE_MAX_CANDIDATES) {
        return CEDE_STATUS_CANDIDATE_COUNT;
    }
    candidate = &track->candidates[track->candidate_count];
    track->candidate_count++;
    candidate->path = seen.path;
    candidate->s = cede_can_track_s_decode(seen.s);
    return status;
}

void can_command(cede_status status, const cede_decision *decision, uint8_t counter, uint8_t frame[CAN_BYTES])
{
    struct cede_can_cede_command_t command = {0};

    command.acceleration = cede_can_cede_command_acceleration_encode(decision->acceleration);
    command.cause = (decision->cause <= CEDE_CAUSE_FALLBACK) ? decision->cause : CEDE_CAUSE_NONE;
    command.breach = (decision->breach <= CEDE_BREACH_TRACK) ? decision->breach : CEDE_BREACH_NONE;
    command.has_plan = decision->has_plan;
    command.status = (uint8_t)status;
    command.counter = counter & 15u;
    (void)cede_can_cede_command_pack(frame, &command, CAN_BYTES);
}
