# SPDX-License-Identifier: Apache-2.0
"""The firmware's PIO programs as pioasm assembled them, in a form that rp2040-pio-emulator runs.

That emulator has one state machine: no flags of IRQ, no optional side-set and no pins relative to
a base. So each of these is put into what takes as many cycles and does the same to the pins:
`irq` and `wait irq` become a `nop`, a pin gets its number, and the bit that says "side-set or not"
gets a pin of its own. What a nop stands for is tested by the emulated box, tests/emulator.
"""
import os
import re
from collections import deque
from dataclasses import dataclass, replace
from pathlib import Path

from pioemu import ShiftRegister, State, emulate

START, TRIG = 2, 3
SYNCHRONISER = 2  # cycles from the pad to the state machine

NOP = 0xA042      # mov y, y
SIDE_AND_DELAY = 0x1F00
JMP_PIN, WAIT_PIN_HIGH = 0x00C0, 0x20A0


@dataclass
class Program:
    code: list
    labels: dict
    wrap_target: int
    wrap: int


def load(name):
    """A program out of the headers in the firmware's build folder."""
    folder = Path(os.environ["OPMS_FIRMWARE_BUILD"])
    for header in ("trigger.pio.h", "tagger.pio.h"):
        text = (folder / header).read_text(encoding="utf-8")
        body = re.search(rf"{name}_program_instructions\[\] = {{(.*?)}};", text, re.S)
        if body:
            return Program(
                code=[int(word, 16) for word in re.findall(r"^\s*0x([0-9a-f]{4}),", body[1], re.M)],
                labels={label: int(at) for label, at in
                        re.findall(rf"#define {name}_offset_(\w+) (\d+)u", text)},
                wrap_target=int(re.search(rf"#define {name}_wrap_target (\d+)", text)[1]),
                wrap=int(re.search(rf"#define {name}_wrap (\d+)", text)[1]))
    raise LookupError(f"no PIO program {name} in {folder}")


def runnable(opcode, in_base):
    kind, source = opcode >> 13, opcode >> 5 & 3
    if kind == 6 or (kind == 1 and source == 2):  # irq, wait irq
        return NOP | opcode & SIDE_AND_DELAY
    if kind == 1 and source == 1:                 # wait pin
        return opcode & ~0x7F | in_base + (opcode & 0x1F)
    return opcode


def debounced(program, debounce):
    """The generator's program for a debounce, as the head of trigger.pio says, and its Y."""
    code, labels = list(program.code), program.labels
    looks = 0
    keep_side = code[labels["counted"]] & SIDE_AND_DELAY
    if debounce == 0:
        code[labels["sample"]] = labels["stays"]
        code[labels["stays"]] = WAIT_PIN_HIGH
    elif debounce == 1:
        code[labels["counted"]] = labels["gate"] | keep_side
    elif debounce == 2:
        code[labels["counted"]] = JMP_PIN | labels["stays"] | keep_side
    elif debounce % 2:
        looks = (debounce - 3) // 2
    else:
        looks = (debounce - 4) // 2
        code[labels["armed"]] |= 1 << 8
    return replace(program, code=code), looks


def level_at(edges, cycle):
    """A line that is low at first and changes at each of these cycles, at the pad."""
    return sum(edge <= cycle for edge in edges) % 2


def run(program, *, begin, cycles, edges, pin, registers=None, side_pin=None, set_pin=TRIG):
    """Run a machine and yield its state after each instruction. What it pushes is taken out at
    once, as DMA does it; a state shows what came with it."""
    def pins(cycle: int) -> int:
        return level_at(edges, cycle - SYNCHRONISER) << pin

    outputs = 0 if side_pin is None else 3 << side_pin
    if set_pin != pin:
        outputs |= 1 << set_pin
    registers = registers or {}
    state = State(program_counter=program.labels[begin], pin_directions=outputs,
                  x_register=registers.get("x", 0), y_register=registers.get("y", 0),
                  input_shift_register=ShiftRegister(registers.get("isr", 0), 0),
                  output_shift_register=ShiftRegister(registers.get("osr", 0), 0),
                  transmit_fifo=deque(registers.get("fifo", ())))
    code = [runnable(opcode, START) for opcode in program.code]
    while state.clock < cycles:
        for _, state in emulate(
                code, initial_state=state, input_source=pins, jmp_pin=pin,
                stop_when=lambda _, now: now.clock >= cycles or now.receive_fifo,
                auto_push=True, push_threshold=32, shift_isr_right=False,
                set_base=set_pin, set_count=1, side_set_base=side_pin or 0,
                side_set_count=0 if side_pin is None else 2,
                wrap_target=program.wrap_target, wrap_top=program.wrap):
            yield state
        state = replace(state, receive_fifo=deque())


def edges_of(states, pin):
    """[(cycle, level)] of a pin. An instruction's clock is where the next one begins."""
    level, found = 0, []
    for state in states:
        now = state.pin_values >> pin & 1
        if now != level:
            level = now
            found.append((state.clock - 1, level))
    return found
