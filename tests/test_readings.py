"""Laboratory tests: ends of several parts, available readings and reasons for absent ones. Speaks TAP."""
from program import *  # noqa: F403


def block(cells, **more):
    """A bonded 2D block of discs of 1 mm that cannot break, damped so that waves die out in a part of the run."""
    scene = {
        "dimension": 2,
        "specimen": {"lattice": {"kind": "square", "radius": 1e-3, "cells": cells}},
        "materials": [{"name": "a", "density": 2000, "normal_stiffness": 1e6, "kratio": 2, "friction": 0.3,
                       "bond_tension_limit": 1e9, "bond_shear_limit": 1e9}],
        "law": {"stiffness": "uniform"}, "bonds": {},
        "damping": {"background": {"model": "viscous", "coefficient": 200}},
        "time": {"end": 0.1}, "output": {"history_rows": 200, "snapshots": 0, "checkpoint": "off"},
        "run": {"threads": 1}}
    return {**scene, **more}


RAMP = [[0, 0], [0.1, -1e-3]]


def part(name, low, high, **motion):
    return {"name": name, "select": {"box": {"min": low, "max": high}}, "motion": motion}


def bending(lower, more_sets=()):
    """A beam of 16 by 4 discs on two supports, pressed down in the middle."""
    sets = [part("left", [0, 0], [2e-3, 2e-3], vy=0), part("right", [30e-3, 0], [32e-3, 2e-3], vy=0),
            part("punch", [14e-3, 6e-3], [18e-3, 8e-3], vy=RAMP), *more_sets]
    return block([16, 4], sets=sets, test={"kind": "compression", "axis": "y", "lower": lower, "upper": "punch"})


def run_scene(folder, scene, *arguments):
    """The output folder and the messages of the run."""
    out = os.path.join(folder, "out")
    return out, expect(gneiss("run", write_scene(folder, scene), "--out", out, *arguments), 0)


def absent(out):
    return summary(out)["absent"]


def warnings(out):
    return {w["name"]: w["text"] for w in summary(out)["warnings"]}


# --- ends -------------------------------------------------------------------------------------------------

@fact
def the_forces_of_two_supports_add_up(folder):
    out, done = run_scene(folder, bending(["left", "right"]), "--quiet")
    rows = history(out)
    supports = rows["set_left_reaction_y"] + rows["set_right_reaction_y"]
    assert np.allclose(rows["force"], 0.5 * (supports - rows["set_punch_reaction_y"]), rtol=1e-12, atol=1e-12)
    # The remaining difference is the drag of the viscous damping: mass times rate times velocity over the force.
    assert rows["force"][-1] > 0 and abs(supports[-1] / rows["force"][-1] - 1) < 0.02, supports[-1]
    assert warnings(out) == {} and done.stderr == ""
    assert summary(out)["readings"]["end_imbalance"] < 0.05, summary(out)["readings"]


@fact
def an_end_without_a_support_is_reported_as_unbalanced(folder):
    """Half of the load acts on one end: the difference of the ends is two thirds of the mean."""
    out, done = run_scene(folder, bending("left"), "--quiet")
    assert abs(summary(out)["readings"]["end_imbalance"] - 2 / 3) < 0.05
    assert "differ by" in warnings(out)["end_imbalance"] and "warning: end_imbalance" in done.stderr, done.stderr


@fact
def particles_have_force_and_deflection_as_elements_have(folder):
    out, _ = run_scene(folder, bending(["left", "right"]), "--quiet")
    rows = history(out)
    assert np.allclose(rows["deflection"], rows["strain"] * 8e-3, rtol=1e-12)
    assert np.allclose(rows["force"], rows["stress"] * 32e-3, rtol=0.05)  # the hull cuts corners of the discs
    moved = 0.5 * 1e-3 / 0.1 * rows["time"][-1] ** 2
    assert abs(rows["deflection"][-1] / moved - 1) < 1e-6


@fact
def a_reaction_goes_to_the_set_that_drives_the_channel(folder):
    """A pin that holds a support sideways does not carry its vertical force."""
    pin = part("pin", [0, 0], [2e-3, 2e-3], vx=0)
    out, _ = run_scene(folder, bending(["left", "right"], [pin]), "--quiet")
    rows = history(out)
    assert rows["set_pin_reaction_y"][-1] == 0
    assert abs(rows["set_left_reaction_y"][-1] / rows["set_right_reaction_y"][-1] - 1) < 0.02


