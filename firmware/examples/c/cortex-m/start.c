/* What a Cortex-M with an FPU needs before main(), and a console by semihosting. */
#include "text.h"

extern uint32_t stack_top;
extern uint32_t data_from, data_start, data_end;
extern uint32_t bss_start, bss_end;

int main(void);
void reset(void);
void port_exit(uint32_t status);
static void fault(void);

/* An operating system has handlers of its own. */
__attribute__((weak)) void SVC_Handler(void);
__attribute__((weak)) void PendSV_Handler(void);
__attribute__((weak)) void SysTick_Handler(void);

typedef union {
    void (*handler)(void);
    const void *stack;
} vector;

__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
    {.stack = &stack_top}, {.handler = reset}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {.handler = fault}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {.handler = SVC_Handler},
    {.handler = fault},    {.handler = fault},
    {.handler = PendSV_Handler}, {.handler = SysTick_Handler},
};

#define SYS_OPEN 0x01u
#define SYS_WRITE 0x05u
#define SYS_EXIT_EXTENDED 0x20u
#define APPLICATION_EXIT 0x20026u

static uint32_t semihost(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;

    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void port_write(const char *text)
{
    static const char console[] = ":tt";
    static uint32_t file; /* 0 until it is opened */
    const uintptr_t open[3] = {(uintptr_t)console, 4u, 3u};
    uintptr_t write[3] = {0u, (uintptr_t)text, 0u};

    while (text[write[2]] != '\0') {
        write[2]++;
    }
    file = (file != 0u) ? file : semihost(SYS_OPEN, open);
    write[0] = file;
    (void)semihost(SYS_WRITE, write);
}

void port_float_mode(uint32_t fpscr)
{
    __asm__ volatile("vmsr fpscr, %0" ::"r"(fpscr));
}

void port_exit(uint32_t status)
{
    const uint32_t block[2] = {APPLICATION_EXIT, status};

    for (;;) {
        (void)semihost(SYS_EXIT_EXTENDED, block);
    }
}

static void fault(void)
{
    port_write("hard fault\n");
    port_exit(1u);
}

void SVC_Handler(void)
{
    fault();
}

void PendSV_Handler(void)
{
    fault();
}

void SysTick_Handler(void)
{
    fault();
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

#ifdef TICK_NS
/*
 * Under QEMU's -icount shift=10 an instruction takes 1024 ns of the board's time; TICK_NS is what a tick of its clock takes.
 * The linker's --wrap puts this between the program and the library.
 */
#define SYSTICK ((volatile uint32_t *)0xe000e010u)
#define TICKS 0x00ffffffu

cede_status __real_cede_approach_decide(cede_approach *approach, uint64_t now_us, const cede_observation *observation,
                                        cede_decision *decision);
cede_status __wrap_cede_approach_decide(cede_approach *approach, uint64_t now_us, const cede_observation *observation,
                                        cede_decision *decision);

static uint32_t most_instructions;

cede_status __wrap_cede_approach_decide(cede_approach *approach, uint64_t now_us, const cede_observation *observation,
                                        cede_decision *decision)
{
    cede_status status;
    uint32_t instructions;

    SYSTICK[1] = TICKS;
    SYSTICK[2] = 0u;
    SYSTICK[0] = 5u;
    status = __real_cede_approach_decide(approach, now_us, observation, decision);
    instructions = ((TICKS - SYSTICK[2]) * TICK_NS) / 1024u;
    most_instructions = (instructions > most_instructions) ? instructions : most_instructions;
    return status;
}

static void put_measure(const char *what, uintptr_t number)
{
    put(what);
    put_number((int32_t)number);
    put("\n");
}

static void report(const uint32_t *word)
{
    const uintptr_t stack = (uintptr_t)&stack_top - (uintptr_t)word;

    put_measure("measured: stack, bytes: ", stack);
    put_measure("measured: RAM with stack, bytes: ", stack + (uintptr_t)&bss_end - (uintptr_t)&data_start);
    put_measure("measured: instructions of a decision, most: ", most_instructions);
}
#else
#define report(word) ((void)(word))
#endif

#define PAINT 0xccccccccu

/* Not inlined: nothing that uses the FPU comes before it is on. */
__attribute__((noinline)) static uint32_t run(void)
{
    uint32_t *word;
    uint32_t *stack;
    uint32_t status;

    __asm__ volatile("mov %0, sp" : "=r"(stack));
    for (word = &bss_end; word < stack - 32; word++) {
        *word = PAINT;
    }
#ifdef FPSCR /* another mode of the FPU, to see it found */
    port_float_mode(FPSCR);
#endif
    status = (uint32_t)main();
    word = &bss_end;
    while ((word < &stack_top) && (*word == PAINT)) {
        word++;
    }
    report(word);
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
    port_exit(run());
}
