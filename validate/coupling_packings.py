"""Waves through zones of disordered packings and of bars in space, and the lower bound of the reflection of any zone:
sections of coupling_study.py."""
import numpy as np

import study

LENGTH, HEIGHT, MODULUS, DENSITY, RADIUS = 0.6, 0.01, 24e9, 7800.0, 0.5e-3
CREST, END = 0.12, 205e-6
SPEED = np.sqrt(MODULUS / DENSITY)
BIN = 2e-3  # m: width over which positions and velocities of a packing are averaged


# --- waves that a mesh cannot transmit --------------------------------------------------------------------------

def short_waves(length, side):
    """Parts of the energy of a pulse 1 + cos of `length` in a medium without dispersion: (above the cut-off 2 c/h of the mesh, returned by an abrupt
    end of the mesh), in %. With k = 2 pi kappa/length the energy per kappa is (sin(pi kappa)/(1 - kappa^2))^2/(pi^2/4). A mesh of lumped masses has
    omega h/(2 c) = sin(k h/2) = sin(theta) and the impedance Z = cos(theta) of that of long waves, so that ((1 - Z)/(1 + Z))^2 = tan(theta/2)^4 runs back."""
    kappa = (np.arange(4_000_000) + 0.5) * 1e-4
    density = (np.sin(np.pi * kappa) / (1 - kappa**2)) ** 2 * 1e-4 / (np.pi**2 / 4)
    theta = np.arcsin(np.minimum(np.pi * kappa * side / length, 1))
    above = np.pi * kappa * side / length >= 1
    return 100 * np.sum(density[above]), 100 * np.sum(density * np.tan(theta / 2) ** 4)


# --- scenes -----------------------------------------------------------------------------------------------------

SCENE = """dimension: {dimension}
{specimen}materials: [{{name: m, density: {density}, {stiffness}, friction: 0, {strength}}}]
law: {{stiffness: {law}}}
bonds: {{interaction_range: {reach}, passive_gaps: true}}
{elements}{couple}initial: {{pulse: {{direction: [1, 0{flat}], centre: [{crest}, 0{flat}], length: {length}, size: 1e-6, speed: {speed}}}}}
time: {{end: {end}}}
output: {{history_rows: 40}}
"""


def body_of(space, packed, low, high, height):
    """The particles from x = low, centres of a lattice on both ends, to high."""
    size = f"size: [{high - low}, {height}, {height}]" if space else f"width: {high - low}, height: {height}"
    if packed:
        kind = "box" if space else "rectangle"
        return (f"specimen: {{group: 1, {kind}: {{{size}}}, origin: [{low}, 0{', 0' if space else ''}], mean_radius: {RADIUS}, density_basis: bulk, "
                "packing: {overlap: passive, size_variation: 0.1}}\n")
    cells = [1 + round((high - low) / (2 * RADIUS)), *([round(height / (2 * RADIUS))] * (2 if space else 1))]
    return (f"specimen: {{group: 1, lattice: {{kind: {'cubic' if space else 'square'}, radius: {RADIUS}, cells: {cells}, "
            f"origin: [{low - RADIUS}, 0{', 0' if space else ''}]}}}}\n")


def read_at(length, front=None):
    """Time at which the reflection is measured, s: after 205 us; before the end of particles at `front` while its
    echo has not yet reached the other end of the body, at least 10 mm away."""
    return END if front is None else min(END, (2 * front - CREST - 0.5 * length - 0.01) / SPEED)


