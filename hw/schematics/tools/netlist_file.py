# SPDX-License-Identifier: Apache-2.0
"""The netlist in KiCad's own format, for a board layout to import."""
from bill_of_materials import natural_order
from kicad_text import quote


def text(netlist, source, stamp):
    lines = ['(export (version "E")',
             f"  (design (source {quote(source)}) (comment {quote('schematic sha256 ' + stamp)}))",
             "  (components"]
    for reference in sorted(netlist.parts, key=natural_order):
        part = netlist.parts[reference]
        lines.append(f"    (comp (ref {quote(reference)}) (value {quote(part.value)})"
                     f" (footprint {quote(part.footprint)}))")
    lines += ["  )", "  (nets"]
    for code, name in enumerate(sorted(netlist.nets), 1):
        lines.append(f'    (net (code "{code}") (name {quote(name)})')
        for reference, number in netlist.nets[name].pins:
            lines.append(f"      (node (ref {quote(reference)}) (pin {quote(number)}))")
        lines.append("    )")
    return "\n".join(lines + ["  )", ")"]) + "\n"
