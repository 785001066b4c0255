#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bring the Raspberry Pi Pico SDK and TinyUSB from Debian's packages into a folder.
#
#   fetch_pico_sdk.sh DIR     -> DIR/pico-sdk, DIR/tinyusb
#
# Who has them already sets PICO_SDK_PATH and PICO_TINYUSB_PATH; what is set is not fetched.
# Nothing is installed.
set -eu

cmake_dir=$(cd "$(dirname "$0")" && pwd)
[ $# -eq 1 ] || { echo "usage: fetch_pico_sdk.sh DIR" >&2; exit 2; }
mkdir -p "$1"
dir=$(cd "$1" && pwd)

# fetch PACKAGE NAME FILE: unpack PACKAGE's /usr/src (or /usr/share) tree that holds FILE as
# DIR/NAME. The folder appears under its name only when it is whole.
fetch() {
    [ -f "$dir/$2/$3" ] && return
    work=$(mktemp -d "$dir/fetch.XXXXXX")
    trap 'rm -rf "$work"' EXIT
    "$cmake_dir/debian_download.sh" "$work" "$1"
    dpkg-deb -x "$work/$1"_*.deb "$work/package"
    found=$(find "$work/package" -path "*/$3" | head -n 1)
    [ -n "$found" ] || { echo "fetch_pico_sdk: package $1 has no $3" >&2; return 1; }
    mv "${found%/"$3"}" "$dir/$2"
    cp "$work/package/usr/share/doc/$1/copyright" "$dir/$2/copyright.debian"
    rm -rf "$work"
    trap - EXIT
}

fail() {
    echo "fetch_pico_sdk: cannot get $1. Set $2 to a folder with $3." >&2
    exit 1
}

if [ -z "${PICO_SDK_PATH:-}" ]; then
    fetch pico-sdk-source pico-sdk pico_sdk_init.cmake ||
        fail "the Pico SDK" PICO_SDK_PATH pico_sdk_init.cmake
elif [ ! -f "$PICO_SDK_PATH/pico_sdk_init.cmake" ]; then
    fail "the Pico SDK from PICO_SDK_PATH=$PICO_SDK_PATH" PICO_SDK_PATH pico_sdk_init.cmake
fi
if [ -z "${PICO_TINYUSB_PATH:-}" ]; then
    fetch tinyusb-source tinyusb src/tusb.h || fail TinyUSB PICO_TINYUSB_PATH src/tusb.h
elif [ ! -f "$PICO_TINYUSB_PATH/src/tusb.h" ]; then
    fail "TinyUSB from PICO_TINYUSB_PATH=$PICO_TINYUSB_PATH" PICO_TINYUSB_PATH src/tusb.h
fi
