# SPDX-License-Identifier: Apache-2.0
"""The deepest stack of a Thumb program, from its disassembly.

Every function's frame is what its pushes and `sub sp` take together, which is at least what it
takes at any time. Calls are followed through `bl` and jumps out of the function. What cannot be
followed must be declared below; anything else that is unknown, and recursion, is an error: a
figure that leaves something out would be worse than none.
"""
import re
import subprocess

INTERRUPT_FRAME = 32 + 4  # registers that the core pushes, and alignment
ROM = "boot ROM"
FRAMES = {ROM: 512}       # the ROM's flash functions are not to be seen here; they take less

# Calls through pointers: who, and whom.
FLASH_CALLS = ["read_flash", "erase_flash", "program_flash"]
EDGE_CALLS = ["edge_tagger_peek_pulse", "edge_tagger_drop_pulse", "edge_tagger_peek_level",
              "edge_tagger_drop_level"]
DRIVER_CALLS = ["hidd_init", "hidd_deinit", "hidd_reset", "hidd_open", "answer_control",
                "hidd_control_xfer_cb", "hidd_xfer_cb"]
INDIRECT = {
    "find_newest": FLASH_CALLS, "is_blank": FLASH_CALLS, "write_record": FLASH_CALLS,
    "write_in_sector": FLASH_CALLS, "settings_store_save": FLASH_CALLS,
    "settings_store_load": FLASH_CALLS,
    "follow_line": EDGE_CALLS, "forget_line": EDGE_CALLS, "hold_pulses": EDGE_CALLS,
    "edge_order_set_lines": EDGE_CALLS,
    "edge_order_next": EDGE_CALLS + [
        "tell_start_line", "tell_glitch", "tell_strobe", "tell_armed", "tell_stopped",
        "tell_start_of_run", "tell_pulse"],
    # TinyUSB: class drivers, and the callback of a control transfer's stages.
    "configuration_reset": DRIVER_CALLS, "invoke_class_control": DRIVER_CALLS,
    "tud_rhport_init": DRIVER_CALLS, "tud_task_ext": DRIVER_CALLS,
    "process_control_request": DRIVER_CALLS, "process_set_config": DRIVER_CALLS,
    "usbd_control_xfer_cb": DRIVER_CALLS + ["invoke_class_control"],
    "dcd_event_handler": [],  # no class driver of ours asks for frames
    # SDK: what runs before main, and code of the ROM.
    "runtime_run_initializers": "runtime_init_",
    "runtime_init": [],
    "runtime_run_per_core_initializers": "runtime_init_",
    "flash_range_erase": [ROM], "flash_range_program": [ROM], "flash_do_cmd": [ROM],
    "flash_enable_xip_via_boot2": [ROM], "rom_func_lookup": [ROM], "rom_reset_usb_boot": [ROM],
}
# In assembly, and known: jump tables and returns through registers.
LEAVES = re.compile(r"__gnu_thumb1_case_\w+|irq_handler_chain_\w+")

# The start-up code calls one after the other, with nothing on the stack.
PROGRAM = ["runtime_init", "main"]
# Interrupts have one priority, so that one of them at a time adds to what main takes.
INTERRUPTS = ["dcd_rp2040_irq", "on_edge", "on_alarm"]

FUNCTION = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\t[0-9a-f ]+\t(\S+)(?:\t(.*))?$")
TARGET = re.compile(r"^([0-9a-f]+) <([^>+]+)(?:\+0x[0-9a-f]+)?>")
VENEER = re.compile(r"^__(.+)_veneer$")


class Unknown(Exception):
    """Something that the depth depends on cannot be told."""


class Function:
    def __init__(self, name, address):
        self.name = name
        self.address = address
        self.frame = 0
        self.calls = set()
        self.jumps = set()  # also those that stay in the function
        self.indirect = False


def registers(text):
    count = 0
    for part in text.strip("{}").split(","):
        first, _, last = part.strip().partition("-")
        count += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return count


