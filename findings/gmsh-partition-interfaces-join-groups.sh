#!/usr/bin/env bash
# gmsh -part puts the faces between partitions into physical surfaces that have the number of the physical volume: an interface gets the number
# of the group of its parent, a volume, but this number names another group among surfaces. Groups of different dimensions often have
# the same numbers. A physical surface 1 "left" of a body whose physical volume is 1 "rock" then holds its left side and faces inside the body: a
# program that puts a pressure on "left" loads the inside as well. The interfaces bear the name of the group, and no message is printed.
#
# Seen with gmsh and libgmsh4.8 4.8.4+ds2-3 of Debian 12 (amd64), on 2026-11-28: "left" of a brick has 42 triangles, with -part 2 it has 78 if its
# number is that of the volume, and 42 if it is another one. With -setnumber Mesh.PartitionCreateTopology 0 it has 42 in both cases.
# A reader of format 4.1 finds the interfaces in $PartitionedEntities: the dimension of the parent is larger than their own.
#
# Needs apt-get, python3 and the libraries of gmsh (apt-get install gmsh brings them). Fails if the behaviour changes.
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
cat >brick.in <<'GEO'
Point(1) = {0,0,0,0.25}; Point(2) = {0,1,0,0.25}; Point(3) = {0,1,1,0.25}; Point(4) = {0,0,1,0.25};
Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,1};
Curve Loop(1) = {1,2,3,4}; Plane Surface(1) = {1};
e[] = Extrude{2,0,0}{ Surface{1}; };
Physical Volume("rock", 1) = {e[1]};
Physical Surface("left", NUMBER) = {1};
GEO
left() { # number of the group; triangles of it in a mesh that gmsh writes with the options that follow
    sed "s/NUMBER/$1/" brick.in >brick.geo
    export NUMBER=$1
    shift
    root/usr/bin/gmsh -3 -format msh41 "$@" -o brick.msh brick.geo -nopopup >log.txt 2>&1
    python3 - <<'PYTHON'
import os
import re
text = open("brick.msh").read()
inside = set()  # surfaces of the group
for name in ("Entities", "PartitionedEntities"):
    found = re.search(r"\$%s\n(.*?)\$End%s" % (name, name), text, re.S)
    if not found:
        continue
    lines = found[1].split("\n")[2 * (name[0] == "P"):]
    numbers, at = [int(one) for one in lines[0].split()], 1
    for dimension in range(4):
        for _ in range(numbers[dimension]):
            row = lines[at].split()
            at += 1
            place = (4 + int(row[3]) if name[0] == "P" else 1) + (6 if dimension else 3)
            if dimension == 2 and os.environ["NUMBER"] in row[place + 1:place + 1 + int(row[place])]:
                inside.add(row[0])
rows = re.search(r"\$Elements\n(.*?)\$EndElements", text, re.S)[1].split("\n")
at, count = 1, 0
for _ in range(int(rows[0].split()[0])):
    dimension, tag, _, many = rows[at].split()
    count += int(many) if dimension == "2" and tag in inside else 0
    at += 1 + int(many)
print(count)
PYTHON
}
whole=$(left 1) parts=$(left 1 -part 2)
grep -q -i 'warning' log.txt && { echo "gmsh warns now:"; grep -i warning log.txt; exit 1; }
other=$(left 7 -part 2) plain=$(left 1 -part 2 -setnumber Mesh.PartitionCreateTopology 0)
echo "triangles of \"left\": $whole in one part; in two parts $parts with the number of the volume, $other with another, $plain without topology"
[[ $whole -gt 0 && $parts -gt $whole && $other -eq $whole && $plain -eq $whole ]] || { echo "expected more of them in the second case alone"; exit 1; }
