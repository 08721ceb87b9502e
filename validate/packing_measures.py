"""Figures of packings, from rows x y z r in metres, from any program; and bodies whose surface is examined."""
import numpy as np

DIAMETER, HEIGHT = 23e-3, 46e-3
BLOCK = np.array([40e-3, 40e-3, 30e-3])
BEAM = np.array([[0, 0], [78, 0], [80, 10], [82, 0], [160, 0], [160, 40], [0, 40]], float)  # mm
BEAM_WIDTH = 40.0
BEAM_CAP = [(0, 1, 6), (1, 2, 6), (2, 5, 6), (2, 3, 5), (3, 4, 5)]


def candidates(a, b, reach):
    """Index pairs (into a, into b), among them all that are within `reach` of each other, by cells of that side."""
    low = np.minimum(a.min(0), b.min(0))
    cell_a, cell_b = ((x - low) // reach for x in (a, b))
    cell_a, cell_b = cell_a.astype(np.int64) + 1, cell_b.astype(np.int64) + 1
    size = np.maximum(cell_a.max(0), cell_b.max(0)) + 2

    def key(cell):
        return (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]

    order = np.argsort(key(cell_b), kind="stable")
    sorted_keys = key(cell_b)[order]
    first, second = [], []
    for shift in np.ndindex(3, 3, 3):
        wanted = key(cell_a + np.array(shift) - 1)
        begin, end = np.searchsorted(sorted_keys, wanted), np.searchsorted(sorted_keys, wanted, "right")
        count = end - begin
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        first.append(np.repeat(np.arange(len(a)), count))
        second.append(order[np.repeat(begin, count) + place])
    return np.concatenate(first), np.concatenate(second)


def pairs_within(rows, gap):
    """i < j and (distance - r_i - r_j)/(r_i + r_j), for those up to `gap`."""
    x, r = rows[:, :3], rows[:, 3]
    i, j = candidates(x, x, 2 * r.max() * (1 + gap))
    i, j = i[i < j], j[i < j]
    reach = r[i] + r[j]
    relative = np.linalg.norm(x[i] - x[j], axis=1) / reach - 1
    near = relative <= gap
    return i[near], j[near], relative[near]


def in_cylinder(x, inset):
    return ((np.hypot(x[:, 0], x[:, 1]) < DIAMETER / 2 - inset) & (x[:, 2] > inset) & (x[:, 2] < HEIGHT - inset))


def core_porosity(rows, inset, count=200000):
    """Share of random points of the inner cylinder that no sphere covers: free of the walls' effect, and spheres
    that overlap count once. Standard error 0.1 %."""
    draw = np.random.default_rng(1)
    points = draw.uniform(-0.5, 0.5, (2 * count, 3)) * [DIAMETER, DIAMETER, HEIGHT] + [0, 0, HEIGHT / 2]
    points = points[in_cylinder(points, inset)]
    covered = np.zeros(len(points), bool)
    i, j = candidates(points, rows[:, :3], rows[:, 3].max())
    inside = np.sum((points[i] - rows[j, :3]) ** 2, axis=1) < rows[j, 3] ** 2
    covered[i[inside]] = True
    return 1 - covered.mean()


def fabric(x, i, j):
    """Largest deviation of an eigenvalue of the mean of n n from 1/3, times 3; and the eigenvalues."""
    normal = x[j] - x[i]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    eigen = np.linalg.eigvalsh(normal.T @ normal / len(normal))
    return np.max(np.abs(3 * eigen - 1)), eigen


def measure(path):
    """The figures of a packing of the cylinder. Porosity is over the cylinder's volume."""
    rows = np.loadtxt(path, ndmin=2)
    x, r = rows[:, :3], rows[:, 3]
    volume = np.pi * DIAMETER ** 2 / 4 * HEIGHT
    i, j, gap = pairs_within(rows, 0.05)
    anisotropy, eigen = fabric(x, i[gap <= 0.01], j[gap <= 0.01])
    apart = np.linalg.norm(x[i] - x[j], axis=1)
    depth = r[i] + r[j] - apart
    lens = np.pi * depth ** 2 * (apart ** 2 + 2 * apart * (r[i] + r[j]) - 3 * (r[i] - r[j]) ** 2) / (12 * apart)
    overlap = -gap[gap < -1e-9]
    inset = 4 * r.mean()
    core = in_cylinder(x, inset)
    close = np.bincount(np.concatenate([i[gap <= 0.01], j[gap <= 0.01]]), minlength=len(r))
    porosity = 1 - np.sum(4 / 3 * np.pi * r ** 3) / volume
    outside = np.maximum.reduce([np.hypot(x[:, 0], x[:, 1]) + r - DIAMETER / 2, r - x[:, 2], x[:, 2] + r - HEIGHT])
    return {
        "particles": len(r), "porosity": porosity, "porosity_net": porosity + lens[depth > 0].sum() / volume,
        "core_porosity": core_porosity(rows, inset), "coordination_01": 2 * np.sum(gap <= 0.001) / len(r),
        "coordination_1": 2 * np.sum(gap <= 0.01) / len(r), "coordination_5": 2 * len(gap) / len(r),
        "core_coordination_1": close[core].mean(), "few_contacts": np.mean(close < 4),
        "fabric_max": eigen[-1], "fabric_min": eigen[0], "anisotropy": anisotropy,
        "overlap_median": np.median(overlap) if len(overlap) else 0.0, "overlap_max": overlap.max(initial=0.0),
        "overlaps": len(overlap) / len(r), "radius_mean": r.mean(), "radius_ratio": r.max() / r.min(),
        "radius_variation": r.std() / r.mean(), "protrusion": np.max(outside / r),
    }


def layer(rows, depth):
    """For the spheres whose gap to the boundary is below half their radius: their number, the share within 5 % of
    the radius of touching it, and the root mean square gap over the radius."""
    gap = depth / rows[:, 3] - 1
    gap = gap[gap < 0.5]
    return len(gap), np.mean(np.abs(gap) <= 0.05), np.sqrt(np.mean(gap ** 2))


def block_depth(rows):
    return np.minimum(rows[:, :3], BLOCK - rows[:, :3]).min(axis=1)


def beam_depth(rows):
    """Distance to the boundary of the beam, for centres inside it."""
    corners, x = BEAM * 1e-3, rows[:, :2]
    depth = np.minimum(rows[:, 2], BEAM_WIDTH * 1e-3 - rows[:, 2])
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        along = np.clip((x - a) @ (b - a) / np.dot(b - a, b - a), 0, 1)
        depth = np.minimum(depth, np.linalg.norm(x - a - along[:, None] * (b - a), axis=1))
    return depth


def write_beam(path):
    """A notched beam as ASCII STL, in mm."""
    low = np.column_stack([BEAM, np.zeros(len(BEAM))])
    high = low + [0, 0, BEAM_WIDTH]
    faces = [(low[a], low[c], low[b]) for a, b, c in BEAM_CAP] + [(high[a], high[b], high[c]) for a, b, c in BEAM_CAP]
    for k in range(len(BEAM)):
        n = (k + 1) % len(BEAM)
        faces += [(low[k], low[n], high[n]), (low[k], high[n], high[k])]
    with open(path, "w", encoding="utf-8") as out:
        out.write("solid beam\n")
        for face in faces:
            out.write("facet normal 0 0 0\nouter loop\n")
            out.writelines("vertex {:g} {:g} {:g}\n".format(*corner) for corner in face)
            out.write("endloop\nendfacet\n")
        out.write("endsolid beam\n")
