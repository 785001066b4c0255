# SPDX-License-Identifier: Apache-2.0
"""Write seeds for fuzz_pair into a folder: sessions as they are, and pure noise.

    make_pair_corpus.py FOLDER
"""
import random
import sys
from pathlib import Path

TRIGGER, FRAME, PONG, SESSION, TIME = 0, 3, 8, 9, 26


def session(profile, steps, noise, chance):
    """Pings, then a trigger and its frame every 100 ms; some inputs are noise."""
    out = bytearray([profile])
    for _ in range(10):
        out += bytes([PONG, 1, 20, 10, 60, 0, 0, 0]) + bytes([TIME, 0, 0, 0, 0, 0, 0, 0])
    for number in range(steps):
        if chance.random() < noise:
            out += bytes(chance.randrange(256) for _ in range(8))
        out += bytes([TRIGGER, 10, number > 0, 0, 100 * (number > 0), 100 * (number > 1), 7, 1])
        out += bytes([FRAME, 1, 0, 8, 0, 0, 0, 0])
        out += bytes([TIME, 0, 0, 0, 0, 0, 0, 0])
        if chance.random() < noise / 8:
            out += bytes([SESSION, 255, 1, number & 1, 0, 0, 0, 0])
    return bytes(out)


def main(arguments):
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    chance = random.Random(1)
    for profile in range(16):
        (folder / f"session_{profile:02d}").write_bytes(session(profile, 60, 0.0, chance))
        (folder / f"noisy_{profile:02d}").write_bytes(session(profile, 120, 0.3, chance))
        (folder / f"noise_{profile:02d}").write_bytes(
            bytes([profile]) + bytes(chance.randrange(256) for _ in range(8 * 250)))


if __name__ == "__main__":
    main(sys.argv[1:])
