# SPDX-License-Identifier: Apache-2.0
"""Run a program beside an emulated box, whose ports it finds in its environment.

    run_with_emulated_box.py NODE BOX_SERVER FIRMWARE PROGRAM [ARGUMENT...]

OPMS_BOX_PORT is the box's, OPMS_WIRES_PORT that of its wires to a camera."""
import os
import re
import subprocess
import sys


def main(arguments):
    node, server, firmware, *command = arguments
    box = subprocess.Popen([node, server, "--port", "0", "--wires", "0", "--firmware", firmware],
                           stdout=subprocess.PIPE, text=True)
    try:
        ports = [re.search(r":(\d+)$", box.stdout.readline().strip()) for _ in range(2)]
        if not all(ports):
            print("the emulated box did not start", file=sys.stderr)
            return 1
        environment = dict(os.environ, OPMS_BOX_PORT=ports[0].group(1),
                           OPMS_WIRES_PORT=ports[1].group(1))
        return subprocess.run(command, env=environment, check=False).returncode
    finally:
        box.kill()
        box.wait()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