@fact
def bodies_and_walls_make_an_end_together(folder):
    """Two blocks below, a wall above; each part carries its share, the travel is the mean over the parts."""
    def foot(name, x, speed):
        corners = [[x, -2e-3], [x + 6e-3, -2e-3], [x + 6e-3, 0], [x, 0]]
        return {"name": name, "polygon": corners, "stiffness": 1e6, "motion": {"vy": speed}}

    wall = {"name": "lid", "point": [0, 8e-3], "normal": [0, -1], "stiffness": 1e6, "motion": {"vy": RAMP}}
    scene = block([8, 4], bodies=[foot("one", 0, 0), foot("two", 10e-3, [[0, 0], [0.1, 5e-4]])], walls=[wall],
                  test={"kind": "compression", "axis": "y", "lower": ["one", "two"], "upper": "lid"})
    out, _ = run_scene(folder, scene, "--quiet")
    rows = history(out)
    feet = rows["body_one_force_y"] + rows["body_two_force_y"]
    assert np.allclose(rows["force"], 0.5 * (rows["wall_lid_force_y"] - feet), rtol=1e-12, atol=1e-12)
    assert rows["body_one_force_y"][-1] < 0 and rows["body_two_force_y"][-1] < 0
    travel = 0.5 * rows["body_two_displacement_y"] - rows["wall_lid_displacement_y"]
    assert np.allclose(rows["deflection"], travel, rtol=1e-12, atol=1e-18)


@fact
def a_set_that_nothing_drives_is_watched(folder):
    """The loaded end has the force of the other end and moves as its particles do."""
    sets = [part("top", [0, 6e-3], [8e-3, 8e-3], vy=RAMP), part("foot", [0, 0], [8e-3, 2e-3], vx=0)]
    wall = {"name": "floor", "point": [0, 0], "normal": [0, 1], "stiffness": 1e6}
    scene = block([4, 4], sets=sets, walls=[wall],
                  test={"kind": "compression", "axis": "y", "lower": "foot", "upper": "top"})
    out, _ = run_scene(folder, scene, "--quiet")
    rows = history(out)
    assert np.array_equal(rows["stress_lower"], rows["stress_upper"]) and rows["stress"][-1] > 0
    moved = 0.5 * 1e-3 / 0.1 * rows["time"][-1] ** 2
    assert 0 < rows["deflection"][-1] < 0.95 * moved, "the foot did not give way"
    assert "by definition" in absent(out)["end_imbalance"]


@fact
def an_end_is_made_of_things_that_are_there_and_each_once(folder):
    for lower, pattern in ((["left", "middle"], "found 'middle'"), (["left", "left"], "found 'left' again"),
                           (["left", "punch"], "test.upper: expected another end than lower, found 'punch'"),
                           ([], "expected a name or a list of names")):
        expect(gneiss("check", write_scene(folder, bending(lower))), 2, pattern)


# --- available readings -----------------------------------------------------------------------------------

def between(cells, sides=None, **more):
    """A block between two walls along y and, with `sides`, two more along x that move in by that times as much."""
    height, width = 2e-3 * cells[1], 2e-3 * cells[0]
    wall = {"stiffness": 1e6}
    walls = [{"name": "low", "point": [0, 0], "normal": [0, 1], **wall},
             {"name": "up", "point": [0, height], "normal": [0, -1], "motion": {"vy": RAMP}, **wall}]
    if sides is not None:
        walls += [{"name": "west", "point": [0, 0], "normal": [1, 0], **wall},
                  {"name": "east", "point": [width, 0], "normal": [-1, 0], "motion": {"vx": [[0, 0], [0.1, -1e-3 * sides]]},
                   **wall}]
    return block(cells, walls=walls, test={"kind": "compression", "axis": "y", "lower": "low", "upper": "up"}, **more)


