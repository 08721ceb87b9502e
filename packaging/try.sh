#!/bin/sh
# In a bare Debian with the packages in /tmp: installs them, uses each, and prints the seconds from the packages to a report.
set -eu
export DEBIAN_FRONTEND=noninteractive HOME=/tmp
start=$(date +%s)
say() { echo "try: $(($(date +%s) - start)) s: $1"; }
cd /tmp
apt-get install -q -y --no-install-recommends ./gneiss_*.deb >apt.log 2>&1 || { tail -n 20 apt.log; exit 1; }
say "installed"
gneiss run /usr/share/gneiss/scenes/ucs-rock.yaml --quiet
say "run"
gneiss report runs/ucs-rock
say "report"
test "$(ls /usr/share/man/man1/gneiss*.1.gz | wc -l)" -gt 10
gneiss schema >/dev/null
apt-get install -q -y --no-install-recommends ./libgneiss0_*.deb ./libgneiss-dev_*.deb gcc libc6-dev pkg-config >>apt.log 2>&1 || { tail -n 20 apt.log; exit 1; }
cat >example.c <<'C'
#include <gneiss/gneiss.h>
#include <stdio.h>
int main(void) { puts(gneiss_version()); return 0; }
C
gcc example.c -o example $(pkg-config --cflags --libs gneiss) && ./example
say "library"
if [ -f ./python3-gneiss_*.deb ]; then
    apt-get install -q -y --no-install-recommends ./python3-gneiss_*.deb >>apt.log 2>&1 || { tail -n 20 apt.log; exit 1; }
    python3 -c "import gneiss; print(gneiss.__name__)"
    say "Python module"
fi
