#!/usr/bin/python3
"""test_schema.py GNEISS: the JSON Schemas of `gneiss schema`, read by python3-jsonschema, against the verdict of `gneiss check`; and
`gneiss explain`."""
import copy
import glob
import os
import random
import re
from collections import Counter

import jsonschema
import yaml

from program import *

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SMALL = ("lattice-small", "plane", "elements", "flow", "ucs-small", "beam-small", "everything")


class Loader(yaml.SafeLoader):
    """YAML 1.2, as gneiss and editors read it: `off` and `yes` are texts, `1e-6` is a number."""


Loader.yaml_implicit_resolvers = {}
for tag, first, form in (("null", "~nN", r"~|null|Null|NULL|"), ("bool", "tTfF", r"true|True|TRUE|false|False|FALSE"),
                         ("int", "-+0123456789", r"[-+]?[0-9]+"),
                         ("float", "-+.0123456789", r"[-+]?(?:\.[0-9]+|[0-9]+\.?[0-9]*)(?:[eE][-+]?[0-9]+)?")):
    for letter in [*first, ""] if tag == "null" else first:
        Loader.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{form})$"), [letter])


def load(text):
    return yaml.load(text, Loader=Loader)


def read(path):
    with open(path, encoding="utf-8") as file:
        return load(file.read())


