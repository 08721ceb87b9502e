"""Makes a packing of discs in a rectangle for scenes in two dimensions, with gneiss itself.

    /usr/bin/python3 tools/make_disc_specimen.py --out scenes/specimens/discs-50x100.txt

Loose discs with radii drawn uniformly between two limits are put on a jittered grid; four frictionless walls close in
at the same rate along both axes until the discs almost touch; then four servo walls press with one pressure
until the unbalanced force is small. Friction is off and background damping on, so the packing is dense and
isotropic. The result is moved to x, y >= 0 and scaled so that its width is exact; the height comes out within a few
percent of what was asked and stands in the header. The same seed gives the same file on the same
instruction set; threads do not matter.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
LOOSE = 0.55        # area fraction at the start
NEARLY = 0.80       # area fraction at the end of the closing: below random close packing, about 0.84
STIFFNESS = 1e8     # N/m of contacts and walls, per metre of thickness
PRESSURE = 2e5      # Pa: overlaps of about pressure/STIFFNESS, 0.2 % of the diameter
DENSITY = 2500.0    # kg/m3
SPEED = 0.5         # m/s of the closing
STEPS_MAX = 0.2     # longest duration of the pressing, s

ARGUMENTS = [("--width", float, 0.05, "m"), ("--height", float, 0.10, "m, about"),
             ("--count", int, 4000, "number of discs"), ("--ratio", float, 2.5, "largest over smallest radius"),
             ("--seed", int, 1, "of radii and places"), ("--out", str, None, "the file to write"),
             ("--program", str, str(ROOT / "build" / "gneiss"), "gneiss")]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    for name, kind, default, text in ARGUMENTS:
        parser.add_argument(name, type=kind, default=default, required=default is None, help=text)
    return parser.parse_args()


def loose_discs(a):
    """Rows x y r around the origin, none touching another, and the half sizes of a box around them."""
    random = np.random.default_rng(a.seed)
    radius = random.uniform(1.0, a.ratio, a.count)
    radius *= np.sqrt(0.84 * a.width * a.height / (np.pi * np.sum(radius**2)))
    cell = 2.02 * radius.max()
    scale = max(1.0, cell / np.sqrt(np.pi * np.sum(radius**2) / LOOSE / a.count))
    half = 0.5 * scale * np.array([1.0, a.height / a.width])
    half *= np.sqrt(np.pi * np.sum(radius**2) / LOOSE / (a.height / a.width))
    columns = int(np.floor(2 * half[0] / cell))
    rows = int(np.ceil(a.count / columns))
    half[1] = max(half[1], 0.5 * rows * cell)
    place = random.permutation(columns * rows)[:a.count]
    pitch = 2 * half / np.array([columns, rows])
    centre = np.stack([place % columns, place // columns], axis=1) * pitch + 0.5 * pitch - half
    free = 0.5 * pitch - 1.001 * radius[:, None]
    centre += random.uniform(-1, 1, centre.shape) * np.maximum(free, 0.0)
    return np.column_stack([centre, radius]), half


def wall(name, point, normal, drive):
    return {"name": name, "point": list(point), "normal": list(normal), "stiffness": STIFFNESS, **drive}


def scene(specimen, walls, end, stop):
    return {"title": "disc packing", "dimension": 2, "specimen": {"file": str(specimen)},
            "materials": [{"name": "disc", "density": DENSITY, "normal_stiffness": STIFFNESS, "kratio": 0}],
            "law": {"stiffness": "uniform", "rotation": "off"},
            "damping": {"background": {"model": "nonviscous_component", "coefficient": 0.7}, "contact": {"restitution": 0.2}},
            "walls": walls, "time": {"end": end, **({"stop": stop} if stop else {})},
            "output": {"snapshots": 0, "checkpoint": "off", "history_rows": 200}}


def compute(a, folder, name, model):
    """Runs a scene; rows x y r and the positions of the four walls at its end."""
    path = folder / f"{name}.yaml"
    path.write_text(json.dumps(model, indent=1))  # JSON is YAML
    out = folder / name
    environment = dict(os.environ, OMP_WAIT_POLICY="passive")
    done = subprocess.run([a.program, "run", str(path), "--quiet", "--out", str(out)], text=True, env=environment,
                          capture_output=True)
    if done.returncode:
        sys.exit(f"{name}: gneiss ended with exit code {done.returncode}\n{done.stderr}")
    with h5py.File(out / "results.h5", "r") as file:
        discs = np.column_stack([file["particles/position"][:, :2], file["particles/radius"][:]])
        moved = {w: np.array([file[f"history/wall_{w}_displacement_{c}"][-1] for c in "xy"])
                 for w in ("left", "right", "bottom", "top")}
        unbalanced = file["history/unbalanced"][-1]
    start = {w["name"]: np.array(w["point"]) for w in model["walls"]}
    return discs, {w: start[w] + moved[w] for w in moved}, unbalanced


def write_rows(path, discs):
    path.write_text("\n".join(" ".join(f"{v:.17g}" for v in row) for row in discs) + "\n")


def close_in(a, folder, discs, half):
    """Walls move in at speeds proportional to the size until the area fraction is NEARLY."""
    write_rows(folder / "loose.txt", discs)
    area = np.pi * np.sum(discs[:, 2]**2)
    target = np.sqrt(area / (NEARLY * a.height / a.width)) * 0.5 * np.array([1.0, a.height / a.width])
    travel = half - target
    end = travel.max() / SPEED
    sides = [("left", 0, -1), ("right", 0, 1), ("bottom", 1, -1), ("top", 1, 1)]
    walls = []
    for name, axis, side in sides:
        point, normal = [0.0, 0.0], [0.0, 0.0]
        point[axis], normal[axis] = side * half[axis], -side
        walls.append(wall(name, point, normal, {"motion": {f"v{'xy'[axis]}": -side * travel[axis] / end}}))
    return compute(a, folder, "closing", scene(folder / "loose.txt", walls, end, None))


def press(a, folder, discs, walls):
    write_rows(folder / "closed.txt", discs)
    size = walls["right"][0] - walls["left"][0], walls["top"][1] - walls["bottom"][1]
    faces = {"left": (1, 0), "right": (-1, 0), "bottom": (0, 1), "top": (0, -1)}
    pressed = [wall(name, walls[name], n, {"servo": {"force": PRESSURE * size[1 if n[0] else 0],
                                                     "max_velocity": 0.5, "relaxation": 0.05}})
               for name, n in faces.items()]
    model = scene(folder / "closed.txt", pressed, STEPS_MAX, {"unbalanced": 1e-4})
    return compute(a, folder, "pressing", model)


def main():
    a = arguments()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        discs, half = loose_discs(a)
        discs, walls, _ = close_in(a, folder, discs, half)
        discs, walls, unbalanced = press(a, folder, discs, walls)
    origin = np.array([walls["left"][0], walls["bottom"][1]])
    size = np.array([walls["right"][0], walls["top"][1]]) - origin
    scale = a.width / size[0]
    discs[:, :2] -= origin
    discs, size = discs * scale, size * scale
    filled = np.pi * np.sum(discs[:, 2]**2) / np.prod(size)
    r = discs[:, 2]
    head = (f"# rectangle W {size[0]:.6g} m, H {size[1]:.6g} m, lower left corner at 0 0; {len(discs)} discs, radii "
            f"{r.min():.4g} to {r.max():.4g} m, porosity {1 - filled:.4f}; columns x y r [m]\n"
            f"# tools/make_disc_specimen.py --width {a.width} --height {a.height} --count {a.count} "
            f"--ratio {a.ratio} --seed {a.seed}\n")
    order = np.lexsort((discs[:, 0], discs[:, 1]))
    rows = "".join(f"{x:.9e} {y:.9e} {q:.9e}\n" for x, y, q in discs[order])
    Path(a.out).write_text(head + rows)
    print(head + f"unbalanced force ratio at the end {unbalanced:.2e}")


if __name__ == "__main__":
    main()
