# SPDX-License-Identifier: Apache-2.0
"""Judge of a recording of made records: Python's sqlite3 and OpenCV alone, nothing of opms.

    check_scan(FOLDER, EDGES, ...) -> Found, or raises WrongScan."""
import math
import sqlite3
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy

import made_truth


class WrongScan(Exception):
    """What is there is not what was handed over."""


@dataclass
class Found:
    ended: bool = False
    rows: dict = field(default_factory=dict)   # table -> number of rows
    newest: dict = field(default_factory=dict)  # table -> n of the newest record
    pictures: set = field(default_factory=set)

    def has(self, n):
        """Whether all rows of frame n are there."""
        return all(self.newest[table] >= n - n % made_truth.FIRST_FOR.get(table, 1)
                   for table in made_truth.COLUMNS) and n in self.pictures


def same(found, wanted):
    if isinstance(wanted, float) and isinstance(found, float):
        return math.isclose(found, wanted, rel_tol=1e-12, abs_tol=1e-12)
    return found == wanted


def check_table(book, table, edges, found):
    columns = made_truth.COLUMNS[table]
    rows = book.execute(f"SELECT {columns} FROM {table} ORDER BY rowid").fetchall()
    step = made_truth.FIRST_FOR.get(table, 1)
    for i, row in enumerate(rows, 1):
        wanted = made_truth.row(table, i * step, edges)
        if len(row) != len(wanted) or not all(map(same, row, wanted)):
            raise WrongScan(f"{table}: row {i} is {row[:9]}, not {wanted[:9]}")
    found.rows[table] = len(rows)
    found.newest[table] = len(rows) * step


def check_events(book, found):
    """The recording's own events may stand among those that were handed over."""
    columns = made_truth.COLUMNS["events"]
    rows = book.execute(f"SELECT {columns} FROM events WHERE code NOT LIKE 'recording.%' "
                        "ORDER BY id").fetchall()
    for i, row in enumerate(rows, 1):
        if row != made_truth.events(10 * i):
            raise WrongScan(f"events: row {i} is {row}")
    found.rows["events"] = len(rows)
    found.newest["events"] = 10 * len(rows)


def check_picture(folder, n, path, size, crc32):
    data = (folder / path).read_bytes() if (folder / path).is_file() else None
    if data is None or len(data) != size or zlib.crc32(data) != crc32:
        raise WrongScan(f"picture {n}: missing, or not the bytes of the books")
    picture = cv2.imdecode(numpy.frombuffer(data, numpy.uint8), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise WrongScan(f"picture {n}: cannot be decoded")
    y, x = numpy.mgrid[0:48, 0:64]
    wanted = made_truth.grey(n, x, y)
    wanted = (wanted * 257).astype(numpy.uint16) if n % 2 == 0 else wanted.astype(numpy.uint8)
    if picture.dtype != wanted.dtype or not numpy.array_equal(picture, wanted):
        raise WrongScan(f"picture {n}: wrong grey levels")


def check_pictures(book, folder, found, known_good):
    """@p known_good: (path, crc32) of pictures whose pixels were looked at before."""
    for n, path, size, crc32 in book.execute("SELECT number, path, bytes, crc32 FROM pictures"):
        if (path, crc32) in known_good:
            data = (folder / path).read_bytes() if (folder / path).is_file() else b""
            if len(data) != size or zlib.crc32(data) != crc32:
                raise WrongScan(f"picture {n}: missing, or not the bytes of the books")
        else:
            check_picture(folder, n, path, size, crc32)
            known_good.add((path, crc32))
        found.pictures.add(n)


def check_scan(folder, edges, known_good=None):
    folder = Path(folder)
    found = Found()
    book = sqlite3.connect(folder / "scan.sqlite")
    try:
        verdict = book.execute("PRAGMA integrity_check").fetchone()[0]
        if verdict != "ok" or book.execute("PRAGMA foreign_key_check").fetchone():
            raise WrongScan(f"the database is damaged: {verdict}")
        header = dict(book.execute("SELECT key, value FROM scan_header"))
        if header.get("mode") != "position" or header.get("box.unique_id") != "A0A1A2A3A4A5A6A7":
            raise WrongScan("the header is not whole")
        end = dict(book.execute("SELECT key, value FROM scan_end"))
        found.ended = bool(end)
        if end and end.get("reason") != "stop":
            raise WrongScan(f"ended by {end.get('reason')}")
        for table in made_truth.COLUMNS:
            if table == "events":
                check_events(book, found)
            else:
                check_table(book, table, edges, found)
        check_pictures(book, folder, found, set() if known_good is None else known_good)
    except sqlite3.Error as error:
        raise WrongScan(f"sqlite: {error}") from error
    finally:
        book.close()
    return found
