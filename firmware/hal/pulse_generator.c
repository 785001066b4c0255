/* SPDX-License-Identifier: Apache-2.0 */
/* Machine numbers have a meaning: of two machines that set one pin in one cycle, PIO obeys the
 * higher one, and the run's pulses go before those of the preamble. */
#include "pulse_generator.h"

#include "board_pins.h"
#include "hardware/gpio.h"
#include "hardware/pio.h"
#include "trigger.pio.h"

#define MACHINE_PREAMBLE 0U
#define MACHINE_GENERATOR 1U
#define MACHINE_SYNC 2U
#define MACHINES 0x7U

#define FLAG_RUN (1U << 4)
#define FLAG_STOP (1U << 5)
#define FLAG_SYNC (1U << 6)

/* What the programs need beyond the counts that they are given; see trigger.pio. */
#define WIDTH_OVERHEAD 4U
#define LOW_OVERHEAD 4U
#define GAP_OVERHEAD 7U
#define SYNC_HIGH_OVERHEAD 3U
#define SYNC_LOW_OVERHEAD 3U

#define SYNC_PERIOD ((uint32_t)OPMS_BOX_CLOCK_HZ)
#define SYNC_WIDTH (SYNC_PERIOD / 10U)

static uint preamble_at, generator_at, sync_at;
static bool stopped = true;

static void drive_low(uint machine, uint pin)
{
    pio_sm_set_pins_with_mask(pio0, machine, 0, 1U << pin);
    pio_sm_set_pindirs_with_mask(pio0, machine, 1U << pin, 1U << pin);
}

/* Not pio_gpio_init(): that would set back the polarity. */
static void connect_to_pio(uint pin)
{
    hw_write_masked(&io_bank0_hw->io[pin].ctrl, GPIO_FUNC_PIO0, IO_BANK0_GPIO0_CTRL_FUNCSEL_BITS);
}

void pulse_generator_init(void)
{
    generator_at = (uint)pio_add_program(pio0, &generator_program);
    preamble_at = (uint)pio_add_program(pio0, &preamble_program);
    sync_at = (uint)pio_add_program(pio0, &sync_program);
    drive_low(MACHINE_GENERATOR, PIN_TRIG);
    drive_low(MACHINE_SYNC, PIN_SYNC);
    connect_to_pio(PIN_TRIG);
    connect_to_pio(PIN_SYNC);
}

/* Give a resting machine's register a value, through its FIFO. */
static void load(uint machine, enum pio_src_dest to, uint32_t value)
{
    pio_sm_put(pio0, machine, value);
    pio_sm_exec(pio0, machine, pio_encode_pull(false, true));
    if (to != pio_osr)
        pio_sm_exec(pio0, machine, pio_encode_mov(to, pio_osr));
}

/* The three instructions that depend on the debounce; see trigger.pio. */
static uint32_t patch_debounce(uint32_t debounce_cycles)
{
    uint stays = generator_at + generator_offset_stays;
    uint16_t sample = (uint16_t)pio_encode_jmp_pin(stays);
    uint16_t armed = (uint16_t)pio_encode_wait_pin(true, 0);
    uint16_t counted = (uint16_t)pio_encode_mov(pio_x, pio_y);
    uint16_t stay = (uint16_t)pio_encode_jmp_x_dec(generator_at + generator_offset_sample);
    uint32_t looks = 0;
    if (debounce_cycles == 0) {
        sample = (uint16_t)pio_encode_jmp(stays);
        stay = armed;
    } else if (debounce_cycles == 1) {
        counted = (uint16_t)pio_encode_jmp(generator_at + generator_offset_gate);
    } else if (debounce_cycles == 2) {
        counted = (uint16_t)pio_encode_jmp_pin(stays);
    } else if (debounce_cycles % 2 == 1) {
        looks = (debounce_cycles - 3) / 2;
    } else {
        looks = (debounce_cycles - 4) / 2;
        armed |= (uint16_t)pio_encode_delay(1);
    }
    uint16_t low = (uint16_t)pio_encode_sideset_opt(1, 0);
    if (debounce_cycles != 0)
        stay |= low;
    pio0->instr_mem[generator_at + generator_offset_sample] = sample | low;
    pio0->instr_mem[generator_at + generator_offset_armed] = armed;
    pio0->instr_mem[generator_at + generator_offset_counted] = counted | low;
    pio0->instr_mem[generator_at + generator_offset_stays] = stay;
    return looks;
}

