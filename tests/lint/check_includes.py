# SPDX-License-Identifier: Apache-2.0
"""Check who includes whom: data flows one way, and includes follow it.

    check_includes.py [ROOT]

The table is docs/architecture.md's:
base <- kits <- stages <- locate, expect <- programs and bindings.
Prints one line a violation and ends with 1 if there was any.
"""
import re
import sys
from pathlib import Path, PurePosixPath

KITS = {"algebra", "image", "lens", "wire"}
STAGES = {"bar", "blur", "calib", "exposure", "grid", "pair", "pose"}
# What a folder of libopms/src may include from other folders of libopms/src.
MAY_USE = {
    "base": set(),
    **{kit: {"base"} for kit in KITS},
    "lens": {"base", "algebra"},  # several rays at a time
    **{stage: {"base"} | KITS for stage in STAGES},
    "locate": {"base"} | KITS,
    "expect": {"base"} | KITS,
    "wire": set(),  # the firmware compiles it alone
}
# Public headers that a folder must not see, because they belong to something after it.
AFTER = {
    "base": {"wire.h", "lens.h", "bar.h", "pose.h", "locate.h", "opms.h"},
    "algebra": {"wire.h", "lens.h", "bar.h", "pose.h", "locate.h", "opms.h"},
    "image": {"wire.h", "bar.h", "pose.h", "locate.h", "opms.h"},
    "lens": {"wire.h", "bar.h", "pose.h", "locate.h", "opms.h"},
    "wire": set(),  # check_wire() is stricter
    "bar": {"wire.h", "pose.h", "locate.h", "opms.h"},
    "pose": {"wire.h", "locate.h", "opms.h"},
    "exposure": {"wire.h", "pair.h", "pose.h", "calib.h", "locate.h", "opms.h"},
    "blur": {"wire.h", "pair.h", "pose.h", "calib.h", "exposure.h", "locate.h", "opms.h"},
    "grid": {"wire.h", "bar.h", "pose.h", "calib.h", "locate.h", "opms.h"},
    "calib": {"wire.h", "bar.h", "locate.h", "opms.h"},
    "pair": {"lens.h", "bar.h", "pose.h", "locate.h", "calib.h", "opms.h"},  # wire.h: its input
    "locate": {"wire.h", "pair.h", "clock.h", "opms.h"},
    "expect": {"wire.h", "pair.h", "clock.h", "locate.h", "grid.h", "calib.h", "opms.h"},
}
C_HEADERS = set("""assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp
    signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath
    time uchar wchar wctype""".split())
# What a C compiler has without a library; more is not for folders that the firmware compiles.
FREESTANDING = {f"{name}.h" for name in
                "float iso646 limits stdalign stdarg stdbool stddef stdint stdnoreturn".split()}
# x86 and ARM vector intrinsics belong to the compiler, not to a library.
COMPILER_HEADERS = {"immintrin.h", "emmintrin.h", "xmmintrin.h", "arm_neon.h"}
# The firmware's folders, in the order in which they may use each other, and what of libopms.
FIRMWARE_ORDER = ["core", "hal", "app"]
FIRMWARE_MAY_READ = {
    "core": {"opms/wire.h"},
    "hal": {"opms/wire.h"},
    "app": {"opms/wire.h", "opms/version.h"},
}
SUFFIXES = {".c", ".h", ".cpp", ".hpp"}
HIDAPI_HEADER = re.compile(r"(hidapi/)?hidapi\w*\.h$")
POSIX_HEADER = re.compile(r"((sys|arpa|netinet)/\w+|fcntl|poll|pthread|unistd)\.h$")
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


