#!/usr/bin/python3
"""count_tests.py TESTLOG.json: one line, `N passed, N failed, N skipped`, from meson's test log.

A cmocka program counts by its subtests (TAP lines), any other test as one. A program that dies, times out or ends with an error without a failed
subtest counts as one more failure. Before it the failed ones are listed, with their messages. Exit code 0 only if something passed and nothing
failed. """
import json
import re
import sys

TAP_LINE = re.compile(r"^(not )?ok\b(?:\s+\d+)?(?P<rest>.*)$", re.MULTILINE)
SKIP = re.compile(r"#\s*SKIP\b", re.IGNORECASE)
GOOD = ("OK", "EXPECTEDFAIL")


def count_program(entry):
    """(passed, failed, skipped) of one program."""
    if entry["result"] == "SKIP":
        return 0, 0, 1
    lines = list(TAP_LINE.finditer(entry.get("stdout") or ""))
    if not lines:
        return (1, 0, 0) if entry["result"] in GOOD else (0, 1, 0)
    failed = sum(1 for m in lines if m[1])  # `not ok # SKIP` too, as for meson
    skipped = sum(1 for m in lines if not m[1] and SKIP.search(m["rest"]))
    passed = len(lines) - skipped - failed
    if entry["result"] not in GOOD and not failed:
        failed = 1
    return passed, failed, skipped


def failures(entry, most=12):
    """Names of the failed subtests, with the last lines that each printed before its result."""
    said = []
    for line in (entry.get("stdout") or "").splitlines():
        if line.startswith("not ok"):
            yield from said[-most:]
            yield line
        said = [] if TAP_LINE.match(line) else said + [line]
    if entry["result"] not in GOOD:
        yield from (entry.get("stderr") or "").splitlines()[-most:]


def main(path):
    try:
        with open(path, encoding="utf-8") as log:
            entries = [json.loads(line) for line in log if line.strip()]
    except OSError:
        entries = []
    except ValueError as e:
        print(f"{path}: not a meson test log: {e}", file=sys.stderr)
        entries = []
    totals = [sum(column) for column in zip(*map(count_program, entries))] or [0, 0, 0]
    passed, failed, skipped = totals
    for entry in entries:
        if count_program(entry)[1]:
            print(f"failed: {entry['name']} ({entry['result']})")
            for line in failures(entry):
                print("    " + line)
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 0 if passed and not failed else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: count_tests.py TESTLOG.json")
    sys.exit(main(sys.argv[1]))
