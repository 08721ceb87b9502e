"""Long forms of hard cases, as a table in Markdown: some 1e7 steps each, minutes of one core.

    /usr/bin/python3 tests/hard/long.py build/gneiss [words of names]
"""
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEAD = "| case | steps | what happens |\n| --- | --- | --- |"


def run(number, case, program):
    """Steps and figures; a case that ended otherwise is reported with its outcome."""
    from hard.case import start

    folder = program.place_of(number)
    scene = case.scene(folder)
    scene["time"]["end"] *= case.long
    try:
        one = start(folder, scene, "long", timeout=3600)
        if one.code != 0:
            return "-", f"**exit code {one.code}**: {one.message[:200]}"
        return f"{one.summary['steps']:.3g}", (case.long_check or case.check)(one)
    except AssertionError as failure:
        return "-", f"**{failure}**"
    finally:
        program.shutil.rmtree(folder, ignore_errors=True)


def main(words):
    import program
    from hard import table

    wrong, written = 0, []
    for number, case in enumerate(table.CASES):
        if not case.long or words and not any(word in case.name for word in words):
            continue
        start = time.monotonic()
        steps, figures = run(number, case, program)
        wrong += steps == "-"
        written.append(f"| {case.name} | {steps} | {figures} |")
        print(f"{case.name}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    print("\n".join([HEAD, *written]))
    return min(wrong, 1)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[2:]))
