/*
 * Cede: decides how a vehicle crosses an unsignalized intersection. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Generated from firmware/capi; not to be edited. docs/integration.md is its manual.
 *
 * There is no allocation, no global state and no output. Numbers are in SI units. Every function returns, and its time is
 * bounded.
 *
 * Pointers. A null or misaligned pointer is answered by a status. Any other pointer points to what its type says, or to as
 * many of them as the count beside it says, during the call. Where the description says "may be null", null is no error;
 * a `detail` may always be null.
 *
 * Arguments. All bits of all arguments are allowed. They are copied before a result is written, so a result may
 * overlap an argument. A result does not overlap an object. If a function returns anything but CEDE_STATUS_OK, its results
 * are unchanged, unless it says otherwise.
 *
 * Objects. cede_policy, cede_drive, cede_junction and cede_approach are storage that the caller provides: static, on a
 * stack, or in a pool that is aligned to CEDE_ALIGNMENT. An object is made by its init or enter function, and needs no
 * end. Its bytes are checked in every call: one that was never made, is moved, overwritten or in use gives a status.
 * One object is used by one thread at a time; functions that take it by a pointer to const may be called at once.
 *
 * Lifetimes. An approach refers to its junction, and a policy, a drive and an approach to the policy's weights. The
 * junction stays where it is; the weights stay as they are.
 */

#ifndef CEDE_H
#define CEDE_H

#include <stdint.h>

/**
 * Words of eight bytes of a cede_approach.
 */
#define CEDE_APPROACH_WORDS 392

/**
 * Most paths of which a part is out of sight, in one approach.
 */
#define CEDE_MAX_SIGHTS 8

/**
 * Braking in m/s^2 that is commanded when the approach cannot be used: nothing is known of its contract then.
 */
#define CEDE_LAST_RESORT_BRAKING 3.0

/**
 * Words of eight bytes of a cede_drive.
 */
#define CEDE_DRIVE_WORDS 42

/**
 * The part of the left-turner, or of the one that has to give way.
 */
#define CEDE_PART_LEFT 0

/**
 * The part of the one whom the left-turner meets.
 */
#define CEDE_PART_OTHER 1

/**
 * Most paths of a junction.
 */
#define CEDE_MAX_PATHS 12

/**
 * Most points of all its paths.
 */
#define CEDE_MAX_POINTS 192

/**
 * The first so many paths can be entered by the ego.
 */
#define CEDE_MAX_ENTRIES 3

/**
 * Most points of one route, before those that lie on a straight line are left out.
 */
#define CEDE_MAX_ROUTE_POINTS 64

/**
 * Most zones of two paths.
 */
#define CEDE_MAX_ZONES 3

/**
 * Most speed limits of a path.
 */
#define CEDE_MAX_LIMITS 4

/**
 * Words of eight bytes of a cede_junction.
 */
#define CEDE_JUNCTION_WORDS 856

/**
 * What cede_known_answer() finds with the embedded policy.
 */
#define CEDE_EMBEDDED_ANSWER 697491257

/**
 * Most tracks of an observation.
 */
#define CEDE_MAX_TRACKS 24

/**
 * Most paths between which a track may be undecided.
 */
#define CEDE_MAX_CANDIDATES 4

/**
 * A car or anything of its size.
 */
#define CEDE_CLASS_CAR 0

/**
 * A lorry or a bus.
 */
#define CEDE_CLASS_LORRY 1

/**
 * A bicycle or a motorcycle.
 */
#define CEDE_CLASS_BICYCLE 2

/**
 * Somebody on foot on a crossing, who may turn back at any time.
 */
#define CEDE_CLASS_PEDESTRIAN 3

/**
 * Words of eight bytes of a cede_policy.
 */
#define CEDE_POLICY_WORDS 32

/**
 * The version of this interface. A program compares it with cede_abi_version() once, at its start: it grows with every
 * change of a structure, a size, a number or the meaning of a function.
 */
#define CEDE_ABI_VERSION 5

/**
 * Alignment of all objects in bytes.
 */
#define CEDE_ALIGNMENT 8

/**
 * What became of a call. The numbers are stable: none changes its meaning, new ones are added.
 */
