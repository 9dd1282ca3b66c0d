"""Python functions in place of an energy and of laws of force."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ._arguments import array, failure, warn
from .material import Material

#: The step of differences at rest, and the relative difference of stiffnesses above which a warning is given.
_STEP, _TOLD = 1e-4, 0.01


def separated(keys: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any] | None]":
    """The keys of a fit without functions, and the functions, if there are any."""
    keys = dict(keys)
    law, stress, force = keys.get("law"), keys.pop("stress", None), keys.get("force")
    energy, forces = None, []
    if stress is not None and not callable(stress):
        raise failure("stress", "a function of F", type(stress).__name__)
    if callable(law):
        energy = keys.pop("law")
    elif law is not None and stress is not None:
        raise failure("stress", "an energy that is a function, or none", f'the law "{law}"')
    if callable(force):
        forces = [_force("force", None, keys.pop("force"))]
    elif isinstance(force, Mapping):
        forces = [_force(f"force.{group}", group, law) for group, law in force.items() if callable(law)]
        rest = {group: law for group, law in force.items() if not callable(law)}
        keys["force"] = rest or None
    if energy is None and stress is None and not forces:
        return keys, None
    own = None
    if energy is not None or stress is not None:
        checked = [None if given is None else _unmasked(key, given) for key, given in (("law", energy), ("stress", stress))]
        own = (_name(energy or stress), *checked)
    return keys, {"energy": own, "forces": forces}


def _name(function: Callable) -> str:
    return getattr(function, "__name__", type(function).__name__)


def _force(key: str, group: "str | None", function: Callable) -> "tuple[str | None, Callable, str, list[str]]":
    expected = "a function with named arguments, such as f(s, k)"
    try:
        arguments = inspect.signature(function).parameters.values()
    except (TypeError, ValueError) as fault:
        raise failure(key, expected, str(fault)) from fault
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    # Arguments with defaults keep them.
    names = [argument.name for argument in arguments if argument.kind in positional and argument.default is argument.empty]
    wrong = [a for a in arguments if a.kind not in positional and (a.default is a.empty and a.kind is not a.VAR_KEYWORD)]
    if wrong:
        raise failure(key, expected, str(wrong[0]))
    if not {"s", "c"} & set(names):
        raise failure(key, "a function of the strain s or of the measure c", f"{_name(function)}({', '.join(names)})")
    return group, _unmasked(key, function), _name(function), names


def _unmasked(key: str, function: Callable) -> Callable:
    """The function, whose results may have no masked entries."""
    return lambda *given: array(key, function(*given))


def warn_of_rest(material: Material, energy: "Callable | None", stress: "Callable | None") -> None:
    """Warns where the stiffness of an energy at rest is not that of the material. What a function does wrong is left to the fit."""
    axes = np.eye(3)
    shears = [np.outer(axes[i], axes[j]) + np.outer(axes[j], axes[i]) for i, j in ((0, 1), (1, 2), (2, 0))]
    strains = np.array([np.outer(axis, axis) for axis in axes] + shears + [np.eye(3)])
    f = np.eye(3) + _STEP * np.concatenate([strains, -strains, 0 * strains[:1]])
    n = len(strains)
    try:
        if stress is not None:
            p = np.asarray(stress(f), np.float64)
            found = np.einsum("nij,nij->n", p[:n] - p[n : 2 * n], strains) / (2 * _STEP)
        elif energy is not None:
            w = np.asarray(energy(f), np.float64)
            found = (w[:n] + w[n : 2 * n] - 2 * w[2 * n]) / _STEP**2
        else:
            return
    except Exception:  # of the user, who hears of it from the fit
        return
    young, poisson = material.young, material.poisson
    with np.errstate(all="ignore"):
        lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
        known = lam * np.trace(strains, axis1=1, axis2=2) ** 2 + 2 * mu * np.einsum("nij,nij->n", strains, strains)
        apart = float(np.max(np.abs(found / known - 1)))
    if apart > _TOLD:
        warn(f"the stiffness of the energy at rest differs by up to {100 * apart:.0f} % from that of the material")
