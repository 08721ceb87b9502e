#!/usr/bin/python3
"""tests_need.py BUILD [SUITE...]: what ninja has to build for the tests that are in none of the suites, a file a line."""
import json
import os
import subprocess
import sys


def introspect(build):
    done = subprocess.run(["/usr/bin/meson", "introspect", build, "--tests", "--targets"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main(build, *left_out):
    found = introspect(build)
    needed = {target for test in found["tests"] if not {suite.split(":")[-1] for suite in test["suite"]} & set(left_out)
              for target in test["depends"]}
    for target in found["targets"]:
        if target["id"] in needed:
            print("\n".join(os.path.relpath(name, build) for name in target["filename"]))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: tests_need.py BUILD [SUITE...]")
    main(os.path.abspath(sys.argv[1]), *sys.argv[2:])
