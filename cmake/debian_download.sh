#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Download packages of Debian into a folder without installing anything.
#
#   debian_download.sh DIR PACKAGE...              -> DIR/PACKAGE_*.deb
#   debian_download.sh --source DIR PACKAGE...     -> DIR/PACKAGE_*.orig.tar.*
#
# Debian 13 and newer have them in their own archive. For older ones a private apt configuration
# is made from the machine's own sources with the suite replaced; the machine's own lists stay as
# they are. Meant for packages of sources: a newer suite's programs need its newer C library.
set -eu

suite=trixie
type=deb
if [ "${1:-}" = --source ]; then
    type=deb-src
    shift
fi
[ $# -ge 2 ] || { echo "usage: debian_download.sh [--source] DIR PACKAGE..." >&2; exit 2; }
mkdir -p "$1"
dir=$(cd "$1" && pwd)
shift
work=$(mktemp -d "$dir/apt.XXXXXX")
trap 'rm -rf "$work"' EXIT

. /etc/os-release
own="${VERSION_CODENAME:-stable}"

# The machine's own sources of its main suite, in both formats that apt knows.
copy_sources() {
    mkdir -p "$work/sources" "$work/lists/partial" "$work/cache/archives/partial"
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -f "$file" ] || continue
        awk -v own="$own" -v suite="$suite" -v type="$type" '
            function flush() { if (wanted) printf "%s\n", text; text = ""; wanted = 0 }
            /^[ \t]*$/ { flush(); next }
            /^#/ { next }
            tolower($1) == "types:" { text = text "Types: " type "\n"; next }
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
        awk -v own="$own" -v suite="$suite" -v type="$type" '
            $1 == "deb" {
                at = 2
                if ($2 ~ /^\[/) { while ($at !~ /\]$/) at++; at++ }
                s = $(at + 1)
                if (s != own && s != "stable" && s != "oldstable") next
                line = ""
                for (i = 1; i <= at; i++) line = line $i " "
                sub(/^deb/, type, line)
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

command -v apt-get > /dev/null || { echo "debian_download: there is no apt here" >&2; exit 1; }
cd "$work"
# The machine's own lists seldom name sources, so these are always looked up in the suite.
if [ "$type" = deb-src ]; then
    copy_sources
    private_apt update
    private_apt source --download-only --tar-only "$@"
    mv ./*.orig.tar.* "$dir"
    exit 0
fi
if ! apt-get -qq -o APT::Sandbox::User="$(id -un)" download "$@" 2> own.log; then
    echo "debian_download: not all in this machine's suite ($own), looking in $suite: $*" >&2
    copy_sources
    if ! { private_apt update && private_apt download "$@"; }; then
        cat own.log >&2
        exit 1
    fi
fi
mv ./*.deb "$dir"