@fact
def one_axis_gives_a_modulus_and_poissons_ratio(folder):
    """A square lattice is loaded along its bonds: k_n per unit of width, no lateral strain, in series with two walls of k_n per
    column, as stiff as a bond each: 12 discs have 11 bonds and 12 diameters."""
    out, _ = run_scene(folder, between([6, 12]), "--quiet")
    readings = summary(out)["readings"]
    assert abs(readings["young_modulus"] / (1e6 * 12 / 13) - 1) < 0.02, readings
    assert abs(readings["poisson_ratio"]) < 0.01, readings
    peaks = {"peak_stress", "peak_strain", "crack_initiation_stress", "crack_damage_stress", "brittleness", "b_value"}
    assert set(absent(out)) == peaks, absent(out)


@fact
def sides_that_are_pressed_leave_neither_modulus_nor_poissons_ratio(folder):
    out, done = run_scene(folder, between([12, 12], sides=1))
    for name in ("young_modulus", "young_modulus_average", "poisson_ratio", "plane_young_modulus", "plane_poisson_ratio"):
        assert summary(out)["readings"][name] is None
        assert re.search(r"not loaded along y alone: stress_xx changes by (0.9|1|1.)\d* of", absent(out)[name]), absent(out)
    assert "Poisson's ratio                 -   the specimen is not loaded along y alone" in done.stdout, done.stdout


@fact
def a_shear_test_leaves_neither_modulus_nor_poissons_ratio(folder):
    """The upper edge moves sideways and a little downwards."""
    sets = [part("low", [0, 0], [24e-3, 2e-3], vx=0, vy=0),
            part("up", [0, 22e-3], [24e-3, 24e-3], vx=[[0, 0], [0.1, 1e-3]], vy=[[0, 0], [0.1, -1e-4]])]
    scene = block([12, 12], sets=sets, test={"kind": "compression", "axis": "y", "lower": "low", "upper": "up"})
    out, _ = run_scene(folder, scene, "--quiet")
    for name in ("young_modulus", "young_modulus_average", "poisson_ratio"):
        assert summary(out)["readings"][name] is None and "not loaded along y alone" in absent(out)[name], absent(out)


@fact
def bending_leaves_no_modulus_over_the_platen_strain(folder):
    out, _ = run_scene(folder, bending(["left", "right"]), "--quiet")
    assert summary(out)["readings"]["young_modulus"] is None and "bending" in absent(out)["young_modulus"], absent(out)


@fact
def soft_walls_leave_the_modulus_over_the_mean_strain(folder):
    run(UCS, os.path.join(folder, "stiff"))
    stiff = summary(os.path.join(folder, "stiff"))["readings"]
    soft = os.path.join(folder, "soft")
    run(UCS, soft, "--set", "walls.bottom.stiffness=1e6", "--set", "walls.top.stiffness=1e6")
    read = summary(soft)["readings"]
    assert read["young_modulus"] is None and "soft ends" in absent(soft)["young_modulus"], absent(soft)
    # The specimen is loaded 5 times slower, so that its wave is smaller than that of the other: a few
    # percent.
    assert abs(read["young_modulus_average"] / stiff["young_modulus_average"] - 1) < 0.05, (read, stiff)
    assert abs(read["poisson_ratio"] - stiff["poisson_ratio"]) < 0.01, (read, stiff)


@fact
def a_stress_that_still_rises_is_no_peak(folder):
    run(UCS, folder, "--set", "time.end=0.1 ms")
    readings, stress = summary(folder)["readings"], history(folder)["stress"]
    assert readings["peak_stress"] is None and readings["peak_strain"] is None
    assert "no bond has broken" in absent(folder)["peak_stress"] or "ended before the peak" in absent(folder)["peak_stress"]
    assert readings["largest_stress"] == stress.max() and readings["largest_strain"] > 0


@fact
def a_stress_that_has_fallen_is_a_peak(folder):
    run(UCS, folder)
    readings, stress = summary(folder)["readings"], history(folder)["stress"]
    assert readings["peak_stress"] == readings["largest_stress"] == stress.max() and stress[-1] < 0.95 * stress.max()
    assert not {"peak_stress", "peak_strain"} & set(absent(folder))


@fact
def results_say_beside_every_absent_reading_why(folder):
    out, _ = run_scene(folder, between([12, 12], sides=1), "--quiet")
    with results(out) as file:
        for name, data in file["readings"].items():
            reason = text(data.attrs["absent"]) if "absent" in data.attrs else ""
            assert np.isnan(data[0]) == bool(reason), name
            assert absent(out).get(name, "") == reason, name


