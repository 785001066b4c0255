# SPDX-License-Identifier: Apache-2.0
"""Write seeds for fuzz_wire: golden reports of each kind, and one refused for each reason.

    make_wire_corpus.py FOLDER
"""
import json
import sys
from pathlib import Path

DATA = Path(__file__).resolve().parents[1] / "data" / "wire"
PER_KIND = 3


def seeds():
    for path in sorted(DATA.glob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        if "report" in document:
            for i, vector in enumerate(document["vectors"][:PER_KIND]):
                yield f"{document['report']}_{i}", vector["hex"]
        else:
            results = {vector["result"]: vector["hex"] for vector in document["vectors"]}
            yield from ((f"refused_{result.lower()}", data) for result, data in results.items())


def main(folder):
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, data in seeds():
        (Path(folder) / f"wire_{name}.bin").write_bytes(bytes.fromhex(data))


if __name__ == "__main__":
    main(*sys.argv[1:])
