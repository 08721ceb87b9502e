#!/usr/bin/env bash
# Everything that is done with gneiss from a shell. `./do help` lists it.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
python=/usr/bin/python3 # Debian's: another python that comes first in PATH has no h5py
meson=/usr/bin/meson
ninja=/usr/bin/ninja

# The one list of Debian 12 packages. Every command needs `build`; `test`, `check` and `bench` add theirs.
packages_build=(
    meson ninja-build gcc g++ libc6-dev pkg-config
    libfyaml-dev libudunits2-dev libhdf5-dev libqhull-dev libmuparser-dev libcmocka-dev
    python3 python3-numpy python3-h5py python3-matplotlib
)
packages_calibrate=(python3-scipy python3-yaml) # of `gneiss calibrate` alone
packages_python=(python3-cffi python3-numpy) # of the Python module; it uses what there is of the next list
packages_python_more=(python3-pandas python3-xarray python3-tqdm mypy python3-pip python3-setuptools python3-wheel)
# A locale with a decimal comma is made from the first.
packages_test=(locales python3-jsonschema "${packages_calibrate[@]}" "${packages_python[@]}" "${packages_python_more[@]}")
packages_mpi=(libopenmpi-dev openmpi-bin) # gneiss-mpi and its tests
packages_check=(git clang libclang-rt-14-dev libomp-dev clang-format clang-tidy cppcheck)
packages_aarch64=(gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user) # and the libraries of `build`, unpacked in a folder
packages_package=(debhelper dh-python lintian mmdebstrap) # only for `package`; the last one for its --try
packages_docs=(python3-sphinx python3-myst-parser furo doxygen python3-breathe python3-numpy python3-cffi) # only for `docs`
packages_bench=(libbenchmark-dev)
packages_effects=(valgrind) # only for bench --effects
packages_validate=(yade python3-scipy) # the second for some of validate/*_study.py
packages_peers=(yade lammps liggghts esys-particle calculix-ccx) # large; only for bench --peers

usage() {
    cat <<'TEXT'
usage: ./do COMMAND [...]

  run SCENE [gneiss options]   build, run the scene, make its report
  mpi                          build build-mpi/gneiss, for several processes of MPI (docs/cluster.md)
  test [meson options]         build and run every test; --checked: on the build of `check gcc`
  check [steps]                format layers links words release gcc clang cppcheck tidy sanitizers python (all of them); on request
                               also tsan: data races, by ThreadSanitizer with LLVM's OpenMP
                               and docs: the site without a warning
                               and aarch64: kernels and bits on another processor, under qemu-user
  bench [--peers] [--large] [--sweep]
                               build and run the benchmarks; --peers: beside LAMMPS, LIGGGHTS, YADE,
                               ESyS-Particle and CalculiX; --large: big specimens; --sweep: 1 372 to 1 000 188 grains
  bench --effects              what every effect costs, and that it costs nothing where it is off: builds the
                               program without it; writes docs/evidence/effects.md
  validate [--quick] [--time] [--only SECTION] [--fresh] [--large]
                               beside YADE, closed forms and published tables; writes docs/evidence/validation.md
  accuracy [--quick] [--only CASE] [--out DIR]
                               what accuracy costs in time; writes docs/evidence/accuracy.md
  package [--try]              Debian packages of the last commit in build-package, and what lintian says of them; --try: installs
                               them in a bare Debian 12 and runs a scene and its report there
  docs                         the site: build-docs/html/index.html, from docs/, the help of the program and both APIs
  install WHAT                 the packages of build, mpi, calibrate, python, test, check, aarch64, package, docs, bench, validate, effects or peers
  keys [text]                  the keys that a scene file may hold, or those that hold a text
  clean                        remove the build folders
  help                         this text

Missing Debian packages are installed first (apt-get; with sudo when not root).
TEXT
}

say() { printf '%s\n' "$*" >&2; }
die() { say "./do: $*"; exit 1; }
heading() { printf '\n== %s\n' "$*"; }

# --- packages -----------------------------------------------------------------------------------------

missing_packages() {
    local name
    for name in "$@"; do
        [[ $(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null) == installed ]] || echo "$name"
    done
}

