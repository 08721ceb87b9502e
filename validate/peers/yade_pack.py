"""Fills the cylinder of scenes/ucs-packed.yaml with YADE's pack.randomDensePack and writes rows x y z r in metres.

    QT_QPA_PLATFORM=offscreen yade -n -x -j2 validate/peers/yade_pack.py

Settings come from the environment, because yade keeps the command line to itself:
  OUT        file for the rows                    RESULT   file for the JSON result
  RADIUS     mean radius, m                       FUZZ     half width of the uniform radii over the mean (0.3)
  CELL       spheres in the periodic cell that is compressed and then repeated (2000); 0: the whole
             cylinder's box at once, between walls (TriaxialTest)
  DIAMETER, HEIGHT  of the cylinder, m (0.023, 0.046)      SEED  (1)
"""
import json
import os
import time

from yade import pack

radius = float(os.environ["RADIUS"])
fuzz = float(os.environ.get("FUZZ", "0.3"))
cell = int(os.environ.get("CELL", "2000"))
diameter = float(os.environ.get("DIAMETER", "0.023"))
height = float(os.environ.get("HEIGHT", "0.046"))
seed = int(os.environ.get("SEED", "1"))

started = time.perf_counter()
spheres = pack.randomDensePack(
    pack.inCylinder((0, 0, 0), (0, 0, height), diameter / 2), radius=radius, rRelFuzz=fuzz, spheresInCell=cell,
    seed=seed, returnSpherePack=True)
seconds = time.perf_counter() - started

with open(os.environ["OUT"], "w", encoding="utf-8") as out:
    for centre, r in spheres:
        out.write(f"{centre[0]!r} {centre[1]!r} {centre[2]!r} {r!r}\n")

result = {"code": "yade", "version": version, "threads": int(os.environ["OMP_NUM_THREADS"]),  # set by -j
          "particles": len(spheres), "radius": radius, "fuzz": fuzz, "cell": cell, "seconds": seconds,
          "load_average": os.getloadavg()[0]}
with open(os.environ["RESULT"], "w", encoding="utf-8") as out:
    json.dump(result, out)