enum cede_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Done.
     */
    CEDE_STATUS_OK = 0,
    /**
     * A pointer that must not be null is.
     */
    CEDE_STATUS_NULL_POINTER = 1,
    /**
     * A pointer is not a multiple of its type's alignment.
     */
    CEDE_STATUS_MISALIGNED = 2,
    /**
     * Not an object of this kind: never initialised, moved, or in use by a call that is not finished.
     */
    CEDE_STATUS_NOT_INITIALISED = 3,
    /**
     * The object's bytes have changed between two calls.
     */
    CEDE_STATUS_CORRUPT = 4,
    /**
     * The junction of this approach is another one now.
     */
    CEDE_STATUS_STALE = 5,
    /**
     * An array is larger than memory.
     */
    CEDE_STATUS_TOO_LARGE = 6,
    /**
     * The FPU does not round to nearest, or does not keep subnormal numbers.
     */
    CEDE_STATUS_FLOAT_ENVIRONMENT = 7,
    /**
     * A numbered choice, as a class or a part, has a number that is none.
     */
    CEDE_STATUS_UNKNOWN_CHOICE = 10,
    /**
     * More than CEDE_MAX_TRACKS tracks.
     */
    CEDE_STATUS_TOO_MANY_TRACKS = 11,
    /**
     * A track without a candidate, or with more than CEDE_MAX_CANDIDATES.
     */
    CEDE_STATUS_CANDIDATE_COUNT = 12,
    /**
     * A number of the observation, or an acceleration, is out of its range.
     */
    CEDE_STATUS_INPUT_FAULT = 13,
    /**
     * The weights do not begin with CEDE.
     */
    CEDE_STATUS_WEIGHTS_MAGIC = 20,
    /**
     * The weights' checksum does not fit: a bit has changed.
     */
    CEDE_STATUS_WEIGHTS_CHECKSUM = 21,
    /**
     * The weights have a version, feature set or perspective that this library does not know.
     */
    CEDE_STATUS_WEIGHTS_UNKNOWN = 22,
    /**
     * The weights' length does not fit their layers.
     */
    CEDE_STATUS_WEIGHTS_SHAPE = 23,
    /**
     * A weight is not finite or too large.
     */
    CEDE_STATUS_WEIGHTS_OUT_OF_RANGE = 24,
    /**
     * This library was built without the embedded policy.
     */
    CEDE_STATUS_WEIGHTS_NOT_EMBEDDED = 25,
    /**
     * A sum of a network of integers could exceed 32 bits.
     */
    CEDE_STATUS_WEIGHTS_OVERFLOW = 26,
    /**
     * A number of the contract is out of its range.
     */
    CEDE_STATUS_CONTRACT_OUT_OF_RANGE = 30,
    /**
     * A route needs two points that are apart.
     */
    CEDE_STATUS_ROUTE_TOO_FEW_POINTS = 40,
    /**
     * More than CEDE_MAX_ROUTE_POINTS points.
     */
    CEDE_STATUS_ROUTE_TOO_MANY_POINTS = 41,
    /**
     * A coordinate is not a number, or more than 8192 m from the origin.
     */
    CEDE_STATUS_ROUTE_OUT_OF_RANGE = 42,
    /**
     * The junction has no path.
     */
    CEDE_STATUS_JUNCTION_NO_PATHS = 50,
    /**
     * More than CEDE_MAX_PATHS paths.
     */
    CEDE_STATUS_JUNCTION_TOO_MANY_PATHS = 51,
    /**
     * More than CEDE_MAX_POINTS points of all paths.
     */
    CEDE_STATUS_JUNCTION_TOO_MANY_POINTS = 52,
    /**
     * There is no such path.
     */
    CEDE_STATUS_JUNCTION_UNKNOWN_PATH = 53,
    /**
     * A side of a footprint is not in (0, 40] m.
     */
    CEDE_STATUS_JUNCTION_FOOTPRINT = 54,
    /**
     * The tolerance is not in [0, 1] m.
     */
    CEDE_STATUS_JUNCTION_TOLERANCE = 55,
    /**
     * A path turns by more than 90 degrees in one point.
     */
    CEDE_STATUS_JUNCTION_KINK = 56,
    /**
     * A path is longer than 512 m.
     */
    CEDE_STATUS_JUNCTION_TOO_LONG = 57,
    /**
     * A path comes back to itself.
     */
    CEDE_STATUS_JUNCTION_RETURNS = 58,
    /**
     * A line is not on its path.
     */
    CEDE_STATUS_JUNCTION_LINE = 59,
    /**
     * A path was given the right of way over itself.
     */
    CEDE_STATUS_JUNCTION_RIGHT_OF_WAY = 60,
    /**
     * The junction is not built yet.
     */
    CEDE_STATUS_JUNCTION_NOT_BUILT = 61,
    /**
     * The junction is built: nothing can be added.
     */
    CEDE_STATUS_JUNCTION_BUILT = 62,
    /**
     * A speed limit is not in (0, 100] m/s, or not on its path.
     */
    CEDE_STATUS_JUNCTION_SPEED_LIMIT = 63,
    /**
     * More than CEDE_MAX_LIMITS speed limits of a path.
     */
    CEDE_STATUS_JUNCTION_TOO_MANY_LIMITS = 64,
    /**
     * The lateral acceleration is not in (0, 20] m/s^2.
     */
    CEDE_STATUS_JUNCTION_LATERAL = 65,
    /**
     * The highest speed of pedestrians is not in (0, 10] m/s.
     */
    CEDE_STATUS_JUNCTION_PACE = 66,
    /**
     * The junction has no such path to enter by.
     */
    CEDE_STATUS_ENTER_PATH = 70,
    /**
     * The contract's position_error is too large for a lane that the ego shares with another path.
     */
    CEDE_STATUS_ENTER_POSITION_ERROR = 71,
    /**
     * The place from which a path is in sight is not on it.
     */
    CEDE_STATUS_SIGHT_FROM = 72,
    /**
     * The speed of those who are out of sight is not in (0, 100] m/s.
     */
    CEDE_STATUS_SIGHT_SPEED = 73,
    /**
     * More than CEDE_MAX_SIGHTS paths that are partly out of sight.
     */
    CEDE_STATUS_TOO_MANY_SIGHTS = 74,
    /**
     * The ego's state cannot be trusted: control cannot be handed over.
     */
    CEDE_STATUS_NOT_READY_FAULT = 80,
    /**
     * No plan is safe: control cannot be handed over.
     */
    CEDE_STATUS_NOT_READY_NO_PLAN = 81,
    /**
     * What this version of the library has no number for.
     */
    CEDE_STATUS_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_status cede_status;
#else
typedef int32_t cede_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A field of cede_contract. The numbers are stable.
 */
enum cede_contract_field
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    CEDE_CONTRACT_FIELD_NONE = 0,
    CEDE_CONTRACT_FIELD_PERIOD = 1,
    CEDE_CONTRACT_FIELD_LATENCY = 2,
    CEDE_CONTRACT_FIELD_JITTER = 3,
    CEDE_CONTRACT_FIELD_POSITION_ERROR = 4,
    CEDE_CONTRACT_FIELD_SPEED_ERROR = 5,
    CEDE_CONTRACT_FIELD_SLACK = 6,
    CEDE_CONTRACT_FIELD_EGO_MAX_SPEED = 7,
    CEDE_CONTRACT_FIELD_EGO_ACCELERATION = 8,
    CEDE_CONTRACT_FIELD_EGO_GO = 9,
    CEDE_CONTRACT_FIELD_EGO_BRAKING = 10,
    CEDE_CONTRACT_FIELD_OTHER_MAX_SPEED = 11,
    CEDE_CONTRACT_FIELD_OTHER_ACCELERATION = 12,
    CEDE_CONTRACT_FIELD_OTHER_BRAKING = 13,
    CEDE_CONTRACT_FIELD_FOLLOWER_REACTION = 14,
    CEDE_CONTRACT_FIELD_FOLLOWER_BRAKING = 15,
    CEDE_CONTRACT_FIELD_PRECEDENCE_DISTANCE = 16,
    CEDE_CONTRACT_FIELD_PRECEDENCE_BRAKING = 17,
    CEDE_CONTRACT_FIELD_PRECEDENCE_PATIENCE = 18,
    CEDE_CONTRACT_FIELD_EGO_EMERGENCY = 19,
    CEDE_CONTRACT_FIELD_EGO_LAG = 20,
    CEDE_CONTRACT_FIELD_EGO_GAIN = 21,
    CEDE_CONTRACT_FIELD_EGO_DISTURBANCE = 22,
    CEDE_CONTRACT_FIELD_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_contract_field cede_contract_field;
#else
typedef uint8_t cede_contract_field;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Who decided.
 */
enum cede_cause
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nobody: the approach cannot be used, and the command is CEDE_LAST_RESORT_BRAKING.
     */
    CEDE_CAUSE_NONE = 0,
    /**
     * The policy: its proposal is safe.
     */
    CEDE_CAUSE_POLICY = 1,
    /**
     * The shield: the proposal is not; `action` and `reason` say more.
     */
    CEDE_CAUSE_SHIELDED = 2,
    /**
     * Neither: `fallback` says why.
     */
    CEDE_CAUSE_FALLBACK = 3,
    /**
     * What this version has no number for.
     */
    CEDE_CAUSE_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_cause cede_cause;
#else
typedef uint8_t cede_cause;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the shield does instead of what was proposed.
 */
enum cede_action
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nothing.
     */
    CEDE_ACTION_NONE = 0,
    /**
     * The nearest acceleration that is safe.
     */
    CEDE_ACTION_NEAREST = 1,
    /**
     * The next command of the plan that was verified last.
     */
    CEDE_ACTION_REMEMBERED = 2,
    /**
     * What this version has no number for.
     */
    CEDE_ACTION_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_action cede_action;
