"""Cross-validation against YADE, closed forms and published tables; writes docs/evidence/validation.md.

    ./do validate                 everything; what is kept in runs/validate and has not changed is not run again
    ./do validate --quick         step by step, and compression of rock-b: a few minutes; writes runs/validate/quick.md
    ./do validate --time          the running times alone, then the page
    ./do validate --only NAME     one section (steps, laboratory, kinds, beam, plane-beam, collisions, scenes, labra, rojek, hard, time), then the page
    ./do validate --kept          sections from the YADE runs that are there already: YADE runs that are missing are left out
  --fresh  forgets what is kept         --large  the beam of 240 x 80 x 40 mm
"""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "yade")]

import jobs  # noqa: E402
import page  # noqa: E402
import study  # noqa: E402

HEAD = """# gneiss beside YADE, closed forms and published tables

Written by `./do validate` (`validate/run.py`); do not edit. Scripts and jobs: `validate/yade/`; `./do validate --quick` is the
part that takes minutes, the meson suite `yade` the part that CI runs. Sections are measured one by one: each says when and
with what.

"""


def sections():
    import beam
    import hard_page
    import kinds
    import laboratory_page
    import plane_beam
    import published
    import scenes_page
    import steps_page
    import timing

    return {"steps": steps_page.section, "laboratory": laboratory_page.section, "kinds": kinds.section, "beam": beam.section,
            "plane-beam": plane_beam.section,
            "collisions": published.collision_section, "scenes": scenes_page.section,
            "labra": published.labra_section, "rojek": published.rojek_section, "hard": hard_page.section,
            "time": timing.section}


def write_page(names):
    page.page(HEAD).write(names)


FLAGS = ("--quick", "--time", "--only", "--kept", "--fresh", "--large")


def main(arguments):
    study.reported(arguments, __doc__, FLAGS)
    if not jobs.yade_program():
        sys.exit("validate: yade is not installed; `./do validate` installs it")
    options = {name: f"--{name}" in arguments for name in ("quick", "large", "time", "fresh")}
    jobs.KEPT_ONLY = "--kept" in arguments
    known = sections()
    if options["quick"]:
        text = "\n\n".join(known[name](options) for name in ("steps", "laboratory"))
        jobs.RUNS.mkdir(parents=True, exist_ok=True)
        (jobs.RUNS / "quick.md").write_text(text + "\n")
        print(text)
        return
    wanted = list(known)
    if options["time"]:
        wanted = ["time"]
    if "--only" in arguments:
        wanted = [name for name in arguments[arguments.index("--only") + 1:] if not name.startswith("--")]
        if not wanted or set(wanted) - set(known):
            sys.exit(f"validate: --only expects some of {', '.join(known)}, found {' '.join(wanted) or 'nothing'}")
    for name in wanted:
        print(f"{name} ...", file=sys.stderr, flush=True)
        page.keep(name, known[name](options))
    write_page(known)


if __name__ == "__main__":
    main(sys.argv[1:])
