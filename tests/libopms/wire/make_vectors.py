# SPDX-License-Identifier: Apache-2.0
"""Write tests/data/wire/*.json, the golden reports, or check that they are as they should be.

    make_vectors.py [--check] [FOLDER]
"""
import json
import sys
from pathlib import Path

from wire_faults import faults
from wire_layouts import LAYOUTS, crc16, reserved, write
from wire_samples import samples

FOLDER = Path(__file__).resolve().parents[2] / "data" / "wire"


def good(kind):
    vectors = [{"name": name, "fields": fields, "hex": write(kind, fields).hex()}
               for name, fields in samples(kind)]
    return {"report": kind, "id": LAYOUTS[kind][0], "reserved": reserved(kind), "vectors": vectors}


def bad():
    return {"vectors": [{"name": name, "report": kind, "result": result, "hex": data.hex()}
                        for kind, name, result, data in faults()]}


def documents():
    for kind in LAYOUTS:
        yield f"{kind}.json", good(kind)
    yield "refused.json", bad()


def dump(document):
    """One vector a line, so that a difference is easy to see."""
    head = {key: value for key, value in document.items() if key != "vectors"}
    lines = ",\n".join("  " + json.dumps(vector) for vector in document["vectors"])
    start = json.dumps(head)[:-1] + (", " if head else "")
    return f'{start}"vectors": [\n{lines}\n]}}\n'


def main(arguments):
    # The published check value of this CRC: else all of the files would be wrong alike.
    assert crc16(b"123456789") == 0x29B1
    check = "--check" in arguments
    folder = Path(next((a for a in arguments if a != "--check"), FOLDER))
    different = 0
    for name, document in documents():
        path, text = folder / name, dump(document)
        if not check:
            path.write_text(text, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            print(f"{name} is not what make_vectors.py writes")
            different += 1
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
