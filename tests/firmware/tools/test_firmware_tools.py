# SPDX-License-Identifier: Apache-2.0
"""The tools of the firmware's build: the budget must fail where it should, UF2 must be UF2."""
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

TOOLS = Path(__file__).resolve().parents[3] / "firmware" / "tools"
sys.path.insert(0, str(TOOLS))

import check_budget  # noqa: E402
import make_uf2      # noqa: E402
import stack_depth   # noqa: E402


def program(**functions):
    """What objdump prints of functions, each given by its instructions."""
    table, code, at = [], [], 0x10000100
    places = {}
    for name, lines in functions.items():
        places[name] = at
        at += 4 * len(lines)
    for name, lines in functions.items():
        at = places[name]
        table.append(f"{at:08x} g     F .text\t{4 * len(lines):08x} {name}")
        code.append(f"{at:08x} <{name}>:")
        for line in lines:
            mnemonic, _, operands = line.partition(" ")
            target = places.get(operands)
            operands = operands if target is None else f"{target:x} <{operands}>"
            code.append(f"{at:8x}:\tbf00      \t{mnemonic}\t{operands}")
            at += 4
    return {"-t": "\n".join(table), "-d": "\n".join(code)}


def depth(outputs, name="main"):
    with mock.patch.object(stack_depth, "run", lambda *command: outputs[command[1]]):
        return stack_depth.depth_of(name, stack_depth.disassemble("objdump", "elf"))


class StackDepth(unittest.TestCase):
    def test_the_deepest_path_counts(self):
        outputs = program(main=["push {r4, lr}", "bl small", "bl large", "pop {r4, pc}"],
                          small=["push {r4, r5, r6, r7, lr}", "pop {r4, r5, r6, r7, pc}"],
                          large=["push {lr}", "sub sp, #256\t@ 0x100", "bl leaf"],
                          leaf=["push {r4}", "bx lr"])
        self.assertEqual(depth(outputs), (8 + 4 + 256 + 4, ["main", "large", "leaf"]))

    def test_a_jump_to_another_function_is_a_call(self):
        outputs = program(main=["push {lr}", "b.n other"], other=["push {r0-r3, lr}"])
        self.assertEqual(depth(outputs)[0], 4 + 20)

    def test_recursion_is_an_error(self):
        for outputs in (program(main=["bl main"]),
                        program(main=["bl one"], one=["bl two"], two=["bl one"])):
            with self.assertRaisesRegex(stack_depth.Unknown, "recursion"):
                depth(outputs)

    def test_a_call_through_an_undeclared_pointer_is_an_error(self):
        with self.assertRaisesRegex(stack_depth.Unknown, "main calls through a pointer"):
            depth(program(main=["blx r3"]))

    def test_a_call_through_a_declared_pointer_is_followed(self):
        outputs = program(find_newest=["push {lr}", "blx r3"], read_flash=["sub sp, #40"])
        self.assertEqual(depth(outputs, "find_newest"), (44, ["find_newest", "read_flash"]))

    def test_a_frame_of_unknown_size_is_an_error(self):
        with self.assertRaisesRegex(stack_depth.Unknown, "by a register"):
            depth(program(main=["add sp, r4"]))


MAP = """Discarded input sections
 .text.gone     0x00000000      0x400 CMakeFiles/opms-box.dir/core/box.c.o
Linker script and memory map
 .text.box_input
                0x10000200      0x{flash:x} CMakeFiles/opms-box.dir/core/box.c.o
 .text.main     0x10008000       0x10 CMakeFiles/opms-box.dir/app/main.c.o
 .rodata.names  0x10008100       0x20 CMakeFiles/opms-box.dir/x/libopms/src/wire/wire_names.c.o
 .text.look     0x10008200       0x30 CMakeFiles/opms-box.dir/hal/edge_tagger.c.o
 .text.tud_task 0x10008300      0x999 CMakeFiles/opms-box.dir/sdk/tinyusb/src/device/usbd.c.o
 .data.own      0x20000100        0x8 CMakeFiles/opms-box.dir/core/box.c.o
 .bss.box       0x20002000     0x{ram:x} CMakeFiles/opms-box.dir/app/main.c.o
"""


def budget(flash=0x100, ram=0x1000, depth_bytes=1000, symbols="main\n"):
    """(exit status, what was printed to stderr) of the whole check."""
    with tempfile.TemporaryDirectory() as folder, \
            mock.patch.object(check_budget, "symbols", lambda *_: set(symbols.split())), \
            mock.patch.object(stack_depth, "worst", lambda *_: (depth_bytes, ["main"])), \
            mock.patch("sys.stderr") as errors, mock.patch("sys.stdout"):
        path = Path(folder) / "x.map"
        path.write_text(MAP.format(flash=flash, ram=ram), encoding="utf-8")
        with mock.patch("sys.argv", ["check_budget.py", "x.elf", str(path)]):
            status = check_budget.main()
        return status, "".join(call.args[0] for call in errors.write.call_args_list)


class Budget(unittest.TestCase):
    def test_sizes_are_those_of_our_own_objects_that_were_placed(self):
        sizes = check_budget.sizes_by_object(MAP.format(flash=0x100, ram=0x1000))
        self.assertEqual(dict(check_budget.own_part(sizes, "flash")),
                         {"core": 0x108, "app": 0x10, "wire": 0x20, "hal": 0x30})
        self.assertEqual(dict(check_budget.own_part(sizes, "ram")), {"core": 8, "app": 0x1000})

    def test_within_the_budget_it_passes_and_past_it_it_fails(self):
        self.assertEqual(budget(), (0, ""))
        for change, what in (({"flash": 33000}, "flash"), ({"ram": 210000}, "ram"),
                             ({"depth_bytes": 2049}, "stack"),
                             ({"symbols": "main\n_malloc_r\n"}, "heap")):
            status, text = budget(**change)
            self.assertEqual(status, 1, change)
            self.assertIn(what, text)


class Uf2(unittest.TestCase):
    def test_every_block_is_one_for_the_rp2040_and_together_they_are_the_image(self):
        image = bytes(range(256)) * 5 + b"the end"
        with tempfile.TemporaryDirectory() as folder:
            source, target = Path(folder) / "a.bin", Path(folder) / "a.uf2"
            source.write_bytes(image)
            subprocess.run([sys.executable, TOOLS / "make_uf2.py", source, target], check=True)
            data = target.read_bytes()
        self.assertEqual(len(data), 6 * 512)
        found = b""
        for number in range(6):
            block = data[512 * number:512 * (number + 1)]
            self.assertEqual(block[:8], b"UF2\n\x57\x51\x5d\x9e")
            self.assertEqual(block[508:], b"\x30\x6f\xb1\x0a")
            flags, address, size, index, count, family = struct.unpack_from("<6I", block, 8)
            self.assertEqual((flags, address, size, index, count, family),
                             (0x2000, 0x10000000 + 256 * number, 256, number, 6, 0xE48BFF56))
            found += block[32:288]
        self.assertEqual(found, image.ljust(6 * 256, b"\0"))

    def test_an_empty_image_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder) / "a.bin"
            source.write_bytes(b"")
            with self.assertRaises(SystemExit):
                make_uf2.main([str(source), str(source.with_suffix(".uf2"))])


if __name__ == "__main__":
    unittest.main()