def read(function, mnemonic, operands):
    """Add what one instruction does."""
    operation = mnemonic.split(".")[0]
    if operation in ("push", "stmdb") and (operation == "push" or operands.startswith("sp!")):
        function.frame += 4 * registers(operands[operands.index("{"):])
    elif operation in ("sub", "add") and operands.startswith("sp,"):
        amount = operands.split(",")[-1].strip()
        if not amount.startswith("#"):
            raise Unknown(f"{function.name} moves the stack by a register")
        if operation == "sub":
            function.frame += int(amount[1:])
    elif operation in ("bl", "b") or re.fullmatch(r"b(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)",
                                                  operation):
        target = TARGET.match(operands)
        if not target:
            raise Unknown(f"{function.name} calls {operands}")
        (function.calls if operation == "bl" else function.jumps).add(
            VENEER.sub(r"\1", target[2]))
    elif operation == "blx" or (operation == "bx" and operands.strip() != "lr"):
        function.indirect = True


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def function_names(objdump, elf):
    """{name: address} of all that is marked as a function; the rest are labels inside of one."""
    names = {}
    for line in run(objdump, "-t", elf).splitlines():
        match = re.match(r"([0-9a-f]{8}) .{5}(.)F \S+\t[0-9a-f]+ (?:\.hidden )?(\S+)$", line)
        if match:
            names[match[3]] = int(match[1], 16)
    return names


def disassemble(objdump, elf):
    """{name: Function}; a function of several names is one object."""
    names = function_names(objdump, elf)
    starts = set(names.values())
    by_address, function, labels = {}, None, {}
    for line in run(objdump, "-d", "--section=.text", "--section=.data", elf).splitlines():
        begin = FUNCTION.match(line)
        if begin:
            address = int(begin[1], 16)
            if address in starts or VENEER.match(begin[2]) or function is None:
                function = by_address.setdefault(address, Function(begin[2], address))
            labels[begin[2]] = function.name
            continue
        instruction = INSTRUCTION.match(line)
        if instruction and function and not VENEER.match(function.name):
            read(function, instruction[2], re.split(r"\s*[;@] ", instruction[3] or "")[0])
    functions = {name: by_address[at] for name, at in names.items() if at in by_address}
    for one in by_address.values():
        functions.setdefault(one.name, one)
        jumps = {labels.get(name, name) for name in one.jumps} - {one.name}
        one.calls = {labels.get(name, name) for name in one.calls} | jumps
    return functions


def callees(function, functions):
    calls = set(function.calls)
    if function.indirect and not LEAVES.fullmatch(function.name):
        declared = INDIRECT.get(function.name.split(".")[0])
        if declared is None:
            raise Unknown(f"{function.name} calls through a pointer that is not declared")
        if isinstance(declared, str):
            declared = [name for name in functions if name.startswith(declared)]
        # What is declared may have been inlined or left out.
        calls |= {name for name in declared if name in functions or name == ROM}
    return calls


def depth_of(name, functions, above=(), known=None):
    """(bytes, path) of the deepest call from a function on."""
    known = {} if known is None else known
    if name in known:
        return known[name]
    if name in above:
        raise Unknown(f"recursion: {' > '.join(above[above.index(name):] + (name,))}")
    if name in FRAMES:
        return FRAMES[name], [name]
    if name not in functions:
        raise Unknown(f"{above[-1] if above else 'the start'} calls {name}, which is not there")
    function = functions[name]
    deepest = (0, [])
    for callee in sorted(callees(function, functions)):
        deepest = max(deepest, depth_of(callee, functions, above + (name,), known),
                      key=lambda one: one[0])
    known[name] = (function.frame + deepest[0], [name] + deepest[1])
    return known[name]


def deepest_of(names, functions):
    return max((depth_of(name, functions) for name in names), key=lambda one: one[0])


def worst(objdump, elf):
    """(bytes, path): the program at its deepest, and the deepest interrupt on top of it."""
    functions = disassemble(objdump, elf)
    program = deepest_of(PROGRAM, functions)
    interrupt = deepest_of(INTERRUPTS, functions)
    return (program[0] + INTERRUPT_FRAME + interrupt[0],
            program[1] + ["interrupt"] + interrupt[1])
