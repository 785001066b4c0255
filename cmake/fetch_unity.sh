#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Bring the sources of Unity (the C test framework) from Debian's package `cmock` into a folder.
#
#   fetch_unity.sh DIR     -> DIR/src/unity.c
#
# Debian 13 and newer have the package in their own archive. For older ones a private apt
# configuration is made from the machine's own sources with the suite replaced; nothing is
# installed and the machine's own lists stay as they are. Only Unity is taken out of the package.
set -eu

suite=trixie
mkdir -p "$1"
dir=$(cd "$1" && pwd)
[ -f "$dir/src/unity.c" ] && exit 0
work=$(mktemp -d "$dir/fetch.XXXXXX")
trap 'rm -rf "$work"' EXIT

. /etc/os-release
own="${VERSION_CODENAME:-stable}"

# The machine's own sources of its main suite, in both formats that apt knows.
copy_sources() {
    mkdir -p "$work/sources" "$work/lists/partial" "$work/cache/archives/partial"
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -f "$file" ] || continue
        awk -v own="$own" -v suite="$suite" '
            function flush() { if (wanted) printf "%s\n", text; text = ""; wanted = 0 }
            /^[ \t]*$/ { flush(); next }
            /^#/ { next }
            tolower($1) == "types:" { text = text "Types: deb\n"; next }
            tolower($1) == "components:" { text = text "Components: main\n"; next }
            tolower($1) == "suites:" {
                for (i = 2; i <= NF; i++)
                    if ($i == own || $i == "stable" || $i == "oldstable") wanted = 1
                text = text "Suites: " suite "\n"; next
            }
            { text = text $0 "\n" }
            END { flush() }' "$file" > "$work/sources/$(basename "$file")"
    done
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ -f "$file" ] || continue
        awk -v own="$own" -v suite="$suite" '
            $1 == "deb" {
                at = 2
                if ($2 ~ /^\[/) { while ($at !~ /\]$/) at++; at++ }
                s = $(at + 1)
                if (s != own && s != "stable" && s != "oldstable") next
                line = ""
                for (i = 1; i <= at; i++) line = line $i " "
                print line suite " main"
            }' "$file" > "$work/sources/$(basename "$file")"
    done
}

private_apt() {
    apt-get -qq \
        -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/sources" \
        -o Dir::State::Lists="$work/lists" -o Dir::Cache="$work/cache" \
        -o Dir::Etc::Preferences=/dev/null -o Dir::Etc::PreferencesParts=/dev/null \
        -o Acquire::Languages=none -o APT::Sandbox::User="$(id -un)" "$@"
}

cd "$work"
if ! apt-get -qq -o APT::Sandbox::User="$(id -un)" download cmock 2> own.log; then
    echo "fetch_unity: package cmock is not in this machine's suite ($own); looking in $suite" >&2
    copy_sources
    if ! { private_apt update && private_apt download cmock; }; then
        cat own.log >&2
        echo "fetch_unity: cannot get Unity. Set UNITY_DIR to a folder with src/unity.c" >&2
        echo "             (the package cmock of Debian 13, or Unity's own sources)." >&2
        exit 1
    fi
fi
dpkg-deb -x cmock_*.deb package
mkdir -p "$dir/src"
cp package/usr/share/cmock/vendor/unity/src/*.[ch] "$dir/src"
cp package/usr/share/doc/cmock/copyright "$dir/copyright" 2> /dev/null || true
