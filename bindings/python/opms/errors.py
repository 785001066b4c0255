# SPDX-License-Identifier: Apache-2.0
"""The one exception of the package."""

from opms._opms import Status


class Error(Exception):
    """A call of the library failed.

    Attributes:
        status: Which kind of failure, an :class:`opms.Status`.
        message: What is wrong and with which argument, in English.
        index: Offending element of an array argument, or -1.
        stage: Part of the library that failed: "lens", "bar", "pose", ...
    """

    status: Status
    message: str
    index: int
    stage: str

    def __init__(self, status: Status, message: str, index: int = -1, stage: str = "") -> None:
        super().__init__(status, message, index, stage)
        self.status = status
        self.message = message
        self.index = index
        self.stage = stage

    def __str__(self) -> str:
        place = f" (element {self.index})" if self.index >= 0 else ""
        stage = f"{self.stage}: " if self.stage else ""
        return f"{stage}{self.message}{place} [OPMS_{self.status.name}]"
