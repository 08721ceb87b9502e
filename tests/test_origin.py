"""Models far from 0: the same motion as near it, and the coordinates that the user gave. Speaks TAP."""
from program import *  # noqa: F403

# Multiples of large powers of two: numbers with few digits near 0 keep all of them when moved there.
EXACT = (2.0**22, -2.0**21, 2.0**20)
MAP = (5e6, -3e6, 1e6)
NEAR = (0.0, 0.0, 0.0)
# The radius and lengths below are dyadic, so that the scene of each place has the same digits.
RADIUS, WIDTH = 2.0**-9, 2.0**-6


def at(place, point):
    return [p + x for p, x in zip(place, point)]


def bonded(place):
    """A bonded block on a floor, an approaching wall and body, a driven set, a set with an initial velocity."""
    return {
        "dimension": 3,
        "specimen": {"lattice": {"kind": "fcc", "radius": RADIUS, "cells": [3, 3, 4],
                                 "origin": at(place, (-WIDTH / 2, -WIDTH / 2, 0))}, "material": "rock"},
        "materials": [{"name": "rock", "density": 2500, "normal_stiffness": 1e6, "kratio": 2, "friction": 0.3,
                       "bond_tension_limit": 5, "bond_shear_limit": 5}],
        "law": {"stiffness": "uniform"},
        "bonds": {},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.3}},
        "gravity": [0, 0, -10],
        "sets": [
            {"name": "held", "select": {"end": {"axis": "z", "side": "lower", "depth": RADIUS * 1.5}},
             "motion": {"vx": 0.001, "vz": 0}},
            {"name": "hit", "select": {"box": {"min": at(place, (-1, -1, WIDTH)), "max": at(place, (1, 1, 1))}},
             "initial_velocity": [0.01, 0, 0]}],
        "walls": [
            {"name": "floor", "point": at(place, (0, 0, 0)), "normal": [0, 0, 1], "stiffness": 1e6},
            {"name": "top", "point": at(place, (0, 0, 0.0234375)), "normal": [0, 0, -1], "stiffness": 1e6,
             "kratio": 2, "friction": 0.4, "motion": {"vz": -0.02}}],
        "bodies": [
            {"name": "punch", "box": {"size": [2 * RADIUS, WIDTH, WIDTH]},
             "origin": at(place, (-WIDTH / 2 - 2 * RADIUS, -WIDTH / 2, RADIUS)), "stiffness": 1e6,
             "motion": {"vx": 0.05}},
            {"name": "stone", "box": {"size": [WIDTH, WIDTH, RADIUS]}, "free": True, "density": 2000,
             "origin": at(place, (WIDTH, 0, 2 * RADIUS)), "stiffness": 1e6, "initial_spin": [0, 0, 3]}],
        "test": {"kind": "compression", "axis": "z", "lower": "floor", "upper": "top"},
        "time": {"end": 2e-3, "step": 2e-6},
        "output": {"history_rows": 20, "snapshots": 1, "checkpoint": "off"},
        "run": {"threads": 1},
    }


def beam(place, corner=0.0):
    """Finite elements alone, chosen by boxes about their corners."""
    low, high = at(place, (corner, corner)), at(place, (corner + 0.1, corner + 0.05))
    return {
        "dimension": 2,
        "elements": {
            "rectangle": {"size": [0.1, 0.05], "cells": [12, 6], "origin": low},
            "materials": [{"young": 30e9, "poisson": 0.2, "density": 2400}],
            "motions": [
                {"name": "lo", "box": {"min": low, "max": [high[0], low[1]]}, "motion": {"vx": 0, "vy": 0}},
                {"name": "hi", "box": {"min": [low[0], high[1]], "max": high}, "motion": {"vy": -1e-3}}]},
        "damping": {"background": {"model": "viscous", "coefficient": 1e5}},
        "test": {"kind": "compression", "axis": "y", "lower": "lo", "upper": "hi"},
        "time": {"end": 1e-4},
        "output": {"history_rows": 20, "snapshots": 1},
        "run": {"threads": 1},
    }


def ball(place, **more):
    """One particle in free flight."""
    return {
        "dimension": 3,
        "specimen": {"particles": [[*place, 1e-3]]},
        "materials": [{"name": "a", "density": 2500, "normal_stiffness": 1e6, "kratio": 2}],
        "law": {"stiffness": "uniform"},
        "sets": [{"name": "all", "select": {"all": True}, "initial_velocity": [1e-3, 0, 0]}],
        "time": {"end": 1e-3, "step": 2e-6},
        "output": {"history_rows": 10, "snapshots": 1},
        "run": {"threads": 1}, **more}


