# SPDX-License-Identifier: Apache-2.0
"""Where the hardware files are, for their tests; and copies of the schematic to break."""
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = ROOT / "hw/schematics"
DATA = Path(__file__).resolve().parent / "data"
SCHEMATIC = PROJECT / "opms-box.kicad_sch"

sys.path.insert(0, str(PROJECT / "tools"))
import kicad_text  # noqa: E402
import read_schematic  # noqa: E402


def copy_schematic(folder):
    """The sheets in another folder; the root's file."""
    for path in PROJECT.glob("*.kicad_sch"):
        shutil.copy(path, folder)
    return Path(folder) / SCHEMATIC.name


def dump(node):
    """A node as text again. The reader does not tell a quoted word from a bare one."""
    if isinstance(node, list):
        return "(" + " ".join(dump(item) for item in node) + ")"
    return kicad_text.quote(node)


class BrokenCopy:
    """A copy of the schematic with faults in it: `with BrokenCopy() as box: box.remove("D5")`."""

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory()
        self.root = copy_schematic(self._folder.name)
        return self

    def __exit__(self, *_):
        self._folder.cleanup()

    def netlist(self):
        return read_schematic.read(self.root)

    def change(self, change_sheet):
        """change_sheet(node) alters the list of one sheet and says whether it did."""
        done = 0
        for path in sorted(self.root.parent.glob("*.kicad_sch")):
            node = kicad_text.parse(path.read_text(encoding="utf-8"))
            if change_sheet(node):
                path.write_text(dump(node), encoding="utf-8")
                done += 1
        if not done:
            raise AssertionError("the fault was not put in")

    def symbols(self, sheet, reference):
        return [symbol for symbol in kicad_text.children(sheet, "symbol")
                if kicad_text.properties(symbol)["Reference"].startswith(reference)
                and (reference.startswith("#")
                     or kicad_text.properties(symbol)["Reference"] == reference)]

    def remove(self, reference):
        """Take a part out; its wires stay. "#FLG" takes out every PWR_FLAG."""
        def cut(sheet):
            found = self.symbols(sheet, reference)
            for symbol in found:
                sheet.remove(symbol)
            return found
        self.change(cut)

    def turn_round(self, reference):
        """Half a turn where it stands."""
        def turn(sheet):
            found = self.symbols(sheet, reference)
            for symbol in found:
                at = kicad_text.child(symbol, "at")
                at[3] = str((int(at[3]) + 180) % 360)
            return found
        self.change(turn)

    def mirror(self, reference, axis):
        """As in a mirror: a transistor's source and drain change places, its gate does not."""
        def flip(sheet):
            found = self.symbols(sheet, reference)
            for symbol in found:
                symbol.insert(3, ["mirror", axis])
            return found
        self.change(flip)

    def set_value(self, reference, value):
        def write(sheet):
            found = self.symbols(sheet, reference)
            for symbol in found:
                for entry in kicad_text.children(symbol, "property"):
                    if entry[1] == "Value":
                        entry[2] = value
            return found
        self.change(write)

    def cut_wires_at(self, reference, number):
        """No wire ends at that pin any more."""
        where = self._place(reference, number)

        def cut(sheet):
            found = [wire for wire in kicad_text.children(sheet, "wire")
                     if where in [read_schematic.point(xy)
                                  for xy in kicad_text.child(wire, "pts")[1:]]]
            mine = self.symbols(sheet, reference)
            for wire in found if mine else []:
                sheet.remove(wire)
            return found and mine
        self.change(cut)

    def join(self, first, second):
        """Connect two pins, wherever they are, by a global label at each."""
        for reference, number in (first, second):
            x, y = (str(v / read_schematic.UNITS_PER_MM) for v in self._place(reference, number))

            def add(sheet, ref=reference, at=(x, y)):
                mine = self.symbols(sheet, ref)
                if mine:
                    sheet.append(["global_label", "JOINED", ["at", at[0], at[1], "0"]])
                return mine
            self.change(add)

    def swap_labels(self, first, second):
        """Exchange two hierarchical labels of the Pico's sheet."""
        def swap(sheet):
            labels = {label[1]: label for label in
                      kicad_text.children(sheet, "hierarchical_label")}
            if not {"USB_DP", first, second} <= set(labels):
                return False
            labels[first][1], labels[second][1] = second, first
            return True
        self.change(swap)

    def _place(self, reference, number):
        reader = read_schematic.Reader(self.root)
        reader.read()
        return reader.pins[(reference, number)][1]
