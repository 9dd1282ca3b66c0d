"""What callers give, as the library takes it, or the error that names the argument."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterable
from typing import Any, Union

import numpy as np

from ._core import Element, SpringfitError, quantity

#: An element, the name of a shipped one, or the path of an element file.
ElementLike = Union[str, "os.PathLike[str]", Element]

#: Names of cells in meshio that are none of shipped elements, and the elements that have these cells.
FOREIGN = {
    "line": "bar2",
    "triangle": "tri3",
    "quad": "quad4",
    "tetra": "tet4",
    "hexahedron": "hex8",
    "wedge": "wedge6",
    "pyramid": "pyramid5",
    "line3": "bar3",
    "triangle6": "tri6",
    "tetra10": "tet10",
    "hexahedron20": "hex20",
    "hexahedron27": "hex27",
}

#: The states of plane bodies, in errors.
PLANES = '"stress" or "strain"'


def failure(key: str, expected: str, found: object, kind: str = "invalid") -> SpringfitError:
    """The error of an argument, as the library would raise it."""
    error = SpringfitError(f"{key}: expected {expected}, found {found}")
    error.kind, error.file, error.line, error.key = kind, None, None, key
    return error


def warn(words: str) -> None:
    """A warning at the line that called the package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "springfit":
        level, frame = level + 1, frame.f_back
    warnings.warn(words, stacklevel=level)


def shown(value: object) -> str:
    """A value in an error: texts in quotes, others by their type."""
    return f'"{value}"' if isinstance(value, str) else f"a value of type {type(value).__name__}"


def array(key: str, values: Any) -> np.ndarray:
    """Values as an array. Masked entries are no values."""
    rows = values if isinstance(values, (list, tuple)) else ()
    if any(np.ma.is_masked(part) for part in (values, *(row for row in rows if isinstance(row, np.ma.MaskedArray)))):
        raise failure(key, "an array without masked entries", "a mask")
    try:
        return np.asarray(values)
    except (TypeError, ValueError, RuntimeError) as error:
        raise failure(key, "an array", str(error)) from error


def typed(key: str, found: np.ndarray, dtype: type) -> np.ndarray:
    """The array with this type, whose values are kept as they are: integers, or real numbers."""
    if np.issubdtype(dtype, np.integer):
        # Durations are integers to issubdtype.
        if found.dtype.kind not in "iu":
            raise failure(key, "integers", f"values of type {found.dtype}")
    elif found.dtype.kind not in "iuf":
        raise failure(key, "real numbers", f"values of type {found.dtype}")
    return np.ascontiguousarray(found, dtype=dtype)


def matrix(key: str, values: Any, dtype: type) -> np.ndarray:
    """A two-dimensional array of this type."""
    found = array(key, values)
    if found.ndim != 2:
        raise failure(key, "an array of two dimensions", f"one of shape {found.shape}")
    return typed(key, found, dtype)


def along_axes(key: str, values: Any, dtype: type) -> list:
    """A number for each axis."""
    found = array(key, values)
    if found.ndim != 1:
        raise failure(key, "a list with a number for each axis", f"values of shape {found.shape}")
    return typed(key, found, dtype).tolist()


def number(key: str, value: Any, expected: str) -> float:
    """A real number."""
    if isinstance(value, (str, bytes)):
        raise failure(key, expected, shown(value))
    found = array(key, value)
    if found.ndim != 0 or found.dtype.kind not in "iuf":
        raise failure(key, expected, shown(value))
    return float(found)


def measure(key: str, value: Any, expected: str, kind: str = "length") -> float:
    """A real number in the SI unit, or a text with a unit."""
    return quantity(key, kind, value) if isinstance(value, str) else number(key, value, expected)


def count(key: str, value: Any) -> int:
    """A whole number above zero."""
    expected = "a whole number above zero"
    found = array(key, value)
    if found.ndim != 0 or found.dtype.kind not in "iu":
        raise failure(key, expected, shown(value))
    if found < 1:
        raise failure(key, expected, found)
    return int(found)


def word(key: str, value: Any, expected: str) -> str | None:
    """A text, whose value the library checks, or None."""
    if not isinstance(value, (str, type(None))):
        raise failure(key, expected, shown(value))
    return value


def places(key: str, values: Any, count: int, of: str = "points") -> np.ndarray:
    """Places from 0 of these, of which there are ``count``, from their list or from a flag for each."""
    found = array(key, values)
    if found.dtype == bool and found.shape == (count,):
        return np.flatnonzero(found)
    if found.size == 0:
        # The type of an empty list says nothing.
        found = found.astype(np.int64)
    if found.ndim != 1 or found.dtype.kind not in "iu":
        expected = f"a list of places of {of}, or a flag for each of {count}"
        raise failure(key, expected, f"values of type {found.dtype}, shape {found.shape}")
    no_flags(key, found, count)
    wrong = found[(found < 0) | (found >= count)]
    if wrong.size:
        raise failure(key, f"places of {of} from 0 and below {count}", wrong[0])
    return np.ascontiguousarray(found, dtype=np.int64)


def no_flags(key: str, found: np.ndarray, count: int) -> None:
    """Raises where numbers 0 and 1 of all things look like flags: as places they would be the first two things, again and again."""
    if count > 2 and found.shape == (count,) and found.max(initial=0) <= 1 and found.min(initial=0) >= 0:
        raise failure(key, f"places, or {count} flags of type bool", f"{count} numbers 0 and 1 of type {found.dtype}")


def element_of(given: ElementLike) -> Element:
    """An element itself, the shipped one of this name, or the one of the file at this path."""
    if isinstance(given, Element):
        return given
    if not isinstance(given, (str, os.PathLike)):
        raise failure("element", "an element, its name or the path of its file", shown(given))
    known = FOREIGN.get(given) if isinstance(given, str) else None
    if known is not None:
        raise failure("element", "a name of springfit's elements", f'"{given}" of meshio; did you mean "{known}"?')
    return Element(os.fspath(given))


def elements_of(given: Iterable[ElementLike]) -> list[Element]:
    """The elements of a list."""
    if isinstance(given, (str, os.PathLike, Element)) or not isinstance(given, Iterable):
        raise failure("elements", "a list of elements, such as [Element(…)]", shown(given))
    return [element_of(element) for element in given]
