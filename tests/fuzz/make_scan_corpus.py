# SPDX-License-Identifier: Apache-2.0
"""Make the corpus of fuzz_scan: small databases of scans, and files that are near to one.

    make_scan_corpus.py        (writes to corpus/scan beside it)"""
import sqlite3
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCHEMA = HERE.parent / "live/recording/schema_0.sql"
CHANGES = {
    "version_0": "",
    "newer": "PRAGMA user_version = 9;",
    "no_poses": "DROP TABLE locations; DROP TABLE poses;",
    "wrong_word": "UPDATE poses SET blur = 'blurred';",
    "short_blob": "UPDATE locations SET location = zeroblob(1271);",
    "odd_edges": "UPDATE locations SET edges = zeroblob(73);",
    "large_number": "UPDATE triggers SET number = 4294967296;",
    "ended": "INSERT INTO scan_end VALUES ('reason', 'stop'), ('rows.frames', 1);",
}


def main():
    folder = HERE / "corpus/scan"
    folder.mkdir(parents=True, exist_ok=True)
    for name, change in CHANGES.items():
        path = folder / name
        path.unlink(missing_ok=True)
        book = sqlite3.connect(path)
        book.executescript("PRAGMA page_size = 512;" + SCHEMA.read_text() + change)
        book.execute("VACUUM")
        book.close()
    whole = (folder / "version_0").read_bytes()
    (folder / "cut_off").write_bytes(whole[:len(whole) // 2])
    (folder / "text").write_bytes(b"no database\n")


if __name__ == "__main__":
    main()
