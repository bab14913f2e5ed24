/* What a Cortex-M with an FPU needs before main(), and a console by semihosting. */
#include "text.h"

extern uint32_t stack_top;
extern uint32_t data_from, data_start, data_end;
extern uint32_t bss_start, bss_end;

int main(void);
void reset(void);
static void fault(void);

typedef union {
    void (*handler)(void);
    const void *stack;
} vector;

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    {.stack = &stack_top}, {.handler = reset}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {.handler = fault}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {.handler = fault}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},
};

#define SYS_WRITE0 0x04u
#define SYS_EXIT_EXTENDED 0x20u
#define APPLICATION_EXIT 0x20026u

static void semihost(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;

    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void port_write(const char *text)
{
    semihost(SYS_WRITE0, text);
}

static void leave(uint32_t status)
{
    const uint32_t block[2] = {APPLICATION_EXIT, status};

    for (;;) {
        semihost(SYS_EXIT_EXTENDED, block);
    }
}

static void fault(void)
{
    port_write("hard fault\n");
    leave(1u);
}

/* What the compiler calls to copy and to clear. */
void *memcpy(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

void *memcpy(void *to, const void *from, size_t count)
{
    uint8_t *place = to;
    const uint8_t *byte = from;

    while (count-- > 0u) {
        *place++ = *byte++;
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    uint8_t *place = to;

    while (count-- > 0u) {
        *place++ = (uint8_t)value;
    }
    return to;
}

#define PAINT 0xccccccccu

/* Not inlined: nothing that uses the FPU comes before it is on. */
__attribute__((noinline)) static uint32_t run(void)
{
    uint32_t *word;
    uint32_t status;

    for (word = &bss_end; word < (uint32_t *)__builtin_frame_address(0) - 32; word++) {
        *word = PAINT;
    }
    status = (uint32_t)main();
#ifdef MEASURE
    for (word = &bss_end; (word < &stack_top) && (*word == PAINT); word++) {
    }
    put("RAM, bytes: ");
    put_number((int32_t)((uintptr_t)&stack_top - (uintptr_t)word + (uintptr_t)&bss_end - (uintptr_t)&data_start));
    put("\nstack, bytes: ");
    put_number((int32_t)((uintptr_t)&stack_top - (uintptr_t)word));
    put("\n");
#endif
    return status;
}

void reset(void)
{
    volatile uint32_t *const cpacr = (volatile uint32_t *)0xe000ed88u;
    const uint32_t *from = &data_from;
    uint32_t *to;

    *cpacr |= 0xfu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    for (to = &data_start; to < &data_end; to++) {
        *to = *from++;
    }
    for (to = &bss_start; to < &bss_end; to++) {
        *to = 0u;
    }
    leave(run());
}
