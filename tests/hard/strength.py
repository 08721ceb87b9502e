"""Laws at their extremes: zero and infinite strength, zero and infinite friction, and values that no scene may have."""
from hard.case import *  # noqa: F403


def pulled(tension, shear, **changes):
    """A bonded block whose layers move apart at 0.1 m/s."""
    def scene(folder):
        made = spheres(lattice("fcc", [3, 3, 3]), 5e-4, {"bond_tension_limit": tension, "bond_shear_limit": shear}, bonds={},
                       sets=[{"name": side, "select": {"end": {"axis": "z", "side": side, "depth": 1.5e-3}}, "motion": {"vz": v}}
                             for side, v in (("lower", -0.1), ("upper", 0.1))])
        made.update(changes)
        return made
    return scene


def falls_apart(one):
    counts = one.summary["counts"]
    broken = counts["broken_tension"] + counts["broken_shear"]
    assert broken > 0.9 * counts["bonds"], counts
    return keeps_ledger(0.01)(one) + f", {broken} of {counts['bonds']} bonds broken"


def holds(one):
    counts = one.summary["counts"]
    assert counts["broken_tension"] + counts["broken_shear"] == 0, counts
    return keeps_ledger(1e-6)(one) + f", none of {counts['bonds']} bonds broken"


def beyond_strength(folder):
    """The bond is stretched by a tenth of a radius where it forms, and breaks in the first step."""
    return spheres([[0, 0, 0, 1e-3], [0, 0, 2.1e-3, 1e-3]], 1e-3, {"bond_tension_limit": 1, "bond_shear_limit": 1},
                   bonds={"interaction_range": 0.1, "passive_gaps": False})


def released(one):
    wanted = 0.5 * 1e6 * 1e-4**2  # J: its energy was stored at the start
    for name in ("bond_breaking", "stored_at_start"):
        found = one.field("energy/" + name).item()
        assert abs(found / wanted - 1) < 1e-9, (name, found)
    assert one.residual < 1e-9, one.residual
    return f"all {wanted:.2g} J released, residual {one.residual:.0e}"


def on_a_floor(friction, speed, spin, end, kratio=2, k=1e4):
    """A sphere on a floor, in balance with its weight."""
    def scene(folder):
        sink = sphere_mass(1e-3) * 10 / k
        return spheres([[0, 0, 1e-3 - sink, 1e-3]], end, {"normal_stiffness": k}, gravity=[0, 0, -10],
                       sets=[launched("ball", [0], [speed, 0, 0], [0, spin, 0])],
                       walls=[wall("floor", [0, 0, 0], [0, 0, 1], k, kratio=kratio, friction=friction)])
    return scene


def slides_and_spins(one):
    v, w = one.field("particles/velocity")[0], one.field("particles/spin")[0]
    assert v[0] == 0.1 and v[1] == 0 and w[1] == 50.0 and w[0] == 0 and w[2] == 0, (v, w)
    return "speed and spin to the bit"


def sticks(one):
    """The surface point oscillates on k_t with 7/2 of 1/m and comes to rest on average: v = 5/7 of the initial value
    and the spin that follows from it; no sliding."""
    rows, t = one.history, one.summary["time"]
    assert rows["energy_friction"].max() == 0, rows["energy_friction"].max()
    m, kt = sphere_mass(1e-3), 1e4 / 2
    omega = math.sqrt(3.5 * kt / m)
    wanted = 0.1 * (5 / 7 * t + 2 / 7 * math.sin(omega * t) / omega)
    return close(one.field("particles/displacement")[0, 0], wanted, 1e-3, "m of path") + f", residual {one.residual:.0e}"


def soft_and_stiff_shear(kratio):
    """A pair of loose spheres that collide off centre without sliding."""
    def scene(folder):
        return spheres([[0, 0, 0, 1e-3], [1.2e-3, 0, 1.7e-3, 1e-3]], 2e-4, {"kratio": kratio, "friction": 0.5},
                       sets=[launched("a", [0], [0, 0, 1]), launched("b", [1], [0, 0, -1])])
    return scene


def keeps_momenta(one):
    x, v, w = (one.field("particles/" + name) for name in ("position", "velocity", "spin"))
    m = sphere_mass(1e-3)
    momentum = np.abs(v.sum(0)).max()
    turning = (np.cross(x, v) * m + 0.4 * m * 1e-6 * w).sum(0)
    wanted = np.array([0, 1.2e-3 * m, 0])
    off = np.abs(turning - wanted).max() / wanted[1]
    assert momentum < 1e-13 and off < 1e-11, (momentum, off)
    return keeps_ledger(0.02)(one) + f", angular momentum within {off:.0e}"


