# SPDX-License-Identifier: Apache-2.0
"""What scan_writer said of itself, and what must therefore be in its recording."""
from dataclasses import dataclass, field

SECOND_NS = 1_000_000_000


@dataclass
class Claims:
    """Lines of scan_writer up to some instant."""
    begun: bool = False
    ending: bool = False
    ended: bool = False
    handed: list = field(default_factory=list)  # (n, NS)
    synced_ns: int = 0
    stall_ns: int = 0  # longest time that the machine let the program sleep too long

    def hear(self, line):
        word, *rest = line.split()
        if word == "n":
            self.handed.append((int(rest[0]), int(rest[1])))
        elif word == "synced":
            self.synced_ns = max(self.synced_ns, int(rest[0]))
        elif word == "late":
            self.stall_ns = max(self.stall_ns, int(rest[0]))
        else:
            setattr(self, word, True)

    def rows_due(self, cut_ns):
        """The last frame whose rows must be there after a cut: all that was handed over a second
        before, and all that the recorder said was on the disk. A machine that let the program
        itself wait cannot be held to the second: that time is added."""
        if self.ended:
            return self.handed[-1][0] if self.handed else 0
        latest = max(cut_ns - SECOND_NS - self.stall_ns, self.synced_ns - 1)
        return max((n for n, t in self.handed if t <= latest), default=0)

    def pictures_due(self, cut_ns):
        if self.ended:
            return self.rows_due(cut_ns)
        return max((n for n, t in self.handed if t <= cut_ns - SECOND_NS - self.stall_ns),
                   default=0)
