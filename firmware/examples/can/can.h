/* From frames of cede.dbc to an observation, and from a decision to a frame. */
#ifndef CAN_H
#define CAN_H

#include "cede.h"

#define CAN_BYTES 8u

/* An EgoState and the EgoPosition of the same counter; NaN in place of what is not valid. */
void can_ego(const uint8_t state[CAN_BYTES], const uint8_t position[CAN_BYTES], cede_vehicle *ego);

/* A Track: a new one, or one more candidate of a track that is in the list. */
cede_status can_track(const uint8_t frame[CAN_BYTES], const cede_junction *junction, cede_track *tracks, uint32_t *count);

/* A CedeCommand. The CRC is left to the end-to-end profile. */
void can_command(cede_status status, const cede_decision *decision, uint8_t counter, uint8_t frame[CAN_BYTES]);

#endif