need() {
    local missing as_root=()
    command -v dpkg-query >/dev/null || die "needs Debian 12 or a relative of it (no dpkg-query found); install by hand: $*"
    mapfile -t missing < <(missing_packages "$@")
    ((${#missing[@]})) || return 0
    if ((EUID != 0)); then
        command -v sudo >/dev/null ||
            die "missing packages, and neither root nor sudo to install them. As root: apt-get install ${missing[*]}"
        as_root=(sudo)
    fi
    say "installing: ${missing[*]}"
    # Lists of the last hour are not fetched again.
    [[ -n $(find /var/lib/apt/lists -maxdepth 1 -name '*Packages*' -mmin -60 2>/dev/null) ]] ||
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q >&2 ||
        say "./do: apt-get update failed; trying with the package lists that are there"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends "${missing[@]}" >&2 ||
        die "apt-get could not install: ${missing[*]} (Debian 12 with its main archive is expected)"
}

# --- building -----------------------------------------------------------------------------------------

# configure FOLDER [meson options]: quiet when it is done already with the same options.
configure() {
    local folder=$root/$1 stamp=$root/$1/.do-options wanted="${CC:-} ${*:2}"
    if [[ -f $folder/build.ninja && -f $stamp && $(<"$stamp") == "$wanted" ]]; then return 0; fi
    local mode=()
    [[ -f $folder/meson-private/coredata.dat ]] && mode=(--wipe)
    "$meson" setup "${mode[@]}" "$folder" "$root" "${@:2}" >&2
    printf '%s' "$wanted" >"$stamp"
}

# What a step of a build takes, in tenths of a second of one core.
step_work() {
    case $1 in
    *contact_template*) work=35 ;;
    *motion_template*) work=9 ;;
    *Compiling*) work=2 ;;
    *) work=1 ;;
    esac
}

# Words for the step of a line `[7/312] Compiling C object src/kernels/libgneiss_kernels_avx2_contact0.a.p/contact_template.c.o`.
step_text() {
    text=${1#*] }
    case $text in
    *kernels_*_template*)
        local set=${text##*kernels_}
        text="kernels of ${text##*/} for ${set%%[./]*}"
        text=${text/_template.c.o/}
        ;;
    'Compiling C object '*) text="compiling ${text##*/}" ;;
    esac
}

span() { # seconds as words
    if (($1 < 90)); then printf '%d s' "$1"; else printf '%d min' $((($1 + 30) / 60)); fi
}