#else
typedef uint8_t cede_action;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Whose motion since the last decision exceeds the contract's bounds.
 */
enum cede_breach
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nobody's.
     */
    CEDE_BREACH_NONE = 0,
    /**
     * The ego deviated from the command.
     */
    CEDE_BREACH_EGO = 1,
    /**
     * The track's.
     */
    CEDE_BREACH_TRACK = 2,
    /**
     * What this version has no number for.
     */
    CEDE_BREACH_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_breach cede_breach;
#else
typedef uint8_t cede_breach;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Why a proposal is refused.
 */
enum cede_reason_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It is not.
     */
    CEDE_REASON_KIND_NONE = 0,
    /**
     * The ego could not clear the zone before the other's earliest arrival; s from now.
     */
    CEDE_REASON_KIND_ARRIVAL = 1,
    /**
     * The ego would enter the other's lane without the gap in which the other can stop; m.
     */
    CEDE_REASON_KIND_ENTRY = 2,
    /**
     * The ego could not stop short of the other's zone, or behind the other in its lane; m.
     */
    CEDE_REASON_KIND_STOP = 3,
    /**
     * The ego could not clear the zone before somebody arrives who may be out of sight; s from now.
     */
    CEDE_REASON_KIND_HIDDEN = 4,
    /**
     * What this version has no number for.
     */
    CEDE_REASON_KIND_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_reason_kind cede_reason_kind;
#else
typedef uint8_t cede_reason_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What is wrong with an input, or with what is left to do.
 */
enum cede_fault_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nothing.
     */
    CEDE_FAULT_KIND_NONE = 0,
    /**
     * No plan keeps the guarantee: the contract was broken, or control was handed over in danger.
     */
    CEDE_FAULT_KIND_NO_PLAN = 1,
    /**
     * A number of the observation is out of its range.
     */
    CEDE_FAULT_KIND_INPUT = 2,
    /**
     * The call's time is not later than that of the last call.
     */
    CEDE_FAULT_KIND_BACKWARDS = 3,
    /**
     * The last call is not one period ago: `value` s instead of `high` s.
     */
    CEDE_FAULT_KIND_OFF_PERIOD = 4,
    /**
     * The proposed acceleration is not a finite number.
     */
    CEDE_FAULT_KIND_PROPOSAL = 5,
    /**
     * What this version has no number for.
     */
    CEDE_FAULT_KIND_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_fault_kind cede_fault_kind;
#else
typedef uint8_t cede_fault_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Whose state it is.
 */
enum cede_subject
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nobody's.
     */
    CEDE_SUBJECT_NONE = 0,
    /**
     * The ego's.
     */
    CEDE_SUBJECT_EGO = 1,
    /**
     * The track's.
     */
    CEDE_SUBJECT_TRACK = 2,
    /**
     * What this version has no number for.
     */
    CEDE_SUBJECT_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_subject cede_subject;
#else
typedef uint8_t cede_subject;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A number of a vehicle's state.
 */
enum cede_field
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * None.
     */
    CEDE_FIELD_NONE = 0,
    /**
     * Arc length in m, outside the path.
     */
    CEDE_FIELD_ARC_LENGTH = 1,
    /**
     * Speed in m/s.
     */
    CEDE_FIELD_SPEED = 2,
    /**
     * The coordinate (m) that is farther from 0.
     */
    CEDE_FIELD_POSITION = 3,
    /**
     * Length of the direction, which is not a unit vector.
     */
    CEDE_FIELD_DIRECTION = 4,
    /**
     * Metres between the pose and where the path is at that arc length.
     */
    CEDE_FIELD_OFFSET = 5,
    /**
     * Cosine of the angle between the direction and that of the path.
     */
    CEDE_FIELD_HEADING = 6,
    /**
     * Number of a path that the junction does not have, or that has another class than the track.
     */
    CEDE_FIELD_PATH = 7,
    /**
     * Number of a track that the observation has twice, on one path.
     */
    CEDE_FIELD_NUMBER = 8,
    /**
     * What this version has no number for.
     */
    CEDE_FIELD_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_field cede_field;
#else
typedef uint8_t cede_field;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A condition of the contract that is monitored.
 */
enum cede_condition
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * None.
     */
    CEDE_CONDITION_NONE = 0,
    /**
     * The ego's arc length, in m: how far it is inside of what its commands lead to.
     */
    CEDE_CONDITION_EGO_POSITION = 1,
    /**
     * The ego's speed, in m/s: the same.
     */
    CEDE_CONDITION_EGO_SPEED = 2,
    /**
     * A track's arc length, in m: how far it is inside of what the contract allows since it was seen last.
     */
    CEDE_CONDITION_OTHER_POSITION = 3,
    /**
     * A track's speed, in m/s: the same.
     */
    CEDE_CONDITION_OTHER_SPEED = 4,
    /**
     * The distance (m) between a pose and its place on the path.
     */
    CEDE_CONDITION_OFFSET = 5,
    /**
     * The cosine of the angle between a direction and the path.
     */
    CEDE_CONDITION_HEADING = 6,
    /**
     * The time (s) since the last call, against period and jitter.
     */
    CEDE_CONDITION_PERIOD = 7,
    /**
     * What this version has no number for.
     */
    CEDE_CONDITION_OTHER = 255,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_condition cede_condition;
#else
typedef uint8_t cede_condition;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What obliges a vehicle to give way where it enters a junction.
 */
enum cede_control
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It is not known.
     */
    CEDE_CONTROL_UNKNOWN = 0,
    /**
     * Nothing: the vehicle is on the major road, or there are no signs.
     */
    CEDE_CONTROL_FREE = 1,
    /**
     * It gives way.
     */
    CEDE_CONTROL_YIELD = 2,
    /**
     * It stops and gives way.
     */
    CEDE_CONTROL_STOP = 3,
    /**
     * It stops, as everybody does: who has stopped first goes first.
     */
    CEDE_CONTROL_ALL_WAY_STOP = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_control cede_control;
#else
typedef uint8_t cede_control;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How two paths meet.
 */
enum cede_conflict_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Not at all.
     */
    CEDE_CONFLICT_KIND_NONE = 0,
    /**
     * They cross and part again.
     */
    CEDE_CONFLICT_KIND_CROSSING = 1,
    /**
     * They run into one lane.
     */
    CEDE_CONFLICT_KIND_MERGING = 2,
    /**
     * They share a lane from the start.
     */
    CEDE_CONFLICT_KIND_FOLLOWING = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_conflict_kind cede_conflict_kind;
#else
typedef uint8_t cede_conflict_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Who has the right of way.
 */
enum cede_right
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Not settled.
     */
    CEDE_RIGHT_UNSETTLED = 0,
    /**
     * The ego.
     */
    CEDE_RIGHT_EGO = 1,
    /**
     * The other.
     */
    CEDE_RIGHT_OTHER = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_right cede_right;
