# SPDX-License-Identifier: Apache-2.0
"""The state of a disk after a power cut, from the log of disk_tap.c.

What was synced is there. Of what was not, any part may be: data in sectors of 512 bytes, sizes,
names. So a cut has many outcomes, and cut() makes one of them by its random numbers:

- a file's data since its last sync: each sector that was written is there or not, by itself;
- a file's size since then: any it had, but never less than a sector that is there needs;
- names since the last sync of their folder: each change (made, renamed, removed) is there or not; a
  rename is there whole or not at all.

A sync of a file does not make its name durable; only that of its folder does. That is less than the
common file systems keep."""
import struct
from pathlib import Path

SECTOR = 512
MARK, CREATE, WRITE, SIZE, RENAME, REMOVE, FOLDER, SYNC = range(8)
HEAD = struct.Struct("<4I3q")


def read_log(path):
    """(kind, name, other, data, time_ns, offset) of each call, in order. A log that was cut off
    ends with the last whole record."""
    data = Path(path).read_bytes()
    at = 0
    while at + HEAD.size <= len(data):
        kind, *sizes, time_ns, offset, _ = HEAD.unpack_from(data, at)
        at += HEAD.size
        if at + sum(sizes) > len(data):
            return
        parts = []
        for size in sizes:
            parts.append(data[at:at + size])
            at += size
        yield kind, parts[0].decode(), parts[1].decode(), parts[2], time_ns, offset


class File:
    def __init__(self):
        self.now = bytearray()
        self.durable = b""
        self.since = []  # (offset, data), or (None, size)

    def write(self, offset, data):
        if len(self.now) < offset:
            self.now.extend(bytes(offset - len(self.now)))
        self.now[offset:offset + len(data)] = data
        self.since.append((offset, data))

    def resize(self, size):
        if len(self.now) > size:
            del self.now[size:]
        else:
            self.now.extend(bytes(size - len(self.now)))
        self.since.append((None, size))

    def sync(self):
        if self.since:
            self.durable = bytes(self.now)
            self.since.clear()

    def after_cut(self, rng, luck):
        data = bytearray(self.durable)
        for offset, written in self.since:
            if offset is None:
                if rng.random() < luck:
                    del data[written:]
                    data.extend(bytes(written - len(data)))
                continue
            for first, part in sectors(offset, written):
                if rng.random() < luck:
                    if len(data) < first:
                        data.extend(bytes(first - len(data)))
                    data[first:first + len(part)] = part
        return bytes(data)


def sectors(offset, data):
    """What of @p data lies in each sector of the disk."""
    at = 0
    while at < len(data):
        size = min(SECTOR - (offset + at) % SECTOR, len(data) - at)
        yield offset + at, data[at:at + size]
        at += size


class Folder:
    def __init__(self):
        self.now = {}
        self.durable = {}
        self.since = []  # each a list of (name, what it then is, or None)

    def change(self, *names):
        for name, what in names:
            if what is None:
                self.now.pop(name, None)
            else:
                self.now[name] = what
        self.since.append(names)

    def sync(self):
        self.durable = dict(self.now)
        self.since.clear()

    def names_after_cut(self, rng, luck):
        names = dict(self.durable)
        for change in self.since:
            if rng.random() < luck:
                for name, what in change:
                    if what is None:
                        names.pop(name, None)
                    else:
                        names[name] = what
        return names


class Disk:
    """Follows the log; the root itself is there from the beginning."""

    def __init__(self):
        self.root = Folder()

    def find(self, path):
        """Folder that holds the path's last name, and that name."""
        folder = self.root
        *above, name = [part for part in path.split("/") if part]
        for part in above:
            folder = folder.now[part]
        return folder, name

    def look_up(self, path):
        if not path.strip("/"):
            return self.root
        folder, name = self.find(path)
        return folder.now[name]

    def apply(self, kind, name, other, data, offset):
        if kind == WRITE:
            self.look_up(name).write(offset, data)
        elif kind == SIZE:
            self.look_up(name).resize(offset)
        elif kind == SYNC:
            self.look_up(name).sync()
        elif kind in (CREATE, FOLDER, REMOVE):
            folder, last = self.find(name)
            new = {CREATE: File, FOLDER: Folder, REMOVE: lambda: None}[kind]()
            folder.change((last, new))
        elif kind == RENAME:
            self.rename(name, other)

    def rename(self, name, other):
        folder, old = self.find(name)
        target, new = self.find(other)
        if folder is not target:
            raise ValueError(f"{name}: renamed into another folder, which this does not model")
        folder.change((old, None), (new, folder.now[old]))

    def cut(self, rng, luck, place):
        """Write one outcome of a cut at this instant into the empty folder @p place.
        @p luck: how probable it is that something unsynced is there, 0 to 1."""
        write_folder(self.root, rng, luck, Path(place))


def write_folder(folder, rng, luck, place):
    place.mkdir(exist_ok=True)
    for name, what in folder.names_after_cut(rng, luck).items():
        if isinstance(what, Folder):
            write_folder(what, rng, luck, place / name)
        else:
            (place / name).write_bytes(what.after_cut(rng, luck))
