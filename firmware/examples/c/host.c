/* The host's console and FPU. */
#include "text.h"
#include <stdio.h>

void port_write(const char *text)
{
    (void)fputs(text, stdout);
}

#if defined(__aarch64__)
void port_float_mode(uint32_t fpscr)
{
    const uint64_t fpcr = fpscr; /* the same bits */

    __asm__ volatile("msr fpcr, %0" ::"r"(fpcr));
}
#else
void port_float_mode(uint32_t fpscr)
{
    static const uint32_t rounding[4] = {0x0000u, 0x4000u, 0x2000u, 0x6000u}; /* to nearest, up, down, to zero */
    const uint32_t flush = ((fpscr & 0x01000000u) != 0u) ? 0x8040u : 0u;
    const uint32_t mxcsr = 0x1f80u | rounding[(fpscr >> 22u) & 3u] | flush;

    __asm__ volatile("ldmxcsr %0" ::"m"(mxcsr));
}
#endif