# Lines `[7/312] Compiling ...` of a build of so much work: its share that is done and the last step, on a terminal in one
# line, else every ten seconds, also while no step ends. All other lines whole.
thin_out() {
    local line work text share shown=$SECONDS start=$SECONDS done=0 last='' status
    while true; do
        status=0
        IFS= read -r -t 10 line || status=$?
        ((status == 0 || status > 128)) || break
        if ((status == 0)); then
            case $line in
            '['*/*'] '*)
                step_work "$line"
                step_text "$line"
                done=$((done + work)) last=$text
                ;;
            'ninja: Entering directory'* | 'ninja: no work to do'*) continue ;;
            *)
                if [[ -t 2 ]]; then printf '\r\033[K' >&2; fi
                say "$line"
                continue
                ;;
            esac
        fi
        share=$(($1 > 0 ? 100 * done / $1 : 100))
        if [[ -t 2 ]]; then
            printf '\r\033[K%3d %% of the work, %s: %s' $((share > 100 ? 100 : share)) "$(span $((SECONDS - start)))" "$last" >&2
        elif ((SECONDS - shown >= 10)); then
            shown=$SECONDS
            say "$((share > 100 ? 100 : share)) % of the work, $(span $((SECONDS - start))): ${last:-the first steps}"
        fi
    done
    if [[ -t 2 && -n $last ]]; then printf '\n' >&2; fi
}

# build FOLDER [targets]: says what it does, and how long it may take, when there is something to do.
build() {
    local folder=$root/$1 line work steps=0 all=0 start=$SECONDS what=${*:2} expected cores
    (($# <= 9)) || what="$(($# - 1)) targets"
    while IFS= read -r line; do
        [[ $line == '['* ]] || continue
        step_work "$line"
        all=$((all + work)) steps=$((steps + 1))
    done < <("$ninja" -C "$folder" -n "${@:2}" 2>/dev/null)
    if ((steps == 0)); then
        "$ninja" --quiet -C "$folder" "${@:2}" 2>&1 | thin_out 0
        return
    fi
    cores=$(nproc)
    expected=$((all / 10 / cores))
    if ((expected >= 20)); then
        say "building ${what:-everything} in $1: $steps steps, about $(span "$expected") on $cores idle cores" \
            "(less where ccache has some of it)"
    else
        say "building ${what:-everything} in $1: $steps steps"
    fi
    "$ninja" -C "$folder" "${@:2}" 2>&1 | thin_out "$all" || return 1
    say "built in $((SECONDS - start)) s"
}

# gneiss-mpi is built wherever MPI is installed.
with_mpi() { if command -v mpicc >/dev/null; then echo -Dmpi=enabled; else echo -Dmpi=disabled; fi; }

prepare() {
    need "${packages_build[@]}"
    configure build --buildtype=release "$(with_mpi)"
}

# --- commands -----------------------------------------------------------------------------------------

# Where `gneiss run` writes: --out, --set output.directory=, the scene's own, runs/<scene name>.
output_folder() {
    local scene=$1 folder='' argument
    shift
    while (($#)); do
        argument=$1
        case $argument in
        --out | -o) folder=${2:-} ;;
        --out=*) folder=${argument#--out=} ;;
        output.directory=* | --set=output.directory=*) [[ -n $folder ]] || folder=${argument#*output.directory=} ;;
        esac
        shift
    done
    if [[ -z $folder && -f $scene ]]; then
        folder=$(awk '/^[^ #]/ { inside = /^output:/ }
            inside && /^ +directory:/ { sub(/^ +directory: */, ""); sub(/ +#.*$/, ""); gsub(/["'\'']/, ""); print; exit }' "$scene")
    fi
    if [[ -z $folder ]]; then
        folder=${scene##*/}
        folder=runs/${folder%.*}
    fi
    printf '%s' "$folder"
}

command_run() {
    (($#)) || die "run: which scene? For example: ./do run scenes/ucs-rock.yaml"
    prepare
    build build gneiss
    local status=0 folder
    folder=$(output_folder "$@")
    "$root/build/gneiss" run --force "$@" || status=$?
    # An unstable or interrupted run (5, 6) has results worth a look too.
    if ((status == 0 || status == 5 || status == 6)) && [[ -f $folder/results.h5 ]]; then
        "$root/build/gneiss" report "$folder" || status=$((status ? status : $?))
    fi
    return "$status"
}

# run_tests FOLDER [meson options]: the last line is `N passed, N failed, N skipped`. Builds `targets`, everything without any.
run_tests() {
    local folder=$root/$1
    need "${packages_test[@]}"
    rm -f "$folder/meson-logs/testlog.json"
    if ! build "$1" "${targets[@]}"; then
        say "./do: the build in $1 failed: no test ran"
        "$python" "$root/tools/count_tests.py" "$folder/meson-logs/testlog.json"
        return 1
    fi
    # One more than there are cores: some tests wait for a program or a terminal.
    "$meson" test -C "$folder" --no-rebuild --print-errorlogs --num-processes $(($(nproc) + 1)) "${@:2}" || true
    "$python" "$root/tools/count_tests.py" "$folder/meson-logs/testlog.json"
}

command_test() {
    local targets=()
    if [[ ${1:-} == --checked ]]; then # what `check gcc` has built is not built a second time
        need "${packages_build[@]}"
        configure_gcc && run_tests build-check-gcc "${@:2}"
        return
    fi
    need "${packages_mpi[@]}"
    prepare
    run_tests build "$@"
}

# build-mpi/gneiss is the program for ranks; all of its objects but one are those of build/gneiss.
command_mpi() {
    need "${packages_mpi[@]}"
    prepare
    build build gneiss-mpi
    mkdir -p "$root/build-mpi"
    ln -sf ../build/gneiss-mpi "$root/build-mpi/gneiss"
}

command_bench() {
    if [[ ${1:-} == --effects ]]; then
        need "${packages_build[@]}" "${packages_effects[@]}"
        /usr/bin/python3 "$root/bench/effects.py" "${@:2}"
        return
    fi
    need "${packages_build[@]}" "${packages_bench[@]}"
    if [[ " $* " == *" --peers "* ]]; then
        local peer
        for peer in "${packages_peers[@]}"; do (need "$peer") || say "./do: going on without $peer"; done
    fi
    configure build-bench --buildtype=release -Dbench=enabled
    build build-bench bench/bench_step gneiss
    [[ -f $root/bench/meson.build ]] || die "bench: there is no bench/meson.build"
    if [[ -x $root/bench/run ]]; then
        "$root/bench/run" "$root/build-bench" "$@"
    else
        "$meson" test -C "$root/build-bench" --benchmark --no-rebuild --verbose --test-args "$*"
    fi
}

command_validate() {
    need "${packages_build[@]}" "${packages_validate[@]}"
    prepare
    build build
    "$python" "$root/validate/run.py" "$@"
}

command_accuracy() {
    prepare
    build build gneiss
    "$python" "$root/validate/accuracy/run.py" "$@"
}

command_install() {
    local name all=()
    for name in "$@"; do
        local -n packages="packages_$name" 2>/dev/null || die "install: no such list of packages: $name"
        [[ -v packages[@] ]] || die "install: no such list of packages: $name"
        all+=("${packages[@]}")
    done
    need "${all[@]}"
}

release_version() {
    sed -n "s/^  version: '\(.*\)',$/\1/p" "$root/meson.build"
}

command_package() {
    local out=$root/build-package version commit
    need "${packages_build[@]}" "${packages_package[@]}"
    check_release || die "package: the versions differ"
    version=$(release_version)
    rm -rf "$out/gneiss-$version"
    mkdir -p "$out/gneiss-$version"
    git -C "$root" archive HEAD | tar -x -C "$out/gneiss-$version"
    commit=$(git -C "$root" describe --always --abbrev=8 --exclude='*')
    sed -i "s/@commit@/$commit/" "$out/gneiss-$version/src/cli/commit.c.in"
    mv "$out/gneiss-$version/packaging/debian" "$out/gneiss-$version/debian"
    (cd "$out/gneiss-$version" && dpkg-buildpackage --build=binary --no-sign) || die "package: the build failed"
    lintian --fail-on error,warning "$out"/gneiss_"$version"_*.changes || die "package: lintian found errors or warnings"
    [[ ${1:-} != --try ]] || try_packages "$out"
}

# Installs the packages in a bare Debian 12 and says how many seconds it takes from there to a report.
try_packages() { # FOLDER
    local packages=("$1"/gneiss_*.deb "$1"/libgneiss*.deb) package copies=()
    for package in "${packages[@]}" "$1"/python3-gneiss_*.deb; do
        [[ ! -f $package || $package == *dbgsym* ]] || copies+=(--customize-hook="copy-in $package /tmp")
    done
    mmdebstrap --variant=apt "${copies[@]}" --customize-hook="copy-in $root/packaging/try.sh /tmp" \
        --customize-hook='chroot "$1" sh /tmp/try.sh' bookworm /dev/null
}

command_docs() {
    local start
    need "${packages_docs[@]}"
    prepare
    build build gneiss module
    start=$SECONDS
    "$python" "$root/packaging/site/build.py" "$root/build/gneiss" "$root/build/libgneiss.so" "$root/build-docs" ||
        die "docs: the site could not be built, or has warnings"
    say "build-docs/html/index.html written in $((SECONDS - start)) s"
}

command_keys() {
    prepare
    build build gneiss
    "$root/build/gneiss" keys "$@"
}

command_clean() {
    rm -rf "$root"/build "$root"/build-effects-* "$root"/build-bench "$root"/build-package "$root"/build-docs "$root"/build-mpi "$root"/build-check-{gcc,clang,sanitize,tsan,aarch64} \
        "$root"/build-aarch64-root
}

# --- check: each step is one function that fails or not -------------------------------------------------

sources() { # tracked and new C files, no ignored ones
    (cd "$root" && git ls-files --cached --others --exclude-standard -- "$@" 2>/dev/null |
        while read -r f; do [[ -f $f ]] && echo "$f"; done | sort -u)
}

check_format() {
    sources '*.c' '*.h' '*.cc' '*.cpp' '*.hpp' | (cd "$root" && xargs -r clang-format --dry-run -Werror)
}

check_layers() { # includes against the table of docs/design.md
    "$python" "$root/tools/layers.py"
}

check_links() { # pages against what they lead to
    "$python" "$root/tools/links.py"
}

check_release() { # the version in all files that name it
    "$python" "$root/tools/release.py"
}

check_words() { # comments and pages against the rules of language
    "$python" "$root/tools/words.py"
}

configure_gcc() {
    need "${packages_mpi[@]}"
    CC=gcc CXX=g++ configure build-check-gcc --buildtype=release -Dwerror=true "$(with_mpi)"
}

check_gcc() {
    configure_gcc && build build-check-gcc
}

# Only read, not compiled: clang's warnings come from reading, and the sanitizers' build compiles and links with it.
check_clang() {
    CC=clang CXX=clang++ configure build-check-clang --buildtype=release -Dwerror=true || return 1
    "$ninja" --quiet -C "$root/build-check-clang" src/accuracy/slopes_table.c src/cli/{commit,key_pages}.c || return 1 # sources that are made
    "$python" "$root/tools/only_read.py" "$root/build-check-clang/compile_commands.json"
}

# Unset on purpose: values of absent effects in kernel templates, variables that Qhull's loop macros set. One configuration:
# the sources have hardly any other, and headers' own take twice as long again.
check_cppcheck() {
    configure_gcc || return 1 # makes headers
    cppcheck --quiet --std=c11 --language=c --enable=warning,performance --inline-suppr \
        --suppress=missingIncludeSystem --suppress=unmatchedSuppression --suppress='uninitvar:*_template.c' \
        --suppress='uninitvar:*/law_softening.h' --suppress='uninitvar:*/delaunay.c' --error-exitcode=1 -j "$(nproc)" \
        -DNDEBUG -I "$root/include" -I "$root/src" -I "$root/build-check-gcc/src" "$root/src"
}

check_tidy() { # the checks are in .clang-tidy
    local commands=$root/build-check-clang
    [[ -f $commands/compile_commands.json ]] || return 1
    # What is compiled on its own, once: a kernel template is compiled per instruction set.
    "$python" - "$commands/compile_commands.json" "$root/src/" <<'PYTHON' |
import json, os, sys
entries = json.load(open(sys.argv[1]))
files = {os.path.normpath(os.path.join(e["directory"], e["file"])) for e in entries}
print("\n".join(sorted(f for f in files if f.startswith(sys.argv[2]) and f.endswith(".c"))))
PYTHON
        (cd "$root" && xargs -r -n 2 -P "$(nproc)" clang-tidy --quiet -p "$commands" 2>/dev/null)
}

# Other programs are compiled without sanitizers and read by clang: what no test here runs is not built.
sanitized_tests() { # [names of tests]
    local folder=build-check-sanitize left_out=(long plain) targets
    "$ninja" --quiet -C "$root/$folder" build.ninja >&2 || return 1 # follows what meson.build says now
    mapfile -t targets < <("$python" "$root/tools/tests_need.py" "$root/$folder" "${left_out[@]}")
    ((${#targets[@]})) || { say "sanitizers: no test to build"; return 1; }
    ASAN_OPTIONS=detect_leaks=1:intercept_tls_get_addr=${trace_tls:-1} UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
        run_tests "$folder" "${left_out[@]/#/--no-suite=}" --timeout-multiplier 5 "$@"
}

check_sanitizers() {
    local ignore=$root/tools/sanitizer_ignore.txt
    # Accesses at wrong addresses are the address sanitizer's, so that checks of pointers beside it would only take time.
    # Of the kernels of vectors one width: with all of them compiling alone takes ten minutes.
    CC=clang CXX=clang++ configure build-check-sanitize -Dsets=scalar,avx2 -Doptimization=1 -Ddebug=true -Db_ndebug=false \
        -Db_sanitize=address,undefined -Db_lundef=false \
        "-Dc_args=-g1 -fsanitize-ignorelist=$ignore -fno-sanitize=null,object-size,pointer-overflow" || return 1
    sanitized_tests && return 0
    # The leak checker of clang 14 guesses from the words before a library's thread-local block where that lies, and reads there. With
    # glibc 2.36 the guess can be wrong and kill it after all has passed; the tests that failed then run without these blocks.
    grep -q 'LeakSanitizer has encountered a fatal error' "$root/build-check-sanitize/meson-logs/testlog.txt" ||
        return 1
    local failed
    mapfile -t failed < <("$python" -c '
import json, sys
for line in open(sys.argv[1]):
    test = json.loads(line)
    if test["result"] not in ("OK", "SKIP"):
        print(test["name"].split(" / ")[-1])' "$root/build-check-sanitize/meson-logs/testlog.json")
    ((${#failed[@]})) || return 1
    say "the leak checker died: once more ${failed[*]}"
    trace_tls=0 sanitized_tests "${failed[@]}"
}

# Archer tells ThreadSanitizer what OpenMP orders; without it every parallel region would seem to be a race.
check_tsan() {
    local archer=/usr/lib/llvm-14/lib/libarcher.so out scene status=0 fixed=()
    [[ -f $archer ]] || { say "tsan: $archer is missing (libomp-14-dev)"; return 1; }
    CC=clang CXX=clang++ configure build-check-tsan -Doptimization=1 -Ddebug=true -Db_ndebug=false \
        -Db_sanitize=thread -Db_lundef=false -Dc_args=-g1 && build build-check-tsan gneiss || return 1
    setarch -R true 2>/dev/null && fixed=(setarch -R) # clang 14 does not know the widest randomisation of addresses
    out=$(mktemp -d)
    for scene in lattice-small ucs-small beam-small elements polygon; do
        OMP_TOOL_LIBRARIES=$archer OMP_WAIT_POLICY=passive GNEISS_CACHE=off \
            TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1" "${fixed[@]}" \
            "$root/build-check-tsan/gneiss" run "$root/tests/scenes/$scene.yaml" --out "$out/$scene" --threads 3 --quiet ||
            { say "tsan: $scene"; status=1; }
    done
    rm -rf "$out"
    return "$status"
}

# The kernels' tests, and the same bits as here, on a processor that is not x86; the arithmetic is qemu's.
check_aarch64() {
    local rootfs=$root/build-aarch64-root folder=build-check-aarch64 libraries=() name set out status=0 there
    local tests=(test_base test_instruction_sets test_kernels test_motion_kernels test_element_kernels test_deal test_soa)
    need "${packages_aarch64[@]}"
    for name in "${packages_build[@]}"; do [[ $name != lib* ]] || libraries+=("$name"); done
    "$root/tools/aarch64_root.sh" "$rootfs" "${libraries[@]}" libgomp1 || return 1
    configure "$folder" --cross-file "$rootfs/cross.ini" --buildtype=release -Dwerror=true || return 1
    build "$folder" gneiss "${tests[@]/#/tests/}" || return 1
    "$meson" test -C "$root/$folder" --no-rebuild --print-errorlogs "${tests[@]}" || status=1
    prepare && build build gneiss || return 1
    out=$(mktemp -d)
    there=(qemu-aarch64 -L "$rootfs/root" "$root/$folder/gneiss")
    for name in lattice-small elements; do
        hash_of "$out/here-$name" "$name" "$root/build/gneiss" >"$out/want"
        for set in $("${there[@]}" info | sed -n 's/^instruction sets *//p'); do
            GNEISS_ISA=$set hash_of "$out/there-$name" "$name" "${there[@]}" >"$out/got"
            if [[ -s $out/want ]] && cmp "$out/want" "$out/got"; then echo "aarch64: $set, $name: the same bits"; continue; fi
            say "aarch64: $set, $name: other bits than here"
            status=1
        done
    done
    rm -rf "$out"
    return "$status"
}

# hash_of FOLDER SCENE PROGRAM...: of the state in which it leaves a scene of the tests, in either precision.
hash_of() {
    local precision
    for precision in double mixed; do
        OMP_WAIT_POLICY=passive GNEISS_CACHE=off "${@:3}" run "$root/tests/scenes/$2.yaml" --out "$1" --force --quiet \
            --threads 1 --precision "$precision" >/dev/null && grep -o '"state_hash": *"[0-9a-f]*"' "$1/summary.json"
    done
}

check_docs() {
    command_docs
}

check_python() {
    (cd "$root" && sources '*.py' | xargs -r "$python" -c '
import sys
for name in sys.argv[1:]:
    with open(name, encoding="utf-8") as f:
        compile(f.read(), name, "exec")')
}

command_check() {
    need "${packages_build[@]}" "${packages_check[@]}"
    git -C "$root" rev-parse --is-inside-work-tree >/dev/null 2>&1 ||
        die "check: $root is not a git work tree; the list of files comes from git"
    local steps=(format layers links words release gcc clang cppcheck tidy sanitizers python) failed=() step start summary=()
    (($#)) && steps=("$@")
    for step in "${steps[@]}"; do
        declare -F "check_$step" >/dev/null || die "check: no such step: $step"
    done
    for step in "${steps[@]}"; do
        heading "$step"
        start=$SECONDS
        if "check_$step"; then
            summary+=("ok      $step ($((SECONDS - start)) s)")
        else
            summary+=("FAILED  $step ($((SECONDS - start)) s)")
            failed+=("$step")
        fi
    done
    heading "summary"
    printf '%s\n' "${summary[@]}"
    if ((${#failed[@]})); then
        echo "check: FAILED: ${failed[*]}"
        return 1
    fi
    echo "check: all ${#steps[@]} steps passed"
}

main() {
    local command=${1:-help}
    (($#)) && shift
    case $command in
    run | mpi | test | check | bench | validate | accuracy | package | docs | install | keys | clean) "command_$command" "$@" ;;
    help | -h | --help) usage ;;
    *)
        usage >&2
        say ""
        die "no such command: $command"
        ;;
    esac
}

main "$@"
