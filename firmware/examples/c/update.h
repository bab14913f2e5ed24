/* Taking in a policy or a junction that was sent to the vehicle. */
#ifndef UPDATE_H
#define UPDATE_H

#include "cede.h"

/*
 * What is sent, in a place of its own beside what is in use, on a boundary of 8. The signature is over the header before it
 * and the content behind it, so that neither number can be changed.
 */
typedef struct {
    uint32_t kind;    /* UPDATE_POLICY or UPDATE_JUNCTION */
    uint32_t version; /* larger than that of what is in use: nothing is taken back */
    uint32_t bytes;   /* of the content, a multiple of 4 */
    uint32_t answer;  /* of a policy: what cede_known_answer() gave on the host that made the file */
    uint8_t signature[64];
} update_header;

#define UPDATE_POLICY 0x6f706563u
#define UPDATE_JUNCTION 0x756a6563u

/* A path of a junction, followed by its points. */
typedef struct {
    cede_footprint footprint;
    uint16_t vehicle_class;
    uint16_t points;
} update_path;

typedef enum {
    UPDATE_DONE,
    UPDATE_TRUNCATED,   /* the content does not fit its place, or its parts do not fit the content */
    UPDATE_OTHER_KIND,  /* a policy where a junction is expected, or the other way round */
    UPDATE_NOT_NEWER,
    UPDATE_NOT_SIGNED,  /* by whom the vehicle trusts */
    UPDATE_REFUSED,     /* by the library: `status` says why */
    UPDATE_OTHER_ANSWER /* it does not decide here as it did there */
} update_result;

/* What is sent, and who judges its signature: yours, as Ed25519 over both parts, with the key where nobody can change it. */
typedef struct {
    const update_header *header;
    const uint32_t *content;
    uint32_t room; /* bytes from the content to the end of its place */
    int (*is_signed)(const update_header *header, const uint32_t *content);
} update;

/* Where a policy is tried; nothing that is driven with. */
typedef struct {
    cede_junction junction;
    cede_approach approach;
} update_bench;

/*
 * Takes in a policy in place of version `version`. Once UPDATE_DONE is returned, and not before, cede_approach_set_policy()
 * gives it to the approaches that are under way, between two decisions; their plans are kept.
 */
update_result update_policy(const update *sent, uint32_t version, update_bench *bench, cede_policy *policy, cede_status *status);

/* Builds a junction in storage that nobody drives through, for the next cede_approach_enter(). */
update_result update_junction(const update *sent, uint32_t version, cede_junction *junction, cede_status *status);

#endif
