"""Zones in which particles and finite elements share one body, in extreme situations."""
from hard.case import *  # noqa: F403
from hard.solids import grid, msh

STIFF, HEAVY = 24e9, 7800.0


def strip(front=False, cells=4, mesh=None, **changes):
    """Along x: a square lattice of discs of 1 mm and elements, which share 6 to 12 mm; `front`: particles have the smaller x, from 0 mm, elements end at 18 mm."""
    made = {"dimension": 2,
            "specimen": {"group": 1, "lattice": {"kind": "square", "radius": 5e-4, "cells": [13, 6], "origin": [-5e-4 if front else 5.5e-3, 0]}},
            "materials": [{"name": "m", "density": HEAVY * 4 / math.pi, "normal_stiffness": STIFF, "kratio": 4, "friction": 0.2,
                           "bond_tension_limit": 1e15, "bond_shear_limit": 1e15}],
            "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.01},
            "elements": {"rectangle": {"origin": [6e-3 if front else 0, 0], "size": [12e-3, 6e-3], "cells": [6, 3]},
                         "materials": [{"young": STIFF, "poisson": 0, "density": HEAVY}]},
            "couple": {"zones": [{"edges": [{"from": [6e-3 if front else 12e-3, 0], "to": [12e-3 if front else 6e-3, 0]}]}]},
            "time": {"end": 1e-4}, **copy.deepcopy(QUIET)}
    made.update(changes)
    return made


def falls_out(constraint):
    """The body falls out of the domain along -x, one column of particles after another, until all particles have
    left."""
    def scene(folder):
        made = strip(True, gravity=[-1e7, 0], domain={"min": [-2e-3, -1], "max": [1, 1], "lost": "remove"}, time={"end": 6e-5})
        made["couple"]["constraint"] = constraint
        return made
    return scene


def fell_out(one):
    """All particles of the zone have left; the remaining body has the speed of its fall."""
    words = " ".join(warning["text"] for warning in one.summary["warnings"])
    assert "42 particles left coupling zones" in words, words
    speed = one.field("nodes/velocity")[:, 0].mean()
    return keeps_ledger(1e-5)(one) + ", " + close(speed, -1e7 * 6e-5, 0.02, "m/s")


def shaken(**changes):
    """Elements are pulled and pushed at their end."""
    def scene(folder):
        made = strip(**changes)
        made["elements"]["motions"] = [{"name": "end", "box": {"min": [0, 0], "max": [0, 1]}, "motion": {"vx": [[0, 0], [2e-6, 0.05], [4e-6, -0.05], [6e-6, 0]]}}]
        return made
    return scene


def uneven(folder):
    """Elements of the lower half are a thousandth as stiff as those of the upper one, which are as stiff as the particles."""
    nodes, triangles = grid(6, 6, lambda i, j: (2e-3 * i, 1e-3 * j))
    msh(folder, nodes, triangles)
    made = shaken()(folder)
    del made["elements"]["rectangle"]
    made["elements"].update(mesh="body.msh", materials=[{"young": STIFF, "poisson": 0, "density": HEAVY},
                                                        {"group": "2", "young": 1e-3 * STIFF, "poisson": 0.3, "density": HEAVY}])
    path = os.path.join(folder, "body.msh")
    with open(path) as file:
        lines = file.read().split("\n")
    first = lines.index("$Elements") + 2
    for k in range(36):  # the elements of the lower three rows of squares
        word = lines[first + k].split()
        word[3] = word[4] = "2"
        lines[first + k] = " ".join(word)
    with open(path, "w") as file:
        file.write("\n".join(lines))
    return made


def torn(folder):
    """Bonds that break at a strain of 2e-6, in the zone as well."""
    made = shaken()(folder)
    made["materials"][0]["bond_tension_limit"] = 5e1
    return made


def tells_of_bonds(one):
    words = " ".join(warning["text"] for warning in one.summary["warnings"])
    assert re.search(r"\d+ bonds broke in coupling zones", words), words
    # Breaks fall into steps near the limit; with a ninth of the step the residual is 6e-6.
    return keeps_ledger(1e-2)(one) + "; " + re.search(r"\d+ bonds broke in coupling zones", words).group(0)


CASES = [
    Case("a zone that loses all its particles", "the body falls out of the domain, particles first, with the mass that nodes carry of them",
         "nodes give it up: the ledger closes, and what is left falls on", falls_out("lumped"), fell_out,
         "nodes give up what they carry before particles lose their masses", "0.14 of the energy unexplained at the end, stopped", more="test_coupling_cases.c"),
    Case("a zone of consistent masses that loses all its particles", "the same, with masses that tie nodes to each other",
         "what is left has its own masses alone", falls_out("consistent"), fell_out,
         "nodes give up what they carry before particles lose their masses", "0.11 of the energy unexplained at the end, stopped", more="test_coupling_cases.c"),
    Case("a zone across two materials", "elements of one half a thousandth as stiff as those of the other, and as the particles", "the ledger closes", uneven,
         keeps_ledger(1e-5), "particles are tied by the place, not by the material", "there is nothing to take out", more="test_coupling_cases.c"),
    Case("bonds that break in a zone", "elements hold together what broke", "the run says so, and the ledger closes", torn, tells_of_bonds,
         "bonds of zones that broke are counted at the end", "the run ends without a word", more="test_coupling_cases.c"),
]