@fact
def without_a_test_every_reading_is_absent_for_that(folder):
    scene = between([3, 3])
    del scene["test"]
    out, _ = run_scene(folder, scene, "--quiet")
    assert set(absent(out)) == set(summary(out)["readings"])
    assert set(absent(out).values()) == {"the scene has no test"}


@fact
def a_peak_from_few_rows_is_reported_with_its_range(folder):
    """A brittle block whose readings are formed from many and from few rows, with the same bits."""
    peaks = {}
    for rows in (300, 6, 3):
        out = os.path.join(folder, str(rows))
        done = run(UCS, out, "--set", f"output.history_rows={rows}")
        h = history(out)
        peaks[rows] = h["stress"].max()
        assert summary(out)["readings"]["peak_stress"] == peaks[rows]
        assert ("peak_rows" in warnings(out)) == (rows < 300) == ("warning: peak_rows" in done.stderr), warnings(out)
        k = h["stress"].argmax()
        least, most = h["strain"][k - 1], h["strain"][k + 1]
        assert rows == 300 or f"{least + 0.0:.4g} and {most:.4g}" in warnings(out)["peak_rows"], warnings(out)
        if rows < 300:
            said = re.search(r"may have been (\S+) Pa instead of (\S+) Pa", warnings(out)["peak_rows"])
            assert float(said[2]) <= peaks[300] <= float(said[1]), (said[0], peaks)
            assert least < history(os.path.join(folder, "300"))["strain"][np.argmax(history(os.path.join(folder, "300"))["stress"])] < most


