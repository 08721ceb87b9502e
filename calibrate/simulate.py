"""Runs tests side by side, one thread each. Runs are kept under a hash of their scene and of the program's version, and are continued."""
import ctypes
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass, field

from calibrate import interrupt
from calibrate.problem import OutOfBudget, Problem

TRIES = 3             # starts of a run that is killed or finds no memory
WENT_BAD = 5          # exit code of a run that a repetition would not improve
PAUSE = 0.01          # interval between checks of running processes, s
_PARENT_DIES = 1      # PR_SET_PDEATHSIG


def write_whole(path, text):
    """Writes a file under another name first: it is there in full or not at all."""
    try:
        _write_whole(path, text)
    except OSError as error:
        raise Problem(f"{path}: cannot be written: {error.strerror}", 3) from error


def _write_whole(path, text):
    folder = os.path.dirname(os.path.abspath(path))
    handle, name = tempfile.mkstemp(dir=folder, prefix=".part-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def kept_runs(folder):
    """Paths of the runs of calibrations in a folder, each named by the hash of its scene."""
    runs = os.path.join(folder, "runs")
    names = os.listdir(runs) if os.path.isdir(runs) else []
    return [os.path.join(runs, name) for name in names if re.fullmatch("[0-9a-f]{16}", name)]


def program_version(program):
    """Version and commit, as in the first line of `gneiss version`."""
    done = subprocess.run([program, "version"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise Problem(f"{program} could not be started: {done.stderr.strip()}", 3)
    return done.stdout.splitlines()[0].strip()


@dataclass
class Outcome:
    """Readings of a run (a missing one is None), and why it has none."""
    readings: dict
    absent: dict = field(default_factory=dict)
    message: str = ""
    seconds: float = 0.0
    errors: dict = field(default_factory=dict)  # error budget without the scatter of packings, by reading
    folder: str = ""

    def reading(self, name):
        return self.readings.get(name)


@dataclass
class _Job:
    scene: dict
    folder: str
    strain: float = 0.0  # above 0: elastic constants up to this strain by `gneiss stiffness`, without a run
    tries: int = 0

    @property
    def packing(self):
        """Text that is equal for scenes of the same packing."""
        return json.dumps([self.scene["specimen"], self.scene["run"]["seed"]], sort_keys=True)


def _follow_parent():
    """Makes the system end a child process when its parent ends, so that nothing writes into the folder of a killed calibration."""
    ctypes.CDLL(None).prctl(_PARENT_DIES, signal.SIGTERM)


class Laboratory:
    """Runs scenes in the folder `folder`/runs. Counts what it ran, and stops at the budget."""

    def __init__(self, program, folder, workers, most_runs, most_seconds):
        self.program, self.workers = program, max(1, workers)
        self.folder = os.path.join(folder, "runs")
        self.version = program_version(program)
        self.most_runs, self.most_seconds = most_runs, most_seconds
        self.used, self.seconds = set(), {}
        self.begun = time.monotonic()
        os.makedirs(self.folder, exist_ok=True)

    # --- one run ---------------------------------------------------------------------------------------

    def key(self, scene, strain):
        text = json.dumps([scene, strain, self.version], sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def _kept(self, folder):
        """Outcome of a finished run, None if there is none."""
        try:
            with open(os.path.join(folder, "outcome.json"), encoding="utf-8") as file:
                kept = json.load(file)
            return Outcome(kept["readings"], kept["absent"], kept["message"], kept["seconds"], kept["errors"], folder)
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def _start(self, job):
        """The process of a run, from its newest checkpoint if there is one."""
        os.makedirs(job.folder, exist_ok=True)
        scene = os.path.join(job.folder, "scene.yaml")
        begun = any(name.startswith("checkpoint_") and name.endswith(".h5") for name in os.listdir(job.folder))
        resume = begun and job.tries == 0
        if not resume:
            write_whole(scene, json.dumps(job.scene, indent=1))
        command = ["resume", job.folder, "--quiet"] if resume else ["run", scene, "--out", job.folder, "--force", "--quiet"]
        if job.strain:
            command = ["stiffness", scene, "--json", "--strain", f"{job.strain:.6g}"]
        job.tries += 1
        with open(os.path.join(job.folder, "messages.txt"), "wb") as messages, open(os.path.join(job.folder, "printed.txt"), "wb") as printed:
            return subprocess.Popen([self.program, *command, "--threads", "1"], stdin=subprocess.DEVNULL,
                                    stdout=printed, stderr=messages, preexec_fn=_follow_parent,
                                    env={**os.environ, "OMP_WAIT_POLICY": "passive"})

    def _finish(self, job, code):
        """True once the run has an outcome; False: to be started again."""
        messages = os.path.join(job.folder, "messages.txt")
        with open(messages, encoding="utf-8", errors="replace") as file:
            message = file.read().strip()
        if code == 0:
            with open(os.path.join(job.folder, "printed.txt" if job.strain else "summary.json"), encoding="utf-8") as file:
                text = file.read()
            # The constants are in the last line: one before it may report a packing.
            outcome = _constants_of(json.loads(text.strip().splitlines()[-1])) if job.strain else _outcome_of(json.loads(text))
        elif code == WENT_BAD:
            outcome = Outcome({}, {}, message.splitlines()[0] if message else f"exit code {code}")
        elif job.tries < TRIES:
            return False
        else:
            raise Problem(f"{job.folder}: the run ended with code {code}: {message[-1000:]}", code if code in (2, 3, 4) else 5)
        kept = {key: getattr(outcome, key) for key in ("readings", "absent", "message", "seconds", "errors")}
        write_whole(os.path.join(job.folder, "outcome.json"), json.dumps(kept, indent=1))
        for name in os.listdir(job.folder):
            if name.startswith("checkpoint_") or name.endswith((".hdf", ".series")):
                os.unlink(os.path.join(job.folder, name))
        return True

    # --- many runs -------------------------------------------------------------------------------------

    def run(self, scenes):
        """[Outcome] of the scenes, in their order. Every different scene counts once, whether it is kept from before or not, so that
        the count and the end of a budget of runs do not depend on interruptions."""
        jobs = [_Job(scene, os.path.join(self.folder, self.key(scene, 0.0))) for scene in scenes]
        after = self.used | {job.folder for job in jobs}
        if len(after) > self.most_runs:
            raise OutOfBudget(f"{self.most_runs} runs")
        outcomes = self._outcomes(jobs)
        self.used = after
        return outcomes

    def constants(self, scenes, strain):
        """[Outcome] with the elastic constants of the tests of scenes up to a strain, by equilibria; these are no runs."""
        return self._outcomes([_Job(scene, os.path.join(self.folder, self.key(scene, strain)), strain) for scene in scenes])

    def _outcomes(self, jobs):
        interrupt.check()
        if time.monotonic() - self.begun > self.most_seconds:
            raise OutOfBudget(f"{self.most_seconds:g} s")
        self._run_all(list({job.folder: job for job in jobs if self._kept(job.folder) is None}.values()))
        outcomes = [self._kept(job.folder) for job in jobs]
        self.seconds.update({job.folder: outcome.seconds for job, outcome in zip(jobs, outcomes)})
        return outcomes

    def _run_all(self, waiting):
        """Runs jobs, as many at a time as there are workers; of those that need the same packing the first makes it alone."""
        running, packed = {}, set()
        try:
            while waiting or running:
                interrupt.check()
                packing = {job.packing for job in running.values()} - packed
                free = [job for job in waiting if job.packing not in packing]
                if free and len(running) < self.workers:
                    waiting.remove(free[0])
                    running[self._start(free[0])] = free[0]
                    continue
                time.sleep(PAUSE)
                for process in [one for one in running if one.poll() is not None]:
                    job = running.pop(process)
                    if self._finish(job, process.returncode):
                        packed.add(job.packing)
                    else:
                        waiting.append(job)
        finally:
            for process in running:
                process.terminate()
            for process in running:
                process.wait()

    def forget(self):
        """Removes all runs of the folder that calibrations made."""
        for path in kept_runs(os.path.dirname(self.folder)):
            shutil.rmtree(path, ignore_errors=True)


def _number(value):
    """A finite number, or None: no NaN leaves this module."""
    return float(value) if isinstance(value, (int, float)) and abs(value) < float("inf") else None


def _constants_of(printed):
    """Outcome with the constants of the test that `gneiss stiffness` printed; with those of the packing where the test gives none."""
    readings = {}
    for found in (printed["network"], printed["test"] or {}):
        given = {name: _number(found.get(name)) for name in ("young_modulus", "young_modulus_average", "poisson_ratio")}
        readings.update({name: value for name, value in given.items() if value is not None})
        readings.setdefault("young_modulus_average", given["young_modulus"])
    return Outcome(readings, {}, printed.get("test_absent", ""), float(printed["seconds"]))


# Causes that differ between packings and so are in their scatter; nonlinearity is a property of the curve, not an error of its reading.
OF_PACKINGS = ("packing", "round-off", "rows", "nonlinearity")


def _outcome_of(summary):
    """Outcome of a run's summary.json; errors are those causes of its budget that all packings share."""
    errors, budget = {}, summary.get("error_budget") or {}
    for name, entry in (budget.get("readings") or budget).items():
        if isinstance(entry, dict) and "causes" in entry:
            errors[name] = sum(cause["error"]**2 for cause in entry["causes"] if cause["name"] not in OF_PACKINGS)**0.5
    readings = {name: _number(value) for name, value in summary["readings"].items()}
    if (readings.get("peak_stress") or 0.0) <= 0.0:  # without a peak the largest stress of the test is not a strength
        readings["peak_stress"] = None
    return Outcome(readings, summary.get("absent") or {}, "", float(summary["seconds"]["cpu"]), errors)
