"""Checks of arguments; their errors state what was expected and what was found."""
from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


def whole(value: Any, what: str, least: int) -> int:
    """An integer of at least `least`; `what` names it. Raises TypeError of other types, InputError of smaller ones."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"expected a whole {what}, found {value!r} ({type(value).__name__})") from None
    if number < least:
        raise InputError(f"expected a {what} of at least {least}, found {number}")
    return number


def finite(value: Any, what: str) -> float:
    """A finite number; `what` names it with its unit. Raises TypeError of other types, InputError of NaN and infinity."""
    if isinstance(value, (str, bytes)) or np.ndim(value) or np.iscomplexobj(value):
        raise TypeError(f"{what}: expected a number, found {value!r} ({type(value).__name__})")
    try:
        number = float(value)
    except TypeError:
        raise TypeError(f"{what}: expected a number, found {value!r} ({type(value).__name__})") from None
    if not math.isfinite(number):
        raise InputError(f"{what}: expected a finite number, found {number}")
    return number


def rows(values: Any, shape: tuple[int, ...], what: str) -> NDArray[Any]:
    """Real numbers broadcast to a shape. Raises TypeError of complex numbers and texts, InputError of another shape."""
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{what}: expected real numbers, found an array of {array.dtype}")
    try:
        return np.broadcast_to(array.astype(float, copy=False), shape)
    except ValueError:
        raise InputError(f"{what}: expected an array of shape {shape} or one that broadcasts to it, found {array.shape}") from None


def function_of(value: Any) -> Any:
    """A function. Raises TypeError of anything else."""
    if not callable(value):
        raise TypeError(f"expected a function, found {value!r} ({type(value).__name__})")
    return value
