"""Contacts, bursts and fragments in files on request, compared with closed forms and with each other. Speaks TAP."""
from program import *  # noqa: F403

ALL = ("--set", "output.contacts=on")


def at_end(folder, group):
    with results(folder) as file:
        return {name: data[()] for name, data in file[group].items()}


def mean_stress(folder):
    """Love-Weber over all contacts, and the mean of the particles' stresses, xx yy zz xy yz xz."""
    c, p = at_end(folder, "contacts"), at_end(folder, "particles")
    with results(folder) as file:
        volume, flat = float(file.attrs["volume"]), int(file.attrs["dimension"]) == 2
    own = np.pi * p["radius"] ** 2 if flat else 4 / 3 * np.pi * p["radius"] ** 3
    s = np.einsum("ca,cb->ab", c["force"], c["branch"]) / volume
    s = 0.5 * (s + s.T)
    return np.array([s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[0, 2]]), (own[:, None] * p["stress"]).sum(0) / own.sum()


def check_all(folder):
    """Checks that hold for any contacts."""
    c, p = at_end(folder, "contacts"), at_end(folder, "particles")
    sums, means = mean_stress(folder)
    assert np.abs(sums - means).max() < 1e-12 * np.abs(sums).max(), (sums, means)
    two = c["with"] == 0
    assert p["coordination"].sum() == 2 * two.sum() and (c["i"][two] < c["j"][two]).all()
    assert (c["j"][~two] == -1).all() and (c["side"][two] == -1).all() and (c["side"][~two] >= 0).all()
    force, branch = np.linalg.norm(c["force"], axis=1), np.linalg.norm(c["branch"], axis=1)
    along = (c["force"] * c["branch"]).sum(1) / branch
    assert np.allclose(c["normal_force"], along, rtol=0, atol=1e-12 * force.max())
    assert np.allclose(np.hypot(c["normal_force"], c["shear_force"]), force, rtol=1e-9, atol=1e-12 * force.max())
    some = c["area"] > 0
    assert np.allclose((c["normal_stress"] * c["area"])[some], c["normal_force"][some], rtol=1e-12)
    assert np.allclose((c["shear_stress"] * c["area"])[some], c["shear_force"][some], rtol=1e-12)
    return c, p


@fact
def contacts_of_a_broken_rock_have_the_force_of_their_overlap(folder):
    for precision, share in (("double", 1e-12), ("mixed", 1e-4)):
        place = os.path.join(folder, precision)
        run(UCS, place, *ALL, "--precision", precision)
        c, p = check_all(place)
        two, held, broke, never = c["with"] == 0, c["state"] == 0, np.isin(c["state"], (1, 2)), c["state"] == 7
        counts = [np.count_nonzero(two & k) for k in (held, broke, never)] + [np.count_nonzero(~two)]
        assert min(counts) > 15 and sum(counts) == len(two), counts
        r = p["radius"]
        ri, rj = r[c["i"]], r[np.where(two, c["j"], c["i"])]
        kn = 2 * 10e9 * 2 * ri * rj / (ri + rj)  # harmonic (Rojek et al. 2012)
        kn[~two] = 15e6
        largest = np.abs(c["normal_force"]).max()
        weak = two & held & (kn * -c["overlap"] > 0.99 * 40e6 * c["area"])  # bonds that break in the next step
        assert np.abs(c["normal_force"] + kn * c["overlap"])[two & ~weak].max() < share * largest
        assert (c["overlap"][two & ~held] > 0).all()
        # At walls the force is that of the last step, after which they and the particles have moved.
        assert np.abs(c["normal_force"] + kn * c["overlap"])[~two].max() < 15e6 * 2 * 5 * 3e-7
        assert np.allclose(c["area"], 4 * np.minimum(ri, rj) ** 2, rtol=1e-12)
        assert np.count_nonzero(weak) < 0.01 * len(two)


@plain_fact
def asking_for_contacts_changes_no_bit_of_a_run_and_no_other_file(folder):
    with_, without = (os.path.join(folder, name) for name in ("with", "without"))
    run(UCS, with_, *ALL)
    run(UCS, without)
    check_same(with_, without)
    assert not [name for name in os.listdir(without) if "contacts" in name]
    with results(without) as file:
        assert "contacts" not in file
    assert [time for _, time in series(with_, "contacts")] == [time for _, time in series(with_)]
    assert series(without) == series(with_) and series(without, "bonds") == series(with_, "bonds")


