# SPDX-License-Identifier: Apache-2.0
"""How sharp the marker bar is in a picture, and what is wrong where it is not."""

from opms._opms import Blur
from opms._opms import BlurVerdict as Verdict
from opms._opms import blur_measure as measure

__all__ = [
    "Blur",
    "Verdict",
    "measure",
]
