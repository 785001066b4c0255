# SPDX-License-Identifier: Apache-2.0
"""From points of a plane seen in several pictures to the camera: lens, poses, how good they are."""

from opms._opms import CALIB_CHI2_LENS as CHI2_LENS
from opms._opms import CALIB_CHI2_MOUNTING as CHI2_MOUNTING
from opms._opms import CalibForesight as Foresight
from opms._opms import CalibLensCheck as LensCheck
from opms._opms import CalibMountingCheck as MountingCheck
from opms._opms import CalibPicture as Picture
from opms._opms import CalibResult as Result
from opms._opms import Calibrator, Footprint
from opms._opms import CalibUse as Use
from opms._opms import CalibWarning as Warning

__all__ = [
    "CHI2_LENS",
    "CHI2_MOUNTING",
    "Calibrator",
    "Footprint",
    "Foresight",
    "LensCheck",
    "MountingCheck",
    "Picture",
    "Result",
    "Use",
    "Warning",
]