def done(folder, scene, name, *arguments):
    """The folder of a run."""
    out = os.path.join(folder, name)
    run(write_scene(folder, scene, name + ".yaml"), out, *arguments)
    return out


def refused(folder, scene, *patterns):
    out = os.path.join(folder, "refused")
    expect(gneiss("run", write_scene(folder, scene, "refused.yaml"), "--out", out, "--quiet"), 2, *patterns)


def field(folder, name):
    with results(folder) as file:
        return file[name][:]


def origin(folder):
    with results(folder) as file:
        return list(file.attrs["origin"])


@fact
def a_bonded_model_has_the_same_bits_wherever_it_stands(folder):
    near = done(folder, bonded(NEAR), "near")
    assert origin(near) == [0, 0, 0]
    for name, place in (("exact", EXACT), ("map", MAP)):
        far = done(folder, bonded(place), name)
        assert origin(far) == list(place), origin(far)
        check_same(far, near)
        for what in ("particles/displacement", "particles/velocity", "bonds/force", "bodies/velocity"):
            assert field(far, what).tobytes() == field(near, what).tobytes(), what
    assert summary(near)["counts"]["broken_tension"] + summary(near)["counts"]["broken_shear"] > 0


@fact
def another_origin_changes_round_off_only(folder):
    # Positions 0.5 m from the origin are rounded to 1e-16 m, and that accumulates over 100 steps. Damping is viscous:
    # the direction of the force on a particle at rest depends on round-off.
    scene = {**bonded(MAP), "time": {"end": 2e-4, "step": 2e-6},
             "damping": {"background": {"model": "viscous", "coefficient": 1e3}}}
    one = done(folder, scene, "one")
    other = done(folder, {**scene, "origin": at(MAP, (-0.5, 0.3, 0.1))}, "other")
    assert origin(other) == at(MAP, (-0.5, 0.3, 0.1))
    a, b = field(one, "particles/displacement"), field(other, "particles/displacement")
    assert abs(a).max() > 1e-7 and abs(a - b).max() < 1e-12, abs(a - b).max()
    for term in ("kinetic", "elastic_normal", "work_walls"):
        a, b = history(one)["energy_" + term], history(other)["energy_" + term]
        assert abs(a - b).max() < 1e-6 * abs(a).max(), (term, a, b)


@fact
def files_show_the_coordinates_of_the_scene(folder):
    near, far = done(folder, bonded(NEAR), "near"), done(folder, bonded(MAP), "far")
    for name in ("particles/position", "bodies/vertex", "bodies/position", "bodies/start"):
        assert (field(far, name) == field(near, name) + MAP).all(), name
    for name in ("particles", "bonds", "bodies"):
        file = series(far, name)[-1][0]
        with h5py.File(os.path.join(near, file)) as a, h5py.File(os.path.join(far, file)) as b:
            assert (b["VTKHDF/Points"][:] == a["VTKHDF/Points"][:] + np.array(MAP)).all(), name
    with results(far) as file:
        scene = text(file["scene"][()])
    assert "origin: [5000000, -3000000, 1000000]" in scene, scene
    assert "point: [5000000, -3000000, 1000000.0234375]" in scene, scene


@fact
def a_run_far_away_resumes_to_the_same_bits(folder):
    whole = done(folder, bonded(MAP), "whole")
    half = done(folder, bonded(MAP), "half", "--set", "time.end=1e-3", "--set", "output.history_rows=10")
    resume(half, "--set", "time.end=2e-3")
    check_same(half, whole)
    assert field(half, "particles/position").tobytes() == field(whole, "particles/position").tobytes()
    assert origin(half) == list(MAP)


@fact
def a_particle_at_map_coordinates_keeps_its_velocity(folder):
    # 500 steps of 2e-9 m, each rounded relative to at most 1e-6 m: 1e-13 of the path.
    for x in (5e6, 1e8):
        out = done(folder, ball([x, 0, 0]), f"at{x:g}")
        assert np.allclose(field(out, "particles/displacement"), [[1e-6, 0, 0]], rtol=1e-12, atol=0)
        assert field(out, "particles/position")[0, 0] == x + 1e-6


