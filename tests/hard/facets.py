"""Particles on triangles: edges, vertices, folds, needles, and which side is which."""
from hard.case import *  # noqa: F403

WEIGHT = 10.0  # m/s2
K = 1e4
SINK = sphere_mass(1e-3) * WEIGHT / K


def body(name, file, **changes):
    return {"name": name, "surface": file, "stiffness": K, **changes}


def plate_of(corners_at, nx, ny):
    """Triangles over a grid of points."""
    at = [[corners_at(i, j) for j in range(ny + 1)] for i in range(nx + 1)]
    for i in range(nx):
        for j in range(ny):
            a, b, c, d = at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]
            yield (a, b, c)
            yield (a, c, d)


def sliding(start, velocity, triangles, **changes):
    """A sphere that slides over a plate at constant height; the distance does not depend on the facets below it."""
    def scene(folder):
        stl(folder, "plate.stl", triangles)
        made = spheres([[*start, 1e-3 - SINK, 1e-3]], 0.02, {"normal_stiffness": K, "kratio": 0, "friction": 0},
                       gravity=[0, 0, -WEIGHT], bodies=[body("plate", "plate.stl")], sets=[launched("ball", [0], [*velocity, 0])],
                       domain={"min": [-1] * 3, "max": [1] * 3})
        made.update(changes)
        return made
    return scene


def slides_as_on_a_plane(speed):
    """Height and speed are conserved; the deepest overlap is 3e-8 m, and rounding of a centre about 1e-18 m."""
    def check(one):
        v, x = one.field("particles/velocity")[0], one.field("particles/position")[0]
        assert abs(np.linalg.norm(v[:2]) / speed - 1) < 1e-9, v
        assert abs(x[2] - (1e-3 - SINK)) < 1e-3 * SINK, x[2] - (1e-3 - SINK)
        f = one.history["body_plate_force_z"][1:]
        off = np.abs(f / (-sphere_mass(1e-3) * WEIGHT) - 1).max()
        assert off < 1e-3, f"the force departs from the weight by {off:.2g}"
        return f"speed within {abs(np.linalg.norm(v[:2]) / speed - 1):.0e}, force within {off:.0e} of the weight"
    return check


def flat(size=1e-3, n=12):
    return list(plate_of(lambda i, j: (size * i, size * j, 0), n, n))


def needles():
    """Strips of a plate: triangles 12 mm long and 1e-3 to 1e-9 mm wide, some without any area, and the remainder of the plate."""
    edge, cuts = 12e-3, [0, 3e-3, 3e-3 + 1e-6, 3e-3 + 1.1e-6, 3e-3 + 1.1e-6 + 1e-9, 6e-3, 6e-3 + 1e-12, 9e-3, 12e-3]
    made = list(plate_of(lambda i, j: (cuts[i], edge * j, 0), len(cuts) - 1, 1))
    return [*made, ((3e-3, 0, 0), (3e-3, 6e-3, 0), (3e-3, 12e-3, 0)), ((6e-3, 1e-3, 0), (6e-3, 1e-3, 0), (6e-3, 2e-3, 0))]


def over_a_vertex(folder):
    """A sphere falls on the tip of a pyramid, exactly."""
    tip, base = (0, 0, 0), [(2e-3, 0, -2e-3), (0, 2e-3, -2e-3), (-2e-3, 0, -2e-3), (0, -2e-3, -2e-3)]
    stl(folder, "tip.stl", [(tip, base[k], base[(k + 1) % 4]) for k in range(4)])
    return spheres([[0, 0, 1.1e-3, 1e-3]], 0.05, {"normal_stiffness": K, "kratio": 0, "friction": 0}, gravity=[0, 0, -WEIGHT],
                   bodies=[body("tip", "tip.stl")])


def stays_above(one):
    x = one.field("particles/position")[0]
    assert abs(x[0]) < 1e-12 and abs(x[1]) < 1e-12, x
    assert one.residual < 0.01, one.residual
    return f"{max(abs(x[0]), abs(x[1])):.0e} m aside, residual {one.residual:.0e}"


