# SPDX-License-Identifier: Apache-2.0
"""The printed patterns as black and white boxes, written from their definition alone."""
from print_kit import Box

BAR = Box(-15, 15, -500, 500)
LINES = Box(-401, 401, -551, 551)
EVALUATION_BAR_X = -350

# Six bits of each square, bit 5 first: cells at X = -11.25, -6.75, -2.25 mm in the gap on the
# right, then at 2.25, 6.75, 11.25 mm in the gap on the left.
HOPE33 = """
    111001 001000 101110 100100 111101 010011 111000 111110 110010 000001 100011
    011100 100110 001010 100101 111010 000010 000110 001101 110110 010111 010110
    110101 011000 100001 101111 110111 101100 001110 000011 010001 110001 000101
""".split()


def hope33(shift_x=0):
    """The bar's squares and cells, (1, Box) each."""
    boxes = []
    for k, code in enumerate(HOPE33):
        y = -480 + 30 * k
        boxes.append(Box(-10, 10, y - 10, y + 10))
        for place, bit in enumerate(code):
            if bit == "1":
                top = -13.5 + 4.5 * place
                left = y + 12.5 if place < 3 else y - 17.5
                boxes.append(Box(top, top + 4.5, left, left + 5))
    return [(1, Box(b.x0 + shift_x, b.x1 + shift_x, b.y0, b.y1)) for b in boxes]


def grid():
    """Lines and marker."""
    lines = [Box(x - 1, x + 1, -551, 551) for x in range(-400, 401, 25)]
    lines += [Box(-401, 401, y - 1, y + 1) for y in range(-550, 551, 25)]
    return [(1, box) for box in lines] + [(1, Box(3, 9, 3, 9))]


def evaluation():
    """The grid with the bar laid over it."""
    return (grid() + [(0, Box(-365, -335, -500, 500))] + hope33(EVALUATION_BAR_X))