@fact
def elements_have_the_same_bits_wherever_they_stand(folder):
    near, far = done(folder, beam(NEAR), "near"), done(folder, beam(EXACT[:2]), "far")
    check_same(far, near)
    assert (field(far, "nodes/position") == field(near, "nodes/position") + [*EXACT[:2], 0]).all()


@fact
def elements_at_1e8_m_keep_their_energy(folder):
    # Near 0 the residual of this scene is 2e-9, from the rounding of 309 steps.
    scene = beam((1e8, 0))
    scene["elements"]["rectangle"].update(size=[0.1, 0.1], cells=[6, 6])
    scene["elements"]["motions"][1]["box"] = {"min": [1e8, 0.1], "max": [1e8 + 0.1, 0.1]}
    scene["elements"]["motions"][0]["motion"] = {"vy": 0}
    out = done(folder, {**scene, "time": {"end": 1e-3}}, "far")
    assert abs(summary(out)["energy_residual"]) < 1e-6, summary(out)["energy_residual"]


@fact
def particles_on_elements_have_the_same_bits_wherever_they_stand(folder):
    def scene(place):
        made = beam(place)
        made["elements"]["rectangle"]["size"] = [0.125, 0.0625]
        made["elements"]["motions"] = [{"name": "lo", "group": "y_lower", "motion": {"vx": 0, "vy": 0}}]
        made["elements"]["contact"] = {"group": "y_upper", "stiffness": 1e6}
        top = at(place, (0.0625, 0.0625 + RADIUS))
        fall = {"specimen": {"particles": [[*top, RADIUS]]}, "gravity": [0, -10],
                "sets": [{"name": "all", "select": {"all": True}, "initial_velocity": [0.1, -1]}],
                "time": {"end": 2e-4}}
        made = {**ball((0, 0)), **made, **fall}
        del made["test"]
        return made
    for k, precision in enumerate(("double", "mixed")):
        near, far = (done(folder, scene(place), name + str(k), "--set", "run.precision=" + precision)
                     for name, place in (("near", NEAR[:2]), ("far", EXACT[:2])))
        check_same(far, near)
        assert history(near)["energy_elastic_elements"].max() > 0


@fact
def boxes_choose_by_the_coordinates_of_the_scene(folder):
    # 5e6 + 0.1 is rounded by 4e-10 m in the scene; the corner of the mesh is rounded alike.
    near, far = done(folder, beam(NEAR, 0.1), "near"), done(folder, beam(MAP[:2], 0.1), "far")
    for name in ("lo", "hi"):
        a, b = (history(run)["motion_" + name + "_reaction_y"] for run in (near, far))
        assert np.allclose(a, b, rtol=1e-6, atol=1e-6 * abs(a).max()), (name, a, b)


@fact
def an_elements_file_far_away_is_read_in_place(folder):
    def mesh(name, place):
        rows = [at(place, point) for point in ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1))]
        nodes = "\n".join(f"{k + 1} {x!r} {y!r} 0" for k, (x, y) in enumerate(rows))
        with open(os.path.join(folder, name), "w") as file:
            file.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n" + nodes + "\n$EndNodes\n$Elements\n4\n"
                       "1 2 2 1 1 1 2 5\n2 2 2 1 1 1 5 4\n3 2 2 1 1 2 3 6\n4 2 2 1 1 2 6 5\n$EndElements\n")
        scene = beam(place)
        low, high = place, at(place, (2, 1))
        scene["elements"] = {
            "mesh": name, "materials": scene["elements"]["materials"],
            "motions": [{"name": "lo", "box": {"min": low, "max": [high[0], low[1]]}, "motion": {"vx": 0, "vy": 0}},
                        {"name": "hi", "box": {"min": [low[0], high[1]], "max": high}, "motion": {"vy": -1e-3}}]}
        scene["time"] = {"end": 1e-3}
        return scene
    near = done(folder, mesh("near.msh", (0.0, 0.0)), "near")
    far = done(folder, mesh("far.msh", EXACT[:2]), "far")
    assert origin(far) == [*EXACT[:2], 0]
    check_same(far, near)


