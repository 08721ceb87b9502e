#!/usr/bin/python3
"""test_log.py GNEISS: --log json of every command, exit codes, status.json (docs/log.md)."""
import socket

from program import *

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MEMBERS = {"info": {"text"}, "note": {"text"}, "warning": {"text"}, "error": {"text"}, "progress": {"progress"}, "result": {"result"},
           "end": {"code", "text"}}
PLACES = {"file", "line", "column", "set", "key", "expected", "found"}


def lines_of(*arguments, code=0):
    done = expect(gneiss(*arguments, "--log", "json"), code)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    for line in lines:
        assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", line["time"]), line
        own = set(line) - {"time", "level", "id"}
        assert MEMBERS[line["level"]] <= own <= MEMBERS[line["level"]] | PLACES and line["id"], line
    assert [line["level"] == "end" for line in lines] == [False] * (len(lines) - 1) + [True] and lines[-1]["code"] == code, lines
    return lines


def errors_of(*arguments, code=2):
    return [line for line in lines_of(*arguments, code=code) if line["level"] == "error"]


@fact
def every_command_prints_objects_alone(folder):
    out = os.path.join(folder, "out")
    calls = {"check": (LATTICE,), "plan": (LATTICE,), "stiffness": (LATTICE,), "run": (LATTICE, "--out", out), "resume": (out,), "keys": ("friction",),
             "explain": ("time.step",), "info": (), "version": (), "help": ("run",)}
    for name, arguments in calls.items():
        lines = lines_of(name, *arguments)
        assert {line["id"] for line in lines} == {name}, (name, lines)
        wanted = "result" if name in ("check", "plan", "stiffness", "run", "resume", "info") else "info"
        assert wanted in [line["level"] for line in lines], (name, lines)


@plain_fact
def commands_in_python_print_objects_alone(folder):
    run(LATTICE, folder)
    assert any(line.get("text", "").endswith("report.html") for line in lines_of("report", folder))
    assert errors_of("report", folder + "/none") and errors_of("view", folder + "/none")
    error = errors_of("calibrate", write_scene(folder, "targets: {young_modulus: 20 candela}\n"))[0]
    assert error["line"] == 1 and error["id"] == "input_error", error


@fact
def an_error_has_place_key_expected_and_found(folder):
    with open(LATTICE, encoding="utf-8") as file:
        text = file.read()
    for wrong, want in ((text.replace("density: ", "density: -"), {"key": "materials[0].density", "expected": "a value in [1e-9, 1e15] kg/m3"}),
                        (text.replace("density", "densety"), {"key": "materials[0].densety", "found": "densety", "expected": "density"}),
                        (text.replace("density: ", "pb_emod: 1\n    density: "),
                         {"key": "materials[0].pb_emod", "found": "pb_emod", "expected": "materials[].contact_modulus"}),
                        (text.replace("specimen:\n", "specimen:\n  porosity: 0.3\n"),
                         {"key": "specimen.porosity", "found": "particle", "expected": "density_basis bulk"})):
        path = write_scene(folder, wrong)
        number = next(k for k, line in enumerate(wrong.splitlines(), 1) if want["key"].split(".")[-1] in line)
        error = errors_of("check", path)[0]
        assert error["file"] == path and error["line"] == number and error["column"] > 1, error
        assert {**error, **want} == error, (error, want)
    error, = errors_of("check", LATTICE, "--set", "time.end=soon")
    assert error["set"] == "time.end" and error["found"] == "soon" and error["expected"].startswith("a time such as"), error


@fact
def several_errors_are_an_object_each(folder):
    with open(LATTICE, encoding="utf-8") as file:
        text = file.read()
    errors = errors_of("check", write_scene(folder, text.replace("density", "densety").replace("kratio", "kration")))
    assert len(errors) >= 2 and all(error["level"] == "error" and "key" in error for error in errors), errors


@fact
def mistakes_on_the_command_line_are_objects_as_well(_):
    assert errors_of("fly")[0]["text"].startswith("unknown command")
    assert errors_of("run", "--bogus", LATTICE)[0]["found"] == "--bogus"


@fact
def a_long_result_is_one_line(folder):
    """The line is longer than the buffer with which a line begins."""
    result, = (line["result"] for line in lines_of("run", LATTICE, "--out", folder) if line["level"] == "result")
    assert result == summary(folder) and len(json.dumps(result)) > 2000, len(json.dumps(result))


