# SPDX-License-Identifier: Apache-2.0
"""Where the tests lay recordings that need not outlive them."""
import os


def memory_folder():
    """A folder in memory, or None: that of all temporary files. A killed process loses nothing that
    it had handed to the system, on whatever it lies; a disk that others keep busy only makes the
    recorder late, which says nothing of it."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
