"""Particles of a run's results.h5 or of a packing's packing.h5."""
import os

import numpy as np

from calibrate.problem import Problem
from convert.particles import SPINS, VELOCITIES, Particles, from_mass

FILES = ("results.h5", "packing.h5")


def read(folder, options):
    """Particles at the end of a run, or of a packing; removed ones are left out."""
    import h5py  # of this format alone

    path = next((os.path.join(folder, name) for name in FILES if os.path.exists(os.path.join(folder, name))), None)
    if not path:
        raise Problem(f"{folder}: expected a folder with {' or '.join(FILES)}, found none of them")
    particles = Particles()
    try:
        with h5py.File(path, "r") as file:
            particles.dimension = int(file.attrs.get("dimension", 3))
            held = {name: np.array(one) for name, one in file["particles"].items() if isinstance(one, h5py.Dataset)}
    except PermissionError:
        raise Problem(f"{path}: cannot be read: Permission denied", 3) from None
    except (OSError, KeyError, ValueError) as error:
        raise Problem(f"{path}: expected results of gneiss, found something else ({error})", 3) from None
    if "position" not in held or "radius" not in held:
        raise Problem(f"{path}: expected particles with position and radius, found {', '.join(held) or 'none'}")
    stays = held["removed"] == 0 if "removed" in held else np.ones(len(held["radius"]), bool)
    held = {name: values[stays] for name, values in held.items()}
    c = particles.columns
    c.update({a: held["position"][:, k].astype(float) for k, a in enumerate("xyz")})
    c["radius"] = held["radius"].astype(float)
    for name in ("id", "group"):
        if name in held:
            c[name] = held[name]
    if "material" in held:
        c["matId"] = held["material"]
    for name, columns in (("velocity", VELOCITIES), ("spin", SPINS)):
        if name in held:
            c.update({column: held[name][:, k].astype(float) for k, column in enumerate(columns)})
    if "mass" in held:
        from_mass(particles, held["mass"])
    members = held["clump"][held["clump"] >= 0] if "clump" in held else ()
    if len(members):
        particles.dropped.append(f"{len(np.unique(members))} clumps (their {len(members)} members are written as particles that may move apart)")
    if np.any(~stays):
        particles.dropped.append(f"{int(np.sum(~stays))} particles that were removed during the run")
    return particles, lambda row, name, text: f"{path}: {text}"
