"""The cost of masses raised for a longer step, and the gain that steps of several lengths would bring. Fills the tables of
docs/evidence/mass-scaling.md; about fifteen minutes of one core.

    /usr/bin/python3 validate/mass_study.py [--fresh] [--only SECTION]     masses, error, waves, several
"""
import re
import sys
from functools import cache

import numpy as np
from scipy.spatial import cKDTree

import study

FACTORS = (1, 1.1, 1.2, 1.33, 1.5, 1.67, 2, 3)
KRATIO, RANGE = 3.7, 0.05
PACKINGS = study.RUNS / "mass" / "packings"
SPECIMENS = study.ROOT / "scenes" / "specimens"

WIDE = """dimension: 3
specimen:
  box: {size: [40 mm, 40 mm, 40 mm]}
  particles: 30000
  packing: {size_ratio: 9, size_variation: %s, overlap: passive}
"""
NOTCH = """dimension: 2
specimen:
  polygon: [[-200 mm, 0], [-2 mm, 0], [-2 mm, 30 mm], [2 mm, 30 mm], [2 mm, 0], [200 mm, 0], [200 mm, 100 mm],
            [-200 mm, 100 mm]]
  particles: 12000
  packing: {size_ratio: 1.5, refine: [{from: [0, 30 mm], to: [0, 60 mm], size: 20 %, distance: 20 mm}]}
"""
BLOCK = """dimension: 3
specimen:
  box: {size: [60 mm, 60 mm, 60 mm]}
  particles: 30000
  packing: {size_ratio: 1.5, refine: [{from: [30 mm, 30 mm, 50 mm], to: [30 mm, 30 mm, 60 mm], size: 20 %, distance: 8 mm}]}
"""


def packed(name, text):
    folder = PACKINGS / name
    note = folder.parent / f"{name}.yaml"
    if not (folder / "packing.txt").exists() or note.read_text() != text:
        folder.parent.mkdir(parents=True, exist_ok=True)
        note.write_text(text)
        done = study.call(["pack", str(note), "--out", str(folder), "--threads", str(study.THREADS), "--quiet", "--force"])
        if done.returncode:
            sys.exit(f"{name}: {done.stderr}")
    return folder / "packing.txt"


def bodies():
    """Name, dimension, file."""
    yield "rock-a", 3, SPECIMENS / "rock-a.txt"
    yield "rock-b", 3, SPECIMENS / "rock-b.txt"
    yield "rock-c", 3, SPECIMENS / "rock-c.txt"
    yield "discs", 2, SPECIMENS / "discs-50x100.txt"
    yield "wide", 3, packed("wide", WIDE % "35 %")
    yield "wider", 3, packed("wider", WIDE % "60 %")
    yield "notched beam", 2, packed("notch", NOTCH)
    yield "block", 3, packed("block", BLOCK)


# --- local bounds, of a free body with the harmonic law; steps in any unit ---

def blocks(dimension, x, r, i, j):
    """[n][d][d] diagonal blocks K_ii, doubled, scaled by masses r^3 (r^2) and moments."""
    n, space = len(x), dimension == 3
    inertia = (0.4 if space else 0.5) * r**(dimension + 2)
    mass = r**dimension
    apart = x[j] - x[i]
    length = np.linalg.norm(apart, axis=1)
    normal = np.zeros((len(i), 3))
    normal[:, :dimension] = apart / length[:, None]
    kn = r[i] * r[j] / (r[i] + r[j]) if space else np.ones(len(i))
    kt = kn / KRATIO
    half = 0.5 * (length - r[i] - r[j])
    nn = normal[:, :, None] * normal[:, None, :]
    one = np.eye(3)
    cross = np.zeros((len(i), 3, 3))
    for a, b, c, sign in ((0, 1, 2, -1), (0, 2, 1, 1), (1, 2, 0, -1)):
        cross[:, a, b], cross[:, b, a] = sign * normal[:, c], -sign * normal[:, c]
    whole = np.zeros((n, 6, 6))
    for end, side in ((i, -1.0), (j, 1.0)):
        arm = r[end] + half
        part = np.zeros((len(i), 6, 6))
        part[:, :3, :3] = kt[:, None, None] * one + (kn - kt)[:, None, None] * nn
        part[:, 3:, 3:] = (arm**2 * kt)[:, None, None] * (one - nn)
        part[:, :3, 3:] = (side * arm * kt)[:, None, None] * cross
        part[:, 3:, :3] = np.transpose(part[:, :3, 3:], (0, 2, 1))
        np.add.at(whole, end, 2.0 * part)
    scale = np.concatenate([np.repeat(mass[:, None], 3, 1), np.repeat(inertia[:, None], 3, 1)], 1)**-0.5
    whole *= scale[:, :, None] * scale[:, None, :]
    return whole if space else whole[:, [0, 1, 5]][:, :, [0, 1, 5]]