def sources(root):
    """All C and C++ files of the tree, with their path relative to it."""
    for top in ("libopms", "firmware", "host-tools", "bindings", "tests"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                yield path, PurePosixPath(path.relative_to(root).as_posix())


def includes(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def is_standard(name):
    if name in COMPILER_HEADERS or name.removesuffix(".h") in C_HEADERS:
        return True
    return re.fullmatch(r"[a-z_0-9]+", name) is not None  # C++: <vector>, <cmath>


def resolve(root, source, name):
    """The file of the tree that an include means, or None for one from outside."""
    for base in (root / source.parent, root / "libopms/src", root / "libopms/include",
                 root / "libopms/apriltag/include", root / "libopms/hid/include",
                 root / "firmware/core", root / "firmware/hal", root / "firmware/app"):
        path = (base / name).resolve()
        if path.is_file() and path.is_relative_to(root):
            return PurePosixPath(path.relative_to(root).as_posix())
    return None


def is_under(path, folder):
    return path is not None and path.is_relative_to(folder)


def check_public(name, target):
    if is_under(target, "libopms/include") or is_standard(name):
        return None
    return "a public header may include public headers and the C library only"


def check_wire(name, target):
    if name in ("opms/wire.h", "opms/export.h") or is_under(target, "libopms/src/wire"):
        return None
    if target is None and name in FREESTANDING:
        return None
    return "wire is freestanding C of opms/wire.h alone: the firmware compiles it, too"


def check_source(source, name, target):
    """Rules inside libopms/src."""
    folder = source.parts[2]
    if folder not in MAY_USE:
        return f"src/{folder} is not in this check's table"
    if folder == "wire":
        return check_wire(name, target)
    if is_under(target, "libopms/include"):
        if target.name in AFTER[folder]:
            return f"{folder} comes before what opms/{target.name} declares"
        return None
    if is_under(target, "libopms/src"):
        other = target.parts[2]
        if other != folder and other not in MAY_USE[folder]:
            return f"{folder} must not see the inside of {other}"
        return None
    if target is None and name.startswith("Eigen/"):
        return "Eigen is for the C++ files" if source.suffix == ".c" else None
    if target is None and is_standard(name):
        return None
    return "libopms depends on nothing but the C and C++ run time and Eigen's headers"


def check_apriltag(name, target):
    if is_under(target, "libopms/src"):
        return "opms::apriltag uses the public headers only"
    if is_under(target, "libopms/apriltag") or is_under(target, "libopms/include"):
        return None
    if target is None and (is_standard(name) or re.match(r"(apriltag|tag\w+|common)\b", name)):
        return None
    return "opms::apriltag depends on libapriltag and the run time only"


def check_hid(name, target):
    if is_under(target, "libopms/src"):
        return "opms::hid uses the public headers only"
    if is_under(target, "libopms/hid") or is_under(target, "libopms/include"):
        return None
    if target is None and (is_standard(name) or POSIX_HEADER.match(name)
                           or HIDAPI_HEADER.match(name)):
        return None
    return "opms::hid depends on hidapi, POSIX and the run time only"


def check_firmware(source, name, target):
    """app -> hal -> core -> opms/wire.h; only hal and app know the chip."""
    folder = source.parts[1]
    if is_under(target, "libopms"):
        if name in FIRMWARE_MAY_READ[folder]:
            return None
        return f"firmware/{folder} may read {', '.join(sorted(FIRMWARE_MAY_READ[folder]))} only"
    if is_under(target, "firmware"):
        other = target.parts[1]
        if FIRMWARE_ORDER.index(other) > FIRMWARE_ORDER.index(folder):
            # The pins stand in app, where a person looks for them, and nowhere else.
            pins = folder == "hal" and target.name == "board_pins.h"
            return None if pins else f"firmware/{folder} comes before firmware/{other}"
        return None
    if folder == "core" and name not in FREESTANDING | {"string.h"}:
        return "firmware/core is plain C: no hardware, no SDK"
    return None


def check_shell(source, name, target):
    """Rules of host-tools and bindings: people-facing, outside of the library."""
    if is_under(target, "libopms/src"):
        return "only public headers opms/*.h are seen from outside libopms"
    if is_under(source, "host-tools/simulate") and (name.startswith("opms/")
                                                    or is_under(target, "libopms")):
        return "the renderer judges libopms, so it must share nothing with it"
    if target is None and name.startswith("opms/"):
        return "no such public header"
    return None


def check(root, source, name):
    """The violation of one include, or None."""
    target = resolve(root, source, name)
    if is_under(target, "tests") and not is_under(source, "tests"):
        return "nothing includes tests"
    if re.match(r"(apriltag/)?(apriltag|tag\w+)\.h$", name) and not (
            is_under(source, "libopms/apriltag") or is_under(source, "tests")):
        return "only opms::apriltag uses libapriltag"
    if HIDAPI_HEADER.match(name) and not (
            is_under(source, "libopms/hid/src") or is_under(source, "tests")):
        return "only opms::hid uses hidapi"
    if is_under(source, "libopms/include"):
        return check_public(name, target)
    if is_under(source, "libopms/src"):
        return check_source(source, name, target)
    if is_under(source, "libopms/apriltag"):
        return check_apriltag(name, target)
    if is_under(source, "libopms/hid"):
        return check_hid(name, target)
    if is_under(source, "firmware"):
        return check_firmware(source, name, target)
    if is_under(source, "host-tools") or is_under(source, "bindings"):
        return check_shell(source, name, target)
    return None


def check_links(root):
    """The renderer must not link libopms, either."""
    for path in sorted((root / "host-tools/simulate").rglob("CMakeLists.txt")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if re.search(r"opms::\w+|\bopms_(camera_file|static|internal)\b", line.split("#")[0]):
                relative = path.relative_to(root).as_posix()
                yield f"{relative}:{number}: the renderer must not link libopms"


def violations(root):
    root = root.resolve()
    for path, source in sources(root):
        for number, _, name in includes(path):
            problem = check(root, source, name)
            if problem:
                yield f"{source}:{number}: {name}: {problem}"
    yield from check_links(root)


def main(arguments):
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parents[2]
    found = list(violations(root))
    print("\n".join(found) if found else "includes follow the table")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