@fact
def messages_remain_text_on_standard_error(_):
    done = gneiss("check", LATTICE, "--set", "time.end=soon", "--log", "json")
    assert done.stderr.startswith("gneiss: input error: --set time.end: expected"), done.stderr


# --- status.json ---------------------------------------------------------------------------------------

def state(folder):
    """The contents of status.json, and the state that `gneiss status` reports."""
    with open(os.path.join(folder, "status.json"), encoding="utf-8") as file:
        kept = json.load(file)
    found, = logged(expect(gneiss("status", folder, "--log", "json"), 0).stdout)
    assert {**found, "state": ""} == {**kept, "state": ""}, (found, kept)
    return kept, found["state"]


def started(folder):
    """A run that has begun and will not end by itself."""
    process = subprocess.Popen(command("run", LATTICE, "--out", folder, "--quiet", "--set", "time.end=1000 s", "--set", "time.stop=none"),
                               env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    assert wait_until(process, lambda: os.path.exists(os.path.join(folder, "status.json")))
    return process


@fact
def a_finished_run_says_so(folder):
    run(LATTICE, folder)
    kept, now = state(folder)
    assert now == kept["state"] == "finished" and kept["share"] == 1 and kept["seconds_left"] == 0 and kept["code"] == 0, kept
    assert kept["step"] == summary(folder)["steps"] and kept["time"] == summary(folder)["time"], kept
    assert "finished" in gneiss("status", folder).stdout


@fact
def a_run_that_is_killed_does_not_count_as_running(folder):
    process = started(folder)
    kept, now = state(folder)
    assert now == "running" and kept["pid"] == process.pid and 0 <= kept["share"] < 1 and kept["host"] == socket.gethostname(), (kept, now)
    process.kill()
    process.wait()
    kept, now = state(folder)
    assert (kept["state"], now) == ("running", "killed"), (kept, now)
    said = gneiss("status", folder).stdout
    assert "killed" in said and "gneiss resume" in said, said


@fact
def a_number_of_a_process_that_is_used_again_does_not_deceive(folder):
    run(LATTICE, folder)
    path = os.path.join(folder, "status.json")
    with open(path, encoding="utf-8") as file:
        kept = json.load(file)
    for start, wanted in ((kept["pid_start"], "killed"), (None, "running")):
        own = {**kept, "state": "running", "pid": os.getpid()}
        with open("/proc/self/stat", encoding="utf-8") as file:
            own["pid_start"] = start or int(file.read().rsplit(")", 1)[1].split()[19])
        with open(path, "w", encoding="utf-8") as file:
            json.dump(own, file)
        assert state(folder)[1] == wanted, (start, wanted)
    with open(path, "w", encoding="utf-8") as file:
        json.dump({**kept, "state": "running", "host": "elsewhere", "heartbeat_unix": int(time.time()) - 100}, file)
    assert state(folder)[1] == "killed"


@fact
def an_interrupted_run_is_stopped_and_continues(folder):
    process = started(folder)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 6
    kept, now = state(folder)
    assert now == "stopped" and kept["code"] == 6 and "gneiss resume" in kept["message"], kept
    resume(folder, "--set", "time.end=0.2 ms") if kept["time"] < 2e-4 else None


@fact
def a_run_that_goes_bad_has_failed(folder):
    done = gneiss("run", LATTICE, "--out", folder, "--quiet", "--set", "time.step=1e-5", "--set", "time.on_unstable=warn")
    assert done.returncode == 5, done.stderr
    kept, now = state(folder)
    assert now == "failed" and kept["code"] == 5 and kept["message"], kept
    expect(gneiss("status", os.path.dirname(LATTICE)), 2, "status.json")


@fact
def a_foreign_status_file_is_not_replaced(folder):
    with open(os.path.join(folder, "status.json"), "w", encoding="utf-8") as file:
        file.write("{}")
    expect(gneiss("run", LATTICE, "--out", folder), 2, "found status.json in it")
    run(LATTICE, folder, "--force")


@fact
def exit_codes_are_one_table(_):
    said = expect(gneiss("help", "exit-codes"), 0).stdout
    rows = dict(re.findall(r"^  (\d) (.*)$", said, re.MULTILINE))
    with open(ROOT + "/docs/log.md", encoding="utf-8") as file:
        assert dict(re.findall(r"^\| (\d) \| (.*) \|$", file.read(), re.MULTILINE)) == rows
    with open(ROOT + "/include/gneiss/status.h", encoding="utf-8") as file:
        assert sorted(map(int, rows)) == sorted(map(int, re.findall(r"GNEISS_\w+ = (\d)\b", file.read())))


sys.exit(main())