#else
typedef uint8_t cede_right;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * When a right of way counts.
 */
enum cede_priority
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * If both arrive at once: whoever arrives first goes first, as at an all-way stop.
     */
    CEDE_PRIORITY_FIRST_COME = 0,
    /**
     * Whoever arrives first, until both rest: then they take turns. Where there are no signs.
     */
    CEDE_PRIORITY_UNSIGNED = 1,
    /**
     * Whoever arrives first, as signs and markings give it: whoever gives way waits longer before they take turns.
     */
    CEDE_PRIORITY_SIGNED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum cede_priority cede_priority;
#else
typedef uint8_t cede_priority;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * One vehicle on its way through one junction: plan, precedence and tracks. The next junction begins with a new one. It
 * refers to its junction and to its policy's weights.
 */
typedef struct cede_approach {
    /**
     * The library's.
     */
    uint64_t storage[CEDE_APPROACH_WORDS];
} cede_approach;

/**
 * What drives the vehicle at every intersection: a policy, a contract and a part.
 */
typedef struct cede_drive {
    /**
     * The library's.
     */
    uint64_t storage[CEDE_DRIVE_WORDS];
} cede_drive;

/**
 * A junction: its paths, and how each two of them meet. Once built it does not change; it stays where it is for as long
 * as an approach through it is used.
 */
typedef struct cede_junction {
    /**
     * The library's.
     */
    uint64_t storage[CEDE_JUNCTION_WORDS];
} cede_junction;

/**
 * What a refusal is about. A function that takes a pointer to one fills it in whenever the pointer is not null; what
 * does not apply is 0.
 */
typedef struct cede_detail {
    /**
     * What the function returns.
     */
    cede_status status;
    /**
     * The number that is out of its range, and the ends of the range.
     */
    float value;
    /**
     * The least that is accepted.
     */
    float low;
    /**
     * The most that is accepted.
     */
    float high;
    /**
     * A number of points or paths, or the index of a point.
     */
    uint32_t index;
    /**
     * The path.
     */
    uint8_t path;
    /**
     * The field of a contract.
     */
    cede_contract_field contract_field;
    /**
     * 1 if `low` itself is refused.
     */
    uint8_t excludes_low;
    /**
     * 1 if `high` itself is refused.
     */
    uint8_t excludes_high;
} cede_detail;

/**
 * A point in m, in any fixed frame of the plane: x east, y north.
 */
typedef struct cede_point {
    /**
     * East.
     */
    float x;
    /**
     * North.
     */
    float y;
} cede_point;

/**
 * Where a vehicle is and where it points.
 */
typedef struct cede_pose {
    /**
     * Centre of the footprint in m.
     */
    struct cede_point position;
    /**
     * Direction of the heading: a vector of length 1, to within 10 %.
     */
    struct cede_point direction;
} cede_pose;

/**
 * A vehicle as it is sensed on a path.
 */
typedef struct cede_vehicle {
    /**
     * Arc length in m of the footprint's centre along the path.
     */
    float s;
    /**
     * Speed in m/s along the path, in [-1, 100].
     */
    float speed;
    /**
     * Where it is and where it points.
     */
    struct cede_pose pose;
} cede_vehicle;

/**
 * A path that a track may be on.
 */
typedef struct cede_candidate {
    /**
     * Arc length in m along that path.
     */
    float s;
    /**
     * Number of the path.
     */
    uint8_t path;
    /**
     * Ignored.
     */
    uint8_t reserved[3];
} cede_candidate;

/**
 * Another vehicle, as tracking reports it. It is known by its number from one observation to the next. All its candidates
 * count until the caller leaves one out.
 */
typedef struct cede_track {
    /**
     * The number that tracking gave it.
     */
    uint16_t number;
    /**
     * CEDE_CLASS_CAR, CEDE_CLASS_LORRY or CEDE_CLASS_BICYCLE; its candidates are paths of this class.
     */
    uint8_t vehicle_class;
    /**
     * How many candidates there are, 1 to CEDE_MAX_CANDIDATES.
     */
    uint8_t candidate_count;
    /**
     * Speed in m/s, in [-1, 100].
     */
    float speed;
    /**
     * Where it is and where it points.
     */
    struct cede_pose pose;
    /**
     * The paths that it may be on.
     */
    struct cede_candidate candidates[CEDE_MAX_CANDIDATES];
} cede_track;

/**
 * What the sensors report at one moment. A vehicle that is no longer among the tracks counts as not seen: it is expected
 * to be somewhere until it has certainly left.
 */
typedef struct cede_observation {
    /**
     * The vehicle that is driven.
     */
    struct cede_vehicle ego;
    /**
     * The others, in any order; may be null if there are none.
     */
    const struct cede_track *tracks;
    /**
     * How many they are, up to CEDE_MAX_TRACKS.
     */
    uint32_t track_count;
} cede_observation;

/**
 * Why a proposal is refused.
 */
typedef struct cede_reason {
    /**
     * What kind of reason.
     */
    cede_reason_kind kind;
    /**
     * 0.
     */
    uint8_t reserved;
    /**
     * Number of the track; with CEDE_REASON_KIND_HIDDEN, of the path that is out of sight.
     */
    uint16_t other;
    /**
     * What there is: seconds to the other's arrival, metres of the gap, metres to where the ego must be at rest.
     */
    float available;
    /**
     * What is needed: seconds to clear the zone, metres of the gap, metres to stop.
     */
    float needed;
} cede_reason;

/**
 * A fault, and the number that is out of its range if it is one of an input.
 */
typedef struct cede_fault {
    /**
     * What kind of fault.
     */
    cede_fault_kind kind;
    /**
     * Whose state.
     */
    cede_subject subject;
    /**
     * Which number of it.
     */
    cede_field field;
    /**
     * 0.
     */
    uint8_t reserved;
    /**
     * Number of the track, if the subject is one.
     */
    uint16_t track;
    /**
     * 0.
     */
    uint16_t reserved2;
    /**
     * The value; perhaps not a number.
     */
    float value;
    /**
     * The least that is accepted.
     */
    float low;
    /**
     * The most that is accepted.
     */
    float high;
} cede_fault;

/**
 * What the policy thinks of one other.
 */
typedef struct cede_prediction {
    /**
     * Number of the track.
     */
    uint16_t other;
    /**
     * 0.
     */
    uint16_t reserved;
    /**
     * The ego's social value orientation towards it in rad, in [0, pi/2].
     */
    float svo;
    /**
     * The acceleration in m/s^2 that is expected of it.
     */
    float acceleration;
} cede_prediction;

/**
 * What is left of a tolerance.
 */
typedef struct cede_room {
    /**
     * What is left, in the condition's unit; below 0 the condition is broken.
     */
    float left;
    /**
     * The same as a share of the most that can be left: 1 in the middle of what is allowed, 0 at its end.
     */
    float share;
    /**
     * Number of the track that has least left.
     */
    uint16_t track;
    /**
     * 1 if there was something to compare.
     */
    uint8_t is_known;
    /**
     * 1 if it is a track's.
     */
    uint8_t has_track;
} cede_room;

