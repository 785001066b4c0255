# SPDX-License-Identifier: Apache-2.0
"""Check that each public header compiles alone, and that the README's C code compiles.

    check_compiles.py [--cc CC] [--cxx CXX] [ROOT]
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror"]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def compile_text(compiler, standard, suffix, text, include_dirs):
    """The compiler's complaints about a text, or None."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / f"text{suffix}"
        source.write_text(text, encoding="utf-8")
        command = [compiler, f"-std={standard}", *WARNINGS,
                   *(f"-I{d}" for d in include_dirs), "-fsyntax-only", str(source)]
        result = subprocess.run(command, capture_output=True, text=True)
        return result.stderr if result.returncode else None


def include_dirs(root):
    return [d for d in (root / "libopms/include", root / "libopms/apriltag/include") if d.is_dir()]


def header_problems(root, cc, cxx):
    dirs = include_dirs(root)
    for folder in dirs:
        for header in sorted((folder / "opms").glob("*.h")):
            text = f"#include <opms/{header.name}>\nint opms_lint_main(void);\n"
            for compiler, standard, suffix in ((cc, "c11", ".c"), (cxx, "c++17", ".cpp")):
                complaint = compile_text(compiler, standard, suffix, text, dirs)
                if complaint:
                    yield f"opms/{header.name} does not compile alone as {standard}:\n{complaint}"


def code_blocks(text):
    """The fenced blocks of a Markdown text, as (language, line, code)."""
    for match in FENCE.finditer(text):
        yield match.group(1), text.count("\n", 0, match.start()) + 2, match.group(2)


def document_problems(root, cc, cxx):
    documents = [root / "README.md", *sorted((root / "docs").glob("*.md"))]
    for document in documents:
        if not document.is_file():
            continue
        name = document.relative_to(root)
        for language, line, code in code_blocks(document.read_text(encoding="utf-8")):
            complaint = None
            if language == "c":
                complaint = compile_text(cc, "c11", ".c", code, include_dirs(root))
            elif language == "cpp":
                complaint = compile_text(cxx, "c++17", ".cpp", code, include_dirs(root))
            elif language == "python":
                try:
                    compile(code, str(name), "exec")
                except SyntaxError as error:
                    complaint = str(error)
            if complaint:
                yield f"{name}:{line}: the {language} code does not compile:\n{complaint}"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cc", default="cc")
    parser.add_argument("--cxx", default="c++")
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parents[2])
    options = parser.parse_args(arguments)
    found = [*header_problems(options.root, options.cc, options.cxx),
             *document_problems(options.root, options.cc, options.cxx)]
    print("\n".join(found) if found else "headers and documents compile")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
