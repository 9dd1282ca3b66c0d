"""Materials: of all cells, of each cell, and of regions."""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, Union

import numpy as np

from . import _core
from ._arguments import PLANES, array, failure, shown, typed, word

#: A number, a text with a unit, an expression of x, y and z in m, or a value of each cell.
Quantity = Union[float, str, np.ndarray, Sequence[float]]
#: One material of the whole body, or those of its regions: by the name of a group of the mesh, None standing for the rest.
MaterialLike = Union["Material", Mapping[Any, "Material"]]

#: Quantities that arrays may give by cell, with what they are in errors.
_QUANTITIES = {
    "young": "a modulus, Pa",
    "poisson": "a ratio",
    "thickness": "a length, m",
    "area": "an area, m²",
    "density": "a density, kg/m³",
}
#: Those of them that are above zero.
_POSITIVE = ("young", "thickness", "density")
#: What else an entry of a scene has.
_OTHERS = ("orthotropic", "transversely_isotropic", "cubic", "stiffness", "axes", "law", "parameters", "fibre")


@dataclass(frozen=True, eq=False)
class Material:
    """A linearly elastic material, and what a body of fewer than three dimensions needs besides.

    The keys are those of ``[material]`` in a scene. Quantities are numbers in the units below, texts with units such as ``"10 kPa"``,
    expressions of x, y and z in metres such as ``"1e4*(1 + z/0.1)"``, which hold at the centroids of the cells, or arrays with one value for each
    cell. Cells are counted block after block, in the order of :attr:`Mesh.cells`: of a mesh of 10 ``hex8`` and 6 ``wedge6`` the first wedge has
    the place 10. In a region an array has values for all cells of the mesh, of which those of the region are taken; others may be NaN.

    Args:
        young: Young's modulus, Pa. An isotropic material has it and ``poisson``; :meth:`isotropic` takes other constants.
        poisson: Poisson's ratio, above -1 and below 0.5.
        plane: The state of a plane body or a surface: "stress" (the default) or "strain".
        thickness: Of a plane body or a surface, m. A plane body without it is 1 m thick; a surface in space requires it.
        area: The cross-section of rods, m². Rods without it have 1 m².
        density: kg/m³; gives the points of a network their masses.
        orthotropic: ``{"young": [E1, E2, E3], "poisson": [ν12, ν23, ν13], "shear": [G12, G23, G13]}`` in place of ``young`` and ``poisson``;
            ν_ij is the contraction along j for each stretch along i under tension along i.
        transversely_isotropic: ``{"young": [along, across], "poisson": [along, across], "shear": along}``.
        cubic: ``{"c11": …, "c12": …, "c44": …}``.
        stiffness: Six rows of six numbers, Pa, in Voigt's notation.
        axes: Of an anisotropic material: one or two vectors, of numbers, of expressions, or an array of each cell (cells, 3).
        law: An energy of large deformation, such as "neo-hookean", or the path of a material file. It is for scenes, and the default of
            ``sampled``.
        parameters: Of the law, by name; values may be arrays by cell.
        fibre: The direction of the law's fibres, as one of the axes.

    Numbers that are texts with units are kept in these units: ``Material("10 kPa", 0.3).young`` is 10000.0.

    Raises:
        SpringfitError: A value has another type or is out of its range, a key is missing, or keys do not go together.

    Examples:
        >>> import numpy as np, springfit as sf
        >>> sf.Material("10 kPa", 0.3).young
        10000.0
        >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
        >>> stiff_above = np.where(mesh.centers[:, 2] > 0.5, 5e4, 1e4)
        >>> net = sf.fit(mesh, sf.Material(young=stiff_above, poisson=0.3))
        >>> fibres = sf.Material(transversely_isotropic={"young": [5e4, 1e4], "poisson": [0.3, 0.3], "shear": 4e3}, axes=[[0, 0, 1]])
        >>> net = sf.fit(mesh, fibres, "frobenius")
    """

    young: Quantity | None = None
    poisson: Quantity | None = None
    plane: Literal['stress', 'strain'] | None = None
    thickness: Quantity | None = None
    area: float | str | None = None
    density: Quantity | None = None
    orthotropic: Mapping[str, Any] | None = None
    transversely_isotropic: Mapping[str, Any] | None = None
    cubic: Mapping[str, Any] | None = None
    stiffness: Sequence[Any] | np.ndarray | None = None
    axes: Sequence[Any] | None = None
    law: str | os.PathLike[str] | None = None
    parameters: Mapping[str, Any] | None = None
    fibre: Sequence[Any] | np.ndarray | None = None

    def __post_init__(self) -> None:
        isotropic = all(getattr(self, key) is None for key in ("orthotropic", "transversely_isotropic", "cubic", "stiffness"))
        for name, what in _QUANTITIES.items():
            value = getattr(self, name)
            if value is not None or (isotropic and name in ("young", "poisson")):
                # The class is frozen.
                object.__setattr__(self, name, _quantity(name, value, what))
        word("plane", self.plane, PLANES)
        if self.law is not None:
            if not isinstance(self.law, (str, os.PathLike)):
                raise failure("law", "the name of an energy, or the path of its file", shown(self.law))
            object.__setattr__(self, "law", os.fspath(self.law))
        for name in _OTHERS:
            object.__setattr__(self, name, _own(getattr(self, name)))
        # Names of arrays are asked for once it is right.
        numbers = zip(_QUANTITIES, _core.checked_material(self, list(_QUANTITIES)))
        object.__setattr__(self, "_is_checked", True)
        for name, value in numbers:
            # Texts with units; expressions stay.
            if isinstance(getattr(self, name), str) and value is not None:
                object.__setattr__(self, name, value)

    @classmethod
    def isotropic(
        cls,
        *,
        young: float | str | None = None,
        poisson: float | str | None = None,
        shear_modulus: float | str | None = None,
        bulk_modulus: float | str | None = None,
        lam: float | str | None = None,
        **others: Any,
    ) -> Material:
        """The isotropic material of two of its five constants.

        With μ and λ, for example, E = μ (3 λ + 2 μ)/(λ + μ) and ν = λ/(2 (λ + μ)).

        Args:
            young: Young's modulus E, Pa.
            poisson: Poisson's ratio ν.
            shear_modulus: The shear modulus μ, Pa.
            bulk_modulus: The bulk modulus K, Pa.
            lam: Lamé's first constant λ, Pa. Errors name it ``lambda``, as its key in a scene is.
            others: What a material has besides, such as ``density``.

        Raises:
            SpringfitError: Not two constants are given, one is not a number or a text with a unit, or no material has them.

        Examples:
            >>> import springfit as sf
            >>> sf.Material.isotropic(lam=4000.0, shear_modulus="4 kPa").poisson
            0.25
        """
        given = {"young": young, "poisson": poisson, "shear_modulus": shear_modulus, "bulk_modulus": bulk_modulus, "lambda": lam}
        constants = {key: value for key, value in given.items() if value is not None}
        if len(constants) != 2:
            expected = "two of young, poisson, shear_modulus, bulk_modulus and lam"
            raise failure("material", expected, " and ".join(constants).replace("lambda", "lam") or "none")
        return cls(*_core.young_and_poisson(constants), **others)

    def _entry(self, held: dict[str, Any] | None) -> dict[str, Any]:
        """The keys of a scene's entry; arrays by cell are held by name."""
        entry = {key.replace("transversely_isotropic", "transversely-isotropic"): _stated(key, getattr(self, key), held)
                 for key in (*_QUANTITIES, *_OTHERS) if getattr(self, key) is not None}
        return entry if self.plane is None else {**entry, "plane": self.plane}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Material):
            return NotImplemented
        return all(_equal(getattr(self, own.name), getattr(other, own.name)) for own in fields(self))

    def __hash__(self) -> int:
        return hash(tuple(value for value in (getattr(self, own.name) for own in fields(self)) if isinstance(value, (float, str))))

    def __repr__(self) -> str:
        def text(value: Any) -> str:
            return f"<{len(value)} values>" if isinstance(value, np.ndarray) else repr(value)

        given = ((own.name, getattr(self, own.name)) for own in fields(self))
        return f"Material({', '.join(f'{name}={text(value)}' for name, value in given if value is not None)})"


