"""The shared library libgneiss, called through its public header alone (cffi in ABI mode)."""
from __future__ import annotations

import ctypes.util
import glob
import importlib
import os
import shutil
import sys
import threading
from pathlib import Path
from typing import Any

import cffi

from ._header import declarations

HERE = Path(__file__).resolve().parent
TREE = HERE.parent.parent  # where the module lies in the source tree


def _declarations() -> str:
    """The declarations for cffi: in the installed module a file of its own, in the source tree made from the headers."""
    own = HERE / "declarations.txt"
    if own.exists():
        return own.read_text(encoding="utf-8")
    return declarations(*(str(TREE / "include" / "gneiss" / name) for name in ("status.h", "gneiss.h")))


def _installed() -> tuple[str, str]:
    """Folders of the library and of the program, as recorded by the installation; empty without one."""
    try:
        places: Any = importlib.import_module("gneiss._places")
    except ImportError:
        return "", ""
    return os.path.join(HERE, places.LIBRARY), os.path.join(HERE, places.PROGRAM)


def _library_places():
    """Paths and names of the library in the order in which they are tried."""
    own, _ = _installed()
    if os.environ.get("GNEISS_LIBRARY"):
        return [os.environ["GNEISS_LIBRARY"]]
    patterns = [HERE / "libgneiss.so", Path(own) / "libgneiss.so.[0-9]" if own else None, TREE / "build" / "libgneiss.so.[0-9]"]
    files = [path for pattern in patterns if pattern for path in sorted(glob.glob(str(pattern))) if os.path.isfile(path)]
    return files + [name for name in (ctypes.util.find_library("gneiss"), "libgneiss.so") if name]


def program() -> str:
    """The path of the `gneiss` program: GNEISS_PROGRAM, else beside the library, in the build folder or on PATH."""
    _, own = _installed()
    here = [os.environ.get("GNEISS_PROGRAM"), os.path.join(own, "gneiss") if own else None, str(HERE.parent / "bin" / "gneiss"),
            str(TREE / "build" / "gneiss"), os.path.join(sys.prefix, "bin", "gneiss"), shutil.which("gneiss")]
    for path in here:
        if path and os.access(path, os.X_OK) and os.path.isfile(path):
            return path
    raise FileNotFoundError("the program `gneiss` was not found: expected it on PATH or at GNEISS_PROGRAM")


def _open(interface):
    reasons = []
    for place in _library_places():
        try:
            return interface.dlopen(place)
        except OSError as error:
            reasons.append(str(error))
    raise ImportError("libgneiss was not found: expected it where the linker looks, or its path in GNEISS_LIBRARY"
                      + "".join("\n  " + reason for reason in reasons))


ffi: Any = cffi.FFI()
ffi.cdef(_declarations())
lib: Any = _open(ffi)

# HDF5 and UDUNITS-2 are not thread-safe: calls that read or write files do not overlap.
files = threading.RLock()


def text(pointer: Any) -> str:
    """A C string as str; '' for NULL."""
    return ffi.string(pointer).decode("utf-8", "replace") if pointer else ""


def encoded(value: str | os.PathLike[str]) -> bytes:
    """A str or path for a C function."""
    return os.fsencode(value)