@plain_fact
def lines_of_contacts_end_at_centres_and_where_walls_act(folder):
    run(UCS, os.path.join(folder, "out"), *ALL)
    name = series(os.path.join(folder, "out"), "contacts")[-1][0]
    c, p = check_all(os.path.join(folder, "out"))
    with h5py.File(os.path.join(folder, "out", name)) as file:
        points, ends = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 2)
        area = file["VTKHDF/CellData/area"][:]
    assert np.array_equal(area, c["area"]) and len(points) == len(p["radius"]) + np.count_nonzero(c["with"])
    way = points[ends[:, 1]] - points[ends[:, 0]]
    assert np.abs(way - c["branch"]).max() < 1e-7 and np.array_equal(ends[:, 0], c["i"])


@fact
def a_resumed_run_lists_the_same_contacts(folder):
    one, two = (os.path.join(folder, name) for name in ("one", "two"))
    run(UCS, one, *ALL, "--threads", 1)
    run(UCS, two, *ALL, "--threads", 2, "--set", "time.end=0.2 ms")
    resume(two, "--set", "time.end=0.3 ms")
    a, b = at_end(one, "contacts"), at_end(two, "contacts")
    assert all(np.array_equal(a[name], b[name]) for name in a) and a.keys() == b.keys()


# Glass beads that fall into a tray: they touch each other, its floor, and a block in it.
BEADS = {
    "dimension": 3, "specimen": {"particles": [[(2.05 * x + 1.05 + 0.2 * (z % 2)) * 1e-3, (2.05 * y + 1.05 + 0.03 * x) * 1e-3, (2.05 * z + 1) * 1e-3, 1e-3]
                                               for x in range(4) for y in range(4) for z in range(3)]},
    "materials": [{"name": "m", "density": 2500, "young": 1e7, "poisson": 0.25, "friction": 0.4}],
    "law": {"stiffness": "hertz"}, "gravity": [0, 0, -9.81], "damping": {"background": {"model": "viscous", "coefficient": 300}},
    "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.4},
              *({"name": f"{side}{axis}", "point": [at if k == a else 0 for k in range(3)], "normal": [sign if k == a else 0 for k in range(3)]}
                for a, axis in enumerate("xy") for side, sign, at in (("low ", 1, 0), ("high ", -1, 8.5e-3)))],
    "bodies": [{"name": "block", "box": {"size": [2e-3, 2e-3, 1e-3]}, "origin": [3e-3, 3e-3, 6.5e-3], "free": True, "density": 2500}],
    "time": {"end": 0.08}, "output": {"history_rows": 200, "snapshots": 1, "contacts": "on"}, "run": {"threads": 1}}


@fact
def hertz_contacts_have_his_force_and_circle_and_stresses_add_up_to_the_reading(folder):
    place = os.path.join(folder, "out")
    run(write_scene(folder, BEADS), place)
    c, p = check_all(place)
    assert set(c["state"]) == {7} and {0, 1, 2} <= set(c["with"]), np.bincount(c["with"])
    two = c["with"] == 0
    modulus = np.where(two, 0.5, 1.0) * 1e7 / (1 - 0.25 ** 2)  # the modulus is that of two beads in series; walls are rigid
    r = p["radius"][c["i"]]
    radius = np.where(two, 0.5, 1.0) * r
    law = 4 / 3 * modulus * np.sqrt(radius) * np.maximum(c["overlap"], 0) ** 1.5
    assert (c["overlap"] > 0).all()
    assert np.allclose(-c["normal_force"][two], law[two], rtol=1e-9, atol=1e-12 * law.max())
    at_rest = c["with"] == 1
    assert np.allclose(-c["normal_force"][at_rest], law[at_rest], rtol=1e-2, atol=1e-3 * law.max())
    assert np.allclose(c["area"], np.pi * radius * c["overlap"], rtol=1e-12)
    weight = 9.81 * (2500 * 4 / 3 * np.pi * (p["radius"] ** 3).sum() + 2500 * 4e-9)
    floor = (c["with"] == 1) & (c["side"] == 0)
    assert abs(c["force"][floor, 2].sum() - weight) < 0.02 * weight, (c["force"][floor, 2].sum(), weight)


