"""Masses, sizes and stiffnesses of very different magnitude in one scene."""
from hard.case import *  # noqa: F403


def collision(speed_light, heavy_speed, ratio):
    """Velocities after an elastic collision, of the light one and of one `ratio` times as heavy."""
    common = (speed_light + ratio * heavy_speed) / (1 + ratio)
    return 2 * common - speed_light, 2 * common - heavy_speed


def light_and_heavy(folder):
    scene = spheres([[0, 0, 0, 1e-3], [2.1e-3, 0, 0, 1e-3]], 3e-4, {"density": 1.0, "kratio": 0})
    add_material(scene, name="heavy", density=1e9, kratio=0)
    scene["sets"] = [launched("light", [0], [1, 0, 0]), {"name": "other", "select": {"ids": [1]}, "material": "heavy"}]
    return scene


def rebounds(light, ratio, allowed):
    """Checks the speeds of particle `light`, launched at 1 m/s, and of the other one."""
    def check(one):
        v = one.field("particles/velocity")[:, 0]
        wanted = collision(1.0, 0.0, ratio)
        assert abs(v[light] - wanted[0]) < allowed, f"{v[light]:.6g} m/s, expected {wanted[0]:.6g}"
        assert abs(v[1 - light] / wanted[1] - 1) < allowed, f"{v[1 - light]:.6g} m/s, expected {wanted[1]:.6g}"
        return f"{v[light]:.6f} m/s ({wanted[0]:.6f}), the other {v[1 - light]:.4g} m/s ({wanted[1]:.4g})"
    return check


def small_and_large(folder):
    """The small particle does not set any scale that both share."""
    small, large = 1e-6, 1e-2
    return spheres([[0, 0, 0, small], [large + 1.1 * small, 0, 0, large]], 1e-6,
                   {"contact_modulus": 1e8, "normal_stiffness": "none", "kratio": 0}, law={"stiffness": "harmonic"},
                   sets=[launched("small", [0], [1, 0, 0])])


def settles_on_a_large_one(folder):
    """A large particle on a floor, on which two of a hundredth of its radius fall."""
    return spheres([[0, 0, 0, 0.1], [0, 0, 0.1012, 1e-3], [2e-3, 0, 0.1013, 1e-3]], 0.02, gravity=[0, 0, -9.81],
                   walls=[wall("floor", [0, 0, -0.1], [0, 0, 1])], damping={"contact": {"restitution": 0.5}})


def stay_outside(one):
    position = one.field("particles/position")
    gaps = np.linalg.norm(position[1:] - position[0], axis=1) - 0.101
    assert np.all(gaps > -1e-4), f"the small ones sank into the large one: {gaps}"
    assert gaps[0] < 0.19e-3, f"the small one did not fall: {gaps}"
    return f"gaps of {gaps[0] * 1e6:.2g} and {gaps[1] * 1e6:.2g} micrometres, {one.summary['steps']} steps"


def soft_between_plates(folder):
    """A loose sphere of 1 N/m bounces between plates of 1e6 N/m."""
    return spheres([[0, 0, 0, 1e-3], [2.2e-3, 0, 0, 1e-3]], 2e-2, {"normal_stiffness": 1.0, "kratio": 0},
                   sets=[launched("a", [0], [0.1, 0, 0])],
                   walls=[wall("left", [-1.1e-3, 0, 0], [1, 0, 0]), wall("right", [3.3e-3, 0, 0], [-1, 0, 0])])


def bonded_between_platens(folder):
    """Three spheres of 1 N/m, bonded, between passive platens of 1e6 N/m that close."""
    return spheres([[0, 0, 2e-3 * k, 1e-3] for k in range(3)], 0.05, {"normal_stiffness": 1.0, "kratio": 0, **STRONG}, bonds={},
                   damping={"background": {"model": "viscous", "coefficient": 30}},
                   walls=[wall("lower", [0, 0, -0.999e-3], [0, 0, 1], passive=True, motion={"vz": [[0, 0], [0.05, 2e-3]]}),
                          wall("upper", [0, 0, 4.999e-3], [0, 0, -1], passive=True, motion={"vz": [[0, 0], [0.05, -2e-3]]})])


def two_springs(one):
    """The platens are rigid compared with two bonds in series, and each has moved by 0.02 t^2; damping takes 1 % of
    the force."""
    rows = one.history
    force = 0.5 * abs(rows["wall_upper_force_z"][-1] - rows["wall_lower_force_z"][-1])
    return close(force, 0.02 * rows["time"][-1]**2, 0.05, "N") + f", residual {one.residual:.0e}"


def rattles_on_platens(folder):
    """The bonded body is shaken without compression, so that it leaves the platens; these count as in contact,
    because they are touched within a step."""
    scene = bonded_between_platens(folder)
    del scene["damping"]
    for one in scene["walls"]:
        del one["motion"]
    scene["sets"] = [launched("middle", [1], [0, 0, 1e-3])]
    return scene


def bonded_that_rattles(folder):
    """The bonded body between plates that it does not touch yet: 20 times as stiff as its bonds."""
    return spheres(lattice("fcc", [2, 2, 2]), 0.02, {"normal_stiffness": 1e4, "kratio": 2, "friction": 0, **STRONG},
                   bonds={}, sets=[launched("all", None, [0, 0, -0.1])],
                   walls=[wall("lower", [0, 0, -1e-5], [0, 0, 1], 1e6), wall("upper", [0, 0, 6e-3], [0, 0, -1], 1e6)])


