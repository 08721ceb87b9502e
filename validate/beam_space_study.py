"""A notched beam in space of one packing in four ways: particles alone, fixed zones, elements that turn into particles, elements alone:
docs/evidence/coupling.md. Some forty minutes, one thread a run.

    /usr/bin/python3 validate/beam_space_study.py [--fresh]
"""
import json

import numpy as np

import conversion_study
import coupling_study
import meshes
import study

FOLDER = study.RUNS / "beam-space"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "coupling-beam-space.png"
LENGTH, HEIGHT, BREADTH, SPAN, NOTCH, SLOT, RADIUS = 0.22, 0.05, 0.008, 0.2, 0.015, 0.002, 0.75e-3  # m
MID, FOOT = LENGTH / 2, (LENGTH - SPAN) / 2
CHOSEN = ((1.0, 9), (1.5, 9), (2.0, 9), (3.0, 9), (1.5, 12))  # MPa at which elements convert, and mm of the zone: six particles, and eight
MIDDLE, ZONE = 0.035, 0.01  # m: half the length of the part with particles between fixed zones, including the zones, and their width
MATERIAL = {"name": "concrete", "density": 2400, "contact_modulus": 19.1e9, "kratio": 3, "friction": 0.5, "tensile_strength": 4e6,
            "shear_strength": 12e6}
SOFT = 5.0  # fracture energy of contacts that soften, J/m2
ONE = {"run.threads": 1}  # settings of runs whose costs are compared


# --- shapes -------------------------------------------------------------------------------------------------------