/**
 * How near each monitored condition of the contract is to its limit. A breach is a position or a speed of which less than 0
 * is left.
 */
typedef struct cede_headroom {
    /**
     * CEDE_CONDITION_EGO_POSITION.
     */
    struct cede_room ego_position;
    /**
     * CEDE_CONDITION_EGO_SPEED.
     */
    struct cede_room ego_speed;
    /**
     * CEDE_CONDITION_OTHER_POSITION.
     */
    struct cede_room other_position;
    /**
     * CEDE_CONDITION_OTHER_SPEED.
     */
    struct cede_room other_speed;
    /**
     * CEDE_CONDITION_OFFSET.
     */
    struct cede_room offset;
    /**
     * CEDE_CONDITION_HEADING.
     */
    struct cede_room heading;
    /**
     * CEDE_CONDITION_PERIOD.
     */
    struct cede_room period;
    /**
     * The condition of which the smallest share is left.
     */
    cede_condition least;
    /**
     * 0.
     */
    uint8_t reserved[3];
} cede_headroom;

/**
 * The ego's acceleration for the period that begins, and why it is what it is.
 */
typedef struct cede_decision {
    /**
     * The acceleration in m/s^2: always finite, and within [-braking, acceleration] of the contract's ego.
     */
    float acceleration;
    /**
     * Metres to spare of the best plan that follows; negative if no plan is safe.
     */
    float margin;
    /**
     * Who decided.
     */
    cede_cause cause;
    /**
     * What the shield did, if it decided.
     */
    cede_action action;
    /**
     * Whose motion exceeds the contract's bounds.
     */
    cede_breach breach;
    /**
     * 1 if there is a plan that is carried out if nothing better is found; 0 is no guarantee.
     */
    uint8_t has_plan;
    /**
     * For so many periods the plan accelerates at ego_go; then it brakes.
     */
    uint16_t plan_go;
    /**
     * Number of the track whose motion exceeds the contract's bounds.
     */
    uint16_t breach_track;
    /**
     * Number of a track that matters and for which there is no room.
     */
    uint16_t unwatched;
    /**
     * 1 if there is such a track: the ego stays out of its zones.
     */
    uint8_t has_unwatched;
    /**
     * 1 if the policy was asked: `prediction` holds.
     */
    uint8_t has_prediction;
    /**
     * Why the shield refused the proposal, if it decided.
     */
    struct cede_reason reason;
    /**
     * Why neither policy nor shield decided, if so.
     */
    struct cede_fault fallback;
    /**
     * What is wrong with the inputs, if something is.
     */
    struct cede_fault fault;
    /**
     * What the policy thinks of the other that restricts the ego most.
     */
    struct cede_prediction prediction;
    /**
     * How near each monitored condition of the contract is to its limit.
     */
    struct cede_headroom headroom;
} cede_decision;

/**
 * Whether control can be handed over.
 */
typedef struct cede_readiness {
    /**
     * Metres to spare of the best plan; negative if none is safe.
     */
    float margin;
    /**
     * What stands in the way.
     */
    struct cede_reason reason;
    /**
     * What is wrong with the inputs, if something is.
     */
    struct cede_fault fault;
} cede_readiness;

/**
 * A policy. It refers to the weights that it was initialised with: they stay where and as they are for as long as the
 * policy, or a drive or an approach with it, is used.
 */
typedef struct cede_policy {
    /**
     * The library's.
     */
    uint64_t storage[CEDE_POLICY_WORDS];
} cede_policy;

/**
 * What the shield assumes of the world. docs/manual.md says what each number means, docs/integration.md where it comes
 * from on a vehicle. Start from cede_contract_worst_case() and change what you know.
 */
typedef struct cede_contract {
    /**
     * Time from one decision to the next in s, in [0.01, 1].
     */
    float period;
    /**
     * A command takes effect within this time in s, in [0, 10 period - 6 jitter].
     */
    float latency;
    /**
     * How far (s) a call may be from the grid of periods, either way, in [0, 0.35 period]; with precedence up to
     * period/8.
     */
    float jitter;
    /**
     * Largest error of a sensed arc length in m, in [0, 10].
     */
    float position_error;
    /**
     * Largest error of a sensed speed in m/s, in [0, 10].
     */
    float speed_error;
    /**
     * Subtracted from every margin in m, in [0.01, 10].
     */
    float slack;
    /**
     * No command accelerates the ego beyond this speed in m/s, in (0, other_max_speed].
     */
    float ego_max_speed;
    /**
     * Hardest acceleration that is commanded in m/s^2; what it may lead to is in (0, other_acceleration].
     */
    float ego_acceleration;
    /**
     * Acceleration that is commanded when the ego must clear a zone, in m/s^2, up to ego_acceleration; it leads to 0.01 at
     * least.
     */
    float ego_go;
    /**
     * Braking that plans command in m/s^2, the hardest while there is one; it leads to 0.01 at least and other_braking at
     * most.
     */
    float ego_braking;
    /**
     * Braking that is commanded while no plan is safe, in m/s^2, in [ego_braking, other_braking]; 0: ego_braking.
     */
    float ego_emergency;
    /**
     * Time constant in s, at most, of the lag with which the ego's acceleration follows a command, in [0, 1].
     */
    float ego_lag;
    /**
     * By which share of a command the ego's acceleration may differ from it, in [0, 0.5].
     */
    float ego_gain;
    /**
     * Acceleration in m/s^2, either way, that nobody commands, in [0, 5]: g times the steepest grade, wind.
     */
    float ego_disturbance;
    /**
     * Highest speed of another in m/s, in (0, 100].
     */
    float other_max_speed;
    /**
     * Hardest acceleration of another in m/s^2, in (0, 20].
     */
    float other_acceleration;
    /**
     * Hardest braking of another in m/s^2, in (0, 20].
     */
    float other_braking;
    /**
     * Reaction time in s of one behind the ego, in [0, 10].
     */
    float follower_reaction;
    /**
     * Braking in m/s^2 of one behind the ego, in (0, other_braking].
     */
    float follower_braking;
    /**
     * Metres before its zone at which a vehicle has arrived, in (0, 200].
     */
    float precedence_distance;
    /**
     * Braking in m/s^2 with which one that gives way is expected to stop, in (0, 20]; with patience, at most ego_braking.
     */
    float precedence_braking;
    /**
     * Arrivals within this many periods of each other are a tie.
     */
    uint16_t precedence_tie;
    /**
     * Periods after which the turn passes on while both rest: 0 for never, else at least 5.
     */
    uint16_t precedence_patience;
    /**
     * 1 if the others keep the rule of precedence; 0 if not, and then its numbers are not looked at.
     */
    uint8_t has_precedence;
    /**
     * Ignored.
     */
    uint8_t reserved[3];
} cede_contract;

