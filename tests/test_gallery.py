"""The scenes of the gallery: they end as they should, with their energy in balance and without other warnings than they have. Speaks TAP.

Long ones run with what `quick` of docs/gallery.yaml changes, the others as they are shipped."""
import pathlib

import yaml

from program import *  # noqa: F403

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.append(os.path.join(ROOT, "tools"))
import gallery  # noqa: E402

with open(os.path.join(ROOT, "docs", "gallery.yaml")) as _table:
    ENTRIES = yaml.safe_load(_table)


def check(entry, folder):
    out = os.path.join(folder, "out")
    run(os.path.join(ROOT, "scenes", entry["scene"] + ".yaml"), out, "--threads", "1", "--set", "output.snapshots=0",
        *(f"--set={change}" for change in entry.get("quick", [])), environment={"GNEISS_CACHE": folder})
    said = summary(out)
    warned = {warning["name"] for warning in said["warnings"]}
    expected = {*entry.get("warns", []), *entry.get("quick_warns", [])}
    assert warned == expected, (warned, expected)
    assert abs(said["energy_residual"]) < 0.01, said["energy_residual"]
    return out


def add(entry):
    def function(folder):
        check(entry, folder)

    function.__name__ = f"{entry['scene']}: {entry['title']}"
    fact(function)


for _entry in ENTRIES:
    add(_entry)


@fact
def the_page_is_that_of_the_table(_):
    with open(gallery.PAGE) as file:
        assert file.read() == gallery.page(ENTRIES), "docs/gallery.md: expected what tools/gallery.py writes"
    assert len(ENTRIES) >= 20, len(ENTRIES)


@fact
def pictures_are_small_and_made_from_a_run(folder):
    for entry in ENTRIES:
        size = os.path.getsize(gallery.PICTURES / f"{entry['scene']}.png")
        assert size <= 30e3, (entry["scene"], size)
    out = check(next(entry for entry in ENTRIES if entry["scene"] == "tension"), folder)
    made = pathlib.Path(folder) / "made.png"
    gallery.picture(out, made)
    assert 5e3 < made.stat().st_size < 30e3, made.stat().st_size


if __name__ == "__main__":
    sys.exit(main())