def corner_of_segments(folder):
    """A disc slides at 0.1 m/s off a table whose edge is a corner of 90 degrees; it falls."""
    k = math.pi * 1e-6 * DENSITY * WEIGHT
    return spheres([[0, 1e-3 - k / 1e6, 1e-3]], 0.03, {"kratio": 0, "friction": 0}, gravity=[0, -WEIGHT],
                   sets=[launched("disc", [0], [0.3, 0])], domain={"min": [-1, -1], "max": [1, 1]},
                   bodies=[{"name": "table", "polyline": [[-0.01, 0], [1e-3, 0], [2e-3, 0], [2e-3, -0.02]],
                            "stiffness": 1e6}])


def falls_off(one):
    """The elastic energy at the start, 1/2 (m g)^2/k, is negligible: the energy is that of the fall."""
    v, d = one.field("particles/velocity")[0], one.field("particles/displacement")[0]
    v = v + np.array([0, -WEIGHT, 0]) * 0.5 * one.summary["time"] / one.summary["steps"]
    rows, weight = one.history, math.pi * 1e-6 * DENSITY * WEIGHT
    on = (rows["time"] > 0) & (rows["time"] < 2e-3 / 0.3)  # rows before its centre is beyond the corner
    jump = np.abs(rows["body_table_force_y"][on] / -weight - 1).max()
    assert jump < 1e-3, f"on the table the force departs from the weight by {jump:.2g}"
    off = abs(0.5 * (v @ v) - 0.045 + WEIGHT * d[1]) / 0.045
    assert d[1] < -1e-3 and off < 0.01, (d, off)
    return f"{-d[1] * 1e3:.2f} mm down, energy within {off:.0e}, residual {one.residual:.0e}"


def groove(angle):
    """A disc falls into a groove of two segments, each sloping by half of the angle."""
    def scene(folder):
        slope = math.tan(angle / 2)
        made = spheres([[0, 1e-3 / math.cos(angle / 2) + 1e-5, 1e-3]], 1e-3, {"kratio": 0, "friction": 0},
                       sets=[launched("disc", [0], [0, -0.1])],
                       bodies=[{"name": "groove", "polyline": [[-0.02, 0.02 * slope], [0, 0], [0.02, 0.02 * slope]],
                                "stiffness": 1e6}])
        made["output"]["history_rows"] = 1000
        return made
    return scene


def comes_back(angle):
    """On a spring of 2 k cos^2(a/2)/(1 + f), f = (1 + 4 x)(1 - x)^4 with x = a/0.6, the largest force is v sqrt(m k);
    steps of y/w resolve at least 1 - y^2/8 of it, with y up to 0.4. The speed is conserved to y^4/80 for the step
    that resolves the contact with one face in ten steps."""
    def check(one):
        x = min(angle / 0.6, 1)
        stiffness = 1e6 * 2 * math.cos(angle / 2)**2 / (1 + (1 + 4 * x) * (1 - x)**4)
        v, wanted = one.field("particles/velocity")[0, 1], 0.1 * math.sqrt(math.pi * 1e-6 * DENSITY * stiffness)
        found = np.abs(one.history["body_groove_force_y"]).max()
        assert abs(v / 0.1 - 1) < 2.8 * 1.2e-4, v
        return f"{v / 0.1:.5f} of the speed, " + close(found, wanted, 0.02, "N at most")
    return check


def thin_plate(folder):
    """A plate of 1e-7 m, thinner than the overlaps, between two spheres that press from both sides."""
    return spheres([[0, 0, 1.01e-3, 1e-3], [0, 0, -1.01e-3 - 1e-7, 1e-3]], 2e-3, {"normal_stiffness": K, "kratio": 0},
                   sets=[launched("upper", [0], [0, 0, -0.1]), launched("lower", [1], [0, 0, 0.1])],
                   bodies=[{"name": "plate", "box": {"size": [0.02, 0.02, 1e-7]}, "origin": [-0.01, -0.01, -1e-7],
                            "stiffness": K}])


def both_rebound(one):
    v, x = one.field("particles/velocity")[:, 2], one.field("particles/position")[:, 2]
    assert x[0] > 1e-3 and x[1] < -1e-3 and np.abs(np.abs(v) - 0.1).max() < 1e-3 * 0.1, (x, v)
    return f"{v[0]:.5f} and {v[1]:.5f} m/s"


TILT = 0.3


def rolling(folder):
    """A ball rolls, without sliding, down a plate of triangles in tilted gravity."""
    stl(folder, "plate.stl", flat())
    return spheres([[1.3e-3, 2.2e-3, 1e-3 - SINK, 1e-3]], 0.05, {"normal_stiffness": K},
                   gravity=[WEIGHT * math.tan(TILT), 0.3 * WEIGHT * math.tan(TILT), -WEIGHT],
                   bodies=[body("plate", "plate.stl", kratio=2, friction=0.5)], domain={"min": [-1] * 3, "max": [1] * 3})


