#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A folder with a Debian 13 and its KiCad (9.0), for machines whose own KiCad has no kicad-cli.
#
#   sudo hw/schematics/tools/make_kicad_root.sh DIR      1 GB; needs debootstrap
#   sudo OPMS_KICAD_ROOT=DIR python3 hw/schematics/tools/make_outputs.py
set -euo pipefail

root=${1:?usage: make_kicad_root.sh DIR}

# The machine's own mirror, whatever it is.
mirror=$({ cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2> /dev/null || true; } |
    sed -nE 's/^(URIs:|deb( \[[^]]*\])?) *(https?:[^ ]*debian\/?)( .*)?$/\3/p' | sed -n 1p)
debootstrap --variant=minbase trixie "$root" ${mirror:+"$mirror"}
# How apt reaches the mirror from here (proxies and the like).
cp -n /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d/"
cp /etc/resolv.conf /etc/hosts "$root/etc/"
chroot "$root" apt-get -qq update
chroot "$root" env DEBIAN_FRONTEND=noninteractive \
    apt-get -qq install -y --no-install-recommends kicad