@cache
def local(path, dimension):
    """Step that each particle's own block allows, masses, and the contacts."""
    rows = np.loadtxt(path)
    x, r = rows[:, :dimension], rows[:, -1]
    pair = np.array(list(cKDTree(x).query_pairs(2 * (1 + RANGE) * r.max(), output_type="ndarray")))
    apart = np.linalg.norm(x[pair[:, 1]] - x[pair[:, 0]], axis=1)
    i, j = pair[apart <= (1 + RANGE) * (r[pair[:, 0]] + r[pair[:, 1]])].T
    top = np.linalg.eigvalsh(blocks(dimension, x, r, i, j))[:, -1]
    steps = np.where(top > 0, 2.0 / np.sqrt(np.maximum(top, 1e-300)), np.inf)
    return steps, r**dimension, i, j


def share_needed(steps, mass, factor):
    wanted = factor * steps.min()
    return np.sum(mass * np.maximum(0.0, (wanted / steps)**2 - 1.0)) / mass.sum()


# --- masses ---

SCENE = """dimension: {dimension}
specimen: {{file: {path}, material: rock}}
materials: [{{name: rock, density: 2650, contact_modulus: 10 GPa, kratio: 3.7, friction: 0.5,
  tensile_strength: 40 MPa, shear_strength: 40 MPa}}]
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.05}}
time: {{end: 1 ms}}
"""


def planned(name, dimension, path, factor, estimate):
    """Share of mass that the program adds."""
    scene = PACKINGS / f"{name.replace(' ', '-')}-free.yaml"
    scene.parent.mkdir(parents=True, exist_ok=True)
    scene.write_text(SCENE.format(dimension=dimension, path=path))
    done = study.call(["plan", str(scene), "--threads", str(study.THREADS), "--set", f"time.estimate={estimate}",
                       "--set", f"time.mass_scaling.factor={factor}", "--set", "time.end=1e-5"])
    if done.returncode:
        sys.exit(f"{name}: {done.stderr}")
    found = re.search(r"= (\S+) % more mass, in (\d+) particles of (\d+), at most (\S+) times", done.stdout)
    if not found:
        return 0.0, 0.0, 1.0, 1.0
    reached = float(re.search(r"mass scaling +\S+ s = (\S+) of", done.stdout).group(1))
    return float(found[1]), 100 * int(found[2]) / int(found[3]), float(found[4]), reached


def digits(value):
    return f"{value:.2g}" if value < 10 else f"{value:.0f}"


def masses_table():
    rows = []
    for name, dimension, path in bodies():
        if name in ("wider", "notched beam", "block"):
            continue
        steps, mass, *_ = local(path, dimension)
        for factor in FACTORS[3:]:
            sharp, with_mass, most, reached = planned(name, dimension, path, factor, "sharp")
            bound, *_ = planned(name, dimension, path, factor, "bound")
            rows.append([name, factor if abs(reached - factor) < 0.002 * factor else f"{factor} ({reached} reached)", digits(sharp),
                         f"{with_mass:.0f}", f"{most:.2f}", digits(bound), digits(100 * share_needed(steps, mass, factor))])
    return study.table(["body", "step x", "sharp: added mass %", "particles %", "largest factor", "bound: added mass %", "by the script's blocks %"], rows)


