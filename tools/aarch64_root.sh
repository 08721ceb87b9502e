#!/usr/bin/env bash
# Unpacks Debian's arm64 packages, with all that they need, below FOLDER/root, and writes FOLDER/cross.ini, with which
# meson builds for them and runs what it built under qemu-user. The machine's own packages and its list of
# architectures stay as they are: apt gets a state of its own below FOLDER.
set -euo pipefail

(($# >= 2)) || { echo "usage: $0 FOLDER PACKAGE..." >&2; exit 2; }
folder=$1
shift
packages=("$@")

[[ -f $folder/packages && $(<"$folder/packages") == "${packages[*]}" ]] && exit 0
rm -rf "$folder"
mkdir -p "$folder"/apt/{lists/partial,cache/archives/partial} "$folder/root"
folder=$(cd "$folder" && pwd)
: >"$folder/apt/status"

apt_arm64() {
    apt-get -q -y -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User= \
        -o Dir::State="$folder/apt" -o Dir::State::status="$folder/apt/status" -o Dir::Cache="$folder/apt/cache" \
        -o Debug::NoLocking=true "$@" >&2
}
apt_arm64 update
apt_arm64 --no-install-recommends --download-only install "${packages[@]}"
for package in "$folder"/apt/cache/archives/*.deb; do
    dpkg-deb -x "$package" "$folder/root"
done
rm -rf "$folder/apt"

libraries=$folder/root/usr/lib/aarch64-linux-gnu
cat >"$folder/cross.ini" <<INI
[binaries]
c = ['aarch64-linux-gnu-gcc', '--sysroot=$folder/root']
ar = 'aarch64-linux-gnu-gcc-ar'
strip = 'aarch64-linux-gnu-strip'
pkgconfig = 'pkg-config'
exe_wrapper = ['qemu-aarch64', '-L', '$folder/root']

[properties]
sys_root = '$folder/root'
pkg_config_libdir = ['$libraries/pkgconfig', '$folder/root/usr/share/pkgconfig']

[host_machine]
system = 'linux'
cpu_family = 'aarch64'
cpu = 'aarch64'
endian = 'little'
INI
printf '%s' "${packages[*]}" >"$folder/packages"
