# SPDX-License-Identifier: Apache-2.0
"""kicad-cli of KiCad 7 or later: from the system, or from a folder with a Debian 13 of its own.

`make_kicad_root.sh DIR` makes such a folder where the system has no kicad-cli (Debian 12).
"""
import os
import shutil
import subprocess
import tempfile
from pathlib import Path


class KicadMissing(RuntimeError):
    """There is no kicad-cli."""


class KicadProgram:
    def __init__(self):
        """Looks in OPMS_KICAD_ROOT first, then on the PATH."""
        self.root = Path(os.environ["OPMS_KICAD_ROOT"]) if "OPMS_KICAD_ROOT" in os.environ else None
        if self.root is None and not shutil.which("kicad-cli"):
            raise KicadMissing("no kicad-cli: install KiCad 7 or later, or run make_kicad_root.sh "
                               "and set OPMS_KICAD_ROOT to its folder")

    def work_folder(self, project):
        """A temporary copy of a project's folder, where kicad-cli can write."""
        base = self.root / "tmp" if self.root else None
        folder = tempfile.TemporaryDirectory(dir=base, prefix="opms-kicad-")
        for path in Path(project).iterdir():
            if path.is_file():
                shutil.copy(path, folder.name)
        return folder

    def run(self, folder, *arguments):
        """kicad-cli in a folder that work_folder() gave."""
        if self.root:
            inside = "/" + str(Path(folder).relative_to(self.root))
            command = ["chroot", str(self.root), "env", "HOME=/root", "sh", "-c",
                       'cd "$0" && exec kicad-cli "$@"', inside, *arguments]
        else:
            command = ["kicad-cli", *arguments]
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if result.returncode:
            raise RuntimeError(f"kicad-cli {' '.join(arguments)}:\n{result.stdout}{result.stderr}")
        return result.stdout

    def version(self):
        with tempfile.TemporaryDirectory(dir=self.root / "tmp" if self.root else None) as folder:
            return self.run(folder, "version").strip()