BOX = {
    "dimension": 2, "specimen": {"lattice": {"kind": "hexagonal", "radius": 1e-3, "cells": [10, 5], "jitter": 0.05}},
    "materials": [{"name": "m", "density": 2500, "contact_modulus": 1e8, "kratio": 2, "friction": 0.3}],
    "law": {"stiffness": "harmonic"}, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.5}},
    "periodic": {"min": [0, 0], "max": [20e-3, 17.32e-3], "x": {"stress": 1e5, "max_rate": 5}, "y": {"stress": 1e5, "max_rate": 5}},
    "time": {"end": 0.02}, "output": {"history_rows": 400, "snapshots": 1, "contacts": "on"}, "run": {"threads": 1}}


@fact
def contacts_across_a_periodic_box_are_as_long_as_others_and_add_up_to_its_stress(folder):
    place = os.path.join(folder, "out")
    run(write_scene(folder, BOX), place)
    c, p = check_all(place)
    length = np.linalg.norm(c["branch"], axis=1)
    apart = np.linalg.norm(p["position"][c["j"]] - p["position"][c["i"]], axis=1)
    assert np.count_nonzero(apart > 8e-3) > 10 and length.max() < 2.1e-3
    assert np.allclose(c["overlap"], p["radius"][c["i"]] + p["radius"][c["j"]] - length, atol=1e-15)
    h, (sums, _) = history(place), mean_stress(place)
    for k, name in enumerate(("xx", "yy")):
        assert abs(sums[k] - h["stress_" + name][-1]) < 1e-3 * 1e5 and abs(sums[k] + 1e5) < 0.02 * 1e5, (sums, h["stress_xx"][-1])
    assert np.allclose(c["area"], 2 * 1e-3, rtol=1e-12)  # 2 r x 1 m


@fact
def sections_of_laws_by_area_are_those_of_bonds(folder):
    place = os.path.join(folder, "out")
    run(write_scene(folder, {
        "specimen": {"lattice": {"kind": "hcp", "radius": 1e-3, "cells": [5, 3, 4], "jitter": 0.03}},
        "materials": [{"name": "rock", "density": 2500, "young": 20e9, "poisson": 0.2, "friction": 0.5, "tensile_strength": 3e6,
                       "shear_strength": 9e6}],
        "law": {"stiffness": "polyhedron"}, "bonds": {"interaction_range": 0.1}, "dimension": 3,
        "sets": [{"name": "top", "select": {"end": {"axis": "z", "side": "upper", "depth": 2e-3}}, "motion": {"vz": -2}},
                 {"name": "low", "select": {"end": {"axis": "z", "side": "lower", "depth": 2e-3}}, "motion": {"vz": 0}}],
        "time": {"end": 1e-4}, "output": {"contacts": "on", "fields": ["area", "shear_stress"]}}), place)
    c, _ = check_all(place)
    b = at_end(place, "bonds")
    where = {(i, j): k for k, (i, j) in enumerate(zip(b["i"], b["j"]))}
    bonded = np.flatnonzero(c["state"] != 7)
    k = np.array([where[c["i"][m], c["j"][m]] for m in bonded])
    assert np.array_equal(b["area"][k], c["area"][bonded]) and np.array_equal(b["state"][k], c["state"][bonded])
    assert np.array_equal(b["contact_stress"][k], c["normal_stress"][bonded])
    broken = set(b["state"]) & {1, 2}
    assert broken and np.array_equal(np.sort(k[c["state"][bonded] == 0]), np.flatnonzero(b["state"] == 0))


