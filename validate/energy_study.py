"""Residual of the energy ledger of uniaxial compression, its causes, and the effect of the platens' speed on the strength. Fills tables of
docs/evidence/models.md; about fifteen minutes of one core.

    /usr/bin/python3 validate/energy_study.py [--fresh]
"""
import numpy as np

import study

SPECIMENS = {"rock-a": [0.2, 0.4], "rock-b": [0.05, 0.1, 0.2, 0.4], "rock-c": [0.2, 0.4]}
SAFETIES = {"rock-a": [0.45, 0.9], "rock-b": [0.225, 0.45, 0.9, 0.95], "rock-c": [0.45, 0.9]}
UNBREAKABLE = {"materials.0.tensile_strength": 1e20, "materials.0.shear_strength": 1e20}


def compress(name, specimen, total, safety, **extra):
    settings = {"specimen.file": f"specimens/{specimen}.txt", "time.safety": safety, **study.closing(total), **extra}
    return study.run(f"energy/{specimen}-{name}", study.ROCK, settings)


def cases():
    for specimen, speeds in SPECIMENS.items():
        for total in speeds:
            for safety in SAFETIES[specimen] if total == 0.2 else [0.9]:
                yield specimen, total, safety


def residual_table():
    rows, end, worst = [], [], []
    for specimen, total, safety in cases():
        r = compress(f"{total}-{safety}", specimen, total, safety)
        end.append(abs(r.residual))
        worst.append(r.worst_residual)
        rows.append([specimen, total, safety, r.summary["steps"], f"{r.residual:.1e}", f"{r.worst_residual:.1e}"])
    text = study.table(["specimen", "closing m/s", "safety", "steps", "residual at the end", "largest on the way"], rows)
    text += (f"\n\nOver the {len(end)} runs: at the end between {min(end):.1e} and {max(end):.1e} in size, median "
             f"{np.median(end):.1e}; the largest of any run at any time {max(worst):.1e}, median {np.median(worst):.1e}.")
    return text


def source_table():
    """Each run switches off one feature; rock-b, closing at 0.2 m/s."""
    cases = [("as it is, to half the peak", None), ("no friction, to half the peak", None),
             ("as it is, to 1 % strain", {}), ("bonds never break", UNBREAKABLE),
             ("bonds never break, no spin", {**UNBREAKABLE, "law.rotation": "off"}),
             ("bonds never break, no tangential springs", {**UNBREAKABLE, "materials.0.kratio": 0, "materials.0.friction": 0}),
             ("bonds never break, no damping", {**UNBREAKABLE, "damping.background.coefficient": 0})]
    rows = []
    for text, extra in cases:
        cells = []
        for safety in (0.225, 0.45, 0.9):
            slug = "".join(c if c.isalnum() else "-" for c in text)
            if extra is None:
                more = {"materials.0.friction": 0} if text.startswith("no friction") else {}
            else:
                more = {"time.stop.strain": 0.01, **extra}
            r = compress(f"source-{slug}-{safety}", "rock-b", 0.2, safety, **more)
            cells.append(f"{r.residual:.2e}")
        rows.append([text, *cells])
    return study.table(["rock-b", "safety 0.225", "0.45", "0.9"], rows)


def velocity_table():
    rows = []
    slow = compress("0.05-0.9", "rock-b", 0.05, 0.9)
    for total in SPECIMENS["rock-b"]:
        r = compress(f"{total}-0.9", "rock-b", total, 0.9)
        tension, shear = r.broken
        lower, upper = r.results("history/stress_lower"), r.results("history/stress_upper")
        stress = r.results("history/stress")
        loading = slice(0, int(np.argmax(stress)) + 1)
        apart = np.sqrt(np.mean((lower[loading] - upper[loading])**2)) / r.peak_stress
        rows.append([total, f"{total/0.046:.1f}", f"{r.peak_stress/1e6:.1f}", f"{r.peak_stress/slow.peak_stress:.3f}",
                     f"{r.young_modulus/1e9:.2f}", f"{r.poisson_ratio:.3f}", f"{100*r.peak_strain:.2f}", tension, shear,
                     f"{100*apart:.1f}", r.summary["steps"]])
    return study.table(["closing m/s", "strain rate 1/s", "UCS MPa", "over the slowest", "E GPa", "nu", "strain at peak %",
                        "broken in tension", "in shear", "ends differ by % of peak (rms)", "steps"], rows)


def main():
    study.put("models.md", "table velocity", velocity_table())
    study.put("models.md", "table sources", source_table())
    study.put("models.md", "table residual", residual_table())


if __name__ == "__main__":
    main()