def wave_run(name, space, packed, low, high, mesh, modulus, wave, side, constraint="lumped", edge=None, height=HEIGHT, contact=MODULUS, end=END,
             even=False):
    """Particles from low to high (None: none), elements over `mesh` (None: none), in space `even` ones with nodes of
    equal masses, a zone with `edge` = (from, to)."""
    solid = (np.pi / 6 if space else np.pi / 4) if not packed else 1.0
    stiffness = (f"contact_modulus: {contact}, kratio: 1" if packed else
                 f"normal_stiffness: {MODULUS * (2 * RADIUS if space else 1)}, kratio: 4")
    flat = ", 0" if space else ""
    elements = couple = ""
    if mesh:
        kind, across = ("box", f", {height}") if space else ("rectangle", "")
        cells = [round((mesh[1] - mesh[0]) / side), *([max(1, round(height / side))] * (2 if space else 1))]
        shape = (f"{kind}: {{origin: [{mesh[0]}, 0{flat}], size: [{mesh[1] - mesh[0]}, {height}{across}], cells: {cells}"
                 f", diagonals: {'parallel' if even or not space else 'alternating'}}}")
        elements = (f"elements:\n  {shape}\n  materials: [{{young: {modulus}, poisson: 0, density: {DENSITY}}}]\n")
    if edge:
        couple = (f"couple: {{constraint: {constraint}, zones: [{{edges: [{{from: [{edge[0]}, 0{flat}], to: [{edge[1]}, 0{flat}]}}]}}]}}\n")
    specimen = body_of(space, packed, low, high, height) if low is not None else ""
    values = dict(dimension=3 if space else 2, specimen=specimen, density=DENSITY / solid, stiffness=stiffness,
                  strength="tensile_strength: 1e15, shear_strength: 1e15" if packed else "bond_tension_limit: 1e12, bond_shear_limit: 1e12",
                  law="harmonic" if packed else "uniform", reach=0.1 if packed else 0.01, elements=elements, couple=couple, flat=flat, crest=CREST,
                  length=wave, speed=np.sqrt(modulus / DENSITY), end=end)
    text = SCENE.format(**values)
    if low is None:
        text = "\n".join(line for line in text.splitlines() if line.split(":")[0] not in ("materials", "law", "bonds")) + "\n"
    path = study.RUNS / "coupling" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return study.run(f"coupling/{name}", path, {})


# --- readings ---------------------------------------------------------------------------------------------------

def step_of(result):
    import h5py

    with h5py.File(result.folder / "results.h5", "r") as file:
        return float(np.ravel(file.attrs["dt"])[0])


def profile(result, kind):
    """Means over bins along x: positions, displacements half a step earlier, velocities."""
    u, v = result.results(f"{kind}/displacement")[:, 0], result.results(f"{kind}/velocity")[:, 0]
    x = result.results(f"{kind}/position")[:, 0] - u
    u = u - 0.5 * step_of(result) * v
    which = np.floor(x / BIN).astype(int)
    which -= which.min()
    count = np.bincount(which)
    there = count > 0
    return tuple(np.bincount(which, of)[there] / count[there] for of in (x, u, v))


def before_zone(result, kind, modulus, end, forward=False, area=HEIGHT):
    """Energy of the waves along -x (or x) at positions before `end`, J."""
    x, u, v = profile(result, kind)
    speed, strain = np.sqrt(modulus / DENSITY), np.diff(u) / np.diff(x)
    wave = 0.5 * (0.5 * (v[1:] + v[:-1]) + (-speed if forward else speed) * strain)
    return np.sum((DENSITY * area * np.diff(x) * wave**2)[x[1:] <= end])


def coherent(result, wave, area):
    """The part of the wave along -x in a packing that has the shape of the pulse, anywhere within 60 mm of where an echo of the middle would be, J."""
    x, u, v = profile(result, "particles")
    middle, size = 0.5 * (x[1:] + x[:-1]), np.diff(x)
    back, best = 0.5 * (0.5 * (v[1:] + v[:-1]) + SPEED * np.diff(u) / size), 0.0
    echo = 2 * (LENGTH / 2) - CREST - SPEED * END
    for centre in np.arange(max(echo - 0.06, wave / 2), echo + 0.06, 1e-3):
        shape = np.where(np.abs(middle - centre) < wave / 2, np.sin(2 * np.pi * (middle - centre) / wave), 0)
        best = max(best, np.sum(size * shape * back) ** 2 / np.sum(size * shape**2))
    return DENSITY * area * best


def stored(result):
    total = 0.0
    for name in ("kinetic", "elastic_normal", "elastic_tangential", "elastic_elements"):
        try:
            total += result.results(f"history/energy_{name}")[0]
        except KeyError:
            pass
    return total


def contact_modulus(space, height):
    """The contact modulus for which a packing has the modulus M = rho c^2, from the speed of a pulse in a strip of
    particles only; M grows with it. Returns the last run as well."""
    contact, early = MODULUS, 1.2e-4
    for number in range(3):
        name = f"packed-alone-{3 if space else 2}d-{number}"
        result = wave_run(name, space, True, 0.0, LENGTH, None, MODULUS, 0.06, 5e-3, height=height, contact=contact, end=END if number == 2 else early)
        if number < 2:
            x, u, v = profile(result, "particles")
            weight = np.where(x > 0.18, v**2, 0)
            contact *= MODULUS / (DENSITY * ((np.sum(weight * x) / np.sum(weight) - CREST) / early) ** 2)
    return contact, result


