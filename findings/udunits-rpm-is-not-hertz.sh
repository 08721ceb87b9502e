#!/usr/bin/env bash
# UDUNITS-2 takes revolutions for radians when it converts to 1/s: 60 rpm and 1 Hz, both once a second, become numbers
# that differ by 2 pi. The radian has no dimension there ("rpm" is 2 pi/60 rad/s, "cps" is 2 pi rad/s, hertz is 1/s), and so a
# program that asks UDUNITS whether a unit fits a rate of events accepts rpm and cps and counts 6.28 times too many.
#
# Seen with udunits-bin, libudunits2-0 and libudunits2-data 2.2.28-5 of Debian 12 (amd64), on 2026-11-27:
#   1 hertz -> 1 1/s, 60 rpm -> 6.28319 1/s, 1 cps -> 6.28319 1/s, 1 becquerel -> 1 1/s
# A program that means events has to look for the radian in the unit by itself (ut_accept_visitor).
#
# Needs apt-get (for the three packages) and libexpat1. Fails if the behaviour changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
chmod 755 "$folder"
cd "$folder"
for package in udunits-bin libudunits2-0 libudunits2-data; do
    apt-get download -q "$package=2.2.28-5" >/dev/null 2>&1 || { echo "$package 2.2.28-5 cannot be had"; exit 2; }
    dpkg-deb -x "$package"_*.deb root
done
export LD_LIBRARY_PATH="$folder/root/usr/lib/x86_64-linux-gnu" UDUNITS2_XML_PATH="$folder/root/usr/share/xml/udunits/udunits2.xml"

number() { # of `1 UNIT` in 1/s
    root/usr/bin/udunits2 -H "$1" -W '1/s' </dev/null | sed -n 's/.*= *\([0-9.e+-]*\) *(\?1\/s.*/\1/p; s/.*= *\([0-9.e+-]*\) s-1.*/\1/p' | head -n 1
}
failed=0
while read -r amount unit wanted; do
    got=$(number "$amount $unit")
    echo "$amount $unit = ${got:-nothing} 1/s"
    [[ $got == "$wanted" ]] || { echo "expected $wanted"; failed=1; }
done <<'UNITS'
1 hertz 1
60 rpm 6.28319
1 cps 6.28319
1 becquerel 1
UNITS
exit "$failed"