@fact
def a_disc_on_a_beam_of_elements_presses_a_facet_with_its_weight(folder):
    place = os.path.join(folder, "out")
    r, weight = 5e-3, 2500 * np.pi * 25e-6 * 9.81
    run(write_scene(folder, {
        "dimension": 2, "specimen": {"particles": [[1.3e-3, 0.1 + r, r]], "group": 0}, "gravity": [0, -9.81],
        "materials": [{"name": "m", "density": 2500, "contact_modulus": 1e6, "kratio": 2}], "law": {"stiffness": "harmonic"},
        "elements": {"beam": {"length": "440 mm", "height": "100 mm", "span": "400 mm", "notch_depth": "30 mm", "notch_width": "2 mm",
                              "cell": "20 mm"}, "contact": {"stiffness": 1e4},
                     "materials": [{"young": 30e9, "poisson": 0.2, "density": 2400}],
                     "motions": [{"name": "held", "box": {"min": [-1, -1], "max": [1, 1]}, "motion": {"vx": 0, "vy": 0}}]},
        "damping": {"background": {"model": "viscous", "coefficient": 300}}, "domain": {"min": [-1, -1], "max": [1, 1]},
        "time": {"end": 0.1}, "output": {"history_rows": 20, "snapshots": 1, "contacts": "on"}, "run": {"threads": 1}}), place)
    c = at_end(place, "contacts")
    assert list(c["with"]) == [3] and list(c["state"]) == [7] and c["side"][0] >= 0, c
    assert np.allclose(c["force"], [[0, weight, 0]], rtol=1e-6, atol=1e-6 * weight) and np.allclose(c["branch"], [[0, -r, 0]], atol=1e-9)
    assert np.allclose(c["overlap"], weight / 1e4, rtol=1e-4) and np.allclose(c["area"], 2 * r) and np.allclose(c["normal_stress"], -weight / (2 * r))


@fact
def contacts_are_refused_where_there_are_no_particles(folder):
    with open(os.path.join(SCENES, "elements.yaml")) as file:
        scene = file.read()
    path = write_scene(folder, scene)
    expect(gneiss("check", path, *ALL), 2, r"output\.contacts: needs a specimen")


# --- bursts --------------------------------------------------------------------------------------------

def bursts_by_hand(folder, period=None):
    """The burst of each break, found by comparing all pairs."""
    e = at_end(folder, "events")
    with results(folder) as file:
        reach, window = (float(file["bursts"].attrs[name]) for name in ("reach", "window"))
    broke = np.flatnonzero(np.isin(e["cause"], (1, 2)))
    place = np.stack([e[name][broke] for name in "xyz"], axis=1)
    way = place[:, None] - place[None]
    if period:
        way[..., :len(period)] -= np.round(way[..., :len(period)] / period) * period
    near = ((way ** 2).sum(2) <= reach ** 2) & (np.abs(e["time"][broke][:, None] - e["time"][broke][None]) <= window)
    label = np.arange(len(broke))
    while True:
        least = np.where(near, label[None], len(broke)).min(1)
        if np.array_equal(least, label):
            break
        label = least
    return np.unique(label, return_inverse=True)[1], broke


def check_bursts(folder, period=None):
    b, e = at_end(folder, "bursts"), at_end(folder, "events")
    of, broke = bursts_by_hand(folder, period)
    assert np.array_equal(e["burst"][broke], of) and (np.delete(e["burst"], broke) == -1).all()
    counts = summary(folder)["counts"]
    assert b["size"].sum() == counts["broken_tension"] + counts["broken_shear"] and b["tension"].sum() == counts["broken_tension"]
    assert np.array_equal(b["size"], np.bincount(of)) and np.allclose(b["energy"], np.bincount(of, e["energy"][broke]), rtol=1e-12, atol=1e-18)
    for k in range(len(b["size"])):
        times = e["time"][broke][of == k]
        assert b["time"][k] == times.min() and b["duration"][k] == np.ptp(times)
    gives = b["energy"] > 0
    assert np.allclose(b["magnitude"][gives], 2 / 3 * np.log10(b["energy"][gives]) - 3.2) and np.isnan(b["magnitude"][~gives]).all()
    with results(folder) as file:
        assert abs(b["energy"].sum() - file["energy/bond_breaking"][0]) < 1e-9 * b["energy"].sum()
        if "events" in file["readings"]:
            assert file["readings/events"][0] == len(b["size"])
    return b


SLOW = ("--set", "time.end=0.2 ms", "--set", "output.burst_reach=2")  # the run ends before all bonds break at once


