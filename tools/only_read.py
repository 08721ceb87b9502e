"""Has the compiler read every source of a build folder, for its warnings: only_read.py COMPILE_COMMANDS. Nothing is written."""
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys


def read(entry):
    words = shlex.split(entry["command"])
    while words[0].endswith("ccache"):
        words = words[1:]
    drop = words.index("-o")
    words = words[:drop] + words[drop + 2:] + ["-fsyntax-only"]
    done = subprocess.run(words, cwd=entry["directory"], capture_output=True, text=True)
    return done.returncode, done.stderr


def main(path):
    with open(path) as file:
        entries = json.load(file)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        found = list(pool.map(read, entries))
    for _, said in found:
        sys.stderr.write(said)
    bad = sum(code != 0 for code, _ in found)
    print(f"{len(entries)} sources read, {bad} refused")
    return 1 if bad or not entries else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
