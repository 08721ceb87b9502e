"""Uniaxial compression of discs in plane strain with the parameters of Labra et al. 2012. Fills the table of
docs/evidence/models.md; a few minutes of one core.

    /usr/bin/python3 validate/disc_study.py [--fresh]
"""
import numpy as np

import study

SCENE = "scenes/ucs-discs.yaml"
KN = 10e9
CASES = [("as it is", {}),
         *((f"closing at {v} m/s", {"walls.bottom.motion.vy": v / 2, "walls.top.motion.vy": -v / 2})
           for v in (0.04, 0.02, 0.005)),
         ("bonds over gaps up to 15 %", {"bonds.interaction_range": 0.15}),
         ("k_t/k_n = 0.1", {"materials.0.kratio": 10}),
         ("k_t/k_n = 0.7", {"materials.0.kratio": 1 / 0.7}),
         ("k_t/k_n = 1", {"materials.0.kratio": 1}),
         ("R_t = 5 kN", {"materials.0.bond_shear_limit": 5e3})]


def uniform_strain(r, kt):
    """Plane-strain E and nu along y (true ones) if every disc followed the mean strain."""
    i, j = r.results("bonds/i"), r.results("bonds/j")
    start = (r.results("particles/position") - r.results("particles/displacement"))[:, :2]
    branch = start[j] - start[i]
    length2 = np.sum(branch**2, axis=1)
    n = branch / np.sqrt(length2)[:, None]
    volume = 0.05 * (start[:, 1].max() - start[:, 1].min() + 2 * r.results("particles/radius").mean())
    stiffness = np.zeros((2, 2))
    for a in range(2):
        for b in range(2):
            tangential = (n[:, a]**2 if a == b else 0) - n[:, a]**2 * n[:, b]**2
            stiffness[a, b] = np.sum(length2 / volume * (KN * n[:, a]**2 * n[:, b]**2 + kt * tangential))
    compliance = np.linalg.inv(stiffness)
    apparent_e, apparent_nu = 1 / compliance[1, 1], -compliance[0, 1] / compliance[1, 1]
    nu = apparent_nu / (1 + apparent_nu)
    return apparent_e * (1 - nu**2), nu


def main():
    rows = []
    for k, (text, settings) in enumerate(CASES):
        r = study.run(f"discs/{k}", SCENE, settings)
        e, nu = uniform_strain(r, KN / settings.get("materials.0.kratio", 2.5))
        tension, shear = r.broken
        stress, strain = r.results("history/stress"), r.results("history/strain")
        peak = int(np.argmax(stress))
        past = stress[peak:] <= 0.5 * stress[peak]
        fall = (strain[peak + int(np.argmax(past))] - strain[peak]) / strain[peak] if past.any() else float("nan")
        rows.append([text, f"{2*r.bonds/r.summary['counts']['particles']:.2f}", f"{r.peak_stress/1e6:.3f}",
                     f"{100*r.peak_strain:.4f}", f"{fall:.2f}", f"{r.young_modulus/1e9:.2f}", f"{r.poisson_ratio:.3f}",
                     f"{r.plane_young_modulus/1e9:.2f}", f"{r.plane_poisson_ratio:.3f}", f"{e/1e9:.2f}", f"{nu:.3f}",
                     tension, shear, f"{r.residual:.0e}"])
    study.put("models.md", "table discs", study.table(
        ["discs", "n_c", "UCS MPa", "strain at peak %", "strain to half the peak, over that", "E' GPa", "nu'", "E GPa",
         "nu", "E uniform strain", "nu uniform strain", "broken in tension", "in shear", "energy residual"], rows))


if __name__ == "__main__":
    main()
