# SPDX-License-Identifier: Apache-2.0
"""Write what is made of the schematic into hw/schematics/outputs.

    make_outputs.py               all of it; the drawings need kicad-cli
    make_outputs.py --no-drawings netlist and parts list alone

opms-box.net, opms-box-bom.csv    by the project's own reader
opms-box.pdf, *.svg               by kicad-cli
opms-box-kicad.json               the nets as kicad-cli sees them: the tests hold the reader to it
Each holds the SHA-256 of the schematic; the tests compare it.
"""
import argparse
import hashlib
import json
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import bill_of_materials  # noqa: E402
import netlist_file  # noqa: E402
from kicad_program import KicadMissing, KicadProgram  # noqa: E402
from read_schematic import read, schematic_files  # noqa: E402

PROJECT = Path(__file__).resolve().parents[1]
NAME = "opms-box"


def schematic_hash(project=PROJECT):
    """One number for all sheets."""
    digest = hashlib.sha256()
    for path in schematic_files(project / f"{NAME}.kicad_sch"):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def own_files(project=PROJECT):
    """What the reader makes, by file name."""
    netlist = read(project / f"{NAME}.kicad_sch")
    stamp = schematic_hash(project)
    return {f"{NAME}.net": netlist_file.text(netlist, f"{NAME}.kicad_sch", stamp),
            f"{NAME}-bom.csv": bill_of_materials.text(netlist, stamp)}


def kicad_nets(kicad, folder):
    """Parts and nets out of kicad-cli's netlist."""
    kicad.run(folder, "sch", "export", "netlist", "--format", "kicadxml", "-o", "nets.xml",
              f"{NAME}.kicad_sch")
    root = ElementTree.parse(Path(folder) / "nets.xml").getroot()
    parts = {comp.get("ref"): {"value": comp.findtext("value"),
                               "footprint": comp.findtext("footprint") or ""}
             for comp in root.iter("comp")}
    nets = {net.get("name"): sorted(f"{node.get('ref')}.{node.get('pin')}"
                                    for node in net.iter("node")) for net in root.iter("net")}
    return {"parts": dict(sorted(parts.items())), "nets": dict(sorted(nets.items()))}


def write_drawings(kicad, out, stamp):
    with kicad.work_folder(PROJECT) as folder:
        report = {"schematic_sha256": stamp, "tool": f"kicad-cli {kicad.version()}",
                  **kicad_nets(kicad, folder)}
        (out / f"{NAME}-kicad.json").write_text(json.dumps(report, indent=1) + "\n")
        kicad.run(folder, "sch", "erc", "--exit-code-violations", f"{NAME}.kicad_sch")
        kicad.run(folder, "sch", "export", "pdf", "--no-background-color", "-o", "all.pdf",
                  f"{NAME}.kicad_sch")
        pdf = (Path(folder) / "all.pdf").read_bytes()
        # Readers of PDF look for the end of a file within its last 1024 bytes.
        (out / f"{NAME}.pdf").write_bytes(pdf + f"% schematic sha256 {stamp}\n".encode())
        kicad.run(folder, "sch", "export", "svg", "--no-background-color", "-o", "svg",
                  f"{NAME}.kicad_sch")
        for path in sorted((Path(folder) / "svg").glob("*.svg")):
            name = path.name.lower()
            body = path.read_text(encoding="utf-8").rstrip("\n")
            (out / name).write_text(f"{body}\n<!-- schematic sha256 {stamp} -->\n",
                                    encoding="utf-8")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--no-drawings", action="store_true")
    options = parser.parse_args(arguments)
    out = PROJECT / "outputs"
    out.mkdir(exist_ok=True)
    for name, text in own_files().items():
        (out / name).write_text(text, encoding="utf-8")
    if not options.no_drawings:
        try:
            write_drawings(KicadProgram(), out, schematic_hash())
        except (KicadMissing, RuntimeError) as error:
            print(f"make_outputs: {error}", file=sys.stderr)
            return 1
    print(*sorted(path.name for path in out.iterdir()), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
