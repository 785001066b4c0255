#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bring the sources of Unity (the C test framework) from Debian's package `cmock` into a folder.
#
#   fetch_unity.sh DIR     -> DIR/src/unity.c
#
# Nothing is installed, and only Unity is taken out of the package.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
dir=$(cd "$1" && pwd)
[ -f "$dir/src/unity.c" ] && exit 0
work=$(mktemp -d "$dir/fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT

if ! "$here/debian_download.sh" "$work" cmock; then
    echo "fetch_unity: cannot get Unity. Set UNITY_DIR to a folder with src/unity.c" >&2
    echo "             (the package cmock of Debian 13, or Unity's own sources)." >&2
    exit 1
fi
cd "$work"
dpkg-deb -x cmock_*.deb package
mkdir -p "$dir/src"
cp package/usr/share/cmock/vendor/unity/src/*.[ch] "$dir/src"
cp package/usr/share/doc/cmock/copyright "$dir/copyright" 2> /dev/null || true