def packed(kind, **more):
    """A packed prism between frictionless walls whose contacts have a quarter of their shear strength in tension:
    cracks open from a fifth of the strength on, along the load, and the sides move by more than those of an intact
    specimen."""
    height, width = 30e-3, 15e-3
    plane = kind == "biaxial"
    shape = {"rectangle": {"width": width, "height": height}} if plane else {"cylinder": {"diameter": width, "height": height}}
    axis = "y" if plane else "z"
    walls = [{"name": name, "point": [0] * (1 if plane else 2) + [at], "normal": [0] * (1 if plane else 2) + [sign], "stiffness": "150 MN/m",
              "passive": True, "motion": {f"v{axis}": [[0, 0], [5e-5, 0.1 * sign]]}} for name, at, sign in (("bottom", 0, 1), ("top", height, -1))]
    return {"dimension": 2 if plane else 3, "specimen": {**shape, "particles": 600, "packing": {"size_ratio": 3, "overlap": "passive"}},
            "materials": [{"name": "rock", "density": 2650, "contact_modulus": "10 GPa", "kratio": 2, "friction": 0.5,
                           "tensile_strength": "4 MPa", "shear_strength": "40 MPa"}],
            "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.05},
            "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}}, "walls": walls,
            "test": {"kind": kind, "axis": axis, "lower": "bottom", "upper": "top"}, "time": {"end": 6e-3, "stop": {"peak_drop": 0.4}},
            "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}, **more}


@plain_fact
def elastic_constants_are_those_of_the_specimen_before_it_cracks(folder):
    for kind, more in (("compression", {}), ("triaxial", {"membrane": {"pressure": [[0, 0], [1e-4, 5e5]]}}),
                       ("biaxial", {"membrane": {"pressure": [[0, 0], [1e-4, 5e5]]}})):
        out, _ = run_scene(folder, packed(kind, **more), "--quiet", "--force")
        rows, found = history(out), summary(out)["readings"]
        stress, broken = rows["stress"], rows["broken_tension"] + rows["broken_shear"]
        along, across = ("zz", ("xx", "yy")) if kind != "biaxial" else ("yy", ("xx",))
        peak = stress.argmax()
        first = np.argmax((stress >= 0.01 * stress[peak]) & (np.arange(len(stress)) >= np.argmax(rows["strain"] > 0)))
        whole = slice(first, np.argmax(broken > broken[first]))
        half = slice(first, np.argmax(stress > 0.5 * stress[peak]))

        def ratio(used):
            slope = {a: np.polyfit(stress[used], rows["strain_" + a][used], 1)[0] for a in (along, *across)}
            return -np.mean([slope[a] for a in across]) / slope[along]

        assert stress[whole.stop] < 0.4 * stress[peak], (kind, stress[whole.stop] / stress[peak])
        assert ratio(half) > ratio(whole) + 0.03, (kind, ratio(half), ratio(whole))
        assert abs(found["poisson_ratio"] - ratio(whole)) < 0.01, (kind, found["poisson_ratio"], ratio(whole))
        assert abs(found["elastic_stress"] / stress[whole.stop] - 1) < 0.1, (kind, found["elastic_stress"], stress[whole.stop])
        change = {a: rows["strain_" + a][half.stop] - rows["strain_" + a][first] for a in (along, *across)}
        secant = -np.mean([change[a] for a in across]) / change[along]
        assert abs(found["secant_poisson_ratio"] - secant) < 1e-3, (kind, found["secant_poisson_ratio"], secant)
        if kind == "compression":
            causes = {c["name"]: c for c in summary(out)["error_budget"]["young_modulus"]["causes"]}
            assert causes["nonlinearity"]["is"] == "measured" and causes["nonlinearity"]["error"] > 0


@plain_fact
def the_modulus_of_a_body_with_a_waist_is_that_of_its_material(folder):
    """Stress of the waist and closing over the whole length do not refer to the same length: readings of discs packed
    in such a shape would be a third too large. They are compared with a strip of the same width and density."""
    length, waist = 60e-3, 10e-3
    sides = [(0.0, 1.0), (0.1, 1.0), (0.3, 0.5), (0.7, 0.5), (0.9, 1.0), (1.0, 1.0)]  # heights over the length; half widths over the waist
    corners = [[sign * w * waist, y * length] for sign, line in ((1, sides), (-1, sides[::-1])) for y, w in line]
    wide = {"polygon": corners}
    strip = {"polygon": [[-waist / 2, 0], [waist / 2, 0], [waist / 2, length], [-waist / 2, length]]}
    found = {}
    for name, shape, count, area in (("strip", strip, 1000, waist), ("waist", wide, 1400, waist), ("mean", wide, 1400, None)):
        scene = packed("compression")
        walls = [{"name": end, "point": [0, at], "normal": [0, sign], "stiffness": "10 GN/m", "passive": True,
                  "motion": {"vy": [[0, 0], [5e-5, 0.1 * sign]]}} for end, at, sign in (("bottom", 0, 1), ("top", length, -1))]
        scene.update(dimension=2, specimen={**shape, "particles": count, "packing": {"size_ratio": 2, "overlap": "passive"}}, walls=walls,
                     test={"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top", "length": length, **({"area": area} if area else {})},
                     time={"end": 1e-3})
        scene["materials"][0].update(tensile_strength="1 GPa", shear_strength="1 GPa")
        out, _ = run_scene(folder, scene, "--quiet", "--force")
        found[name] = summary(out)["readings"]
        if name != "strip":
            assert found[name]["poisson_ratio"] is None and "section" in absent(out)["poisson_ratio"], absent(out)
    assert abs(found["waist"]["young_modulus"] / found["mean"]["young_modulus"] - 1) < 0.02, found
    assert abs(found["waist"]["young_modulus"] / found["strip"]["young_modulus"] - 1) < 0.08, {n: f["young_modulus"] for n, f in found.items()}


def pressed(polygon, length, count):
    """Discs in a polygon that cannot break, pressed along y by those within 3 % of its length at each end. (Walls
    would touch only the few grains that protrude farthest.)"""
    scene = packed("compression")
    del scene["walls"]
    sets = [{"name": name, "select": {"box": {"min": [-1, low * length], "max": [1, high * length]}}, "motion": {"vy": [[0, 0], [5e-5, speed]]}}
            for name, low, high, speed in (("bottom", -1, 0.03, 0.1), ("top", 0.97, 2, -0.1))]
    scene.update(dimension=2, specimen={"polygon": polygon, "particles": count, "packing": {"size_ratio": 2, "overlap": "passive"}}, sets=sets,
                 test={"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top"}, time={"end": 1e-3})
    scene["materials"][0].update(tensile_strength="1 GPa", shear_strength="1 GPa")
    return scene


def mirrored(sides):
    """A polygon about the y axis from (y, half width)."""
    return [[w, y] for y, w in sides] + [[-w, y] for y, w in reversed(sides)]


@fact
def the_modulus_of_particles_without_a_shape_is_over_the_area_that_is_given(folder):
    """The area of every tapered body was taken as that of its narrowest section, and the modulus scaled by it."""
    length = 40e-3
    scene = pressed(mirrored([(0, 10e-3), (length, 5e-3)]), length, 800)
    out, _ = run_scene(folder, {**scene, "time": {"end": 1e-8}}, "--quiet", "--force")
    with results(out) as r:
        place, radius = r["particles/position"][:, :2], r["particles/radius"][:]
    np.savetxt(os.path.join(folder, "wedge.txt"), np.column_stack([place, radius]), fmt="%.17g")
    out, _ = run_scene(folder, scene, "--quiet", "--force")
    shape = summary(out)["readings"]["young_modulus"]
    scene["specimen"] = {"file": "wedge.txt"}
    found = {}
    for area in (15e-3, 20e-3):
        scene["test"]["area"] = area
        reported = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
        assert re.search(r"section +varies along y, 0\.\d+ of the mean at the narrowest section, and no shape gives it", reported), reported
        out, _ = run_scene(folder, scene, "--quiet", "--force")
        found[area] = summary(out)["readings"]["young_modulus"]
        assert "varies along y" in warnings(out)["uneven_section"], warnings(out)
    # Mean of A times mean of 1/A is 1.5 ln 2 = 1.04, by which a prism of the mean area is less stiff; 6 % of the length is held.
    assert abs(0.94 * 1.04 * found[15e-3] / shape - 1) < 0.05, (shape, found)
    assert abs(15 * found[15e-3] / (20 * found[20e-3]) - 1) < 1e-3, found


@fact
def the_strength_of_a_round_stone_is_said_to_be_that_of_the_body(folder):
    """Its stress is the force over the mean section, and no modulus follows from it; a strip has no such warning."""
    size, scene = 20e-3, packed("compression")
    walls = [{"name": end, "point": [0, at], "normal": [0, sign], "stiffness": "1 GN/m", "motion": {"vy": 0.1 * sign}} for end, at, sign in (("bottom", 0, 1), ("top", size, -1))]
    scene.update(dimension=2, walls=walls, test={"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top"}, time={"end": 2e-4})
    for specimen, warned in (({"disc": {"diameter": size}, "origin": [0, size / 2]}, True), ({"polygon": mirrored([(0, size / 4), (size, size / 4)])}, False)):
        scene["specimen"] = {**specimen, "particles": 200, "packing": {"size_ratio": 2, "overlap": "passive"}}
        out, _ = run_scene(folder, scene, "--quiet", "--force")
        assert summary(out)["readings"]["largest_stress"] > 0
        said = warnings(out).get("uneven_section", "")
        assert bool(re.search(r"stresses and strengths are forces over [\d.e-]+ m2, and the narrowest section across y has .* those of this body", said)) == warned, said
        reported = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
        assert bool(re.search(r"section .* at the narrowest section: (no modulus|moduli).* stresses over", reported)) == warned, reported


@plain_fact
def the_error_of_the_modulus_of_a_stepped_body_includes_its_section(folder):
    """Stress spreads into a wider part gradually, so that the mean of 1/area of a slender bar is no bound. The specimen is compared with a strip
    without steps."""
    length, waist = 60e-3, 6e-3
    found = {}
    for name, sides, count in (("strip", [(0, waist), (length, waist)], 1000),
                               ("steps", [(0, 2 * waist), (0.3 * length, 2 * waist), (0.3 * length, waist), (0.7 * length, waist),
                                          (0.7 * length, 2 * waist), (length, 2 * waist)], 1600),
                               ("taper", [(0, 1.25 * waist), (length, waist)], 1100)):
        out, _ = run_scene(folder, pressed(mirrored(sides), length, count), "--quiet", "--force")
        causes = {c["name"]: c for c in summary(out)["error_budget"]["young_modulus"]["causes"]}
        found[name] = summary(out)["readings"]["young_modulus"], causes.get("section", {"error": 0})
        assert causes.get("section", {"is": "estimated"})["is"] == "estimated"
    strip, steps = found["strip"][0], found["steps"][0]
    assert found["strip"][1]["error"] == 0 and found["taper"][1]["error"] < 0.01 * found["taper"][0], found
    assert 0.1 < strip / steps - 1 and abs(strip - steps) < 1.2 * found["steps"][1]["error"] < 0.3 * steps, found


@plain_fact
def the_strain_of_a_test_counts_from_the_contact_of_both_ends(folder):
    """Platens start at a distance from the specimen: walls or bodies, on one side or both."""
    def closing(gap_below, gap_above, kind="wall", **more):
        scene = packed("compression", **more)
        for wall, gap in zip(scene["walls"], (-gap_below, gap_above)):
            wall["point"][2] += gap
        if kind == "body":
            top = scene["walls"].pop()
            scene["bodies"] = [{"name": "top", "box": {"size": [20e-3, 20e-3, 5e-3]}, "origin": [-10e-3, -10e-3, top["point"][2]],
                                "stiffness": top["stiffness"], "motion": top["motion"]}]
        scene["materials"][0].update(tensile_strength="20 MPa")
        scene["time"]["end"] = 12e-3
        for wall in scene["walls"]:
            wall["motion"] = {"vz": 0.1 * wall["normal"][2]} if "start" in scene["time"] else wall["motion"]
        out, _ = run_scene(folder, scene, "--quiet", "--force")
        return history(out), summary(out)["readings"]

    # Grains protrude slightly beyond the end planes, into platens that touch these planes: without an allowance the
    # first of them would form the only contact.
    _, flush = closing(0, 0)
    _, there = closing(0.2e-3, 0.2e-3)
    assert abs(there["peak_strain"] / flush["peak_strain"] - 1) < 0.25, (there["peak_strain"], flush["peak_strain"])
    for gaps, kind in (((0.2e-3, 0.2e-3), "wall"), ((0.2e-3, 1e-3), "wall"), ((1e-3, 0.2e-3), "wall"), ((0.2e-3, 0.5e-3), "body")):
        rows, found = closing(*gaps, kind)
        assert abs(found["peak_stress"] / there["peak_stress"] - 1) < 0.05, (gaps, kind, found["peak_stress"], there["peak_stress"])
        assert abs(found["peak_strain"] / there["peak_strain"] - 1) < 0.05, (gaps, kind, found["peak_strain"], there["peak_strain"])
        touched = np.argmax((rows["stress_lower"] != 0) & (rows["stress_upper"] != 0))
        assert np.all(rows["strain"][: touched] == 0) and rows["deflection"][touched] > 0.8 * sum(gaps), (gaps, kind, rows["deflection"][touched])
    # The static states before the first break have few rows without contact.
    rows, found = closing(0.2e-3, 0.2e-3, time={"start": "first_break", "stop": {"peak_drop": 0.4}})
    assert abs(found["peak_strain"] / there["peak_strain"] - 1) < 0.05, (found["peak_strain"], there["peak_strain"])


@fact
def a_gap_to_unbonded_grains_that_counts_as_strain_is_reported(folder):
    """Loose grains touch the ends no more than each other: within their spacing the strain counts from the start, beyond it
    from contact."""
    height = 30e-3
    for gap, said in ((0.5e-3, "strain counts from the start"), (5e-3, "strain counts from contact")):
        scene = packed("compression", bonds={"enabled": "off"}, time={"end": 1e-3}, gravity=[0, 0, 0])
        scene["specimen"]["packing"] = {"size_ratio": 3}
        scene["test"]["length"] = height
        scene["walls"][1]["point"][2] += gap
        for key in ("tensile_strength", "shear_strength"):
            del scene["materials"][0][key]
        reported = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
        line = re.search(r"ends +begin (\S+) m in total away.*", reported)
        assert line and said in line[0] and 0.9 * gap < float(line[1]) < gap + 1e-3, reported
        out, _ = run_scene(folder, scene, "--quiet", "--force")
        rows = history(out)
        counted = rows["strain"][-1] * height / rows["deflection"][-1]
        assert abs(counted - (1 if "start" in said else 0)) < 1e-6, (gap, counted)


if __name__ == "__main__":
    sys.exit(main())
