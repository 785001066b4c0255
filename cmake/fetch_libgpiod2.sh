#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bring the sources of libgpiod 2 (LGPL-2.1-or-later; for tests only) from Debian 13's source
# package into a folder.
#
#   fetch_libgpiod2.sh DIR     -> DIR/lib/chip.c, DIR/include/gpiod.h, DIR/version
set -eu

here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
dir=$(cd "$1" && pwd)
[ -f "$dir/version" ] && exit 0
work=$(mktemp -d "$dir/fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT

if ! "$here/debian_download.sh" --source "$work" libgpiod; then
    echo "fetch_libgpiod2: cannot get libgpiod's sources. Set LIBGPIOD2_DIR to a folder with" >&2
    echo "                 lib/chip.c and include/gpiod.h of a version 2, and a file version" >&2
    exit 1
fi
mkdir "$work/tree"
tar -xf "$work"/libgpiod_*.orig.tar.* -C "$work/tree" --strip-components=1
cp -R "$work/tree/lib" "$work/tree/include" "$work/tree/LICENSES" "$dir"
# The version is in the tarball's name: libgpiod_2.2.1.orig.tar.xz. It is written last.
name=$(basename "$work"/libgpiod_*.orig.tar.*)
name=${name#libgpiod_}
echo "${name%%.orig.tar.*}" > "$dir/version"