@fact
def a_periodic_box_stands_anywhere(folder):
    def gas(place):
        scene = ball(place)
        scene["specimen"] = {"lattice": {"kind": "cubic", "radius": RADIUS, "cells": [4, 4, 4], "spacing": 1.5,
                                         "origin": at(place, [-6 * RADIUS] * 3)}}
        scene["periodic"] = {"min": at(place, [-6 * RADIUS] * 3), "max": at(place, [6 * RADIUS] * 3)}
        scene["sets"] = []
        scene["initial"] = {"random_velocity": 1}
        scene["time"] = {"end": 4e-3, "step": 5e-6}
        return scene
    near, far = done(folder, gas(NEAR), "near"), done(folder, gas(EXACT), "far")
    check_same(far, near)
    assert abs(field(near, "particles/displacement")).max() > 2 * RADIUS


def soup(folder, corners, name):
    """An STL file of a box between two corners, text."""
    low, high = corners
    points = [[(high if k >> a & 1 else low)[a] for a in range(3)] for k in range(8)]
    with open(os.path.join(folder, name), "w") as file:
        file.write("solid box\n")
        for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
            for t in ((a, b, c), (a, c, d)):
                rows = "\n".join("vertex " + " ".join(repr(x) for x in points[k]) for k in t)
                file.write(f"facet normal 0 0 0\nouter loop\n{rows}\nendloop\nendfacet\n")
        file.write("endsolid\n")
    return name


@fact
def shapes_are_packed_alike_wherever_they_stand(folder):
    def specimens(place, name):
        low, high = at(place, (0, 0, 0)), at(place, (0.25, 0.25, 0.5))
        yield 3, {"box": {"size": [0.25, 0.25, 0.5]}, "origin": low, "particles": 60}
        yield 3, {"surface": soup(folder, (low, high), name + ".stl"), "particles": 60}
        yield 2, {"polygon": [low[:2], [high[0], low[1]], high[:2]], "particles": 40,
                  "packing": {"refine": [{"from": low[:2], "to": low[:2], "size": 0.5, "distance": 0.125}]}}

    def packed(place, name):
        for k, (dimension, specimen) in enumerate(specimens(place, name)):
            path = write_scene(folder, {"dimension": dimension, "specimen": specimen}, f"{name}{k}.yaml")
            out = os.path.join(folder, f"{name}{k}")
            expect(gneiss("pack", path, "--out", out, "--quiet", environment={"GNEISS_CACHE": "off"}), 0)
            with h5py.File(os.path.join(out, "packing.h5")) as file:
                yield dimension, file["particles/position"][:], file["particles/radius"][:]

    for (dimension, x, r), (_, y, s) in zip(packed(NEAR, "near"), packed(EXACT, "far")):
        assert r.tobytes() == s.tobytes()
        assert (y == x + np.array([*EXACT[:dimension], 0][:3])).all()


@fact
def a_packing_file_far_away_runs_from_there(folder):
    def scene(place, name):
        with open(os.path.join(folder, name), "w") as file:
            for k in range(5):
                file.write(" ".join(repr(x) for x in at(place, (k * WIDTH, 0, 0))) + f" {WIDTH / 2!r}\n")
        made = {**ball(place), "bonds": {}, "specimen": {"file": name}}
        made["materials"][0].update(bond_tension_limit=1, bond_shear_limit=1)
        made["sets"] = [{"name": "end", "select": {"ids": [4]}, "motion": {"vx": 0.01}}]
        return made
    near, far = done(folder, scene(NEAR, "near.txt"), "near"), done(folder, scene(EXACT, "far.txt"), "far")
    check_same(far, near)


@fact
def an_oblique_wall_may_be_given_by_a_point_far_along_it(folder):
    # The wall overlaps the particle by 7.4e-6 m at the start and expels it.
    def scene(place, point):
        made = ball(place)
        made["sets"] = []
        made["walls"] = [{"name": "slope", "point": point, "normal": [1, 0, 1], "stiffness": 1e6,
                          "motion": {"vx": 1e-4, "vz": 1e-4}}]
        return made
    edge = -23 * 2.0**-15
    near = done(folder, scene([0, 0, 0], [edge, 0, edge]), "near")
    along = done(folder, scene([0, 0, 0], [edge + 2.0**22, 0, edge - 2.0**22]), "along")
    a, b = field(near, "particles/displacement"), field(along, "particles/displacement")
    # The distance is the difference of products of 2^22 m: its error is 2^-30 m, 1.3e-4 of the overlap.
    assert abs(a).max() > 1e-6 and abs(a - b).max() < 2e-4 * abs(a).max(), (a, b)
    a, b = (history(out)["wall_slope_displacement_x"][-1] for out in (near, along))
    assert a > 5e-8 and abs(a - b) < 1e-9 * a, (a, b)


