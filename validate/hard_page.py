"""Hard cases: writes docs/evidence/hard-cases.md, and runs their long forms."""
import os
import subprocess
import sys

import study

HERE = study.ROOT / "tests" / "hard"

INTRO = """## Hard cases, long

The long forms of cases of [hard-cases.md](hard-cases.md), which is written by the same command: what is kept over thousands of steps has to be
kept over millions. Default settings; one thread.
"""


def call(name):
    done = subprocess.run([sys.executable, str(HERE / name), os.path.abspath(study.PROGRAM)], stdout=subprocess.PIPE, text=True,
                          check=False)
    if done.returncode != 0:
        print(f"hard: {name} ended with {done.returncode}", file=sys.stderr)
    return done.stdout


def section(options):
    call("page.py")
    return INTRO + "\n" + call("long.py")
