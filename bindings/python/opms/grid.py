# SPDX-License-Identifier: Apache-2.0
"""From a picture of the calibration grid ``a0-25`` to its labelled nodes.

The node with label (i, j) lies at X = (i - CENTRE) * PITCH_M and Y = (j - CENTRE) * PITCH_M of the
grid frame.
"""

from opms._opms import GRID_CENTRE as CENTRE
from opms._opms import GRID_LINE_M as LINE_M
from opms._opms import GRID_NODES_X as NODES_X
from opms._opms import GRID_NODES_Y as NODES_Y
from opms._opms import GRID_PITCH_M as PITCH_M
from opms._opms import NODE_DTYPE
from opms._opms import GridDetection as Detection
from opms._opms import GridDetector as Detector
from opms._opms import GridState as State
from opms._opms import GridSummary as Summary
from opms._opms import grid_relabel as relabel

__all__ = [
    "CENTRE",
    "LINE_M",
    "NODES_X",
    "NODES_Y",
    "NODE_DTYPE",
    "PITCH_M",
    "Detection",
    "Detector",
    "State",
    "Summary",
    "relabel",
]