def validator(kind):
    schema = json.loads(expect(gneiss("schema", kind), 0).stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


SCHEMA = validator("scene")


def problems(data, of=SCHEMA):
    """Paths and messages of the refusals by a schema."""
    return [(list(error.absolute_path), error.message[:200]) for error in of.iter_errors(data)]


def kind_of(data):
    return ("calibrate" if "targets" in data else "sweep" if "scene" in data else
            "scene" if {"time", "law", "elements"} & data.keys() else "pack")


@fact
def every_scene_fits_the_schema_of_its_kind(_):
    counts = Counter()
    for path in sorted(glob.glob(ROOT + "/scenes/*.yaml") + glob.glob(ROOT + "/tests/scenes/*.yaml") + glob.glob(ROOT + "/examples/*.yaml")):
        data = read(path)
        counts[kind_of(data)] += 1
        found = problems(data, validator(kind_of(data)))
        assert not found, f"{path}: {found[:3]}"
    print("# files that fit their schema:", dict(counts))
    assert counts["scene"] >= 35 and counts["sweep"] >= 2 and counts["calibrate"] >= 1 and counts["pack"] >= 1, counts


def key_of(path):
    """The path as a message writes it: walls[0].motion.vz."""
    return ".".join(f"[{one}]" if isinstance(one, int) else one for one in path).replace(".[", "[")


REQUIRED = set(re.findall(r"^\| `([^`*]+)` \| [^|]* \| required \|", gneiss("keys", "--markdown").stdout, re.MULTILINE))


# --- changes of a scene: each returns the path of the changed value, or None where it does not apply -----------------

def leaves(data, path=()):
    """(path, parent, key) of every value that is neither a section nor a list."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(value, (dict, list)):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key), data, key


def sections(data, path=()):
    if isinstance(data, dict):
        yield path, data
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from sections(value, (*path, key))


def leaf(scene, draw, wanted):
    found = [one for one in leaves(scene) if wanted(one[1][one[2]])]
    return draw.choice(found) if found else None


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_quantity(value):
    return isinstance(value, str) and re.match(r"[-+]?[0-9.]+(e[-+]?[0-9]+)? *[a-zA-Z]", value)


def replaced(wanted, change):
    def make(scene, draw):
        one = leaf(scene, draw, wanted)
        if one:
            one[1][one[2]] = change(one[1][one[2]])
        return one and one[0]
    return make


def misspelt(scene, draw):
    path, section = draw.choice([one for one in sections(scene) if one[1]])
    key = draw.choice(sorted(section))
    section[key + "x"] = section.pop(key)
    return path


def foreign(scene, draw):
    path, section = draw.choice(list(sections(scene)))
    section["colour"] = "red"
    return path


def shortened(scene, draw):
    vectors = [(path, section, key) for path, section in sections(scene) for key, value in section.items()
               if isinstance(value, list) and len(value) == 3 and all(not isinstance(one, (dict, list)) for one in value)]
    if not vectors:
        return None
    path, section, key = draw.choice(vectors)
    section[key] = section[key][:1]
    return (*path, key)


def section_as_text(scene, draw):
    found = [(path, section, key) for path, section in sections(scene) for key, value in section.items() if isinstance(value, dict)]
    path, section, key = draw.choice(found)
    section[key] = "steel"
    return (*path, key)


def without_a_key(scene, draw):
    path, section = draw.choice([one for one in sections(scene) if len(one[1]) > 1])
    del section[draw.choice(sorted(section))]
    return path


def without_a_required_key(scene, draw):
    path, section, key = draw.choice([(path, section, key) for path, section in sections(scene) for key in section
                                      if re.sub(r"\[\d+\]", "[]", key_of((*path, key))) in REQUIRED])
    del section[key]
    return path


# Name: the change, and the messages of `check` whose reason a schema can state as well (a regular expression).
CHANGES = {
    "key misspelt": (misspelt, ""),
    "key that no section has": (foreign, ""),
    "list of another length": (shortened, ""),
    "text for a section": (section_as_text, ""),
    "word for a number": (replaced(lambda value: is_number(value) and value < 1, lambda value: "plenty"), ""),
    "list for a value": (replaced(lambda value: True, lambda value: {"much": value}), ""),
    "number far out of range": (replaced(is_number, lambda value: -1e40), "a value in"),
    "text after a number": (replaced(is_quantity, lambda value: value + " 7 7"), ""),
    "unit of another dimension": (replaced(is_quantity, lambda value: value.split()[0] + " candela"), "(?!)"),
    "unit that is unknown": (replaced(is_quantity, lambda value: value.split()[0] + " smoot"), "(?!)"),
    "out of range with a unit": (replaced(is_quantity, lambda value: re.sub(r"^[-+0-9.e]*[0-9]", "1e60", value)), "(?!)"),
    "name that nothing has": (replaced(lambda value: value in ("top", "bottom", "rock"), lambda value: "nobody"), "(?!)"),
    "key left out": (without_a_key, "(?!)"),
    "required key left out": (without_a_required_key, ""),
}
BAD = 16  # number of bad scenes of each kind


def verdict(folder, scene):
    """The message of `gneiss check`; None: it accepts the scene, whatever a run would do."""
    for name in ("plate.msh",):
        if not os.path.exists(os.path.join(folder, name)):
            shutil.copy(os.path.join(SCENES, name), folder)
    done = gneiss("check", write_scene(folder, scene), "--quiet")
    assert done.returncode in (0, 2, 5), (done.returncode, done.stderr, scene)
    return done.stderr if done.returncode == 2 else None


@plain_fact
def bad_scenes_are_refused_at_the_changed_place_as_far_as_a_schema_can_say_it(folder):
    draw, table, count = random.Random(17), Counter(), 0
    scenes = {name: read(os.path.join(SCENES, name + ".yaml")) for name in SMALL}
    for name, (change, stated) in CHANGES.items():
        for _ in range(BAD):
            scene = copy.deepcopy(scenes[draw.choice(SMALL)])
            path = change(scene, draw)
            if path is None:
                continue
            message, found = verdict(folder, scene), problems(scene)
            count += 1
            table[name, "refused by check" if message else "accepted by check", "refused by schema" if found else "accepted by schema"] += 1
            assert message or not found, f"{name} at {key_of(path)}: the schema refuses what check accepts: {found}"
            assert found or not message or not re.search(stated, message), f"{name} at {key_of(path)}: accepted by the schema, refused by check: {message}"
            near = [place for place, _ in found if place[:len(path)] == list(path)[:len(place)]]
            assert not found or near, f"{name} at {key_of(path)}: refused at {[key_of(place) for place, _ in found]}"
    for row, number in sorted(table.items()):
        print("#", ": ".join(row), number)
    refused = sum(number for (_, check, _), number in table.items() if check == "refused by check")
    assert refused >= 150, (refused, count)


@fact
def a_plane_scene_takes_vectors_of_two_components_and_no_shapes_of_space(_):
    plane = {"dimension": 2, "gravity": [0, -9.81], "time": {"end": "1 s"}}
    assert not problems(plane)
    assert problems({**plane, "dimension": 3}) and not problems({**plane, "gravity": [0, -9.81, 0]})
    assert problems({**plane, "gravity": [0, -9.81, 1]})
    assert problems({**plane, "specimen": {"box": {"size": [1, 1, 1]}, "particles": 100}})
    assert not problems({**plane, "specimen": {"disc": {"diameter": "5 cm"}, "particles": 100}})


@fact
def formulas_of_t_stand_where_tables_do(folder):
    """Components of some vectors take them too; a single number does not."""
    for change, good in (({"gravity": [0, 0, "9.81*sin(2*pi*t)"]}, True), ({"gravity": [0, 0, [[0, 0], [1, -9.81]]]}, True),
                         ({"gravity": [0, 0, "9.81*sin(2*pi*x)"]}, False), ({"time": {"end": "2*t"}}, False), ({"gravity": "t"}, False)):
        scene = {**read(LATTICE), **change}
        scene["time"].pop("stop", None)
        assert bool(problems(scene)) != good and (verdict(folder, scene) is None) == good, (change, problems(scene), verdict(folder, scene))


@fact
def a_stage_may_change_what_check_lets_it_change(folder):
    for change, good in (({"walls": {"top": {"motion": {"vz": 0.1}}}}, True), ({"walls": [{"name": "top", "friction": 0.2}]}, True),
                         ({"walls": {"top": {"point": [0, 0, 1]}}}, False), ({"gravity": [0, 0, 0]}, True), ({"law": {"rotation": "off"}}, False),
                         ({"walls": {"top": {"motion": "off"}}}, True), ({"walls": [{"friction": 0.2}]}, False), ({"membrane": {"colour": 1}}, False)):
        scene = read(LATTICE)
        scene["time"].pop("stop", None)
        scene["stages"] = [{"name": "first", "end": {"steps": 2}}, {"name": "second", **change}]
        assert bool(problems(scene)) != good and (verdict(folder, scene) is None) == good, (change, problems(scene), verdict(folder, scene))


@plain_fact
def schemas_of_other_files_refuse_misspelt_keys_and_wrong_values(_):
    for kind, name, wrong in (("sweep", "sweep-strength", {"combine": "all"}), ("sweep", "sweep-strength", {"parameter": {}}),
                              ("calibrate", "calibrate-sandstone", {"targets": {"youngs_modulus": "20 GPa"}}),
                              ("calibrate", "calibrate-sandstone", {"dimension": 4}), ("calibrate", "calibrate-sandstone", {"scene": "rock.yaml"}),
                              ("calibrate", "calibrate-sandstone", {"parameters": {"friction": [1]}}),
                              ("calibrate", "calibrate-sandstone", {"targets": {"curve": {"confinement": "9 MPa"}}}),
                              ("pack", "pack-uniform", {"specimen": {"particles": "many"}})):
        data, of = read(f"{ROOT}/scenes/{name}.yaml"), validator(kind)
        assert not problems(data, of) and problems({**data, **wrong}, of), (kind, wrong)
    data = {"scene": "base.yaml", "parameters": {"friction": [0.1, 1], "yield_stress_1": ["5 MPa", "50 MPa"]},
            "targets": {"curve": ["a.csv", {"file": "b.csv", "confinement": "9 MPa", "tolerance": "5 %"}]}}
    assert not problems(data, validator("calibrate")), data


# --- explain -------------------------------------------------------------------------------------------

def paths():
    return re.findall(r"^\| `([^`*]+)` \|", expect(gneiss("keys", "--markdown"), 0).stdout, re.MULTILINE)


def without_required(schema):
    """The schema of a part of a scene: nothing is required."""
    if isinstance(schema, list):
        return [without_required(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    return {key: without_required(value) for key, value in schema.items() if key != "required" or not isinstance(value, list)}


@plain_fact
def examples_of_explain_fit_the_schema(_):
    part = without_required(SCHEMA.schema)
    part["if"]["required"] = ["dimension"]
    part = jsonschema.Draft7Validator(part)
    keys = paths()
    assert len(keys) > 300
    for key in keys[::7]:
        said = expect(gneiss("explain", key), 0).stdout
        example = load(said.split("example:\n")[1].split("\npages:")[0])
        found = problems(example, part)
        assert not found, f"{key}: {example}: {found}"


@fact
def explain_shows_text_value_default_example_and_pages(_):
    said = expect(gneiss("explain", "neighbours.skin"), 0).stdout
    for words in ("extra distance of the neighbour list", "number, m, in [1e-12, 1e9], or auto", "default: auto", "    neighbours:\n      skin: 23 mm\n",
                  "docs/performance.md"):
        assert words in said, (words, said)


@fact
def explain_takes_names_of_elements_and_ends_of_paths(_):
    whole = expect(gneiss("explain", "walls[].motion.vz"), 0).stdout
    for path in ("walls.top.motion.vz", "walls[0].motion.vz", "walls.motion.vz"):
        assert expect(gneiss("explain", path), 0).stdout == whole, path
    several = expect(gneiss("explain", "friction"), 0).stdout
    assert "materials[].friction\n" in several and "walls[].friction\n" in several, several
    expect(gneiss("explain", "time.ende"), 2, "did you mean 'time.end'")
    expect(gneiss("schema", "mesh"), 2, "expected scene, pack, sweep or calibrate, found 'mesh'")


# --- names of other programs -----------------------------------------------------------------------------

with open(os.path.join(ROOT, "src/scene/foreign.c"), encoding="utf-8") as table:
    FOREIGN = re.findall(r'^    (PFC|YADE|LAMMPS|LIGGGHTS|KRATOS)\("([^"]+)", "([^"]+)", "([^"]*)"\)', table.read(), re.M)
PAGES = {"PFC": "tutorials/from-pfc.md", "YADE": "tutorials/from-yade.md"}


@fact
def names_of_other_programs_lead_to_a_key_and_are_on_their_page(_):
    assert len(FOREIGN) > 60
    for program, name, key, value in FOREIGN:
        page = PAGES.get(program, "other-codes.md")
        with open(os.path.join(ROOT, "docs", page), encoding="utf-8") as file:
            assert re.search(rf"(?<!\w){re.escape(name.split()[-1])}(?!\w)", file.read()), (name, page)
        found = expect(gneiss("keys", name), 0).stdout
        said = f"{name} of {program.replace('KRATOS', 'Kratos')} is {key}{': ' * bool(value)}{value} (docs/{page})"
        assert said in found and f"\n{key}\n" in found, (said, found[:300])


@fact
def names_of_other_programs_are_explained_and_named_in_errors(folder):
    found = expect(gneiss("explain", "PB_EMOD"), 0).stdout
    assert found.startswith("pb_emod of PFC is materials[].contact_modulus: pi/4 pb_emod (docs/tutorials/from-pfc.md)\n\nmaterials[].contact_modulus: "), found
    assert "Kn of LAMMPS" in gneiss("keys", "kn").stdout and "kn of PFC" in gneiss("keys", "kn").stdout
    expect(gneiss("keys", "PyRunner"), 2, r"no key concerns 'PyRunner': functions between steps are those of the Python module \(docs/python\.md\)")
    assert "fix gravity of LAMMPS is gravity" in gneiss("keys", "fix", "gravity").stdout
    scene = read(os.path.join(SCENES, "lattice-small.yaml"))
    scene["materials"][0]["pb_emod"] = "10 GPa"
    scene["damp"] = 0.7
    done = expect(gneiss("check", write_scene(folder, scene)), 2, r"pb_emod: unknown key 'pb_emod'; pb_emod of PFC is materials\[\]\.contact_modulus: pi/4 pb_emod")
    assert "damp: unknown key 'damp'; damp of PFC is damping.background.coefficient: damp, with model" in done.stderr, done.stderr


sys.exit(main())
