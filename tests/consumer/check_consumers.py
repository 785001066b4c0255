# SPDX-License-Identifier: Apache-2.0
"""Build and run other people's programs against an installed libopms, outside of the tree.

    check_consumers.py --prefix PREFIX --source ROOT CHECK

with CHECK cmake-c11, cmake-cpp17, cmake-hid, pkgconfig or subdirectory.
"""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def call(*command, **options):
    print("+", " ".join(map(str, command)), flush=True)
    return subprocess.run([str(word) for word in command], check=True, **options)


def clean_environment(**more):
    """The environment of somebody who has never heard of our build folders."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("CMAKE_", "LD_", "PKG_"))}
    return {**kept, **more}


def build_with_cmake(project, build, **variables):
    settings = [f"-D{name}={value}" for name, value in variables.items()]
    call("cmake", "-S", project, "-B", build, "-G", "Ninja", *settings, env=clean_environment())
    call("cmake", "--build", build, env=clean_environment())
    for program in ("consumer_opms", "consumer_opms_static"):
        call(build / program, env=clean_environment())


def check_cmake(folder, options, work):
    project = work / "project"
    shutil.copytree(HERE / folder, project)
    build_with_cmake(project, work / "build", CMAKE_PREFIX_PATH=options.prefix,
                     CMAKE_FIND_PACKAGE_NO_PACKAGE_REGISTRY="ON")


def check_subdirectory(options, work):
    project = work / "project"
    shutil.copytree(HERE / "subdirectory", project)
    build_with_cmake(project, work / "build", OPMS_SOURCE_DIR=options.source,
                     CONSUMER_SOURCE=HERE / "c11/consumer_c11.c")


def check_pkgconfig(options, work):
    pc_file = next(options.prefix.rglob("opms.pc"))
    env = clean_environment(PKG_CONFIG_PATH=str(pc_file.parent))
    library_dir = pc_file.parent.parent
    source = work / "consumer.c"
    shutil.copyfile(HERE / "c11/consumer_c11.c", source)

    def flags(*what):
        return call("pkg-config", *what, "opms", env=env, text=True,
                    stdout=subprocess.PIPE).stdout.split()

    call("cc", "-std=c11", source, *flags("--cflags", "--libs"), "-o", work / "shared", env=env)
    call(work / "shared", env={**env, "LD_LIBRARY_PATH": str(library_dir)})
    libs = [f if f != "-lopms" else "-l:libopms.a" for f in flags("--static", "--libs")]
    call("cc", "-std=c11", "-DOPMS_STATIC", source, *flags("--cflags"), *libs,
         "-o", work / "static", env=env)
    call(work / "static", env=env)


CHECKS = {
    "cmake-c11": lambda options, work: check_cmake("c11", options, work),
    "cmake-cpp17": lambda options, work: check_cmake("cpp17", options, work),
    "cmake-hid": lambda options, work: check_cmake("hid", options, work),
    "pkgconfig": check_pkgconfig,
    "subdirectory": check_subdirectory,
}


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--prefix", required=True, type=Path)
    parser.add_argument("--source", required=True, type=Path)
    parser.add_argument("check", choices=CHECKS)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="opms-consumer-") as work:
        try:
            CHECKS[options.check](options, Path(work))
        except subprocess.CalledProcessError as error:
            print(f"failed with {error.returncode}: {error.cmd[0]}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