/**
 * What traffic there is that is not on the junction's paths.
 */
typedef struct cede_traffic {
    /**
     * Metres from bumper to bumper to the vehicle ahead in the ego's lane.
     */
    float leader_gap;
    /**
     * Its speed in m/s.
     */
    float leader_speed;
    /**
     * Metres that the ego still has to where a third one crosses its way.
     */
    float crosser_distance;
    /**
     * Metres that the third one has to it.
     */
    float crosser_its_distance;
    /**
     * The third one's speed in m/s.
     */
    float crosser_its_speed;
    /**
     * 1 if there is a vehicle ahead.
     */
    uint8_t has_leader;
    /**
     * 1 if there is one that crosses.
     */
    uint8_t has_crosser;
    /**
     * Ignored.
     */
    uint8_t reserved[2];
} cede_traffic;

/**
 * How much of a path the sensors see at one moment.
 */
typedef struct cede_sight {
    /**
     * Arc length in m from which they see the path: whoever has its centre there or beyond, towards the path's end, is
     * certainly among the tracks. Before it somebody may be.
     */
    float from;
    /**
     * Nobody out of sight is faster than this (m/s), in (0, 100], nor than other_max_speed.
     */
    float speed;
    /**
     * The path.
     */
    uint8_t path;
    /**
     * Ignored.
     */
    uint8_t reserved[3];
} cede_sight;

/**
 * The plan that the shield falls back on.
 */
typedef struct cede_plan {
    /**
     * For so many periods it accelerates at ego_go; then it brakes.
     */
    uint16_t go;
    /**
     * 1 if there is a plan; 0 is no guarantee.
     */
    uint8_t exists;
    /**
     * 0.
     */
    uint8_t reserved;
} cede_plan;

/**
 * How fast the ego may drive along its path, whoever is there: by speed limits, and in bends.
 */
typedef struct cede_profile {
    /**
     * The speed (m/s) that is allowed at this place; infinite, if nothing bounds it there.
     */
    float speed;
    /**
     * The largest acceleration (m/s^2) that keeps to the profile; infinite, if nothing bounds it.
     */
    float acceleration;
} cede_profile;

/**
 * The largest footprint of the vehicles on a path, centred on the reference point.
 */
typedef struct cede_footprint {
    /**
     * Metres from bumper to bumper, in (0, 40].
     */
    float length;
    /**
     * Metres from side to side, in (0, 40].
     */
    float width;
} cede_footprint;

/**
 * A path of a junction.
 */
typedef struct cede_path_info {
    /**
     * Length in m.
     */
    float length;
    /**
     * Arc length in m at which a vehicle waits at its line.
     */
    float line;
    /**
     * What a vehicle covers at most.
     */
    struct cede_footprint footprint;
    /**
     * Its class, CEDE_CLASS_...
     */
    uint8_t vehicle_class;
    /**
     * What obliges it to give way.
     */
    cede_control control;
    /**
     * 1 if the line was set: the ego waits there, and not in the junction.
     */
    uint8_t waits_at_line;
    /**
     * 0.
     */
    uint8_t reserved;
} cede_path_info;

/**
 * A stretch of the ego's path and one of the other's in which they can touch; arc lengths in m. An end of 10^6 or -10^6
 * stands for a zone that goes on past the end of a path.
 */
typedef struct cede_zone {
    /**
     * Arc lengths of the ego: lower end.
     */
    float ego_from;
    /**
     * Upper end.
     */
    float ego_to;
    /**
     * Arc lengths of the other: lower end.
     */
    float other_from;
    /**
     * Upper end.
     */
    float other_to;
    /**
     * The ego's arc length minus the other's: lower end.
     */
    float lead_from;
    /**
     * Upper end.
     */
    float lead_to;
    /**
     * How they meet there.
     */
    cede_conflict_kind kind;
    /**
     * 0.
     */
    uint8_t reserved[3];
} cede_zone;

/**
 * How the ego's path meets another.
 */
typedef struct cede_conflict {
    /**
     * Arc length in m at which the ego has reached the conflict point.
     */
    float ego_conflict;
    /**
     * The same for the other.
     */
    float other_conflict;
    /**
     * How the paths meet first, along the ego's.
     */
    cede_conflict_kind kind;
    /**
     * Who has the right of way.
     */
    cede_right right;
    /**
     * When it counts.
     */
    cede_priority priority;
    /**
     * How many zones there are.
     */
    uint8_t zone_count;
    /**
     * The zones, in no particular order.
     */
    struct cede_zone zones[CEDE_MAX_ZONES];
} cede_conflict;

/**
 * What a policy is.
 */
typedef struct cede_policy_info {
    /**
     * SHA-256 of what the network was made from.
     */
    uint8_t provenance[32];
    /**
     * Neurons of a hidden layer.
     */
    uint16_t width;
    /**
     * Features that the network is told: 0 raw, 1 route, 2 traffic, 3 scene, 4 rights.
     */
    uint8_t features;
    /**
     * Whose commands it gives: 0 joint, 1 the ego's.
     */
    uint8_t perspective;
} cede_policy_info;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Begins an approach by path number `path` of a junction that is built. What the drive says is copied.
 */
cede_status cede_approach_enter(struct cede_approach *approach,
                                const struct cede_drive *drive,
                                const struct cede_junction *junction,
                                uint8_t path,
                                struct cede_detail *detail);

/**
 * The ego's acceleration for the period that begins at `now_us`, in microseconds of a clock that never goes back. To be
 * called once a period.
 *
 * Whatever is returned, `decision` holds an acceleration that is finite and admissible, unless the pointer itself is bad.
 * If the observation cannot be read, the step is decided as one without sensors: by the plan that was verified last. If
 * the approach cannot be used, the cause is CEDE_CAUSE_NONE and the acceleration -CEDE_LAST_RESORT_BRAKING.
 *
 * CEDE_STATUS_FLOAT_ENVIRONMENT: the step was decided, but the FPU's mode is not the one that the guarantee was proved for.
 */
cede_status cede_approach_decide(struct cede_approach *approach,
                                 uint64_t now_us,
                                 const struct cede_observation *observation,
                                 struct cede_decision *decision);

/**
 * cede_approach_decide() for a vehicle that has a driver of its own for everything but the others at the junction, of its
 * speed limit, curves and leader for example: no more than `most` (m/s^2) is proposed, and `most` where nobody is left to
 * meet who goes first. NaN counts as full braking.
 */
cede_status cede_approach_decide_up_to(struct cede_approach *approach,
                                       uint64_t now_us,
                                       float most,
                                       const struct cede_observation *observation,
                                       struct cede_decision *decision);

/**
 * Whether a plan is safe before control is handed over. CEDE_STATUS_OK, CEDE_STATUS_NOT_READY_FAULT or
 * CEDE_STATUS_NOT_READY_NO_PLAN; `readiness`, which may be null, says more. Nothing is remembered.
 */
