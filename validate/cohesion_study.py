#!/usr/bin/python3
"""cohesion_study.py GNEISS OUT [SCENE]: slope and height of the heap of scenes/wet-column.yaml over the Bond number, the force of a bridge
over the weight of a grain, 2 pi r gamma cos(theta)/(m g). Writes OUT/cohesion.json and prints the tables of docs/cohesion.md; a run is not
repeated if its folder is there. The contact angle and the liquid stay those of the scene; its surface tension follows from the Bond number.
Before that, the force of a bridge by Willett et al. 2000, eq. 12, over that of the meniscus by the equation of Young and Laplace."""
import json
import math
import os
import subprocess
import sys

import h5py
import numpy as np
from scipy.optimize import fsolve

RADIUS, DENSITY, ANGLE, GRAVITY = 1e-3, 2500.0, math.radians(10.0), 9.81
BONDS = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0)


def meniscus(filling, suction, theta):
    """Gap, volume and force over 2 pi gamma of a bridge between two unit spheres, without weight: `filling` is half the angle that it covers,
    rad, `suction` its lack of pressure over 2 gamma. The force is the same in every section across the axis, so that the cosine u of the slope
    of the meridian at the distance y from the axis follows from y u + suction y^2 = force; it is 1 at the neck."""
    edge = math.sin(filling)
    force = edge * math.sin(filling + theta) + suction * edge**2
    neck = (math.sqrt(max(1 + 4 * suction * force, 0)) - 1) / (2 * suction) if abs(suction) > 1e-12 else force
    t = (np.arange(2000) + 0.5) / 2000  # y = neck + (edge - neck) t^2 has no singularity at the neck
    y, step = neck + (edge - neck) * t**2, 2 * (edge - neck) * t / 2000
    u = (force - suction * y**2) / y
    along = u / np.sqrt(np.maximum(1 - u**2, 1e-300)) * step
    cap = math.pi * (1 - math.cos(filling))**2 * (2 + math.cos(filling)) / 3
    return 2 * (along.sum() - 1 + math.cos(filling)), 2 * ((math.pi * y**2 * along).sum() - cap), force


def fit_over_meniscus(volume, shares):
    """Willett's force over that of the meniscus, for a volume over R^3 and gaps as shares of the distance at which it ruptures."""
    rupture, ratios = (1 + ANGLE / 2) * volume**(1 / 3), []
    filling = (4 * volume / math.pi)**0.25
    guess = (filling, filling**-2)
    for share in shares:
        gap = max(share * rupture, 1e-6)

        def missed(x, gap=gap):
            found = meniscus(*x, ANGLE)
            return 10 * (found[0] - gap), found[1] / volume - 1

        guess, _, solved, said = fsolve(missed, guess, full_output=True, xtol=1e-10)
        assert solved == 1 and max(map(abs, missed(guess))) < 1e-6, said
        half = 0.5 * gap / math.sqrt(volume)
        ratios.append(math.cos(ANGLE) / (1 + 2.1 * half + 10 * half**2) / meniscus(*guess, ANGLE)[2])
    return ratios


def tension(bond):
    """Surface tension, N/m, of a Bond number."""
    weight = DENSITY * 4 / 3 * math.pi * RADIUS**3 * GRAVITY
    return bond * weight / (2 * math.pi * RADIUS * math.cos(ANGLE))


def run(program, scene, out, bond):
    """Runs the scene for a Bond number; 0: without cohesion. Returns the folder."""
    place = os.path.join(out, f"bond-{bond:g}")
    if os.path.exists(os.path.join(place, "summary.json")):
        return place
    with open(scene) as file:
        text = file.read()
    if bond == 0.0:
        text = "\n".join(line for line in text.split("\n") if not line.strip().startswith(("cohesion", "surface_t", "contact_a", "liquid_c")))
    changed = os.path.join(out, f"bond-{bond:g}.yaml")
    with open(changed, "w") as file:
        file.write(text)
    more = [] if bond == 0.0 else ["--set", f"law.surface_tension={tension(bond)!r}"]
    subprocess.run([program, "run", changed, "--threads", "1", "--quiet", "--force", "--out", place, *more], check=True)
    return place


def heap(place):
    """Slope, degrees, of both flanks of the heap (nan if they are not lower outside), its height and half width, in radii. The surface is the mean, over 2.5 mm of |x|, of the
    highest grains across y; the slope that of a line through it between 15 and 85 % of the height."""
    with h5py.File(os.path.join(place, "results.h5")) as file:
        at = file["particles/position"][:]
    x, z = np.abs(at[:, 0]), at[:, 2]
    edges = np.arange(0, x.max() + 2.5e-3, 2.5e-3)
    middle, top = [], []
    for low, high in zip(edges[:-1], edges[1:]):
        inside = np.sort(z[(x >= low) & (x < high)])
        if len(inside):
            middle.append(0.5 * (low + high))
            top.append(np.mean(inside[-max(1, min(8, len(inside) // 4)):]))
    middle, top = np.array(middle), np.array(top)
    height = top.max()
    flank = (top > 0.15 * height) & (top < 0.85 * height)
    slope = -np.polyfit(middle[flank], top[flank], 1)[0] if flank.sum() > 1 else math.nan
    return math.degrees(math.atan(slope)) if slope > 0 else math.nan, height / RADIUS, np.quantile(x, 0.98) / RADIUS


def last(place, *names):
    """Last values of columns of the history; nan if a run has none."""
    with h5py.File(os.path.join(place, "results.h5")) as file:
        return [float(file["history"][name][-1]) if name in file["history"] else math.nan for name in names]


def main():
    program, out = sys.argv[1:3]
    scene = sys.argv[3] if len(sys.argv) > 3 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes", "wet-column.yaml")
    os.makedirs(out, exist_ok=True)
    shares = (0, 0.1, 0.2, 0.4, 0.6, 0.8)
    print("| V/R^3 | " + " | ".join(f"D/D_r {share:g}" for share in shares) + " |\n|" + " ---: |" * (1 + len(shares)))
    for volume in (0.001, 0.005, 0.02):
        print(f"| {volume:g} | " + " | ".join(f"{ratio:.2f}" for ratio in fit_over_meniscus(volume, shares)) + " |")
    rows = []
    print("\n| Bond number | slope | height | half width | coordination | porosity of the core | bridges | energy residual |")
    print("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for bond in BONDS:
        place = run(program, scene, out, bond)
        slope, height, width = heap(place)
        contacts, pores, bridges, residual = last(place, "coordination", "porosity", "bridges", "energy_residual")
        rows.append({"bond": bond, "slope": slope, "height": height, "width": width, "coordination": contacts, "porosity": pores,
                     "bridges": bridges, "residual": residual})
        print(f"| {bond:g} | {'it stands' if math.isnan(slope) else f'{slope:.0f} deg'} | {height:.1f} r | {width:.1f} r | {contacts:.2f} | {pores:.3f} | "
              f"{'none' if math.isnan(bridges) else f'{bridges:.0f}'} | {residual:.1e} |", flush=True)
    with open(os.path.join(out, "cohesion.json"), "w") as file:
        json.dump(rows, file, indent=1)


if __name__ == "__main__":
    main()