def through_zone(space, packed, width, wave, side, contact, back, height, constraint="lumped", even=False):
    half, middle = width / 2, LENGTH / 2
    name = f"{'packed' if packed else 'bar'}-{3 if space else 2}d-{constraint}-{round(1e3 * width)}-{round(1e3 * wave)}-{side * 1e3:g}-{'back' if back else 'forth'}"
    name += "-even" if even else ""
    reach = RADIUS if packed else 0.0  # outermost centres of a packing lie a radius inside
    if back:
        low, high, mesh, edge = 0.0, middle + half + reach, (middle - half, LENGTH), (middle - half, middle + half)
    else:
        low, high, mesh, edge = middle - half - reach, LENGTH, (0.0, middle + half), (middle + half, middle - half)
    end = read_at(wave, middle - half) if back and not packed else END
    result = wave_run(name, space, packed, low, high, mesh, MODULUS, wave, side, constraint, edge, height, contact, end, even)
    area = height * (height if space else 1.0)
    if not back:
        return 100 * result.returned_energy
    if packed:
        return 100 * coherent(result, wave, area) / stored(result)
    return 100 * before_zone(result, "particles", MODULUS, middle - half, area=area) / stored(result)


# --- tables -----------------------------------------------------------------------------------------------------

def packing_table():
    rows = []
    for space, height, even in ((False, HEIGHT, False), (True, 4e-3, False), (True, 4e-3, True)):
        contact, alone = contact_modulus(space, height)
        area = height * (height if space else 1.0)
        for back in (False, True):
            for wave, side in ((0.06, 5e-3), (0.12, 5e-3)):
                cells = [f"{through_zone(space, True, width, wave, side, contact, back, height, even=even):.3f}" for width in (0.02, 0.04, 0.08)]
                floor = coherent(alone, wave, area) if back else before_zone(alone, "particles", MODULUS, 0.26, area=area)
                name = f"3D, {'six' if even else 'five'} tetrahedra a cell" if space else "2D"
                rows.append([name, "particles to elements" if back else "elements to particles", round(1e3 * wave), round(1e3 * side), *cells,
                             f"{100 * floor / stored(alone):.3f}" if back or wave == 0.06 else ""])
    return study.table(["packing", "direction", "wave, mm", "h, mm", "L 20", "L 40", "L 80", "packing alone"], rows)


def mesh_alone(wave, side, height, even):
    """Reflected energy in a bar of elements only, measured in the same way, in %."""
    name = f"bar-mesh-{round(1e3 * wave)}-{side * 1e3:g}{'-even' if even else ''}"
    result = wave_run(name, True, False, None, None, (0.0, LENGTH), MODULUS, wave, side, height=height, even=even)
    return 100 * before_zone(result, "nodes", MODULUS, 0.26, area=height**2) / stored(result)


def bar_table():
    rows, height = [], 4e-3
    for back in (False, True):
        for even, constraint in ((False, "lumped"), (False, "consistent"), (True, "lumped"), (True, "consistent")):
            for wave, side in ((0.06, 4e-3), (0.12, 4e-3), (0.06, 2e-3)):
                cells = [f"{through_zone(True, False, width, wave, side, MODULUS, back, height, constraint, even):.3f}" for width in (0.016, 0.04, 0.08)]
                rows.append(["particles to elements" if back else "elements to particles", "6" if even else "5", constraint, round(1e3 * wave),
                             round(1e3 * side), *cells, "" if back else f"{mesh_alone(wave, side, height, even):.3f}"])
    return study.table(["direction", "tetrahedra a cell", "constraint", "wave, mm", "h, mm", "L 16", "L 40", "L 80", "mesh alone"], rows)


def short_table(measured):
    """`measured`(width, wave, side, constraint): reflection of a zone into a square lattice, in %."""
    rows = []
    for wave, side in ((30, 5), (60, 5), (120, 5), (60, 2.5)):
        above, abrupt = short_waves(wave, side)
        rows.append([wave, side, f"{above:.3f}", f"{abrupt:.3f}", *(f"{measured(width, wave, side, 'lumped'):.3f}" for width in (10, 20, 40))])
    return study.table(["wave, mm", "h, mm", "above the cut-off", "abrupt end of the mesh", "lumped, L 10", "L 20", "L 40"], rows)
