"""Numbers with units, converted by UDUNITS-2 as in a scene."""
import ctypes
import re

_LIBRARY = "libudunits2.so.0"
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_UTF8 = 2
_system = {}
_ALIASES = {"deg": "degree"}  # aliases of a scene


def _load():
    """The library and its system of units, read once."""
    if not _system:
        library = ctypes.CDLL(_LIBRARY)
        for name in ("ut_read_xml", "ut_parse", "ut_get_converter"):
            getattr(library, name).restype = ctypes.c_void_p
        library.ut_set_error_message_handler.restype = ctypes.c_void_p
        library.cv_convert_double.restype = ctypes.c_double
        library.ut_set_error_message_handler(ctypes.cast(library.ut_ignore, ctypes.c_void_p))
        _system["library"] = library
        _system["units"] = ctypes.c_void_p(library.ut_read_xml(None))
    return _system["library"], _system["units"]


def factor(unit, to):
    """Value in `to` of 1 `unit`; ValueError if a unit is unknown or the dimensions differ."""
    library, system = _load()
    parsed = [ctypes.c_void_p(library.ut_parse(system, _ALIASES.get(name, name).encode(), _UTF8)) for name in (unit, to)]
    if not all(one.value for one in parsed):
        raise ValueError(f"unknown unit '{unit}'")
    converter = ctypes.c_void_p(library.ut_get_converter(*parsed))
    if not converter.value:
        raise ValueError(f"'{unit}' cannot be converted to {to}")
    return library.cv_convert_double(ctypes.c_double(1.0), converter)


def number(text, to):
    """Number in the unit `to` ("1": dimensionless) of a text such as `25 mm`; without a unit the text is in `to`."""
    found = _NUMBER.match(str(text))
    if not found:
        raise ValueError(f"expected a number, found '{text}'")
    value, unit = float(found[1]), found[2]
    return value * factor(unit, to) if unit else value
