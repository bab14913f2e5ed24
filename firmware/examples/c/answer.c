/* answer FILE.cede prints the policy's known answer: what cede_known_answer() has to find on the target. For a host. */
#include "cede.h"
#include <stdio.h>

static uint32_t weights[65536];
static cede_policy policy;
static cede_junction junction;
static cede_approach approach;

int main(int argc, char **argv)
{
    FILE *file = (argc == 2) ? fopen(argv[1], "rb") : NULL;
    uint32_t answer = 0u;
    size_t bytes;
    cede_status status;

    if (file == NULL) {
        (void)fprintf(stderr, "usage: answer FILE.cede\n");
        return 2;
    }
    bytes = fread(weights, 1u, sizeof weights, file);
    (void)fclose(file);
    status = cede_policy_init(&policy, weights, (uint32_t)bytes);
    if (status == CEDE_STATUS_OK) {
        status = cede_known_answer(&policy, &junction, &approach, &answer);
    }
    if (status != CEDE_STATUS_OK) {
        (void)fprintf(stderr, "%s: %s\n", argv[1], cede_status_text(status));
        return (int)status;
    }
    (void)printf("0x%08lx\n", (unsigned long)answer);
    return 0;
}
