#!/usr/bin/env bash
# HDF5's newer file format keeps the second in which groups were made, also when every data set is made with
# track_times=False: two files with the same data are then not the same bytes. In the default format
# (libver='earliest') they are, so a program that compares files byte by byte finds out only when it switches to
# libver='latest', and then only if the clock passes a full second between the two files.
#
# The switch of a data set is not inherited: the root group takes it from the property list of the file
# (H5P_FILE_CREATE), and groups that are made on the way to a data set take none at all
# (H5Pset_create_intermediate_group makes them by the default list). A C program gets the same bytes if it sets
# H5Pset_obj_track_times(list, 0) on the list of the file and makes each group itself with such a list; h5py 3.7 has
# no argument for either.
#
# Seen with python3-h5py and python3-h5py-serial 3.7.0-8, libhdf5-103-1 1.10.8+repack1-1 and python3-numpy 1:1.24.2-1+deb12u1 of
# Debian 12 (amd64), on 2026-11-28; bytes that differ between two files made a second apart:
#   earliest, data set in a group: 0          latest, data set in a group: 16
#   earliest, data set in the root: 0         latest, data set in the root: 8
# (In each header one byte of each of four times, and the four bytes of its checksum.)
#
# Needs apt-get (for the packages) and python3 3.11. Fails if the behaviour changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
chmod 755 "$folder"
cd "$folder"
for package in python3-h5py=3.7.0-8 python3-h5py-serial=3.7.0-8 libhdf5-103-1=1.10.8+repack1-1 libhdf5-hl-100=1.10.8+repack1-1 \
    python3-numpy=1:1.24.2-1+deb12u1 libaec0=1.0.6-1+b1 libsz2=1.0.6-1+b1 liblzf1=3.6-3 libblas3=3.11.0-2 liblapack3=3.11.0-2 \
    libgfortran5=12.2.0-14+deb12u1; do
    apt-get download -q "$package" >/dev/null 2>&1 || { echo "$package cannot be had"; exit 2; }
    dpkg-deb -x "${package%%=*}"_*.deb root
done
lib=$folder/root/usr/lib/x86_64-linux-gnu
export LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack PYTHONPATH=$folder/root/usr/lib/python3/dist-packages
/usr/bin/python3 - <<'PYTHON'
import sys
import time

import h5py


def image(name, libver):
    with h5py.File("file.h5", "w", libver=libver) as file:
        file.create_dataset(name, data=[1.0, 2.0, 3.0], track_times=False)
    with open("file.h5", "rb") as file:
        return file.read()


def differing(name, libver):
    first, second = image(name, libver), int(time.time())
    while int(time.time()) == second:
        time.sleep(0.02)
    return sum(a != b for a, b in zip(first, image(name, libver), strict=True))


print(f"h5py {h5py.__version__}, HDF5 {h5py.version.hdf5_version}")
wanted = {("group/values", "earliest"): 0, ("values", "earliest"): 0, ("group/values", "latest"): 16, ("values", "latest"): 8}
failed = False
for (name, libver), expected in wanted.items():
    found = differing(name, libver)
    print(f"{libver}, {name}: {found} bytes differ")
    # A checksum may share a byte by chance, and a second may carry into the next byte.
    failed |= found != 0 if expected == 0 else not expected / 2 <= found <= 2 * expected
sys.exit(failed)
PYTHON