def with_value(**path):
    """The scene of two spheres and a floor, with one value replaced: path = {a__0__b: value}."""
    def scene(folder):
        made = spheres([[0, 0, 1e-3, 1e-3], [0, 0, 3e-3, 1e-3]], 1e-3, {"bond_tension_limit": 1, "bond_shear_limit": 1},
                       bonds={}, walls=[wall("floor", [0, 0, 0], [0, 0, 1], **{"kratio": 2, "friction": 0.3})])
        for keys, value in path.items():
            inner, *rest = made, *keys.split("__")
            for key in rest[:-1]:
                inner = inner[int(key)] if key.isdigit() else inner[key]
            inner[rest[-1]] = value
        return made
    return scene


def alone(**sections):
    """Sections that are refused before any other key is read."""
    def scene(folder):
        return {"dimension": 3, "time": {"end": 1e-4}, **copy.deepcopy(QUIET), **sections}
    return scene


PACKED = {"materials": [material()], "law": {"stiffness": "uniform"}}


def cylinder(height=0.03, **packing):
    return alone(specimen={"cylinder": {"diameter": 0.02, "height": height}, "particles": 60, "packing": packing}, **PACKED)


def rough_body(folder):
    body = {"name": "b", "box": {"size": [1, 1, 1]}, "stiffness": 1e6, "kratio": 1e-12, "friction": 0.3}
    return alone(specimen={"particles": [[-0.5, 0, 0, 1e-3]]}, bodies=[body], **PACKED)(folder)


def notched(folder):
    beam = {"length": 0.4, "height": 0.1, "span": 0.3, "notch_depth": 1e-12, "notch_width": 2e-3, "cell": 0.02}
    return {"dimension": 2, "time": {"end": 1e-4}, **copy.deepcopy(QUIET),
            "elements": {"beam": beam, "materials": [{"young": 1e9, "poisson": 0.2, "density": 2400}]}}


def body_scene(step=None, **motion):
    """Bonded spheres and a moving plate, with given steps unless automatic."""
    def scene(folder):
        made = spheres(lattice("hcp", [4, 3, 3]), 1e-4, {"bond_tension_limit": 100, "bond_shear_limit": 100}, bonds={},
                       bodies=[{"name": "tool", "box": {"size": [0.5, 1e-3, 1]}, "origin": [0.02, 0, -0.5], "reference": [0.02, 0, 0],
                                "stiffness": 1e6, "motion": motion}])
        if step:
            made["time"]["step"] = step
        return made
    return scene


def fast_wall(folder):
    made = spheres([[0, 0, 1.1e-3, 1e-3]], 1e-4, walls=[wall("floor", [0, 0, -0.5], [0, 0, 1], motion={"vz": 1e5})])
    return made


def fast_spin(folder):
    return spheres([[0, 0, 0, 1e-3], [0, 0, 3e-3, 1e-3]], 1e-4, sets=[launched("ball", [0], None, [0, 0, 1e7])])


