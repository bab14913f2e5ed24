/* Lines of text without a C library: the same on the host and on a microcontroller. */
#ifndef TEXT_H
#define TEXT_H

#include "cede.h"
#include <stddef.h>

/* What each platform has: text to its console, and a mode of the FPU by the bits of an Arm core's FPSCR, 0 for the usual one. */
void port_write(const char *text);
void port_float_mode(uint32_t fpscr);

void put(const char *text);
void put_line(const char *text);
void put_number(int32_t number);

/* A value with two decimals, rounded to the nearest. */
void put_fixed(float value);

/* A decision in words, with the bits of its numbers. */
void put_decision(const cede_decision *decision);

/* What a call has refused. */
void put_refusal(const cede_detail *detail);

#endif
