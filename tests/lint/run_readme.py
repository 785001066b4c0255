# SPDX-License-Identifier: Apache-2.0
"""Run the README's code and see that it prints a position.

    run_readme.py python              with the interpreter that runs this
    run_readme.py c --prefix PREFIX   against an installed libopms (needs Pillow for the picture)
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from check_compiles import code_blocks  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
PICTURE = "tests/data/bar/bar_01011.png"


def block(language):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return next(code for found, _, code in code_blocks(text) if found == language)


def run_python():
    return subprocess.run([sys.executable, "-B", "-c", block("python")], cwd=ROOT, check=True,
                          stdout=subprocess.PIPE, text=True).stdout


def run_c(prefix):
    from PIL import Image
    pixels = Image.open(ROOT / PICTURE).convert("L").tobytes()
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "first_pose"
        source = program.with_suffix(".c")
        source.write_text(block("c"), encoding="utf-8")
        subprocess.run(["cc", "-std=c11", source, f"-I{prefix}/include", f"-L{prefix}/lib",
                        f"-Wl,-rpath,{prefix}/lib", "-lopms", "-o", program], check=True)
        return subprocess.run([program], input=pixels, check=True,
                              stdout=subprocess.PIPE).stdout.decode()


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("language", choices=("c", "python"))
    parser.add_argument("--prefix", type=Path)
    options = parser.parse_args(arguments)
    try:
        text = run_python() if options.language == "python" else run_c(options.prefix)
    except subprocess.CalledProcessError as error:
        print(f"the code failed with {error.returncode}", file=sys.stderr)
        return 1
    print(text, end="")
    return 0 if re.search(r"-?\d\.\d{3}", text) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
