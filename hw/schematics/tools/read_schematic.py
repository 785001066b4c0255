# SPDX-License-Identifier: Apache-2.0
"""Which pins a KiCad schematic connects, without KiCad.

    read_schematic.py FILE.kicad_sch      print the nets

Reads the files of KiCad 6 to 9 with their sheets. The rules are KiCad's: items are connected where
their ends meet, a label also anywhere on a wire; two wires that only cross are not. Labels join
wires within a sheet, hierarchical labels a sheet with its pin one level up, global labels and power
symbols everything. Buses are not known and are refused.
"""
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from kicad_text import FormatError, child, children, flag, parse, properties, value  # noqa: E402
from netlist import Net, Netlist, Part, Pin  # noqa: E402

UNITS_PER_MM = 10000  # KiCad's own grid; whole numbers compare exactly
STRONGEST_FIRST = ("power", "global", "local", "hierarchical")


def point(node):
    return tuple(round(float(number) * UNITS_PER_MM) for number in node[1:3])


class Groups:
    """Things that belong together: union-find."""

    def __init__(self):
        self._parent = {}

    def find(self, item):
        self._parent.setdefault(item, item)
        while self._parent[item] != item:
            self._parent[item] = self._parent[self._parent[item]]
            item = self._parent[item]
        return item

    def join(self, first, second):
        self._parent[self.find(first)] = self.find(second)


def place_pin(at, turn_degrees, mirror, offset):
    """Where a symbol's pin lies on the sheet, whose y axis points down."""
    turn = math.radians(turn_degrees)
    cosine, sine = round(math.cos(turn)), round(math.sin(turn))
    x = offset[0] * cosine - offset[1] * sine
    y = -(offset[0] * sine + offset[1] * cosine)
    if mirror == "x":
        y = -y
    if mirror == "y":
        x = -x
    return at[0] + x, at[1] + y


def library_pins(symbol, unit):
    """Pins of one unit of a library symbol, those common to all units included."""
    for body in children(symbol, "symbol"):
        _, number, style = body[1].rsplit("_", 2)
        if int(number) in (0, unit) and int(style) in (0, 1):
            for node in children(body, "pin"):
                yield {"kind": node[1], "offset": point(child(node, "at")),
                       "name": value(node, "name"), "number": value(node, "number"),
                       "hidden": flag(node, "hide")}


class Reader:
    def __init__(self, root_file):
        self.root_file = Path(root_file)
        self.groups = Groups()
        self.parts = {}
        self.pins = {}  # (reference, number) -> node of self.groups
        self.names = []  # (rank, depth, name, node)
        self.flags = []  # nodes with a PWR_FLAG
        self.instances = {}
        self.files = []

    def read(self):
        root = self._load(self.root_file)
        for entry in children(child(root, "symbol_instances") or [], "path"):
            self.instances[entry[1]] = (value(entry, "reference"), int(value(entry, "unit")))
        self._sheet(root, "/", "/" + value(root, "uuid"), "/", self.root_file)
        return self._netlist()

    def _load(self, path):
        node = parse(path.read_text(encoding="utf-8"))
        if node[0] != "kicad_sch":
            raise FormatError(f"{path}: not a schematic of KiCad 6 or later")
        for name in ("bus", "bus_entry"):
            if child(node, name):
                raise FormatError(f"{path}: buses are not known here; draw single wires")
        self.files.append(path)
        return node

    def _sheet(self, node, path, full_path, name, file):
        """path: uuids as KiCad 6 writes them; full_path: with the root's, as 7 does; name: /A/B/"""
        here = Sheet(self, node, path, full_path, name, file)
        here.read()
        for sheet, pins in here.sheets:
            fields = properties(sheet)
            sheet_name = fields.get("Sheet name", fields.get("Sheetname"))
            inner_file = file.parent / fields.get("Sheet file", fields.get("Sheetfile"))
            uuid = value(sheet, "uuid")
            inner_name = f"{name}{sheet_name}/"
            for pin_name, at in pins:
                self.groups.join((name, at), (inner_name, "hierarchical", pin_name))
            self._sheet(self._load(inner_file), f"{path}{uuid}/", f"{full_path}/{uuid}",
                        inner_name, inner_file)

    def _netlist(self):
        members, labels = {}, {}
        for pin, node in self.pins.items():
            members.setdefault(self.groups.find(node), []).append(pin)
        for rank, depth, name, node in self.names:
            labels.setdefault(self.groups.find(node), []).append((rank, depth, name))
        nets, by_root = [], {}
        for root, pins in members.items():
            pins.sort()
            named = root in labels
            name = min(labels[root])[2] if named else self._name_of_pin(pins)
            by_root[root] = name
            nets.append(Net(name, pins, named))
        flags = [by_root[self.groups.find(node)] for node in self.flags
                 if self.groups.find(node) in by_root]
        nets.sort(key=lambda net: net.name)
        return Netlist(sorted(self.parts.values(), key=lambda part: part.reference), nets, flags)

    def _name_of_pin(self, pins):
        reference, number = pins[0]
        word = "Net" if len(pins) > 1 else "unconnected"
        return f"{word}-({reference}-Pad{number})"


