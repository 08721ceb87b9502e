#!/usr/bin/env bash
# gmsh writes prisms of second order to .inp as elements of the type C3D6 with 18 nodes each. In the format of Abaqus and CalculiX C3D6 has six
# nodes, C3D15 fifteen, and none has eighteen; hexahedra of 27 nodes get a name of their own (C3D27). A reader that trusts the
# name finds 12 numbers too many behind every prism.
#
# Seen with gmsh and libgmsh4.8 4.8.4+ds2-3 of Debian 12 (amd64), on 2026-11-28:
#   gmsh -3 -order 2 -format inp: *ELEMENT, type=C3D6, 18 nodes; with -setnumber Mesh.SecondOrderIncomplete 1: type=C3D15, 15 nodes
# Corners come first in both, so that a reader which accepts C3D6 of 18 nodes gets the volume right.
#
# Needs apt-get and the libraries of gmsh (apt-get install gmsh brings them). Fails if the behaviour changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
chmod 755 "$folder"
cd "$folder"
for package in gmsh libgmsh4.8; do
    apt-get download -q "$package=4.8.4+ds2-3" >/dev/null 2>&1 || { echo "$package 4.8.4+ds2-3 cannot be had"; exit 2; }
    dpkg-deb -x "$package"_*.deb root
done
export LD_LIBRARY_PATH="$folder/root/usr/lib/x86_64-linux-gnu"
cat >wedge.geo <<'GEO'
Point(1) = {0,0,0,1}; Point(2) = {1,0,0,1}; Point(3) = {0,1,0,1};
Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,1};
Curve Loop(1) = {1,2,3}; Plane Surface(1) = {1};
e[] = Extrude{0,0,1}{ Surface{1}; Layers{1}; Recombine; };
Physical Volume("body") = {e[1]};
GEO
solid() { # type and number of nodes of the first solid element
    root/usr/bin/gmsh -3 -order 2 "$@" -format inp -o wedge.inp wedge.geo -nopopup >/dev/null 2>&1
    awk -F, '/^\*/ {solid = /C3D/; if (solid) {sub(/.*type=/, ""); sub(/,.*/, ""); type = $0}; next}
        solid && !done {for (k = 1; k <= NF; k++) if ($k ~ /[0-9]/) count++; if ($NF ~ /[0-9]/) done = 1}
        END {print type, count - 1}' wedge.inp
}
whole=$(solid) incomplete=$(solid -setnumber Mesh.SecondOrderIncomplete 1)
echo "order 2: $whole nodes; incomplete order 2: $incomplete nodes"
[[ $whole == "C3D6 18" && $incomplete == "C3D15 15" ]] || { echo "expected C3D6 18 and C3D15 15"; exit 1; }