def stiff_bond(folder):
    """Four spheres in a row; the bond of the last two is 1e6 times as stiff as the first one."""
    scene = spheres([[2e-3 * k, 0, 0, 1e-3] for k in range(4)], 2e-3, {"normal_stiffness": 1e3, "kratio": 0, **STRONG},
                    bonds={})
    add_material(scene, name="stiff", normal_stiffness=1e9, kratio=0, **STRONG)
    scene["sets"] = [launched("first", [0], [0.01, 0, 0]), {"name": "s", "select": {"ids": [2, 3]}, "material": "stiff"}]
    return scene


def swings_as_three(one):
    """The stiff pair moves as one mass: beside it the system is m - k - m - k' - 2m, with k' = 2 k in series with 1e9
    N/m."""
    k, m = 1e3, sphere_mass(1e-3)
    stiffness = np.array([[k, -k, 0], [-k, 3 * k, -2 * k], [0, -2 * k, 2 * k]])
    root = np.diag([1, 1, 0.5**0.5]) / m**0.5
    squares, modes = np.linalg.eigh(root @ stiffness @ root)
    speeds = modes.T @ (np.linalg.inv(root) @ np.array([0.01, 0, 0]))
    t = one.summary["time"]
    omega = np.sqrt(np.maximum(squares, 0))
    path = [v * (math.sin(w * t) / w if w > 1 else t) for v, w in zip(speeds, omega)]
    wanted, found = root @ modes @ path, one.field("particles/displacement")[:3, 0]
    off = np.abs(found - wanted).max() / np.abs(wanted).max()
    assert off < 1e-3, f"displacements off by {off:.2g}"
    return keeps_energy(1e-5)(one) + f", displacements within {off:.0e}"


def thousand(folder, around=1000):
    """A light sphere that a thousand others of its mass are bonded to."""
    large, small = 0.032, 1e-3
    k = np.arange(around) + 0.5
    polar, turn = np.arccos(1 - 2 * k / around), np.pi * (1 + 5**0.5) * k
    way = np.stack([np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)], 1)
    shell = [[*map(float, (large + small) * d), small] for d in way]
    scene = spheres([[0, 0, 0, large], *shell], 1e-4, {"friction": 0, **STRONG}, bonds={"interaction_range": 1e-3})
    add_material(scene, name="light", density=DENSITY * (small / large)**3, **STRONG)
    scene["sets"] = [{**launched("core", [0], [0.01, 0, 0]), "material": "light"}]
    return scene


def carries_a_thousand(one):
    assert one.field("particles/bonds_at_start")[0] >= 1000
    v = one.field("particles/velocity")
    m = sphere_mass(1e-3)
    momentum, given = np.linalg.norm(v.sum(0) * m - [0.01 * m, 0, 0]), 0.01 * m
    assert momentum < 1e-10 * given, momentum
    return keeps_energy(1e-4)(one) + f", momentum within {momentum / given:.0e}"


CASES = [
    Case("a mass ratio of 1e9", "two spheres collide, one 1e9 times as heavy", "the light one comes back with its speed",
         light_and_heavy, rebounds(0, 1e9, 1e-3), "the step resolves the shortest collision of what is loose",
         "a stable step alone: ledger off by 0.57, stopped"),
    Case("a size ratio of 1e4", "a sphere of 1 micrometre meets one of 1 cm; masses 1 to 1e12",
         "the small one comes back with its speed", small_and_large, rebounds(0, 1e12, 1e-3),
         "the step resolves the shortest collision of what is loose, of the stiffest pair that there is",
         "a stable step alone: ledger off by 0.13, stopped", more="test_new_contacts.c"),
    Case("small spheres on one a hundred times larger", "they fall on it and bounce", "they stay outside",
         settles_on_a_large_one, stay_outside, "the step resolves the shortest collision of what is loose",
         "without that and the limit of what is near: a small one flies off at 3.6e4 m/s"),
    Case("a soft sphere between rigid plates", "stiffness 1 to 1e6, sphere against sphere and sphere against plate",
         "energy stays", soft_between_plates, keeps_ledger(0.01),
         "the step resolves the shortest collision of what is loose, walls included",
         "a stable step alone: ledger off by 0.24, stopped"),
    Case("a soft bonded body between rigid platens", "stiffness 1 to 1e6, platens that close",
         "the force of two springs", bonded_between_platens, two_springs,
         "the springs of walls are in the stability limit",
         "a step of 3.4 ms instead of 5 us, flies off in the second one"),
    Case("a soft bonded body that rattles on rigid platens",
         "stiffness 1 to 1e6, and passive walls are laid on as a rule", "energy stays", rattles_on_platens, keeps_ledger(0.01),
         "a platen stiffer than the bonds is met in three steps or more", "15 % of the energy unexplained, stopped"),
    Case("a bonded body that rattles between stiff plates",
         "plates 100 times as stiff as the bonds, not touched at the start", "energy stays", bonded_that_rattles,
         keeps_ledger(0.01), "a wall stiffer than the bonds is met in half as many steps as loose particles are",
         "ledger off by 0.12, stopped", more="test_new_contacts.c"),
    Case("a bond a million times stiffer than the others", "a row of four", "it swings as three masses do", stiff_bond,
         swings_as_three, "the sharp limit sees the stiffest mode", "no guard to take out but the limit itself: with "
         "`time.step` 7 times as long, far below what the other bonds bear, it flies apart after 8 steps"),
    Case("a sphere with a thousand bonds", "all at one light sphere", "energy and momentum stay", thousand,
         carries_a_thousand, "the stability limit counts all contacts of a particle",
         "with one spring per particle (the literature's estimate): flies off at 4.7e4 m/s in the third step"),
]
