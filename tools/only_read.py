"""Has the compiler read every source of a build folder, for its warnings: only_read.py COMPILE_COMMANDS. Nothing is written. A
source that is compiled several times is read once for each set of definitions (-D)."""
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys


def differs_by(entry):
    return entry["file"], *sorted(word for word in shlex.split(entry["command"]) if word.startswith("-D"))


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
        entries = list({differs_by(entry): entry for entry in reversed(json.load(file))}.values())
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        found = list(pool.map(read, entries))
    for _, said in found:
        sys.stderr.write(said)
    bad = sum(code != 0 for code, _ in found)
    print(f"{len(entries)} sources read, {bad} refused")
    return 1 if bad or not entries else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