@fact
def an_origin_that_loses_digits_is_refused(folder):
    refused(folder, ball([5e6, 0, 0], origin=[0, 0, 0]), r"specimen: expected places .* 1e-08 of the smallest radius",
            r"origin")
    refused(folder, {**beam((1e8, 0)), "origin": [0, 0]}, r"elements: expected places .* height of an element")


@fact
def a_model_too_large_for_its_smallest_radius_is_refused(folder):
    scene = ball([0, 0, 0])
    scene["specimen"]["particles"].append([1e6, 0, 0, 1e-3])
    refused(folder, scene, r"specimen: expected places", r"\(0\.001 m\)")


@fact
def motion_below_the_rounding_of_places_is_refused(folder):
    # 2e-6 s of 1e-12 m/s are 2e-18 m; doubles at 0.1 m are 1.4e-17 m apart.
    scene = ball([0.1, 0, 0])
    scene["sets"] = [{"name": "slow", "select": {"all": True}, "motion": {"vx": 1e-12}}]
    refused(folder, scene, r"set 'slow': expected a velocity .* its motion would be lost")


@fact
def a_body_that_is_held_far_away_is_refused(folder):
    scene = bonded(MAP)
    name = soup(folder, (at(MAP, (1, 1, 1)), at(MAP, (2, 2, 2))), "block.stl")
    scene["bodies"] = [{"name": "block", "surface": name, "stiffness": 1e6, "motion": {"vx": 0.1}}]
    refused(folder, scene, r"body 'block': its reference point \(key reference\)")
    scene["bodies"][0]["reference"] = at(MAP, (1, 1, 1))
    done(folder, scene, "held")


@fact
def a_particle_that_flies_out_of_reach_stops_the_run(folder):
    # Doubles from 2^16 m on are more than 1e-8 of 1 mm apart.
    scene = ball([65535.95, 0, 0], origin=[0, 0, 0], domain={"min": [-1e9] * 3, "max": [1e9] * 3})
    scene["sets"][0]["initial_velocity"] = [100, 0, 0]
    out = os.path.join(folder, "out")
    expect(gneiss("run", write_scene(folder, scene), "--out", out, "--quiet"), 5,
           r"left the domain at \(6553\d.*beyond 65536 m from the origin places are too coarse")


@fact
def check_shows_the_origin_and_the_coordinates_of_the_scene(folder):
    shown = expect(gneiss("check", write_scene(folder, bonded(MAP))), 0).stdout
    assert "origin             (5000000, -3000000, 1000000) m" in shown, shown
    assert re.search(r"x +4999999\.99\d+ to 5000000\.0\d+ m \(surfaces\)", shown), shown


@fact
def a_body_at_rest_enters_the_next_stage(folder):
    """A run continues however slow its motion has become: only values set at the start have to exceed rounding."""
    block = {"name": "block", "origin": [-0.01, -0.01, 0.001], "stiffness": 1e6, "friction": 0.5, "kratio": 2, "free": True, "density": 2500,
             "box": {"size": [0.02, 0.02, 0.02]}}
    scene = {"dimension": 3, "law": {"stiffness": "uniform"}, "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e5, "kratio": 2, "friction": 0.3}],
             "specimen": {"particles": [[1, 1, 1, 0.001]]}, "gravity": [0, 0, -9.81], "damping": {"contact": {"restitution": 0.3}},
             "sets": [{"name": "still", "select": {"all": True}, "motion": {"vx": 0, "vy": 0, "vz": 0}}],
             "domain": {"min": [-50] * 3, "max": [50] * 3}, "bodies": [block],
             "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 1e6, "friction": 0.5, "kratio": 2}],
             "stages": [{"name": "settle", "end": {"time": 0.2}}, {"name": "tilt", "gravity": [1, 0, -9.81], "end": {"time": 0.002}}], "time": {"end": 1}}
    out = run(write_scene(folder, scene), os.path.join(folder, "out"))
    assert abs(summary(os.path.join(folder, "out"))["energy_residual"]) < 1e-3, out


if __name__ == "__main__":
    sys.exit(main())
