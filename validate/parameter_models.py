"""Uniaxial compression with the five parameter models of Rojek et al. 2012, sec. 2, and experiments on why
the numbers differ from the published ones. Fills the tables of docs/evidence/models.md; about half an hour of one
core when nothing is there yet.

    /usr/bin/python3 validate/parameter_models.py [--fresh]
"""
import numpy as np

import study

MODELS = [("arithmetic", "1"), ("harmonic", "2"), ("mean_radius", "3a"), ("mean_arithmetic", "3b"),
          ("mean_harmonic", "3c")]
PUBLISHED = {"arithmetic": (299.91, 20.32, 0.168), "harmonic": (241.38, 20.13, 0.168)}
KRATIO, MODULUS, STRENGTH, AREA = 3.7, 10e9, 40e6, np.pi / 4 * 0.023**2


class Packing:
    """Bond geometry of a finished run, as the laws use it."""

    def __init__(self, result):
        i, j = result.results("bonds/i"), result.results("bonds/j")
        start = result.results("particles/position") - result.results("particles/displacement")
        self.radius = result.results("particles/radius")
        self.ri, self.rj = self.radius[i], self.radius[j]
        branch = start[j] - start[i]
        self.length = np.linalg.norm(branch, axis=1)
        self.normal = branch / self.length[:, None]
        self.coordination = 2 * len(i) / len(self.radius)
        self.volume = AREA * 0.046
        self.end = np.minimum(start[:, 2], 0.046 - start[:, 2])  # distance from the nearer platen

    def law(self, model):
        """Effective radius of the stiffness and squared radius of the strength, per bond."""
        mean, small = 0.5 * (self.ri + self.rj), np.minimum(self.ri, self.rj)
        harmonic = 2 * self.ri * self.rj / (self.ri + self.rj)
        one = np.ones_like(mean)
        return {"arithmetic": (mean, mean**2), "harmonic": (harmonic, small**2),
                "mean_radius": (one * self.radius.mean(), one * (self.radius**2).mean()),
                "mean_arithmetic": (one * mean.mean(), one * (mean**2).mean()),
                "mean_harmonic": (one * harmonic.mean(), one * (small**2).mean())}[model]

    def uniform_strain(self, model):
        """E and nu along z if every particle followed the mean strain (upper bound of the stiffness)."""
        kn = 2 * MODULUS * self.law(model)[0]
        n, weight = self.normal, kn * self.length**2 / self.volume
        stiffness = np.zeros((3, 3))
        for a in range(3):
            for b in range(3):
                tangential = (n[:, a]**2 if a == b else 0) - n[:, a]**2 * n[:, b]**2
                stiffness[a, b] = np.sum(weight * (n[:, a]**2 * n[:, b]**2 + tangential / KRATIO))
        compliance = np.linalg.inv(stiffness)
        return 1 / compliance[2, 2], -0.5 * (compliance[0, 2] + compliance[1, 2]) / compliance[2, 2]


def rock(name):
    return {"specimen.file": f"specimens/{name}.txt"}


def compress(label, specimen, model, **extra):
    settings = {**rock(specimen), "law.stiffness": model, **extra}
    return study.run(f"models/{specimen}-{model}{label}", study.ROCK, settings)


def reading_cells(r):
    tension, shear = r.broken
    return [f"{r.peak_stress/1e6:.1f}", f"{r.young_modulus/1e9:.2f}", f"{r.young_modulus_average/1e9:.2f}",
            f"{r.poisson_ratio:.3f}", f"{100*r.peak_strain:.2f}", tension, shear]


READINGS = ["UCS MPa", "E GPa", "E average GPa", "nu", "strain at peak %", "broken in tension", "in shear"]


def main_table(specimen):
    rows, runs = [], {}
    for model, number in MODELS:
        r = runs[model] = compress("", specimen, model)
        published = PUBLISHED.get(model)
        text = "{} / {} / {}".format(*published) if published else ""
        rows.append([f"{model} ({number})", *reading_cells(r), f"{r.residual:.0e}", r.summary["steps"], text])
    head = ["model", *READINGS, "energy residual", "steps", "published, n_c 11.89"]
    return study.table(head, rows), runs


def ratio_table(all_runs):
    """All results relative to the arithmetic model, beside the values predicted from averages of the packing."""
    rows = []
    for specimen, runs in all_runs.items():
        packing, base = Packing(runs["arithmetic"]), runs["arithmetic"]
        stiff0, strong0 = (np.mean(x) for x in packing.law("arithmetic"))
        bound0 = packing.uniform_strain("arithmetic")[0]
        for model, number in MODELS[1:]:
            r = runs[model]
            stiff, strong = (np.mean(x) for x in packing.law(model))
            rows.append([specimen, f"{model} ({number})", f"{r.peak_stress/base.peak_stress:.3f}",
                         f"{strong/strong0:.3f}", f"{r.young_modulus/base.young_modulus:.3f}",
                         f"{stiff/stiff0:.3f}", f"{packing.uniform_strain(model)[0]/bound0:.3f}"])
    head = ["specimen", "model", "UCS", "mean bond strength", "E", "mean k_n", "E at uniform strain"]
    return study.table(head, rows)


