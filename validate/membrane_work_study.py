"""A membrane on specimens with tips and edges, at defaults: its work over the energy that they store, the mean stress over the pressure,
bonds that broke. Writes the table of docs/evidence/laboratory.md (grains that pivot) to standard output; some minutes.

    /usr/bin/python3 validate/membrane_work_study.py [build/gneiss]
"""
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np

TRIANGLE = [[0, 0], [0.04, 0], [0.005, 0.02]]
TETRAHEDRON = ([[0, 0, 0], [0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.02]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
WEDGE = ([[x, y, z] for z in (0, 0.008) for x, y in TRIANGLE],
         [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]])
SHAPES = (("cylinders", 3, {"cylinder": {"diameter": 0.02, "height": 0.04}}, 500), ("boxes", 3, {"box": {"size": [0.01, 0.012, 0.016]}}, 500),
          ("tetrahedra", 3, TETRAHEDRON, 500), ("wedges of 30 degrees", 3, WEDGE, 500),
          ("rectangles", 2, {"rectangle": {"width": 0.02, "height": 0.03}}, 250), ("triangles with 30 degrees", 2, {"polygon": TRIANGLE}, 500),
          ("equilateral triangles", 2, {"polygon": [[0, 0], [0.03, 0], [0.015, 0.026]]}, 250),
          ("parallelograms of 45 degrees", 2, {"polygon": [[0, 0], [0.02, 0], [0.04, 0.02], [0.02, 0.02]]}, 250))


def write_surface(body, path):
    with open(path, "w") as file:
        file.write("solid body\n")
        for face in body[1]:
            file.write("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % tuple(body[0][c]) for c in face) + "endloop\nendfacet\n")
        file.write("endsolid body\n")


def run_one(program, folder, dimension, shape, count, pressure, strength, seed, overlap):
    if isinstance(shape, tuple):
        write_surface(shape, os.path.join(folder, "body.stl"))
        shape = {"surface": "body.stl"}
    scene = {"dimension": dimension, "specimen": {**shape, "particles": count, "packing": {"overlap": overlap}},
             "materials": [{"name": "rock", "density": 2600, "contact_modulus": "10 GPa", "kratio": 2.5, "friction": 0.5,
                            "tensile_strength": strength, "shear_strength": strength}],
             "law": {"stiffness": "harmonic"}, "bonds": {}, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
             "membrane": {"pressure": pressure, "ramp": "0.1 ms"}, "test": {"kind": "hydrostatic"}, "time": {"end": "0.6 ms"},
             "output": {"snapshots": 0, "history_rows": 100, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}
    path, out = os.path.join(folder, "scene.yaml"), os.path.join(folder, "out")
    with open(path, "w") as file:
        json.dump(scene, file)
    subprocess.run(["rm", "-rf", out], check=True)
    subprocess.run([program, "run", path, "--out", out, "--quiet"], check=True, capture_output=True)
    with h5py.File(os.path.join(out, "results.h5")) as file:
        rows = {name: file["history"][name][-1] for name in file["history"]}
    held = rows["energy_elastic_normal"] + rows["energy_elastic_shear"]
    stress = [-rows["stress_" + name] / rows["membrane_pressure"] for name in ("xx", "yy", "zz")[:dimension]]
    return rows["energy_work_applied"] / held, stress, rows["broken_tension"] + rows["broken_shear"] > 0


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "build/gneiss"
    print("| specimens | runs | work over energy | mean stress over pressure | runs with broken bonds |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name, dimension, shape, count in SHAPES:
            found = [run_one(program, folder, dimension, shape, count, pressure, strength, seed, overlap)
                     for pressure, strength in (("1 MPa", "30 MPa"), ("10 MPa", "30 MPa"), ("10 MPa", "300 MPa")) for seed in (1, 2)
                     for overlap in ("none", "passive")]
            work, stress = np.array([f[0] for f in found]), np.concatenate([f[1] for f in found])
            print(f"| {name}, {count} | {len(found)} | {work.min():.2f} to {work.max():.2f} | {stress.min():.4f} to {stress.max():.4f} "
                  f"| {sum(f[2] for f in found)} |", flush=True)


if __name__ == "__main__":
    main()