def stated(material: Any) -> tuple[Any, dict[str, Any]]:
    """What a material, or a dictionary of them by group, is as a scene states it, with the arrays that it holds by name."""
    held: dict[str, Any] = {}
    if isinstance(material, Material):
        return material._entry(held if "_is_checked" in material.__dict__ else None), held
    if not is_regions(material):
        expected = "a springfit.Material, such as Material(young=1e4, poisson=0.3), or a dictionary of them by group"
        raise failure("material", expected, shown(material))
    return regions(material, held), held


def default_law(material: Material) -> str | None:
    """The law of a sampled fit that names none."""
    if material.law is not None and (material.parameters is not None or material.fibre is not None):
        key = "parameters" if material.parameters is not None else "fibre"
        raise failure(key, "none in a sampled fit outside of a scene: a material file has them", "some")
    return None if material.law is None else os.fspath(material.law)


def is_regions(material: Any) -> bool:
    """Whether it is a dictionary of materials."""
    return isinstance(material, Mapping) and len(material) > 0 and all(isinstance(own, Material) for own in material.values())


def regions(material: Mapping[Any, Material], held: dict[str, Any] | None) -> list[dict[str, Any]]:
    """The entries of the regions."""
    entries = []
    for name, own in material.items():
        if not isinstance(name, (str, type(None))):
            raise failure("material", "names of groups of the mesh, and None for the rest", shown(name))
        entries.append({**own._entry(held), **({} if name is None else {"group": name})})
    return entries


