#!/usr/bin/python3
"""Cost of calls and fields of force from Python, in microseconds a step: `PYTHONPATH=python python3 python/bench_calls.py`."""
import time

import gneiss

PAIR = {"specimen": {"particles": [[0, 0, 0, "1 mm"], ["9 mm", 0, 0, "1 mm"]]},
        "materials": [{"name": "a", "density": 2000, "normal_stiffness": "1 MN/m", "kratio": 2}],
        "law": {"stiffness": "uniform"}, "time": {"end": "1 s"}, "output": {"history_rows": 1}, "run": {"threads": 1}}
STEPS, REPEATS = 20000, 15


def seconds(prepare):
    """Returns the least of REPEATS times for STEPS steps."""
    with gneiss.World(PAIR) as world:
        prepare(world)
        world.step(STEPS)
        least = float("inf")
        for _ in range(REPEATS):
            begin = time.perf_counter()
            world.step(STEPS)
            least = min(least, time.perf_counter() - begin)
        return least


def main():
    plain = seconds(lambda world: None)
    print(f"a step of two particles       {1e6 * plain / STEPS:.2f} us")
    for name, prepare in (("an empty call each step", lambda world: world.every(1, lambda own: None)),
                          ("a call that reads the time", lambda world: world.every(1, lambda own: own.time)),
                          ("an empty field of force", lambda world: world.force(lambda points: None))):
        print(f"{name:29s} {1e6 * (seconds(prepare) - plain) / STEPS:.2f} us more")


if __name__ == "__main__":
    main()
