# SPDX-License-Identifier: Apache-2.0
"""Write the seeds of fuzz_calib, in the form that it reads.

    make_calib_corpus.py        (the seeds are kept in corpus/calib)
"""
import random
import struct
from pathlib import Path

HERE = Path(__file__).resolve().parent
COCKLE, NAN, NO_SIGMA, RAW, TWICE = 1, 2, 4, 8, 16


def setup(views, flags=0, width=64, height=48, focal=30, k1=-12, k2=3, odd=5):
    return struct.pack("<3B2b3B", width, height, focal, k1, k2, views, flags, odd)


def view(rng, points=64, disturbance=1, tilt=45):
    return struct.pack("<5b3B", rng.randint(-tilt, tilt), rng.randint(-tilt, tilt),
                       rng.randint(-120, 120), rng.randint(-30, 30), rng.randint(-30, 30),
                       rng.randint(40, 90), points, disturbance)


def seed(number, views=6, flags=0, **how):
    rng = random.Random(number)
    look = {k: how.pop(k) for k in ("points", "disturbance", "tilt") if k in how}
    data = setup(views, flags, **how) + b"".join(view(rng, **look) for _ in range(views))
    return data + rng.randbytes(97)


def seeds():
    yield "usual", seed(1)
    yield "usual_twice", seed(2, flags=TWICE)
    yield "cockle", seed(3, views=8, flags=COCKLE)
    yield "wide_lens", seed(4, focal=18, k1=-30, k2=9, width=120, height=90)
    yield "tele_lens", seed(5, focal=120, k1=20, k2=5)
    yield "few_points", seed(6, points=6)
    yield "four_points", seed(7, points=9, disturbance=0)
    yield "noisy", seed(8, disturbance=160)
    yield "wild", seed(9, disturbance=255)
    yield "parallel", seed(10, tilt=0)
    yield "two_pictures", seed(11, views=2)
    yield "not_a_number", seed(12, flags=NAN)
    yield "no_sigma", seed(13, flags=NO_SIGMA)
    yield "raw", seed(14, flags=RAW)
    yield "no_picture", setup(0)


def main():
    folder = HERE / "corpus" / "calib"
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in seeds():
        (folder / name).write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main()