@fact
def bursts_are_breaks_that_are_near_in_place_and_time(folder):
    place = os.path.join(folder, "out")
    run(UCS, place, *SLOW)
    b = check_bursts(place)
    assert len(b["size"]) > 20 and 5 < b["size"].max() < 0.9 * b["size"].sum(), b["size"]
    e = at_end(place, "events")
    for k in np.flatnonzero(b["size"] > 1)[:5]:
        assert abs(b["x"][k] - e["x"][e["burst"] == k].mean()) < 1e-12
    p, bonds = at_end(place, "particles"), at_end(place, "bonds")
    sums = (p["radius"][bonds["i"]] + p["radius"][bonds["j"]]).mean()
    with results(place) as file:
        assert abs(file["bursts"].attrs["reach"] - 2 * sums) < 1e-12 * sums
        r = 1 / (0.5 / p["radius"][bonds["i"]] + 0.5 / p["radius"][bonds["j"]])
        slow = np.sqrt(2 / (1 / p["mass"][bonds["i"]] + 1 / p["mass"][bonds["j"]]) / (2 * 10e9 * r)) / bonds["rest_length"]
        assert abs(file["bursts"].attrs["window"] / (2 * sums * slow.mean()) - 1) < 1e-12


@plain_fact
def bursts_are_the_same_whatever_rows_threads_and_interruptions(folder):
    one, two = (os.path.join(folder, name) for name in ("one", "two"))
    run(UCS, one, *SLOW, "--threads", 1)
    run(UCS, two, "--threads", 2, "--set", "time.end=0.15 ms", "--set", "output.burst_reach=2", "--set", "output.history_rows=11")
    resume(two, "--threads", 2, "--set", "time.end=0.2 ms")
    for group in ("bursts", "events", "fragments"):
        a, b = at_end(one, group), at_end(two, group)
        assert a.keys() == b.keys() and all(a[name].tobytes() == b[name].tobytes() for name in a), group
    assert summary(one)["readings"]["b_value"] == summary(two)["readings"]["b_value"] and summary(one)["readings"]["events"] > 20


@fact
def every_burst_is_one_of_the_stage_in_which_it_began(folder):
    with open(UCS) as file:
        scene = file.read().replace("../../scenes/specimens", os.path.join(os.path.dirname(SCENES), "..", "scenes", "specimens"))
    place = os.path.join(folder, "out")
    run(write_scene(folder, scene + "stages: [{name: a, end: {time: 0.171 ms}}, {name: b, end: {time: 0.013 ms}}, {name: c}]\n"), place,
        *SLOW, "--set", "output.history_rows=7")
    stages = summary(place)["stages"]
    begins, began = [stage["time"] for stage in stages], at_end(place, "bursts")["time"]
    want = [np.count_nonzero((began >= low) & (began < high)) for low, high in zip(begins, begins[1:] + [1])]
    assert min(want) > 3 and [stage["readings"]["events"] for stage in stages] == want, (want, stages)


@fact
def bursts_across_a_periodic_box_are_one(folder):
    """Two bonds at the two sides, a third in the middle."""
    place = os.path.join(folder, "out")
    pairs = [[0.4e-3, 5e-3], [10e-3, 5e-3], [19.6e-3, 5e-3]]
    particles = [[x, y + side * 1e-3, 1e-3] for x, y in pairs for side in (-1, 1)]
    run(write_scene(folder, {
        "dimension": 2, "specimen": {"particles": particles, "material": "m"},
        "materials": [{"name": "m", "density": 2500, "contact_modulus": 1e9, "kratio": 2, "tensile_strength": 1e6, "shear_strength": 1e6}],
        "law": {"stiffness": "harmonic"}, "bonds": {}, "periodic": {"min": [0, 0], "max": [20e-3, 10e-3]},
        "sets": [{"name": "up", "select": {"box": {"min": [0, 5.5e-3], "max": [1, 1]}}, "motion": {"vy": 1}},
                 {"name": "low", "select": {"box": {"min": [0, 0], "max": [1, 4.5e-3]}}, "motion": {"vy": -1}}],
        "time": {"end": 1e-5}, "output": {"burst_reach": 1.5}}), place)
    b = check_bursts(place, [20e-3, 10e-3])
    assert sorted(b["size"]) == [1, 2], b
    assert abs(b["x"][b["size"] == 2][0] % 20e-3 - 0) < 1e-5 or abs(b["x"][b["size"] == 2][0] % 20e-3 - 20e-3) < 1e-5
    with results(place) as file:
        assert abs(file["bursts"].attrs["reach"] - 3e-3) < 1e-12


