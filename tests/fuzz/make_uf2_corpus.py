# SPDX-License-Identifier: Apache-2.0
"""Write the seeds of fuzz_uf2: small UF2 files, good and bad.

    make_uf2_corpus.py [FOLDER]
"""
import struct
import sys
from pathlib import Path

FLASH = 0x10000000


def crc32_mpeg2(data):
    """The boot ROM's CRC-32."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ 0x04C11DB7 if crc & 0x80000000 else crc << 1) & 0xFFFFFFFF
    return crc


def block(number, count, page, address=None, family=0xE48BFF56, flags=0x2000, size=256):
    """One block of 512 bytes."""
    address = FLASH + 256 * number if address is None else address
    head = struct.pack("<8I", 0x0A324655, 0x9E5D5157, flags, address, size, number, count, family)
    return head + page.ljust(476, b"\0") + struct.pack("<I", 0x0AB16F30)


def firmware():
    """Two pages that pass as the box's firmware."""
    stage = bytes(range(252))
    first = stage + struct.pack("<I", crc32_mpeg2(stage))
    second = struct.pack("<2I", 0x20042000, FLASH + 0x141) + bytes.fromhex("064fff0901a101")
    return first, second.ljust(256, b"\x5a")


def seeds():
    first, second = firmware()
    good = block(0, 2, first) + block(1, 2, second)
    yield "good", good
    yield "order", block(1, 2, second) + block(0, 2, first)
    yield "cut", good[:700]
    yield "missing", good[:512]
    yield "twice", block(0, 2, first) + block(0, 2, first)
    yield "same-address", block(0, 2, first) + block(1, 2, second, address=FLASH)
    yield "other-family", block(0, 1, first, family=0xE48BFF59)
    yield "ram", block(0, 1, first, address=0x20000000)
    yield "end-of-flash", block(0, 1, first, address=FLASH + 0x1FFF00)
    yield "beyond-flash", block(0, 1, first, address=FLASH + 0x200000)
    yield "not-main-flash", block(0, 2, first) + block(1, 2, second, flags=0x2001)
    yield "size", block(0, 1, first, size=476)
    yield "empty", b""


def main(arguments):
    folder = Path(arguments[0] if arguments else Path(__file__).parent / "corpus/uf2")
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in seeds():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main(sys.argv[1:])
