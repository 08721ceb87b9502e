"""Elements that convert to particles in difficult situations."""
from hard.case import *  # noqa: F403
from hard.solids import grid, msh
from hard.zones import HEAVY, STIFF

LATTICE = {"materials": [{"name": "m", "density": HEAVY * 4 / math.pi, "normal_stiffness": STIFF, "kratio": 1, "friction": 0.2,
                          "bond_tension_limit": 1e15, "bond_shear_limit": 1e15}],
           "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.01}}
SOLID = [{"young": STIFF, "poisson": 0, "density": HEAVY}]


def drawn(folder, notches, box=None, end=5e-5, **changes):
    """48 x 12 mm of cells of 2 mm, drawn along x; notches of a cell, two deep, from below at these columns. Discs of 1 mm are dormant in it."""
    nodes, triangles = grid(24, 6, lambda i, j: (2e-3 * i, 2e-3 * j))
    gone = {24 * j + i for i in notches for j in (0, 1)}
    msh(folder, nodes, [t for k, t in enumerate(triangles) if k // 2 not in gone])
    discs = [[1e-3 * (i + 0.5), 1e-3 * (j + 0.5), 5e-4] for j in range(12) for i in range(48) if 24 * (j // 2) + i // 2 not in gone]
    motion = [[0, 0], [1e-5, 0.05]]
    made = {"dimension": 2, "specimen": {"group": 1, "particles": discs}, **copy.deepcopy(LATTICE),
            "elements": {"mesh": "body.msh", "materials": SOLID,
                         "motions": [{"name": "left", "box": {"min": [-1, -1], "max": [0, 1]}, "motion": {"vx": [[t, -v] for t, v in motion]}},
                                     {"name": "right", "box": {"min": [0.048, -1], "max": [1, 1]}, "motion": {"vx": motion}}]},
            "couple": {"convert": {"box": box or {"min": [-1, -1], "max": [1, 1]}, "width": 6e-3, "stress": 3e6, "every": 5}},
            "time": {"end": end}, **copy.deepcopy(QUIET)}
    made.update(changes)
    return made


def centres(one):
    """Initial positions of the remaining elements, m."""
    start = one.field("nodes/position") - one.field("nodes/displacement")
    return start[one.field("elements/node")].mean(axis=1)


def two_places(folder):
    return drawn(folder, (8, 14))


def between(one):
    """Remaining elements between the notches, and beside them."""
    at = centres(one)
    return int(((at[:, 0] > 0.018) & (at[:, 0] < 0.028) & (at[:, 1] < 4e-3)).sum())


def have_met(one):
    """The material between the notches carries little load and converts because no zone fits there; with a single
    notch a part of it remains."""
    alone = one.again(drawn(one.folder, (8,)), "alone")
    assert between(one) == 0 and between(alone) > 0, (between(one), between(alone))
    return keeps_ledger(1e-3)(one) + f"; none left between, {between(alone)} with one notch"


def out_of_what_is_packed(folder):
    made = drawn(folder, (11,), box={"min": [-1, -1], "max": [1, 0.0101]})
    made["couple"]["convert"].update(width=4e-3)
    return made


def says_where_it_stopped(one):
    halted = [w["text"] for w in one.summary["warnings"] if w["name"] == "conversion_halted"]
    assert len(halted) == 1 and re.search(r"which is not in couple\.convert\.box but beyond its upper y side", halted[0]), one.summary["warnings"]
    active = one.summary["counts"]["particles"] - one.summary["counts"]["asleep"]
    assert one.summary["time"] < 5e-5 and active > 0, (one.summary["time"], active)
    return keeps_ledger(1e-3)(one) + f"; ended at {one.summary['time']:.2e} s with {active} particles active"


def line(x, y, size):
    """The nodes of a line across a bar."""
    return {"min": [x - 1e-6, y - 1e-6, -1][:size], "max": [x + 1e-6, y + 1e-6, 1][:size]}


def bent(specimen, mesh, size, length, height, limit, end, **convert):
    """A bar at three lines of nodes."""
    held = {"v" + a: 0 for a in "xyz"[:size]}
    return {"dimension": size, "specimen": {"group": 1, **specimen}, **copy.deepcopy(LATTICE),
            "elements": {**mesh, "materials": SOLID,
                         "motions": [{"name": "left", "box": line(2e-3, 0, size), "motion": held},
                                     {"name": "right", "box": line(length - 2e-3, 0, size), "motion": {"vy": 0}},
                                     {"name": "load", "box": line(0.5 * length, height, size), "motion": {"vy": [[0, 0], [0.3 * end, -0.04]]}}]},
            "couple": {"convert": {"box": {"min": [-1] * size, "max": [1] * size}, "width": 4e-3, "stress": limit, "every": 10, **convert}},
            "damping": {"background": {"model": "viscous", "coefficient": 2e4}}, "time": {"end": end}, **copy.deepcopy(QUIET)}


def bar(limit):
    return bent({"lattice": {"kind": "cubic", "radius": 5e-4, "cells": [40, 8, 4]}}, {"box": {"size": [0.04, 8e-3, 4e-3], "cells": [20, 4, 2]}}, 3, 0.04, 8e-3,
                limit, 1e-4) | {"materials": [{**LATTICE["materials"][0], "density": HEAVY * 6 / math.pi, "normal_stiffness": STIFF * 1e-3}]}


def edges(folder):
    return bar(1.2e6)


def bears_as_before(one):
    """The lower edges of the middle have converted; the bar carries the load of the elements only, which with four
    over the height are some per cent too stiff."""
    at = centres(one)
    low = (at[:, 1] < 1e-3) & (abs(at[:, 0] - 0.02) < 1e-3)
    assert not low.any(), at[low]
    alone = one.again(bar(1e30), "alone")
    force, wanted = one.history["motion_load_reaction_y"][-1], alone.history["motion_load_reaction_y"][-1]
    return keeps_ledger(1e-3)(one) + ", " + close(force, wanted, 0.1, "N")


def relaxing(folder):
    """A disordered packing, pulled twice."""
    made = drawn(folder, (11,), box={"min": [4e-3, -1], "max": [0.044, 1]}, end=5.8e-5)
    pulls = [[0, 0], [2e-6, 0.05], [1e-5, 0.05], [1.1e-5, 0], [2.4e-5, 0], [2.5e-5, 0.005]]
    for sign, side in ((-1, 0), (1, 1)):
        made["elements"]["motions"][side]["motion"]["vx"] = [[t, sign * v] for t, v in pulls]
    mm = [[0, 0], [22, 0], [22, 4], [24, 4], [24, 0], [48, 0], [48, 12], [0, 12]]
    made["specimen"] = {"group": 1, "polygon": [[1e-3 * x, 1e-3 * y] for x, y in mm], "mean_radius": 5e-4, "density_basis": "bulk",
                        "packing": {"overlap": "passive", "size_variation": 0.1}}
    made["materials"] = [{"name": "m", "density": HEAVY, "contact_modulus": 0.75 * STIFF, "kratio": 3, "friction": 0.5, "tensile_strength": 6e6, "shear_strength": 18e6}]
    made.update(law={"stiffness": "harmonic"}, bonds={"interaction_range": 0.1, "passive_gaps": True})
    made["couple"]["convert"].update(stress=1.6e6)
    return made


def relaxed_on_both_sides(one):
    """Conversions occur in both halves of the run, the second of which another program continues; the ledger closes in both."""
    rows, relaxation = one.history, one.summary["relaxation"]
    active, half = rows["particles"], int((rows["time"] < 0.5 * one.summary["time"]).sum())
    assert 0 < active[half] < active[-1], (active[half], active[-1])
    assert relaxation["count"] > 2 and relaxation["worst"] <= 1e-3, relaxation
    return keeps_ledger(1e-3)(one) + f"; {relaxation['count']} relaxations, to {relaxation['worst']:.1e} of the mean force"


CASES = [
    Case("conversion in two places that meet", "two notches, 10 mm apart; zones of 6 mm", "what is between, too thin for two zones, goes as well; the ledger closes",
         two_places, have_met, "elements at nodes of which no neighbour has a larger part go as well", "19 elements stay between both, as beside one notch alone",
         more="test_conversion.c"),
    Case("a crack that runs out of what is packed", "particles are ready up to 10 of 12 mm", "the run ends there, with its results and a name for it",
         out_of_what_is_packed, says_where_it_stopped, "nothing is converted where more would have to go than may", "goes on without a word, with a zone in which no particles are",
         more="test_conversion.c"),
    Case("elements converted at the edges of a body", "a bar that is bent; its lower edges go first", "it carries the load that elements alone carry, the ledger closes",
         edges, bears_as_before, "a particle bonded to one of nonzero weight becomes active as well and follows the elements", "76 N, as bonds end at particles that stay where they were",
         more="test_conversion.c"),
    Case("a run taken up amid conversions that relax", "a disordered packing, parts of which become active before and after", "the same bits", relaxing, relaxed_on_both_sides,
         "a relaxation is over within an instant, and nothing is written in it", "there is nothing to take out", more="test_relaxation.c"),
]
