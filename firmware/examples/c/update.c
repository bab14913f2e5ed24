#include "update.h"
#include <stddef.h>

/* Everything that can be said before the content is looked at. */
static update_result judge(const update *sent, uint32_t kind, uint32_t version)
{
    const update_header *header = sent->header;

    if ((header->bytes > sent->room) || ((header->bytes % 4u) != 0u)) {
        return UPDATE_TRUNCATED;
    }
    if (sent->is_signed(header, sent->content) == 0) {
        return UPDATE_NOT_SIGNED;
    }
    if (header->kind != kind) {
        return UPDATE_OTHER_KIND;
    }
    return (header->version > version) ? UPDATE_DONE : UPDATE_NOT_NEWER;
}

update_result update_policy(const update *sent, uint32_t version, update_bench *bench, cede_policy *policy, cede_status *status)
{
    update_result result = judge(sent, UPDATE_POLICY, version);
    uint32_t answer = 0u;

    *status = CEDE_STATUS_OK;
    if (result != UPDATE_DONE) {
        return result;
    }
    *status = cede_policy_init(policy, sent->content, sent->header->bytes);
    if (*status == CEDE_STATUS_OK) {
        *status = cede_known_answer(policy, &bench->junction, &bench->approach, &answer);
    }
    if (*status != CEDE_STATUS_OK) {
        return UPDATE_REFUSED;
    }
    return (answer == sent->header->answer) ? UPDATE_DONE : UPDATE_OTHER_ANSWER;
}

/* Adds the path at the start of `content`; the words that it takes, 0 if it does not fit in. */
static uint32_t add_path(const uint32_t *content, uint32_t words, cede_junction *junction, cede_status *status)
{
    const uint32_t head = (uint32_t)(sizeof(update_path) / 4u);
    const update_path *path = (const void *)content;
    uint32_t taken;
    uint8_t number;

    if (words < head) {
        return 0u;
    }
    taken = head + (2u * (uint32_t)path->points);
    if (words < taken) {
        return 0u;
    }
    *status = cede_junction_add_path(junction, (const void *)&content[head], path->points, (uint8_t)path->vehicle_class,
                                     &path->footprint, &number, NULL);
    return taken;
}

update_result update_junction(const update *sent, uint32_t version, cede_junction *junction, cede_status *status)
{
    update_result result = judge(sent, UPDATE_JUNCTION, version);
    uint32_t words = sent->header->bytes / 4u;
    const uint32_t *content = sent->content;

    *status = CEDE_STATUS_OK;
    if (result != UPDATE_DONE) {
        return result;
    }
    *status = cede_junction_init(junction);
    while ((*status == CEDE_STATUS_OK) && (words > 0u)) {
        const uint32_t taken = add_path(content, words, junction, status);

        if (taken == 0u) {
            return UPDATE_TRUNCATED;
        }
        content = &content[taken];
        words -= taken;
    }
    if (*status == CEDE_STATUS_OK) {
        *status = cede_junction_build(junction, NULL);
    }
    return (*status == CEDE_STATUS_OK) ? UPDATE_DONE : UPDATE_REFUSED;
}