class Sheet:
    """One sheet of the hierarchy: its items go into the reader's groups."""

    def __init__(self, reader, node, path, full_path, name, file):
        self.reader, self.node, self.file = reader, node, file
        self.path, self.full_path, self.name = path, full_path, name
        self.library = {symbol[1]: symbol for symbol in
                        children(child(node, "lib_symbols") or [], "symbol")}
        self.wires = [tuple(point(xy) for xy in child(wire, "pts")[1:])
                      for wire in children(node, "wire")]
        self.unused = {point(child(mark, "at")) for mark in children(node, "no_connect")}
        self.sheets = [(sheet, [(pin[1], point(child(pin, "at"))) for pin in
                                children(sheet, "pin")]) for sheet in children(node, "sheet")]

    def read(self):
        for start, end in self.wires:
            self.reader.groups.join((self.name, start), (self.name, end))
        for symbol in children(self.node, "symbol"):
            self._symbol(symbol)
        for kind, node_name in (("local", "label"), ("global", "global_label"),
                                ("hierarchical", "hierarchical_label")):
            for label in children(self.node, node_name):
                self._label(kind, label[1], point(child(label, "at")))

    def _symbol(self, symbol):
        reader = self.reader
        library = self.library.get(value(symbol, "lib_name") or value(symbol, "lib_id"))
        if library is None:
            raise FormatError(f"{self.file}: {value(symbol, 'lib_id')} is not embedded")
        fields = properties(symbol)
        reference, unit = self._instance(symbol, fields)
        at_node = child(symbol, "at")
        at, turn = point(at_node), float(at_node[3]) if len(at_node) > 3 else 0
        pins = [(pin, place_pin(at, turn, value(symbol, "mirror"), pin["offset"]))
                for pin in library_pins(library, unit)]
        if child(library, "power"):
            for pin, where in pins:
                self._power(pin, fields["Value"], (self.name, where))
            return
        part = reader.parts.setdefault(reference, self._part(symbol, reference, fields))
        for pin, where in pins:
            part.pins[pin["number"]] = Pin(pin["number"], pin["name"], pin["kind"],
                                           where in self.unused)
            reader.pins[(reference, pin["number"])] = (self.name, where)
            if pin["hidden"] and pin["kind"] == "power_in":
                # KiCad's old way to supply a gate: a hidden pin is on the net of its name.
                self._power(pin, pin["name"], (self.name, where))

    def _power(self, pin, net, node):
        if pin["kind"] == "power_out":
            self.reader.flags.append(node)
            return
        self.reader.groups.join(node, ("power", net))
        self.reader.names.append((STRONGEST_FIRST.index("power"), 0, net, node))

    def _instance(self, symbol, fields):
        """Reference and unit: KiCad 6 keeps them in the root file, 7 and later in the symbol."""
        for project in children(child(symbol, "instances") or [], "project"):
            for entry in children(project, "path"):
                if entry[1] == self.full_path:
                    return value(entry, "reference"), int(value(entry, "unit"))
        found = self.reader.instances.get(self.path + value(symbol, "uuid"))
        return found or (fields["Reference"], int(value(symbol, "unit", "1")))

    def _part(self, symbol, reference, fields):
        shown = {key: text for key, text in fields.items()
                 if key not in ("Reference", "Value", "Footprint", "Datasheet")}
        return Part(reference, fields["Value"], fields.get("Footprint", ""), shown,
                    value(symbol, "in_bom", "yes") == "yes", value(symbol, "lib_id"))

    def _label(self, kind, name, at):
        node = (self.name, at)
        for start, end in self.wires:
            if on_wire(at, start, end):
                self.reader.groups.join(node, (self.name, start))
        scope = () if kind == "global" else (self.name,)
        self.reader.groups.join(node, (*scope, kind, name))
        if kind == "hierarchical":
            # A local label of the same name on the sheet is the same net.
            self.reader.groups.join(node, (self.name, "local", name))
        full = name if kind == "global" else self.name + name
        depth = self.name.count("/")
        self.reader.names.append((STRONGEST_FIRST.index(kind), depth, full, node))


def on_wire(at, start, end):
    (x, y), (x0, y0), (x1, y1) = at, start, end
    across = (x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)
    return across == 0 and min(x0, x1) <= x <= max(x0, x1) and min(y0, y1) <= y <= max(y0, y1)


def read(root_file):
    """The netlist of a schematic, given by the file of its root sheet."""
    return Reader(root_file).read()


def schematic_files(root_file):
    """The files of all sheets, the root's first."""
    reader = Reader(root_file)
    reader.read()
    return list(dict.fromkeys(reader.files))


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    for net in read(arguments[0]).nets.values():
        print(net.name, *(f"{ref}.{number}" for ref, number in net.pins))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