RANGE = "every key has a range"
DURATION = "a run of more than 1e15 steps is refused"
CASES = [
    Case("no strength", "the least that a bond may have: 1e-30 N", "all bonds break at once, the ledger closes",
         pulled(1e-30, 1e-30, initial={"random_velocity": 0.1}), falls_apart,
         "contacts that close or open within a step act for their part of it", "contacts of whole steps: residual 0.02"),
    Case("strength of zero", "a bond that is none", "refused at its place",
         with_value(materials__0__bond_tension_limit=0), refuses(r"materials\[0\]\.bond_tension_limit", "1e-30"),
         "every key has a range", "0 counts as not given, and is refused in those words", ends=2),
    Case("all strength", "1e100 N, squared 1e200", "nothing breaks, nothing overflows", pulled(1e100, 1e100), holds, "",
         "none was found whose absence it shows: with 1e200 N nothing breaks either"),
    Case("strength that is infinite", ".inf", "refused at its place", with_value(materials__0__bond_shear_limit=".inf"),
         refuses(r"materials\[0\]\.bond_shear_limit"), "", "no guard to take out: no number of a scene is infinite",
         ends=2),
    Case("a bond made beyond its strength", "it breaks in the first step",
         "all that it held is released, the ledger closes to rounding", beyond_strength, released,
         "what a bond held where it broke at once is stored at the start", "the ledger misses all of it, stopped"),
    Case("no friction", "a sphere slides and spins on a floor", "speed and spin stay to the bit",
         on_a_floor(0, 0.1, 50.0, 0.05), slides_and_spins, "",
         "no guard to take out: without friction there is no shear force"),
    Case("friction of 1e6", "a sphere pushed along a floor",
         "it sticks: the closed form of the oscillator, not a bit slides", on_a_floor(1e6, 0.1, 0.0, 0.02), sticks,
         "the step resolves the shortest collision of what is loose", "a stable step alone: path off by 1.2e-3"),
    *[Case(f"a k_n/k_t of {kratio:g}", "spheres that meet off centre", "momenta to rounding, the ledger closes",
           soft_and_stiff_shear(kratio), keeps_momenta, guard, without) for kratio, guard, without in (
        (1e12, "the step resolves the shortest collision of what is loose",
         "without that and the limit of what is near: residual 0.047"),
        (0.5, "", "no guard to take out: forces of a contact are mirrored"))],
    Case("a stiffness of 1e308", "a value that overflows with the next product", "refused at its place",
         with_value(walls__0__stiffness=1e308), refuses(r"walls\[0\]\.stiffness", "1e21"), RANGE,
         "stops in the first step: no finite stiffness over mass", ends=2),
    Case("a density of 1e-12", "masses of 1e-20 kg and steps to match", "refused at its place",
         with_value(materials__0__density=1e-12), refuses(r"materials\[0\]\.density", "1e-9"), RANGE,
         "starts a run that does not end", ends=2),
    Case("a k_n/k_t of 1e-12", "a body whose shear is 1e12 times as stiff", "refused at its place", rough_body,
         refuses(r"bodies\[0\]\.kratio", "1e-6"), RANGE, "starts a run that does not end", ends=2),
    Case("a wall at 1e15 m", "places rounded to 0.1 m", "refused at its place", with_value(walls__0__point=[1e15, 0, 0]),
         refuses(r"walls\[0\]\.point"), RANGE, "runs; the wall stands where rounding puts it", ends=2),
    Case("spheres of 1e-12 m", "masses of 1e-32 kg", "refused at its place",
         alone(specimen=lattice("fcc", [2, 2, 2], radius=1e-12), **PACKED),
         refuses(r"specimen\.lattice\.radius", "1e-9"), RANGE, "refused by the specimen, without the key", ends=2),
    Case("a cylinder 5e-324 m high", "a volume of nothing to pack", "refused at its place", cylinder(5e-324),
         refuses(r"specimen\.cylinder\.height", "1e-9"), RANGE, "long tries to pack it, then: no particle found a place",
         ends=2),
    Case("spheres refined to 1e-308", "more of them than there are numbers", "refused at its place",
         cylinder(refine=[{"from": [0, 0, 0], "to": [0.01, 0, 0.01], "size": 1e-308, "distance": 5e-3}]),
         refuses(r"specimen\.packing\.refine\[0\]\.size"), RANGE,
         "long tries to pack it, then: no particle found a place", ends=2),
    Case("a notch 1e-12 m deep", "cells that are graded down to it", "refused at its place", notched,
         refuses(r"elements\.beam\.notch_depth", "1e-9"), RANGE, "refused by its smallest element, without the key",
         ends=2),
    Case("an end in 1e308 s", "1e314 steps", "refused at its place", with_value(time__end=1e308),
         refuses(r"time: expected an end within 1e\+15 steps"), DURATION, "starts a run that does not end", ends=2),
    Case("a safety of 5e-324", "no step at all", "refused at its place", with_value(time__safety=5e-324),
         refuses(r"time: expected an end within 1e\+15 steps"), DURATION, "crashes, with a step of zero", ends=2),
    Case("a plate at 1e6 m/s", "in a step that is given it would pass through", "stopped, the body named", body_scene(1e-7, vx=-1e6),
         says("body 'tool' moved farther in one step than half the smallest radius"),
         "a body's path in a step is bounded", "it goes through the block untouched, exit code 0", ends=5,
         more="test_paths.c"),
    Case("a plate that spins at 1e8 rad/s", "its edge moves 7 m in a step", "stopped, the body named",
         body_scene(1e-7, wz=1e8), says("body 'tool' moved farther in one step than half the smallest radius"),
         "a body's path in a step is bounded", "it goes through the block; 97 % of the energy unexplained", ends=5),
    Case("a plate that spins at 1e300 rad/s", "squared it is infinite", "refused at its place", body_scene(wz=1e300),
         refuses(r"bodies\[0\]\.motion\.wz"), RANGE, "stopped in the first step by the bound on its path", ends=2),
    Case("a wall at 1e5 m/s", "it would pass through in a step", "stopped, the wall named", fast_wall,
         says("wall 'floor' moved farther in one step than half the smallest radius"),
         "a wall's path in a step is bounded", "the sphere is thrown, and stopped by the bound on its own path", ends=5,
         more="test_paths.c"),
    Case("a sphere that spins at 1e7 rad/s", "it turns by radians in a step", "stopped, the particle named", fast_spin,
         says("particle 0 turned in one step by more than half a radian"), "a particle's turn in a step is bounded",
         "runs, as if all were well", ends=5, more="test_paths.c"),
]
