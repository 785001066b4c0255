#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write a flash image as a UF2 file, which the Pico's bootloader takes like a file on a drive.

    make_uf2.py IMAGE.bin OUTPUT.uf2

The format: blocks of 512 bytes, each with 32 bytes of header, up to 476 of data and a closing
magic; this chip wants 256 bytes of data in each, at addresses that follow each other.
"""
import struct
import sys
from pathlib import Path

MAGIC_BEGIN = (0x0A324655, 0x9E5D5157)
MAGIC_END = 0x0AB16F30
FLAG_FAMILY = 0x2000
FAMILY_RP2040 = 0xE48BFF56
FLASH_BASE = 0x10000000
PAYLOAD = 256


def blocks(image):
    count = -(-len(image) // PAYLOAD)
    for number in range(count):
        payload = image[number * PAYLOAD:(number + 1) * PAYLOAD].ljust(PAYLOAD, b"\0")
        header = struct.pack("<8I", *MAGIC_BEGIN, FLAG_FAMILY, FLASH_BASE + number * PAYLOAD,
                             PAYLOAD, number, count, FAMILY_RP2040)
        yield header + payload.ljust(476, b"\0") + struct.pack("<I", MAGIC_END)


def main(arguments):
    if len(arguments) != 2:
        sys.exit("usage: make_uf2.py IMAGE.bin OUTPUT.uf2")
    image = Path(arguments[0]).read_bytes()
    if not image:
        sys.exit(f"make_uf2: {arguments[0]} is empty")
    Path(arguments[1]).write_bytes(b"".join(blocks(image)))


if __name__ == "__main__":
    main(sys.argv[1:])