static void set_up_generator(const opms_settings_t *settings)
{
    uint32_t width = settings->width_us * OPMS_BOX_CYCLES_PER_US;
    uint32_t period = settings->period_us * OPMS_BOX_CYCLES_PER_US;
    pio_sm_config config = generator_program_get_default_config(generator_at);
    sm_config_set_in_pins(&config, PIN_START);
    sm_config_set_jmp_pin(&config, PIN_START);
    sm_config_set_sideset_pins(&config, PIN_TRIG);
    uint32_t looks = patch_debounce(settings->debounce_cycles);
    pio_sm_init(pio0, MACHINE_GENERATOR, generator_at + generator_offset_begin, &config);
    load(MACHINE_GENERATOR, pio_x, looks);
    load(MACHINE_GENERATOR, pio_y, looks);
    load(MACHINE_GENERATOR, pio_isr, width - WIDTH_OVERHEAD);
    load(MACHINE_GENERATOR, pio_osr, period - width - LOW_OVERHEAD);
}

static void set_up_preamble(const opms_settings_t *settings)
{
    uint32_t width = settings->width_us * OPMS_BOX_CYCLES_PER_US;
    pio_sm_config config = preamble_program_get_default_config(preamble_at);
    sm_config_set_in_pins(&config, PIN_START);
    sm_config_set_set_pins(&config, PIN_TRIG, 1);
    sm_config_set_fifo_join(&config, PIO_FIFO_JOIN_TX);
    pio_sm_init(pio0, MACHINE_PREAMBLE, preamble_at + preamble_offset_begin, &config);
    load(MACHINE_PREAMBLE, pio_isr, width - WIDTH_OVERHEAD);
    for (uint gap = 0; gap < OPMS_BOX_PREAMBLE_MAX && settings->preamble_gap_ms[gap] != 0; gap++)
        pio_sm_put(pio0, MACHINE_PREAMBLE,
                   settings->preamble_gap_ms[gap] * 1000U * OPMS_BOX_CYCLES_PER_US - width -
                       GAP_OVERHEAD);
}

/* A START that is high before the box is armed must not keep the preamble back. */
static void patch_hold(void)
{
    bool is_high = gpio_get(PIN_START);
    pio0->instr_mem[preamble_at + preamble_offset_hold] =
        (uint16_t)(is_high ? pio_encode_nop() : pio_encode_wait_pin(false, 0));
}

static void set_up_sync(opms_sync_mode_t mode)
{
    pio_sm_config config = sync_program_get_default_config(sync_at);
    sm_config_set_set_pins(&config, PIN_SYNC, 1);
    if (mode == OPMS_SYNC_RUN)
        sm_config_set_wrap(&config, sync_at + sync_offset_rise, sync_at + sync_offset_rise);
    pio_sm_init(pio0, MACHINE_SYNC, sync_at + sync_offset_begin, &config);
    load(MACHINE_SYNC, pio_isr, SYNC_WIDTH - SYNC_HIGH_OVERHEAD);
    load(MACHINE_SYNC, pio_osr, SYNC_PERIOD - SYNC_WIDTH - SYNC_LOW_OVERHEAD);
}

void pulse_generator_arm(const opms_settings_t *settings)
{
    uint32_t machines = 1U << MACHINE_GENERATOR;
    pio0->irq = FLAG_RUN | FLAG_STOP | FLAG_SYNC;
    set_up_generator(settings);
    if (settings->preamble_gap_ms[0] != 0) {
        set_up_preamble(settings);
        patch_hold();
        machines |= 1U << MACHINE_PREAMBLE;
    }
    if (settings->sync != OPMS_SYNC_OFF) {
        set_up_sync(settings->sync);
        machines |= 1U << MACHINE_SYNC;
    }
    stopped = false;
    pio_enable_sm_mask_in_sync(pio0, machines);
}

void pulse_generator_stop(void)
{
    pio0->irq_force = FLAG_STOP;
    /* A machine that had just passed its gate sets TRIG before anyone looks. */
    busy_wait_at_least_cycles(8);
}

bool pulse_generator_is_stopped(void)
{
    if (stopped)
        return true;
    if ((pio0->dbg_padout & (1U << PIN_TRIG)) != 0)
        return false;
    pio_set_sm_mask_enabled(pio0, MACHINES, false);
    drive_low(MACHINE_GENERATOR, PIN_TRIG);
    drive_low(MACHINE_SYNC, PIN_SYNC);
    stopped = true;
    return true;
}
