"""Isotropic materials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Material:
    """An isotropic, linearly elastic material, and what a body of fewer than three dimensions needs besides.

    Attributes:
        young: Young's modulus, Pa.
        poisson: Poisson's ratio, above -1 and below 0.5.
        plane: The state of a plane body or a surface: "stress" (the default) or "strain".
        thickness: Of a plane body or a surface, m. A plane body without it is 1 m thick; a surface in space requires it.
        area: The cross-section of rods, m². Rods without it have 1 m².
        density: kg/m³; gives the points of a network their masses.
    """

    young: float
    poisson: float
    plane: Literal["stress", "strain"] | None = None
    thickness: float | None = None
    area: float | None = None
    density: float | None = None

    @classmethod
    def lame(cls, lam: float, mu: float, **rest) -> "Material":
        """The material of Lamé's constants λ and μ, Pa."""
        return cls(young=mu * (3 * lam + 2 * mu) / (lam + mu), poisson=lam / (2 * (lam + mu)), **rest)