def surface():
    """Closed surface of the notched beam."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    left, right = MID - SLOT / 2, MID + SLOT / 2
    outline = [(0, 0), (left, 0), (left, NOTCH), (right, NOTCH), (right, 0), (LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT)]
    return meshes.prism(FOLDER / "beam.stl", outline, [(0, 1, 2), (0, 2, 7), (4, 5, 6), (4, 6, 3), (7, 2, 3), (7, 3, 6)], BREADTH)


def mesh(name, x, kept=lambda x, y: True, part=1.0):
    """Tetrahedra between the coordinates x, finer at the tip of the notch; only cells whose centres satisfy `keep`
    exist; `part`: factor of the usual height."""
    y, z = meshes.graded([0, NOTCH, HEIGHT], lambda y: part * np.minimum(2e-3 + 0.25 * np.abs(y - NOTCH), 6e-3)), np.linspace(0, BREADTH, 3)
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(1, len(nodes) + 1).reshape(len(x), len(y), len(z))
    cells = meshes.tetrahedra(number, lambda c, r, _: kept(0.5 * (x[c] + x[c + 1]), 0.5 * (y[r] + y[r + 1])))
    used = {node: k + 1 for k, node in enumerate(sorted({node for cell in cells for node in cell}))}
    path = FOLDER / f"{name}.msh"
    meshes.write(path, [nodes[node - 1] for node in used], [tuple(used[node] for node in cell) for cell in cells], {})
    return str(path)


def both_sides(half):
    return np.r_[MID - half[::-1], MID + half]


def whole_mesh(part):
    half = meshes.graded([SLOT / 2, SPAN / 2, LENGTH / 2], lambda x: np.minimum(2e-3 + 0.2 * np.maximum(x - 2e-3, 0), 8e-3))
    return mesh("whole" if part == 1 else f"whole-{part:.3g}", both_sides(half), lambda x, y: abs(x - MID) > SLOT / 2 or y > NOTCH, part)


def side_meshes():
    """Elements at both sides, with cells of a quarter of the zone inside it."""
    half = meshes.graded([MIDDLE - ZONE, MIDDLE, SPAN / 2, LENGTH / 2], lambda x: np.clip(ZONE / 4 + 0.2 * (x - MIDDLE), ZONE / 4, 8e-3))
    return mesh("sides", both_sides(half), lambda x, y: abs(x - MID) > MIDDLE - ZONE)


# --- scenes -------------------------------------------------------------------------------------------------------

def box(x, y, half=0.0, room=0.0, depth=0.0):
    """A region over the whole breadth, around (x, y): x within `half`, y within `room`, and `depth` into the beam."""
    low, high = sorted((y, y + depth))
    return {"min": [x - half, low - room, -1e-3], "max": [x + half, high + room, BREADTH + 1e-3]}


MOTIONS = {"left": {"vx": 0, "vy": 0, "vz": 0}, "right": {"vy": 0}, "load": {"vy": [[0, 0], [1e-3, -2e-3]]}}


def particle_set(name):
    deep = 2 * RADIUS
    where = {"left": box(FOOT, 0, 1.75 * RADIUS, 0, deep), "right": box(LENGTH - FOOT, 0, 1.75 * RADIUS, 0, deep),
             "load": box(MID, HEIGHT, 2.5e-3, 0, -deep)}[name]
    return {"name": name, "select": {"box": where}, "motion": MOTIONS[name]}


def node_motion(name):
    tiny = 1e-6
    where = {"left": box(FOOT, 0, tiny, tiny), "right": box(LENGTH - FOOT, 0, tiny, tiny), "load": box(MID, HEIGHT, 2.5e-3, tiny)}[name]
    return {"name": name, "box": where, "motion": MOTIONS[name]}


def base(soft=False):
    mouths = [{"name": f"mouth_{side}", "select": {"box": box(MID + sign * (SLOT / 2 + 2e-3), 0, 2e-3, 0, 3 * RADIUS)}}
              for side, sign in (("left", -1), ("right", 1))]
    return {"dimension": 3,
            "specimen": {"group": 1, "surface": surface(), "mean_radius": RADIUS, "material": "concrete", "density_basis": "bulk",
                         "packing": {"overlap": "passive", "size_variation": 0.1}},
            "materials": [{**MATERIAL, "fracture_energy": SOFT} if soft else MATERIAL],
            "law": {"stiffness": "harmonic", "softening": "energy"} if soft else {"stiffness": "harmonic"},
            "bonds": {"interaction_range": 0.1, "passive_gaps": True}, "sets": mouths,
            "damping": {"background": {"model": "viscous", "coefficient": 2000}},
            "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": "load", "span": SPAN, "height": HEIGHT, "thickness": BREADTH,
                     "notch": NOTCH, "opening": {"axis": "x", "lower": "mouth_left", "upper": "mouth_right"}},
            "time": {"end": 25e-3, "stop": {"peak_drop": 0.4}}, "output": {"history_rows": 1000}, "run": {"seed": 1}}


def written(name, scene):
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return path


def elements(path, young, poisson, held):
    return {"mesh": path, "materials": [{"young": young, "poisson": poisson, "density": MATERIAL["density"]}], "motions": [node_motion(name) for name in held]}


class Beam:
    """The runs of one kind of contacts; settings of particles alone and adaptive runs by a note in their names."""

    def __init__(self, young, poisson, soft=False):
        self.young, self.poisson, self.soft, self.kind = young, poisson, soft, "soft" if soft else "brittle"

    def run(self, name, scene, settings):
        return study.run(f"beam-space/{self.kind}-{name}", written(f"{self.kind}-{name}", scene), {**ONE, **settings})

    def elements(self, path, held):
        materials = [{"young": self.young, "poisson": self.poisson, "density": MATERIAL["density"]}]
        return {"mesh": path, "materials": materials, "motions": [node_motion(name) for name in held]}

    def alone(self, note="", **settings):
        scene = base(self.soft)
        scene["sets"] += [particle_set(name) for name in MOTIONS]
        return self.run(f"particles{note}", scene, settings)

    def fixed(self, whole):
        """The middle of the packing of `whole` between elements."""
        position, radius = whole.results("particles/position") - whole.results("particles/displacement"), whole.results("particles/radius")
        keep = np.abs(position[:, 0] - MID) <= MIDDLE
        np.savetxt(FOLDER / "middle.txt", np.c_[position[keep], radius[keep]], fmt="%.17g")
        volume = BREADTH * (LENGTH * HEIGHT - SLOT * NOTCH)
        scene = base(self.soft)
        scene["specimen"] = {"file": "middle.txt", "group": 1, "material": "concrete", "density_basis": "bulk",
                             "porosity": float(1 - np.sum(4 / 3 * np.pi * radius**3) / volume)}
        scene["sets"].append(particle_set("load"))
        scene["elements"] = self.elements(side_meshes(), ("left", "right"))
        scene["couple"] = {"zones": [{"edges": [{"from": [MID + sign * (MIDDLE - ZONE), 0, 0], "to": [MID + sign * MIDDLE, 0, 0]}]} for sign in (-1, 1)]}
        return self.run("fixed", scene, {})

    def adaptive(self, limit, width, note="", part=1.0, **settings):
        """Elements, of a `part` of the usual height, convert at `limit` MPa, with zones of `width` mm."""
        scene = base(self.soft)
        scene["elements"] = self.elements(whole_mesh(part), MOTIONS)
        inner = {"min": [FOOT + 0.01, -1e-3, -1e-3], "max": [LENGTH - FOOT - 0.01, HEIGHT + 1e-3, BREADTH + 1e-3]}
        scene["couple"] = {"convert": {"box": inner, "width": 1e-3 * width, "stress": 1e6 * limit, "every": 100}}
        return self.run(f"adaptive-{limit:g}-{width}{note}", scene, settings)

    def never(self, end):
        return self.adaptive(1e6, CHOSEN[0][1], f"-{1e3 * end:g}", **{"time.end": end})


# --- meshes and elements ------------------------------------------------------------------------------------------

def bar(seed):
    """A bar of particles with the section of the beam, twice as long as high, pulled at its ends; no bond breaks."""
    scene = base()
    scene["specimen"]["box"] = {"size": [2 * HEIGHT, HEIGHT, BREADTH]}
    del scene["specimen"]["surface"]
    ends = [{"name": name, "select": {"end": {"axis": "x", "side": side, "depth": 2 * RADIUS}}, "motion": {"vx": [[0, 0], [2e-4, sign * 5e-3]]}}
            for name, side, sign in (("below", "lower", -1), ("above", "upper", 1))]
    scene |= {"sets": ends, "test": {"kind": "tension", "axis": "x", "lower": "below", "upper": "above", "area": HEIGHT * BREADTH},
              "materials": [{**MATERIAL, "tensile_strength": 1e15, "shear_strength": 1e15}], "time": {"end": 1e-3}, "run": {"seed": seed}}
    return study.run(f"beam-space/bar-{seed}", written(f"bar-{seed}", scene), ONE)


def modulus(result):
    """E in Pa and nu of the middle half of the bar."""
    u = result.results("particles/displacement")
    x = result.results("particles/position") - u
    middle = np.abs(x[:, 0] - HEIGHT) < HEIGHT / 2
    strain = np.array([np.polyfit(x[middle, k], u[middle, k], 1)[0] for k in range(3)])
    return result.results("history/stress")[-1] / strain[0], -0.5 * (strain[1] + strain[2]) / strain[0]


def calibrated(seeds=(1, 2)):
    return np.array([modulus(bar(seed)) for seed in seeds])


# --- tables and picture -------------------------------------------------------------------------------------------

def runs(beam):
    whole = beam.alone()
    found = [("particles alone", whole), ("fixed zones", beam.fixed(whole))]
    found += [(f"adaptive, {limit} MPa, {width} mm", beam.adaptive(limit, width)) for limit, width in CHOSEN]
    found.append(("adaptive, 3.0 MPa, 9 mm, cells half as high", beam.adaptive(3.0, 9, "-finer", part=FINER)))
    return [*found, (conversion_study.NEVER, beam.never(8e-3))]


def beam_table(found):
    return study.table(conversion_study.head("N"), conversion_study.lines(found, "N"))


def parted_table(found):
    """Load at which this number of bonds has broken, N, which is comparable whether a crack pauses or not."""
    counts, rows = (5, 10, 20, 40), []
    for name, result in found:
        if name != conversion_study.NEVER:
            force = result.results("history/force")
            broken = result.results("history/broken_tension") + result.results("history/broken_shear")
            rows.append([name, *(f"{np.max(force[:np.argmax(broken >= count) + 1]):.1f}" for count in counts), f"{np.max(force):.1f}"])
    return study.table(["largest load up to", *(f"{count} bonds broken, N" for count in counts), "the end"], rows)


def draw(kinds):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(kinds), 2, figsize=(11, 4.2 * len(kinds)), sharey="row", constrained_layout=True, squeeze=False)
    for row, (found, title, bends, openings, most) in zip(axes, kinds):
        conversion_study.panels(row, found, "N", bends, openings, most)
        row[0].set_title(title, fontsize=9)
    figure.savefig(PICTURE, dpi=110, metadata={"Software": None})


SAFETIES = (0.9, 0.89, 0.88, 0.87, 0.86, 0.85)  # 0.9 is the default
FINER = 0.5  # height of cells relative to the usual one


def rounded(run, *chosen, note="", **more):
    """Runs that differ only by rounding, obtained by slightly different steps."""
    return [run(*chosen, note, **more) if k == SAFETIES[0] else run(*chosen, f"{note}-{k}", **more, **{"time.safety": k}) for k in SAFETIES]


def rounding_table(beam):
    """Peaks of the same runs with slightly shorter steps, N, and the difference of their means with its standard
    error."""
    kinds = [("particles alone", rounded(beam.alone))]
    kinds += [(f"adaptive, {limit} MPa, {width} mm", rounded(beam.adaptive, limit, width)) for limit, width in CHOSEN]
    kinds.append(("adaptive, 3.0 MPa, 9 mm, cells half as high", rounded(beam.adaptive, 3.0, 9, note="-finer", part=FINER)))
    rows, first = [], None
    for name, made in kinds:
        peaks = np.array([np.max(result.results("history/force")) for result in made])
        mean, error = peaks.mean(), peaks.std(ddof=1) / np.sqrt(len(peaks))
        first = first or (mean, error)
        off, unsure = 100 * (mean / first[0] - 1), 100 * mean / first[0] * np.hypot(error / mean, first[1] / first[0])
        rows.append([name, *(f"{peak:.1f}" for peak in peaks), f"{mean:.1f} ± {error:.1f}", "" if name == kinds[0][0] else f"{off:+.1f} ± {unsure:.1f}"])
    return study.table(["peak, N", "steps of 0.9", *(f"{k}" for k in SAFETIES[1:]), "mean and its error", "off, %"], rows)


def main():
    young, poisson = calibrated().mean(axis=0)
    brittle, soft = Beam(young, poisson), Beam(young, poisson, True)
    print(f"E {young / 1e9:.2f} GPa, nu {poisson:.3f}")
    found = {beam.kind: runs(beam) for beam in (brittle, soft)}
    for kind, made in found.items():
        study.put("coupling.md", f"table space {kind}", beam_table(made))
    study.put("coupling.md", "table space brittle bonds", parted_table(found["brittle"]))
    study.put("coupling.md", "table space rounding", rounding_table(brittle))
    draw([(found["brittle"], "brittle contacts", 26, 16, 190), (found["soft"], "contacts that soften", 40, 30, 250)])


if __name__ == "__main__":
    main()
