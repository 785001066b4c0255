# SPDX-License-Identifier: Apache-2.0
"""How exact a position will be: asked of a calibrated camera before any picture of the bar."""

from opms._opms import Expectation
from opms._opms import expect_pose as pose

__all__ = ["Expectation", "pose"]