# --- fragments -----------------------------------------------------------------------------------------

def pieces_by_hand(folder):
    b, count = at_end(folder, "bonds"), len(at_end(folder, "particles")["radius"])
    holds = np.isin(b["state"], (0, 4, 5))
    label = np.arange(count)
    while True:
        least = np.minimum(label[b["i"][holds]], label[b["j"][holds]])
        new = label.copy()
        np.minimum.at(new, b["i"][holds], least)
        np.minimum.at(new, b["j"][holds], least)
        if np.array_equal(new, label):
            return label
        label = new


@fact
def fragments_are_what_bonds_hold_together_with_their_mass_and_momentum(folder):
    place = os.path.join(folder, "out")
    run(UCS, place, "--set", "output.fields=[fragment, fragment_size]")
    f, p = at_end(place, "fragments"), at_end(place, "particles")
    label = pieces_by_hand(place)
    lone, index, sizes = np.unique(label, return_inverse=True, return_counts=True)
    assert len(f["mass"]) == len(lone) > 50
    assert np.array_equal(p["fragment_size"], sizes[index])
    assert np.array_equal(f["particles"], np.bincount(p["fragment"])) and np.array_equal(f["first"][p["fragment"]], lone[index])
    assert (np.diff(f["volume"]) <= 0).all()
    m = p["mass"]
    assert np.allclose(f["mass"], np.bincount(p["fragment"], m), rtol=1e-12)
    assert np.allclose(f["volume"], np.bincount(p["fragment"], 4 / 3 * np.pi * p["radius"] ** 3), rtol=1e-12)
    for name, of in (("centre", "position"), ("velocity", "velocity")):
        for a in range(3):
            want = np.bincount(p["fragment"], m * p[of][:, a]) / f["mass"]
            assert np.allclose(f[name][:, a], want, rtol=1e-9, atol=1e-12 * np.abs(p[of]).max()), name
    r = summary(place)["readings"]
    assert r["fragments"] == np.count_nonzero(f["particles"] > 1)
    assert abs(r["largest_fragment"] - f["volume"][0] / f["volume"].sum()) < 1e-12
    with h5py.File(os.path.join(place, series(place)[-1][0])) as file:
        assert np.array_equal(file["VTKHDF/PointData/fragment"][:].ravel(), p["fragment"])
    with h5py.File(os.path.join(place, series(place)[0][0])) as file:
        first = file["VTKHDF/PointData/fragment_size"][:].ravel()
        assert first.max() > 0.99 * len(first)


@fact
def removed_particles_belong_to_no_fragment(folder):
    place = os.path.join(folder, "out")
    run(write_scene(folder, {
        "dimension": 2, "specimen": {"particles": [[0, 0, 1e-3], [2e-3, 0, 1e-3], [10e-3, 0, 1e-3], [20e-3, 0, 1e-3]]},
        "materials": [{"name": "m", "density": 2500, "contact_modulus": 1e9, "kratio": 2, "tensile_strength": 1e6, "shear_strength": 1e6}],
        "law": {"stiffness": "harmonic"}, "bonds": {}, "domain": {"min": [-1, -1], "max": [0.021, 1], "lost": "remove"},
        "sets": [{"name": "out", "select": {"ids": [3]}, "initial_velocity": [3, 0]}, {"name": "up", "select": {"ids": [0, 1]},
                 "initial_velocity": [0, 2]}], "time": {"end": 2e-3}, "output": {"fields": ["fragment", "fragment_size"]}}), place)
    f, p = at_end(place, "fragments"), at_end(place, "particles")
    assert list(p["fragment"]) == [0, 0, 1, -1] and list(p["fragment_size"]) == [2, 2, 1, 0] and list(p["removed"]) == [0, 0, 0, 1]
    assert np.allclose(f["velocity"], [[0, 2, 0], [0, 0, 0]]) and np.allclose(f["centre"][0], [1e-3, 4e-3, 0], atol=2e-6), f
    assert np.allclose(f["mass"], 2500 * np.pi * 1e-6 * np.array([2, 1]))


if __name__ == "__main__":
    sys.exit(main())