def bound_table(all_runs):
    rows = []
    for specimen, runs in all_runs.items():
        packing = Packing(runs["arithmetic"])
        for model in ("arithmetic", "harmonic"):
            e, nu = packing.uniform_strain(model)
            r = runs[model]
            rows.append([specimen, model, f"{packing.coordination:.2f}", f"{e/1e9:.2f}", f"{nu:.3f}",
                         f"{r.young_modulus_average/1e9:.2f}", f"{r.young_modulus_average/e:.3f}",
                         f"{r.young_modulus/1e9:.2f}"])
    return study.table(["specimen", "model", "n_c", "E uniform strain GPa", "nu uniform strain",
                        "E average GPa", "over the bound", "E platens GPa"], rows)


def experiment_table(specimen, cases):
    rows = []
    for text, model, label, extra in cases:
        r = compress(label, specimen, model, **extra)
        rows.append([text, model, f"{2*r.bonds/r.summary['counts']['particles']:.2f}", *reading_cells(r)])
    return study.table(["rock-" + specimen[-1], "model", "n_c", *READINGS], rows)


def rock_a_experiments():
    cases = []
    for model in ("arithmetic", "harmonic"):
        cases += [
            ("as it is", model, "", {}),
            ("bonds over gaps up to 15 %", model, "-range15", {"bonds.interaction_range": 0.15}),
            ("bonds over gaps up to 29.5 %", model, "-range29", {"bonds.interaction_range": 0.295}),
            ("platen penalty 150 MN/m", model, "-stiff",
             {"walls.bottom.stiffness": 150e6, "walls.top.stiffness": 150e6}),
            ("closing at 0.1 m/s", model, "-slow", study.closing(0.1))]
    cases += [("bonds strained at the start (no passive gaps)", "harmonic", "-active", {"bonds.passive_gaps": "false"})]
    return experiment_table("rock-a", cases)


def supported_subset(name, least):
    """A copy of a specimen without the particles that have fewer than `least` neighbours, again and again
    until all have as many; the path of the file and how many were left out."""
    data = np.loadtxt(study.ROOT / "scenes" / "specimens" / f"{name}.txt")
    total = len(data)
    while True:
        count = np.zeros(len(data), dtype=int)
        for k in range(len(data)):
            gap = np.linalg.norm(data[:, :3] - data[k, :3], axis=1) - 1.05 * (data[:, 3] + data[k, 3])
            count[k] = np.count_nonzero(gap <= 0) - 1
        if count.min() >= least:
            break
        data = data[count >= least]
    path = study.RUNS / "models" / f"{name}-supported.txt"
    path.parent.mkdir(parents=True, exist_ok=True)
    text = "\n".join(" ".join(f"{v:.12e}" for v in row) for row in data)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    return path, total - len(data)


def rock_c_experiments():
    path, removed = supported_subset("rock-c", 4)
    packing = Packing(compress("", "rock-c", "arithmetic"))
    weaker = np.mean(packing.law("harmonic")[1]) / np.mean(packing.law("arithmetic")[1])
    scaled = {"materials.0.tensile_strength": STRENGTH * weaker, "materials.0.shear_strength": STRENGTH * weaker}
    cases = [("as it is", "arithmetic", "", {}), ("as it is", "harmonic", "", {}),
             (f"without {removed} particles with fewer than 4 neighbours", "arithmetic", "-supported",
              {"specimen.file": path}),
             ("the same", "harmonic", "-supported", {"specimen.file": path}),
             (f"sigma_c, tau_c times {weaker:.3f} (mean of r_min^2 over that of rbar^2)", "arithmetic",
              "-scaled", scaled)]
    return experiment_table("rock-c", cases)


def small_contact_table(all_runs):
    """The bonds that break before the peak, in thirds of the bonds, ordered by their smaller radius."""
    rows = []
    for specimen, runs in all_runs.items():
        for model, _ in MODELS:
            r = runs[model]
            packing = Packing(r)
            time = r.results("bonds/broken_time")
            stress, instant = r.results("history/stress"), r.results("history/time")
            peak = instant[np.argmax(stress)]
            early = np.isfinite(time) & (time <= peak)
            order = np.argsort(np.minimum(packing.ri, packing.rj), kind="stable")
            thirds = [early[part].sum() for part in np.array_split(order, 3)]
            share = [f"{100*t/max(early.sum(), 1):.0f}" for t in thirds]
            rows.append([specimen, model, early.sum(), f"{100*early.mean():.1f}", *share])
    return study.table(["specimen", "model", "broken before the peak", "% of bonds", "smallest third %",
                        "middle third %", "largest third %"], rows)


def main():
    all_runs = {}
    for specimen in ("rock-a", "rock-c"):
        text, all_runs[specimen] = main_table(specimen)
        study.put("models.md", f"table {specimen}", text)
    study.put("models.md", "table ratios", ratio_table(all_runs))
    study.put("models.md", "table bound", bound_table(all_runs))
    study.put("models.md", "table small", small_contact_table(all_runs))
    study.put("models.md", "table why a", rock_a_experiments())
    study.put("models.md", "table why c", rock_c_experiments())


if __name__ == "__main__":
    main()