cede_status cede_approach_ready(const struct cede_approach *approach,
                                uint64_t now_us,
                                const struct cede_observation *observation,
                                struct cede_readiness *readiness);

/**
 * What the policy alone would do, in m/s^2 within 3: to measure what the shield costs, never to drive. Once a period
 * instead of cede_approach_decide(); 0 if the ego's state has a fault.
 */
cede_status cede_approach_proposal(struct cede_approach *approach,
                                   const struct cede_observation *observation,
                                   float *acceleration);

/**
 * Drives with another policy from the next decision on; the plan is kept.
 */
cede_status cede_approach_set_policy(struct cede_approach *approach, const struct cede_policy *policy);

/**
 * Drives within another contract from the next decision on; the plan is kept if it is safe under it. A contract that is
 * refused changes nothing.
 */
cede_status cede_approach_set_contract(struct cede_approach *approach,
                                       const struct cede_contract *contract,
                                       struct cede_detail *detail);

/**
 * Tells the policy of traffic that is not on the junction's paths, for the decisions to come; the shield considers the
 * tracks alone.
 */
cede_status cede_approach_set_traffic(struct cede_approach *approach, const struct cede_traffic *traffic);

/**
 * Says of `count` paths how much of them is in sight at `now_us`, for cede_approach_decide() or cede_approach_ready() at that
 * time: before each of these places somebody may be, and is expected to be in every decision to come. Where nothing is said
 * of a path that was named before, those who were out of sight may have come on. Name a path whose view may ever be limited
 * from the first decision on. Sights that are refused change nothing.
 */
cede_status cede_approach_set_sight(struct cede_approach *approach,
                                    uint64_t now_us,
                                    const struct cede_sight *sights,
                                    uint32_t count,
                                    struct cede_detail *detail);

/**
 * Says that the track with this number is known not to be there any more.
 */
cede_status cede_approach_forget(struct cede_approach *approach, uint16_t number);

/**
 * The worst case: others accelerate at 3 m/s^2 up to 15 m/s and may brake at 8; a command takes effect one period late;
 * nobody is courteous; sensors are exact.
 */
cede_status cede_contract_worst_case(struct cede_contract *contract);

/**
 * The worst case among vehicles that keep the rule of precedence of an all-way stop.
 */
cede_status cede_contract_all_way_stop(struct cede_contract *contract);

/**
 * Whether every number of the contract is in its range; `detail` names the first that is not, with value and range.
 */
cede_status cede_contract_check(const struct cede_contract *contract, struct cede_detail *detail);

/**
 * Makes a drive. Policy and contract are copied; the policy's weights are not. `part`, CEDE_PART_LEFT or
 * CEDE_PART_OTHER, matters to a joint policy alone.
 */
cede_status cede_drive_init(struct cede_drive *drive,
                            const struct cede_policy *policy,
                            const struct cede_contract *contract,
                            uint8_t part,
                            struct cede_detail *detail);

/**
 * The plan that the shield falls back on.
 */
cede_status cede_approach_plan(const struct cede_approach *approach, struct cede_plan *plan);

/**
 * The contract that it drives within.
 */
cede_status cede_approach_contract(const struct cede_approach *approach, struct cede_contract *contract);

/**
 * Writes 1 if the ego has precedence over the track with this number, on every path that the track may be on, since the last
 * decision; else 0.
 */
cede_status cede_approach_goes_before(const struct cede_approach *approach,
                                      uint16_t number,
                                      uint8_t *first);

/**
 * Metres to spare of the best plan after one period at `acceleration` (m/s^2), given now while `previous` (m/s^2) is in
 * effect; not negative exactly if the shield would accept it. It knows nobody but whom it sees, assumes no precedence, and
 * remembers nothing.
 *
 * CEDE_STATUS_INPUT_FAULT: `fault`, which may be null, says what is wrong with the observation or an acceleration.
 */
cede_status cede_approach_margin(const struct cede_approach *approach,
                                 const struct cede_observation *observation,
                                 float previous,
                                 float acceleration,
                                 float *margin,
                                 struct cede_fault *fault);

/**
 * What bounds the ego at arc length `s` (m) of its path with `speed` (m/s), whoever is there: it comes down to a lower speed
 * ahead at 1.5 m/s^2. For a driver of one's own; cede_approach_decide() keeps to it already.
 */
cede_status cede_approach_profile(const struct cede_approach *approach,
                                  float s,
                                  float speed,
                                  struct cede_profile *profile);

/**
 * Begins a junction without paths, whatever was in the storage.
 */
cede_status cede_junction_init(struct cede_junction *junction);

/**
 * Sets how far (m) any point of a vehicle's footprint may be from where it is on its path, in [0, 1]; 0.1 unless
 * it is set. cede_junction_build() checks it.
 */
cede_status cede_junction_set_tolerance(struct cede_junction *junction, float tolerance);

/**
 * Sets the lateral acceleration (m/s^2), at most, that the ego is to have in bends, in (0, 20]; bends do not slow it down
 * unless it is set. It bounds proposals; plans know nothing of it. cede_junction_build() checks it.
 */
cede_status cede_junction_set_lateral(struct cede_junction *junction,
                                      float lateral);

/**
 * Says that an ego on a path drives at `speed` (m/s) or slower from arc length `from` (m) on, until the next limit; up to
 * CEDE_MAX_LIMITS of them, in any order. It bounds proposals; plans know nothing of it.
 */
cede_status cede_junction_add_speed_limit(struct cede_junction *junction,
                                          uint8_t path,
                                          float from,
                                          float speed,
                                          struct cede_detail *detail);

/**
 * Adds a path through `count` points, for vehicles of a class with this largest footprint, and writes its number. The
 * first CEDE_MAX_ENTRIES paths are those that the ego can enter by.
 */
cede_status cede_junction_add_path(struct cede_junction *junction,
                                   const struct cede_point *points,
                                   uint32_t count,
                                   uint8_t vehicle_class,
                                   const struct cede_footprint *footprint,
                                   uint8_t *path,
                                   struct cede_detail *detail);

/**
 * Adds a path along the points of path `of_path`, for another class of vehicles, and writes its number.
 */
cede_status cede_junction_add_variant(struct cede_junction *junction,
                                      uint8_t of_path,
                                      uint8_t vehicle_class,
                                      const struct cede_footprint *footprint,
                                      uint8_t *path,
                                      struct cede_detail *detail);

/**
 * Sets where vehicles of a path wait: the arc length `s` in m of the footprint's centre. An ego that has not passed it does
 * so only with a plan that clears every zone of a crossing or a merge. Unless it is set, it is where the footprint comes to
 * the first zone in which the path crosses or merges with any other, and the ego may wait between two zones.
 */
cede_status cede_junction_set_line(struct cede_junction *junction,
                                   uint8_t path,
                                   float s,
                                   struct cede_detail *detail);

/**
 * Says that vehicles of path `first` go before those of path `second` if they arrive at once:
 * cede_junction_set_priority() with CEDE_PRIORITY_FIRST_COME. The last call for two paths counts.
 */