def rolls(one):
    """5/7 of the acceleration, and friction does no work. The contact's spring starts without a force and oscillates
    permanently, by (2/7 m g)^2/k_t: 1e-4 of the energy."""
    t, d = one.summary["time"], one.field("particles/displacement")[0]
    words = close(d[0], 0.5 * 5 / 7 * WEIGHT * math.tan(TILT) * t * t, 2e-3, "m of path")
    lost = one.history["energy_friction"][-1] / one.history["energy_work_gravity"][-1]
    assert lost < 1e-6, f"{lost:.2g} of the energy went into friction"
    return words + f", {lost:.0e} of the energy to friction"


def centre_on_a_facet(folder):
    stl(folder, "plate.stl", flat())
    return spheres([[3.5e-3, 3.5e-3, 0, 1e-3]], 1e-3, bodies=[body("plate", "plate.stl")])


SUPPRESSED = "a face that comes nearer suppresses the edges and corners that it shares"
CASES = [
    Case("a sphere over the edges of triangles", "a plate of 288 facets; nothing but its normal may press",
         "it slides as on a plane", sliding((1.3e-3, 2.2e-3), (0.3, 0.11), flat()),
         slides_as_on_a_plane(math.hypot(0.3, 0.11)), SUPPRESSED,
         "without that and sharing: lifted at each edge, 8e-5 m/s up and down", more="test_surfaces.c"),
    Case("a sphere over the vertices of triangles", "along a diagonal of the same plate, through vertices to rounding",
         "it slides as on a plane", sliding((1e-3, 1e-3), (0.3, 0.3), flat()), slides_as_on_a_plane(0.3 * math.sqrt(2)),
         SUPPRESSED, "without that and sharing: lifted at each vertex, 3e-4 m/s up and down"),
    Case("a sphere over needles", "facets of 12 mm by 1e-12 to 1e-6 m, and some without an area",
         "it slides as on a plane", sliding((1e-3, 5.2e-3), (0.4, 0.01), needles()),
         slides_as_on_a_plane(math.hypot(0.4, 0.01)),
         "a face that comes nearer suppresses the edges and corners that it shares",
         "without that and sharing: lifted, 3e-4 m/s up and down. (Facets without an area may as well stay.)"),
    Case("a sphere on the tip of a pyramid", "four faces, four edges and a corner at one point",
         "it bounces straight up and down", over_a_vertex, stays_above,
         "the step resolves the shortest collision of what is loose", "a stable step alone: ledger off by 0.33, stopped"),
    Case("a disc that slides off a table", "round a corner of 90 degrees",
         "the normal turns without a jump, the energy stays", corner_of_segments, falls_off, SUPPRESSED,
         "without that and sharing: at a joint the force is off by 0.8 of the weight"),
    *[Case(f"a disc in a groove of {angle} rad", "two faces, or one that is bent", "it comes back with its speed",
           groove(angle), comes_back(angle), "contacts of nearly the same normal share the stiffness by a potential",
           without, more="test_grooves.c") for angle, without in (
        (1e-3, "each face by itself: 12.8 N instead of 8.9"), (0.1, "each face by itself: 12.8 N instead of 9.3"),
        (0.3, "each face by itself: 12.7 N instead of 11.4"))],
    Case("a plate thinner than the overlaps", "pressed from both sides", "both rebound with their speed", thin_plate,
         both_rebound, "equal normals act as the deepest of them; each sphere has its own",
         "every face by itself: speeds off by 2e-3"),
    Case("a ball that rolls over triangles", "what its contact holds goes from facet to facet",
         "5/7 of the acceleration, no energy to friction", rolling, rolls,
         "contacts take over the shear force of the contact whose normal agrees best",
         "shear forces forgotten: 1e-3 of the energy into friction; edges not suppressed and not shared: 1e-4"),
    Case("a centre on a facet", "its side of the facet is undefined", "refused, the particle and the body named",
         centre_on_a_facet, refuses("particle 0: centre on the surface of body 'plate'"),
         "centres are held against facets when lists are made",
         "runs into a stiffness that is not a number, and says so", ends=2),
]
