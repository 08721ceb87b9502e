"""The JSON Schema (draft 7) of a file of targets, from the tables that also drive its reading."""
from calibrate.laws import NAMES as LAWS
from calibrate.targets import FREE, KEYS, MATERIAL, MOST_SEEDS, READINGS

WITH_UNIT = {"type": "string", "pattern": r"^ *\+?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)? *[^0-9 ]?[^+]*$"}
SCALAR = {"type": ["string", "number", "boolean"]}
SECTION = {"type": "object"}


def quantity(unit, low, high, text):
    """A number within the limits in the unit, or a text with a unit."""
    shown = "" if unit == "1" else f" {unit}"
    return {"description": f"{text} (number in [{low:g}, {high:g}]{shown})",
            "anyOf": [{"type": "number", "minimum": low, "maximum": high}, WITH_UNIT]}


def target(name, **more):
    """A wanted reading: its value, or a section with its tolerance and the members of `more`."""
    unit, low, high, default = READINGS[name]
    value = quantity(unit, low, high, f"wanted {name.replace('_', ' ')}")
    section = {"type": "object", "required": ["value", *more], "additionalProperties": False,
               "properties": {"value": value, **more,
                              "tolerance": {"description": f"tolerance (default {default:g})", "anyOf": [{"type": "number"}, WITH_UNIT]}}}
    return {"anyOf": [*value["anyOf"], section]}


def targets():
    confinement = quantity("Pa", 1.0, 1e12, "confining pressure")
    triaxial = {"type": "array", "minItems": 1, "items": target("compressive_strength", confinement=confinement)["anyOf"][-1]}
    file = {"type": "string", "description": "text file of rows strain,stress"}
    curve = {"anyOf": [file, {"type": "object", "required": ["file"], "additionalProperties": False, "properties": {
        "file": file, "confinement": quantity("Pa", 0.0, 1e12, "confining pressure"), "tolerance": quantity("1", 1e-4, 1.0, "share of the largest stress")}}]}
    return {"type": "object", "minProperties": 1, "additionalProperties": False,
            "properties": {**{name: target(name) for name in READINGS}, "triaxial": triaxial, "curve": {"anyOf": [*curve["anyOf"], {"type": "array", "minItems": 1, "items": curve}]}}}


def parameters():
    """Ranges of keys of the material."""
    return {"type": "object", "minProperties": 1, "additionalProperties": False,
            "properties": {key: {"type": "array", "minItems": 2, "maxItems": 2, "items": quantity(*limits, "lowest and highest value")} for key, limits in FREE.items()}}


def schema():
    """The schema as a dict."""
    seeds = {"type": "array", "minItems": 1, "uniqueItems": True, "items": {"type": "integer", "minimum": 0}}
    properties = {
        "title": SCALAR, "scene": SCALAR, "specimen": SECTION, "bonds": SECTION, "targets": targets(), "parameters": parameters(), "budget": {"type": ["string", "integer"]},
        "dimension": {"enum": [2, 3]}, "density": quantity(*MATERIAL["density"], "mass density"), "friction": quantity("1", 0.0, 10.0, "friction"),
        "law": {"anyOf": [{"enum": ["auto", "scene", *LAWS]}, SECTION]}, "seeds": {"anyOf": [{"type": "integer", "minimum": 1, "maximum": MOST_SEEDS}, seeds]}}
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": "gneiss targets", "description": "a file of gneiss calibrate",
            "type": "object", "required": ["targets"], "additionalProperties": False, "oneOf": [{"required": ["scene"]}, {"required": ["specimen"]}],
            "properties": {key: properties[key] for key in KEYS}}