def _own(value: Any) -> Any:
    """A value that does not change with the lists, dictionaries and arrays from which it comes."""
    if isinstance(value, np.ndarray):
        value = value.copy()
        value.setflags(write=False)
        return value
    if isinstance(value, Mapping):
        return {key: _own(own) for key, own in value.items()}
    return [_own(own) for own in value] if isinstance(value, (list, tuple)) else value


def _quantity(key: str, value: Any, what: str) -> Any:
    """A number, a text, or a read-only array of one value for each cell."""
    expected = f"{what}: a number, a text such as \"10 kPa\", or an array with a value for each cell"
    if isinstance(value, str):
        return value
    if isinstance(value, (bytes, bool, np.bool_, type(None), Mapping)):
        raise failure(key, expected, "nothing" if value is None else shown(value))
    found = array(key, value)
    if found.dtype.kind not in "iuf" or found.ndim > 1:
        raise failure(key, expected, shown(value) if found.ndim == 0 else f"an array of type {found.dtype}, shape {found.shape}")
    if found.ndim == 0:
        return float(found)
    if key == "area":
        raise failure(key, "one area for the rods of a region", f"an array of shape {found.shape}")
    found = typed(key, found, np.float64)
    if found.size and 0.0 < found.min() and found.max() < (0.5 if key == "poisson" else np.inf):
        return _kept(found, value)
    if key == "poisson":
        wrong, range_ = (found <= -1) | (found > 0.5), "ratios above -1 and below 0.5"
    else:
        wrong, range_ = (found <= 0) | np.isinf(found), "finite numbers above zero"
    # What is not a number may be outside of the region.
    if wrong.any():
        cell = int(np.flatnonzero(wrong)[0])
        raise failure(f"{key}[{cell}]", range_, found[cell])
    return _kept(found, value)


def _kept(found: np.ndarray, given: Any) -> np.ndarray:
    """A read-only array that nobody else has."""
    if found is given or found.base is not None:
        found = found.copy()
    found.flags.writeable = False
    return found


def _stated(key: str, value: Any, held: dict[str, Any] | None) -> Any:
    """A value as a scene has it; arrays by cell are held by name."""
    if isinstance(value, np.ndarray) and key in _QUANTITIES:
        return _held(key, value[:, None], held)
    if key == "fibre" or key.startswith("axes["):
        rows = array(key, value) if isinstance(value, np.ndarray) else None
        return _held(key, _vectors(key, rows), held) if rows is not None and rows.ndim == 2 else value
    if key == "axes":
        if isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__iter__"):
            raise failure(key, "a list of one or two vectors", shown(value))
        return [_stated(f"axes[{i}]", axis, held) for i, axis in enumerate(value)]
    if isinstance(value, Mapping):
        return {name: _constant(f"{key}.{name}", own, held) for name, own in value.items()}
    return value


def _constant(key: str, value: Any, held: dict[str, Any] | None) -> Any:
    """A constant of a law or a list of them, each a number, a text or an array by cell."""
    of_cells = isinstance(value, np.ndarray) and value.ndim == 1 and key.startswith("parameters.")
    if of_cells or (isinstance(value, np.ndarray) and value.ndim == 1 and value.size > 3):
        return _held(key, typed(key, value, np.float64)[:, None], held)
    if isinstance(value, (list, tuple)):
        return [_constant(f"{key}[{i}]", own, held) for i, own in enumerate(value)]
    return value


def _vectors(key: str, rows: np.ndarray) -> np.ndarray:
    if rows.shape[1] not in (2, 3):
        raise failure(key, "an array of a vector for each cell, (cells, 3)", f"one of shape {rows.shape}")
    vectors = np.zeros((len(rows), 3))
    vectors[:, : rows.shape[1]] = typed(key, rows, np.float64)
    return vectors


def _held(key: str, values: np.ndarray, held: dict[str, Any] | None) -> dict[str, str]:
    """Holds an array; its name tells its content from others. Nothing is held where the rest is checked alone."""
    if held is None:
        return {"file": "memory"}
    values = np.ascontiguousarray(values)
    name = f"memory:{key}-{zlib.crc32(values.tobytes()):08x}-{values.size}"
    held[name] = (None, values)
    return {"file": name}


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    return bool(a == b)