cede_status cede_junction_set_right_of_way(struct cede_junction *junction,
                                           uint8_t first,
                                           uint8_t second,
                                           struct cede_detail *detail);

/**
 * Says that vehicles of path `first` have the right of way over those of path `second`, and when it counts: `priority` is
 * a cede_priority. Whether the shield relies on it is for the contract to say. The last call for two paths counts.
 */
cede_status cede_junction_set_priority(struct cede_junction *junction,
                                       uint8_t first,
                                       uint8_t second,
                                       uint8_t priority,
                                       struct cede_detail *detail);

/**
 * Says what obliges vehicles of a path to give way: `control` is a cede_control. A policy is told; the shield counts on
 * nothing of it. CEDE_CONTROL_UNKNOWN unless it is set.
 */
cede_status cede_junction_set_control(struct cede_junction *junction,
                                      uint8_t path,
                                      uint8_t control,
                                      struct cede_detail *detail);

/**
 * Sets the highest speed (m/s) of pedestrians on a path, either way, in (0, 10]; 3 unless it is set. Of other classes it says
 * nothing.
 */
cede_status cede_junction_set_pace(struct cede_junction *junction,
                                   uint8_t path,
                                   float pace,
                                   struct cede_detail *detail);

/**
 * Sets the place of a path in the order in which vehicles at rest take turns, its number unless it is set: of two, the one with
 * the larger place has the first turns. Vehicles that are to trust each other have to agree on it (U7 of the manual).
 */
cede_status cede_junction_set_order(struct cede_junction *junction,
                                    uint8_t path,
                                    uint16_t place,
                                    struct cede_detail *detail);

/**
 * Builds the junction: works out how each two paths meet. Nothing can be added afterwards. A junction that is refused can
 * be mended and built again.
 */
cede_status cede_junction_build(struct cede_junction *junction,
                                struct cede_detail *detail);

/**
 * Checks the junction's checksum: a test for the background, to find memory that has changed.
 */
cede_status cede_junction_check(const struct cede_junction *junction);

/**
 * Writes the number of paths.
 */
cede_status cede_junction_count(const struct cede_junction *junction, uint32_t *paths);

/**
 * Describes a path of a junction that is built.
 */
cede_status cede_junction_path(const struct cede_junction *junction, uint8_t path, struct cede_path_info *info);

/**
 * The pose at arc length `s` (m) of a path; before its start and past its end a path goes on straight.
 */
cede_status cede_junction_pose(const struct cede_junction *junction, uint8_t path, float s, struct cede_pose *result);

/**
 * The arc length (m) of the point of a path that is nearest to `position`: from localisation to `s`.
 */
cede_status cede_junction_project(const struct cede_junction *junction,
                                  uint8_t path,
                                  const struct cede_point *position,
                                  float *s);

/**
 * How path `ego`, one that can be entered, meets path `other`.
 */
cede_status cede_junction_conflict(const struct cede_junction *junction,
                                   uint8_t ego,
                                   uint8_t other,
                                   struct cede_conflict *conflict);

/**
 * Asks the policy's network about 64 inputs, drives a short encounter with it, and writes a number that stands for all bits of
 * what comes out: a test of compiler, flash, core and FPU by everything that deciding uses, and one that fails if any of it
 * computes something else than where the number was found. `answer` is CEDE_EMBEDDED_ANSWER for the embedded policy; for another one it is what a host
 * writes.
 *
 * `junction` and `approach` are storage for the test, whatever was in it; nothing that is used may be there afterwards, and
 * they can be used for others. It takes as long as a junction and 48 decisions.
 */
cede_status cede_known_answer(const struct cede_policy *policy,
                              struct cede_junction *junction,
                              struct cede_approach *approach,
                              uint32_t *answer);

/**
 * Makes a policy of a weights file (.cede): `bytes` bytes at `weights`, which are on a boundary of 4 (64 is fastest).
 *
 * The time is linear in the size: the checksum of all weights is checked.
 */
cede_status cede_policy_init(struct cede_policy *policy, const uint32_t *weights, uint32_t bytes);

/**
 * Makes a policy of the weights that are part of the library.
 */
cede_status cede_policy_init_embedded(struct cede_policy *policy);

/**
 * Checks the weights' checksum again: a test for the background, to find memory that has changed.
 */
cede_status cede_policy_check(const struct cede_policy *policy);

/**
 * What the policy is.
 */
cede_status cede_policy_describe(const struct cede_policy *policy, struct cede_policy_info *info);

/**
 * Whether the FPU rounds to nearest and keeps subnormal numbers, as every decision assumes. To be called at start-up by the
 * task that decides: the mode may differ from task to task. cede_approach_decide() looks at it in every call. Takes no time to
 * speak of.
 */
cede_status cede_self_test(void);

/**
 * What a cede_status says; "unknown" for a number that is none. Never null.
 */
const char *cede_status_text(int32_t status);

/**
 * What a cede_cause says.
 */
const char *cede_cause_text(uint8_t cause);

/**
 * What a cede_action says.
 */
const char *cede_action_text(uint8_t action);

/**
 * What a cede_reason_kind says.
 */
const char *cede_reason_text(uint8_t reason);

/**
 * What a cede_fault_kind says.
 */
const char *cede_fault_text(uint8_t fault);

/**
 * What a cede_subject says.
 */
const char *cede_subject_text(uint8_t subject);

/**
 * What a cede_field says.
 */
const char *cede_field_text(uint8_t field);

/**
 * What a cede_breach says.
 */
const char *cede_breach_text(uint8_t breach);

/**
 * What a cede_condition says.
 */
const char *cede_condition_text(uint8_t condition);

/**
 * The name of a cede_contract_field, as in "ego.braking".
 */
const char *cede_contract_field_text(uint8_t field);

/**
 * What a cede_conflict_kind says.
 */
const char *cede_conflict_text(uint8_t kind);

/**
 * What a cede_right says.
 */
const char *cede_right_text(uint8_t right);

/**
 * What a cede_priority says.
 */
const char *cede_priority_text(uint8_t priority);

/**
 * What a cede_control says.
 */
const char *cede_control_text(uint8_t control);

/**
 * What a CEDE_CLASS_... says.
 */
const char *cede_class_text(uint8_t vehicle_class);

/**
 * The library's CEDE_ABI_VERSION.
 */
uint32_t cede_abi_version(void);

/**
 * The library's version in words, as in "0.2.0".
 */
const char *cede_version(void);

/**
 * Alignment of all objects in bytes, CEDE_ALIGNMENT.
 */
uint32_t cede_alignment(void);

/**
 * Bytes of a cede_policy.
 */
uint32_t cede_policy_size(void);

/**
 * Bytes of a cede_drive.
 */
uint32_t cede_drive_size(void);

/**
 * Bytes of a cede_junction.
 */
uint32_t cede_junction_size(void);

/**
 * Bytes of a cede_approach.
 */
uint32_t cede_approach_size(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CEDE_H */