# --- error ---

def perturbed(name, k):
    """The specimen with coordinates changed by 1e-12 of the largest."""
    path = PACKINGS / f"{name}-{k}.txt"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = np.loadtxt(SPECIMENS / f"{name}.txt")
        rows[:, :3] += 1e-12 * np.abs(rows[:, :3]).max() * np.random.default_rng(k).uniform(-1, 1, rows[:, :3].shape)
        np.savetxt(path, rows, fmt="%.17g")
    return path


def crushed(factor, k, **extra):
    settings = {"specimen.file": str(perturbed("rock-a", k)), "run.threads": 1, **extra}
    if factor != 1:
        settings["time.mass_scaling.factor"] = factor
    slug = "-".join([str(factor), str(k), *(str(v) for v in extra.values())])
    return study.run(f"mass/rock-a-{slug}", study.ROCK, settings)


def readings(r):
    loading = slice(0, int(np.argmax(r.results("history/stress"))) + 1)
    kinetic, elastic = (sum(r.results(f"history/energy_{name}")[loading] for name in names)
                        for names in (("kinetic", "rotational"), ("elastic_normal", "elastic_shear", "elastic_wall")))
    added = r.summary.get("mass_scaling", {}).get("added_share", 0.0)
    share = r.results("history/added_kinetic")[loading] if added else np.zeros(1)
    return [r.peak_stress / 1e6, r.young_modulus_average / 1e9, r.poisson_ratio, 100 * r.peak_strain, *r.broken,
            100 * added, 100 * np.mean(share), 100 * np.median(kinetic[len(kinetic) // 2:] / elastic[len(elastic) // 2:]),
            abs(r.residual), r.summary["steps"]]


def spread(values, form):
    values = np.array(values, dtype=float)
    return form.format(values.mean()) + (" ± " + form.format(values.std(ddof=1)) if len(values) > 1 else "")


def error_table():
    rows, plain = [], None
    for factor, seeds in ((1, 4), (1.1, 2), (1.33, 3), (1.5, 2), (1.67, 2), (2, 3), (3, 2)):
        found = np.array([readings(crushed(factor, k)) for k in range(seeds)])
        forms = ("{:.1f}", "{:.2f}", "{:.3f}", "{:.3f}", "{:.0f}", "{:.0f}")
        rows.append([factor, seeds, *(spread(found[:, c], forms[c]) for c in range(6)), f"{found[0, 6]:.2g}", f"{found[:, 7].mean():.2g}",
                     f"{found[:, 8].mean():.2g}", f"{found[:, 9].max():.0e}", f"{found[:, 10].mean():.0f}", f"{(plain or found[:, 10].mean()) / found[:, 10].mean():.2f} x"])
        plain = plain or found[:, 10].mean()
    return study.table(["step x", "runs", "UCS MPa", "E GPa", "nu", "strain at peak %", "broken in tension", "in shear", "added mass %",
                        "of the kinetic energy %", "kinetic over elastic %", "residual", "steps", "fewer by"], rows)


# --- waves ---

def pulse(factor):
    """The lower platen starts at 0.01 m/s; nothing breaks, nothing is damped."""
    settings = {"run.threads": 1, "damping.background.model": "none", "damping.background.coefficient": 0,
                "walls.bottom.motion.vz": 0.01, "walls.top.motion.vz": 0, "materials.rock.tensile_strength": 1e20,
                "materials.rock.shear_strength": 1e20, "time.end": 30e-6, "time.stop.peak_drop": "off", "output.history_rows": 3000,
                "time.safety": 0.5}
    if factor != 1:
        settings["time.mass_scaling.factor"] = factor
    return study.run(f"mass/wave-{factor}", study.ROCK, settings)


def arrival(r):
    """When the upper platen first carries half of the first maximum, s."""
    time, stress = r.results("history/time"), r.results("history/stress_upper")
    falls = np.flatnonzero((stress[1:-1] >= stress[:-2]) & (stress[1:-1] > stress[2:]) & (stress[1:-1] > 0.3 * stress.max()))
    first = stress[1 + falls[0]] if len(falls) else stress.max()
    at = int(np.argmax(stress >= 0.5 * first))
    return time[at - 1] + (0.5 * first - stress[at - 1]) / (stress[at] - stress[at - 1]) * (time[at] - time[at - 1])


def wave_table():
    rows, plain = [], arrival(pulse(1))
    for factor in FACTORS:
        r = pulse(factor)
        added = r.summary.get("mass_scaling", {}).get("added_share", 0.0)
        rows.append([factor, f"{100*added:.2g}", f"{1e6*arrival(r):.3f}", f"{arrival(r)/plain:.4f}", f"{np.sqrt(1 + added):.4f}"])
    return study.table(["step x", "added mass %", "arrival us", "over that without", "sqrt(1 + added share)"], rows)


# --- steps of several lengths ---

def several_table():
    rows = []
    for name, dimension, path in bodies():
        steps, mass, i, j = local(path, dimension)
        least = steps.min()
        power = np.floor(np.log2(np.minimum(steps[i], steps[j]) / least))
        gain = len(i) / np.sum(2.0**-power)
        cells = [f"{100*np.mean(power >= k):.0f}" for k in (1, 2, 3)]
        wanted = []
        for share in (0.01, 0.05):
            low, high = 1.0, 100.0
            while high - low > 1e-3:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if share_needed(steps, mass, middle) <= share else (low, middle)
            wanted.append(low)
        # First masses are raised, then several steps are used for the remaining particles.
        raised = np.maximum(steps, wanted[1] * least)
        left = np.floor(np.log2(np.minimum(raised[i], raised[j]) / raised.min()))
        rows.append([name, len(steps), f"{np.median(steps)/least:.2f}", *cells, f"{gain:.2f}", f"{wanted[0]:.2f}", f"{wanted[1]:.2f}",
                     f"{len(i) / np.sum(2.0**-left):.2f}"])
    return study.table(["body", "particles", "median step over the least", "contacts at 2 x % or more", "4 x", "8 x", "several lengths gain",
                        "1 % more mass gives", "5 %", "several lengths beside these 5 %"], rows)


def coupled_table():
    """Elements with a step of their own beside particles: from the sharp limits that `gneiss plan` prints of either by itself. A contact and
    an element cost about as much (docs/performance.md)."""
    rows = []
    for scene in ("bending-coupled", "wave-zone"):
        done = study.call(["plan", f"scenes/{scene}.yaml", "--threads", "1"])
        if done.returncode:
            sys.exit(f"{scene}: {done.stderr}")
        particles, elements = (float(re.search(rf"^  {part}\n  sharp limit +(\S+) s", done.stdout, re.M)[1]) for part in ("particles", "elements"))
        contacts, cells = (int(re.search(rf"^  {part} +(\d+) x", done.stdout, re.M)[1]) for part in ("bonds", "elements"))
        longer = 2.0**np.floor(np.log2(elements / particles))
        rows.append([scene, contacts, cells, f"{elements / particles:.2f}", f"{longer:.0f}", f"{(contacts + cells) / (contacts + cells / longer):.2f}",
                     f"{(contacts + cells) / contacts:.2f}"])
    return study.table(["scene", "bonds", "elements", "limit of the elements over that of the particles", "their steps x", "gain",
                        "gain if elements cost nothing"], rows)


SECTIONS = {"masses": masses_table, "error": error_table, "waves": wave_table, "several": several_table, "coupled": coupled_table}


def main():
    only = sys.argv[sys.argv.index("--only") + 1] if "--only" in sys.argv else None
    for name, make in SECTIONS.items():
        if only in (None, name):
            text = make()
            print(f"{name}\n{text}\n")
            study.put("mass-scaling.md", f"table {name}", text)


if __name__ == "__main__":
    main()
