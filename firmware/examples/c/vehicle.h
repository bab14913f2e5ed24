/* A simulated vehicle for the task of task.h. */
#ifndef VEHICLE_H
#define VEHICLE_H

/* What was diagnosed last; 0 if nothing was. */
int vehicle_wrong(void);

#endif
