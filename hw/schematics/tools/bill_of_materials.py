# SPDX-License-Identifier: Apache-2.0
"""The parts to buy: one row for each kind, with a second source and an estimated price."""
import csv
import io
import re
from collections import defaultdict

COLUMNS = ["Quantity", "References", "Value", "Description", "Footprint", "Manufacturer", "MPN",
           "Manufacturer 2", "MPN 2", "Cost EUR", "Sum EUR"]
NEEDED_FIELDS = ("Description", "Manufacturer", "MPN", "Manufacturer 2", "MPN 2", "Cost EUR")


def natural_order(reference):
    letters, digits = re.fullmatch(r"(\D+)(\d*)", reference).groups()
    return letters, int(digits or 0)


def rows(netlist):
    """Rows of strings in COLUMNS' order, by reference, and the sum of all in EUR."""
    kinds = defaultdict(list)
    for part in netlist.parts.values():
        if part.in_bom:
            kinds[(part.fields.get("MPN", ""), part.value, part.footprint)].append(part)
    table, total = [], 0.0
    groups = [sorted(parts, key=lambda part: natural_order(part.reference))
              for parts in kinds.values()]
    for parts in sorted(groups, key=lambda parts: natural_order(parts[0].reference)):
        fields = parts[0].fields
        each = float(fields.get("Cost EUR", 0))
        total += each * len(parts)
        table.append([str(len(parts)), " ".join(part.reference for part in parts), parts[0].value,
                      fields.get("Description", ""), parts[0].footprint,
                      *(fields.get(key, "") for key in NEEDED_FIELDS[1:5]),
                      f"{each:.2f}", f"{each * len(parts):.2f}"])
    return table, total


def text(netlist, stamp):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    table, total = rows(netlist)
    writer.writerow(COLUMNS)
    writer.writerows(table)
    writer.writerow(["", "", "", "all parts of one box"] + [""] * 6 + [f"{total:.2f}"])
    writer.writerow(["", "", "", f"schematic sha256 {stamp}"] + [""] * 7)
    return out.getvalue()
