"""Isotropic materials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ._arguments import PLANES, failure, number, word

_UNITS = {"young": "Pa", "poisson": "without a unit", "thickness": "m", "area": "m²", "density": "kg/m³"}


@dataclass(frozen=True)
class Material:
    """An isotropic, linearly elastic material, and what a body of fewer than three dimensions needs besides.

    Values are numbers in these units; texts with units, such as "10 kPa", are of scenes. Their ranges are checked by what takes the
    material.

    Attributes:
        young: Young's modulus, Pa.
        poisson: Poisson's ratio, above -1 and below 0.5.
        plane: The state of a plane body or a surface: "stress" (the default) or "strain".
        thickness: Of a plane body or a surface, m. A plane body without it is 1 m thick; a surface in space requires it.
        area: The cross-section of rods, m². Rods without it have 1 m².
        density: kg/m³; gives the points of a network their masses.

    Raises:
        SpringfitError: A value is no number.
    """

    young: float
    poisson: float
    plane: Literal["stress", "strain"] | None = None
    thickness: float | None = None
    area: float | None = None
    density: float | None = None

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            value = getattr(self, name)
            if value is not None or name in ("young", "poisson"):
                # The class is frozen.
                object.__setattr__(self, name, number(name, value, f"a number, {unit}"))
        word("plane", self.plane, PLANES)

    @classmethod
    def lame(cls, lam: float, mu: float, **rest: Any) -> "Material":
        """The material of Lamé's constants λ and μ, Pa.

        Raises:
            SpringfitError: μ or the bulk modulus λ + 2 μ/3 is not above zero.
        """
        lam, mu = number("lam", lam, "a number, Pa"), number("mu", mu, "a number, Pa")
        if not mu > 0:
            raise failure("mu", "a number above zero, Pa", mu)
        if not 3 * lam + 2 * mu > 0:
            raise failure("lam", f"a number above -2/3 mu = {-2 * mu / 3:g} Pa", lam)
        return cls(young=mu * (3 * lam + 2 * mu) / (lam + mu), poisson=lam / (2 * (lam + mu)), **rest)
