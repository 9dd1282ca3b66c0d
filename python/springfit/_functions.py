"""Python functions in place of an energy, of laws of force, of a norm and of shapes."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ._arguments import array, count, failure, typed, warn
from .material import Material, MaterialLike

#: The step of differences at rest, and the relative difference of stiffnesses above which a warning is given.
_STEP, _TOLD = 1e-4, 0.01
#: The least det F of a shape of a list, as in a scene.
_FLATTEST = 1e-3


def separated(keys: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """The keys of a fit without functions, and the functions, if there are any."""
    keys = dict(keys)
    law, stress, force = keys.get("law"), keys.pop("stress", None), keys.get("force")
    energy, forces, norm = None, [], None
    if keys.get("shapes") is not None:
        keys["shapes"] = drawn(keys["shapes"])
    if callable(keys.get("norm")):
        norm = keys.pop("norm")
        norm = (_name(norm), norm)
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
    if energy is None and stress is None and not forces and norm is None:
        return keys, None
    own = None
    if energy is not None or stress is not None:
        checked = [None if given is None else _unmasked(key, given) for key, given in (("law", energy), ("stress", stress))]
        own = (_name(energy or stress), *checked)
    return keys, {"energy": own, "forces": forces, "norm": norm}


def drawn(shapes: Any) -> Any:
    """The shapes with deformation gradients in place of samplers that are functions."""
    if isinstance(shapes, (list, tuple)):
        return [_drawn(f"shapes[{i}]", one) for i, one in enumerate(shapes)]
    return _drawn("shapes", shapes)


def _drawn(place: str, shapes: Any) -> Any:
    if not isinstance(shapes, Mapping):
        return shapes
    shapes = dict(shapes)
    held_out, seed = shapes.get("held_out"), shapes.get("seed")
    if isinstance(held_out, Mapping) and "sampler" in held_out:
        shapes["held_out"] = _listed(f"{place}.held_out", {"seed": seed, **held_out}, 100, 1)
    if shapes.get("sampler") is None:
        return shapes
    if held_out is None or not (isinstance(held_out, Mapping) or _is_zero(held_out)):
        held_out = 100 if held_out is None else count(f"{place}.held_out", held_out)
        rest = {"sampler": shapes["sampler"], "count": held_out, "seed": seed}
        shapes["held_out"] = _listed(f"{place}.held_out", rest, 100, 1)
    return _listed(place, shapes, 300, 0)


def _is_zero(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and value == 0


def _listed(place: str, shapes: dict[str, Any], usual: int, part: int) -> dict[str, Any]:
    """The shapes with the gradients that their sampler draws; ``part`` tells those of the fit from others."""
    sampler, key = shapes.pop("sampler"), f"{place}.sampler"
    if not callable(sampler):
        raise failure(key, "a function of a number of shapes and a random generator", type(sampler).__name__)
    given = [name for name in ("families", "gradients", "loads", "run", "states") if shapes.get(name) is not None]
    if given:
        raise failure(place, "one source of shapes", f'"sampler" and "{given[0]}"')
    number = shapes.pop("count", None)
    number = usual if number is None else count(f"{place}.count", number)
    seed = shapes.get("seed")
    if seed is not None and not (_is_zero(seed) or count(f"{place}.seed", seed)):
        raise failure(f"{place}.seed", "a whole number from 0", seed)
    # Of a list with nothing held out beside it each fifth shape is left out.
    drawn = number + (number // 4 if part == 0 and _is_zero(shapes.get("held_out")) else 0)
    try:
        found = sampler(drawn, np.random.default_rng([1 if seed is None else int(seed), part]))
    except Exception as fault:
        raise failure(key, "a function that returns", f"{type(fault).__name__}: {fault}") from fault
    found = typed(key, array(key, found), np.float64)
    if found.ndim != 3 or found.shape[0] != drawn or found.shape[1] != found.shape[2]:
        raise failure(key, f"deformation gradients of shape ({drawn}, d, d)", f"an array of shape {found.shape}")
    if not np.isfinite(found).all():
        wrong = int(np.flatnonzero(~np.isfinite(found).all(axis=(1, 2)))[0])
        raise failure(key, "finite numbers", f"others in shape {wrong}")
    contents = np.linalg.det(found)
    if (contents < _FLATTEST).any():
        wrong = int(np.flatnonzero(contents < _FLATTEST)[0])
        expected = f"shapes that are neither flat nor inverted, with det F of at least {_FLATTEST}"
        raise failure(key, expected, f"det F = {contents[wrong]:.4f} of shape {wrong}")
    return {**shapes, "gradients": found.tolist(), "count": number}


def _name(function: Callable) -> str:
    return getattr(function, "__name__", type(function).__name__)


def _force(key: str, group: str | None, function: Callable) -> tuple[str | None, Callable, str, list[str]]:
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


#: Energies in single precision are as far from invariant.
_TURNED = 1e-4


def warn_of_rest(material: MaterialLike, energy: Callable | None, stress: Callable | None) -> None:
    """Warns where the stiffness of an energy at rest is not that of the material. What a function does wrong is left to the fit."""
    if not isinstance(material, Material) or not (isinstance(material.young, float) and isinstance(material.poisson, float)):
        return
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


def warn_of_turns(energy: Callable | None, stress: Callable | None) -> None:
    """Warns where a rotation changes an energy, W(QF) = W(F), or a stress is not that of one: P Fᵀ is symmetric. What a function does wrong is left
    to the fit."""
    random = np.random.default_rng(1)
    f = np.eye(3) + random.uniform(-0.2, 0.2, (6, 3, 3))
    q = np.linalg.qr(random.normal(size=f.shape))[0]
    q *= np.linalg.det(q)[:, None, None]
    try:
        if energy is not None:
            # Without a shape at rest an energy might be a constant beside which a change is rounding.
            w = np.asarray(energy(np.concatenate([f, q @ f, np.eye(3)[None]])), np.float64)
            size, apart = np.max(np.abs(w[:6] - w[-1])), np.max(np.abs(w[6:12] - w[:6]))
            words = "the energy is not that of a body: a rotation changes it, by {:.1f} % of the largest (W(QF) = W(F) does not hold)"
        elif stress is not None:
            kirchhoff = np.asarray(stress(f), np.float64) @ f.transpose(0, 2, 1)
            size, apart = np.max(np.abs(kirchhoff)), np.max(np.abs(kirchhoff - kirchhoff.transpose(0, 2, 1)))
            words = "the stress is not the first Piola-Kirchhoff stress of a body: P Fᵀ is not symmetric, by {:.1f} % of the largest"
        else:
            return
    except Exception:  # of the user, who hears of it from the fit
        return
    if apart > _TURNED * size:
        warn(words.format(100 * apart / size))
