"""Fits of networks of springs, and the finite elements beside them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arguments import failure, number, shown, warn
from ._functions import separated, warn_of_rest, warn_of_turns
from ._progress import listener
from ._sparse import csr
from ._supports import held_flags
from .material import Material, MaterialLike, default_law, is_regions
from .mesh import Mesh
from .springs import Network

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix
else:
    csr_matrix = Any


def fit(
    mesh: Mesh,
    material: MaterialLike,
    objective: str = "exact",
    *,
    springs: "str | list[str] | None" = None,
    fix: Any = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
    **keys: Any,
) -> "Network":
    """Fits the springs of every cell, and puts them together.

    Args:
        mesh: The body.
        material: What it is made of: a :class:`Material`, or a dictionary of them by group for a body of regions, None standing for the rest.
        objective: "exact" (the default: the network is the finite element), "frobenius", "offdiag", "modal", "spectral",
            "divergence", "sampled", or a published method.
        springs: Names of spring groups, or a word for several such as "all + volume"; all that are not optional, if None.
        fix: What is held, as in :meth:`Network.solve`, of fits to the whole object, and of exact networks with ``volume="patches"``, whose held points
            have no patches; other fits do not depend on it.
        progress: True shows a bar (by ``tqdm`` where it is installed); or a function of (stage, done, total).
        **keys: The other keys of a ``[[fit]]`` in a scene, such as ``nonnegative=True`` or ``volume="patches"``.

    Returns:
        The network, whose points are those of the mesh.

    Raises:
        SpringfitError: A key or a value is wrong, or a cell cannot be fitted.
    """
    check_body(mesh, material)
    entry: "dict[str, Any]" = {"objective": objective, "springs": springs, **keys}
    has_patches = objective == "exact" and keys.get("volume") == "patches"
    if fix is not None and objective != "whole" and not has_patches:
        raise failure("fix", 'what is held with the objective "whole" or volume = "patches" alone', f'it with "{objective}"')
    if fix is None and has_patches:
        warn("no point is held: patches of points that will be held lock as cells do; fix says what is held")
    held = None if fix is None else held_flags(mesh.points.shape, mesh.groups, fix)
    entry, functions = separated(entry)
    if functions is not None and functions["energy"] is not None:
        warn_of_rest(material, *functions["energy"][1:])
        warn_of_turns(*functions["energy"][1:])
    law = material.law if isinstance(material, Material) else None
    if objective == "exact" and law is not None and "energy" not in keys:
        warn(f'the law "{law}" of a material is that of scenes: this network has its usual energy at large deformation, or that of the key "energy"')
    with listener(progress) as told:
        found = _core.fit(mesh._core, material, entry, held, told, functions)
    unreached = (found.statistics(False) or {}).get("unreached_cells", 0)
    if unreached:
        warn(f"the search of {unreached} cells has ended before an optimum: their constants are not those that the objective asks for")
    return Network._of(found, mesh)


def sampled(
    mesh: Mesh,
    material: MaterialLike,
    law: "str | os.PathLike[str] | Callable[[np.ndarray], Any] | None" = None,
    *,
    stress: "Callable[[np.ndarray], Any] | None" = None,
    force: "str | Callable[..., Any] | Mapping[str, str | Callable[..., Any]] | None" = None,
    norm: "str | Callable[[np.ndarray], Any] | None" = None,
    **keys: Any,
) -> "Network":
    """Fits the springs of every cell to the forces of an energy at sampled shapes.

    Args:
        law: That of the material if None. A shipped energy, such as "neo-hookean", or the path of a material file, whose expression is differentiated exactly. Or a
            function W(F) of the deformation gradients (n, 3, 3) that returns the energies per volume at rest (n,), J/m³. F is that of a
            solid; of a plane body its stretch through the thickness follows from the plane state. Without ``stress``, W is differentiated
            by differences of the fourth order, whose error is some 1e-12 of the moduli. The material gives the moduli at rest; a warning tells where W has others.
        stress: The derivative P(F) of W, (n, 3, 3), Pa: the first Piola-Kirchhoff stress. It is enough without W; with W both are compared.
        force: The law of force of the springs: an expression, such as "k1*s + k3*s^3", or a function such as f(s, k, a), or a dictionary of
            laws by spring group. Arguments of a function are the strain s = (c - c0)/c0 and the measure c, of shape (n,), the measure c0 at
            rest, and the parameters to fit, which are numbers and have any other names; those with a default keep it. It returns the
            forces (n,), N. Its derivatives are differences.
        norm: What is minimised: "2", "1", "max", "huber", or a function of the residual forces of a cell, (shapes, nodes, d), each shape
            times the root of its weight; with ``higher`` below 1, d more rows follow. It returns a pair: the value, or one of each shape
            (shapes,), which are added, and its gradient in the residuals. It belongs to laws that are linear in their parameters.
        **keys: The other keys of a ``[[fit]]`` with the objective "sampled", such as ``shapes={"count": 300, "stretch": 0.3}``; and the
            options of :func:`fit`. ``shapes`` may have a ``sampler`` in place of families: a function of a number and a
            ``numpy.random.Generator`` that returns as many deformation gradients, (count, d, d); also in its ``held_out``.

    Functions are called on the threads of the fit, one call at a time. What they raise is the cause of the error. A network whose law of
    force is a function is not written to files.

    Raises:
        SpringfitError: A key or a value is wrong, a function fails or returns an array of another shape, or a cell cannot be fitted.
    """
    if law is None and isinstance(material, Material) and stress is None:
        law = default_law(material)
    law = law if law is None or callable(law) else os.fspath(law)
    return fit(mesh, material, "sampled", law=law, stress=stress, force=force, norm=norm, **keys)


def whole(mesh: Mesh, material: MaterialLike, fix: Any, **keys: Any) -> "Network":
    """Fits the springs of all cells together to the displacements of the whole object.

    Args:
        fix: What is held: the name of a group, places of points, a flag for each point, or for each component (points, dimension). Points
            are numbered as in :attr:`Mesh.points`, without those that belong to no cell.
        **keys: The other keys of a ``[[fit]]`` with the objective "whole", such as ``unknowns="group"``; and the options of :func:`fit`.

    Raises:
        SpringfitError: A key or a value is wrong, or nothing holds a piece of the mesh.
    """
    return fit(mesh, material, "whole", fix=fix, **keys)


def check_body(mesh: Any, material: Any) -> None:
    """Raises where one is not what its name says."""
    if not isinstance(mesh, Mesh):
        raise failure("mesh", "a springfit.Mesh, such as Mesh(points, {element: cells})", shown(mesh))
    if not isinstance(material, Material) and not is_regions(material):
        expected = "a springfit.Material, such as Material(young=1e4, poisson=0.3), or a dictionary of them by group"
        raise failure("material", expected, shown(material))


def stiffness(mesh: Mesh, material: MaterialLike) -> "csr_matrix":
    """The stiffness matrix of the finite elements, N/m: a ``scipy.sparse.csr_matrix`` of shape (points·dimension, points·dimension).

    The degree of freedom of point p along axis k has the number ``p * dimension + k``.
    """
    check_body(mesh, material)
    return csr(_core.finite_elements(mesh._core, material))


def mass(mesh: Mesh, material: MaterialLike, share: float = 0.0, total: "float | None" = None) -> "csr_matrix":
    """The mass matrix ``(1 - share) * M + share * diag(m)``, kg: a ``scipy.sparse.csr_matrix``, numbered as in :func:`stiffness`.

    ``M_ab = ∫ ρ N_a N_b dV`` is the consistent matrix of the finite elements, and ``m`` its diagonal with the mass of each cell (HRZ).

    Args:
        share: From 0 to 1; whole-object fits report it as ``lumped_share``, fitted to frequencies.
        total: The mass of the body, kg, where that of its mesh is another; whole-object fits report it as ``total``.

    Raises:
        SpringfitError: The material has no density, or a value is outside its range.
    """
    check_body(mesh, material)
    own = csr(_core.masses(mesh._core, material, number("share", share, "a number from 0 to 1")))
    if total is None:
        return own
    wanted = number("total", total, "a mass above zero, kg")
    if not 0.0 < wanted < float("inf"):
        raise failure("total", "a mass above zero, kg", wanted)
    # Each axis has the mass once.
    return own * (wanted * mesh.points.shape[1] / own.sum())
