"""A network as a pickle, as lines of PyVista and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pyvista

    from .springs import Network

#: What is known of springs from arrays.
GIVEN: "dict[str, Any]" = {"name": "given", "status": "given", "notes": [], "statistics": {}, "sampled": None}

#: The keys of the statistics of a fit.
STATISTICS = dict.fromkeys(
    (
        "name",
        "status",
        "seconds",
        "seconds_assembly",
        "undetermined_cells",
        "unreached_cells",
        "reused_cells",
        "negative",
        "frobenius",
        "spectral",
    )
)


def frozen(group: "dict[str, Any]") -> "dict[str, Any]":
    """The group, whose arrays are read-only."""
    for value in (*group.values(), *group.get("parameters", {}).values()):
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
    return group


def state(net: "Network") -> "tuple[Any, ...]":
    """The arguments of :func:`restored`. Errors of a fit that have not been read are left out, because they take longer than the fit."""
    net._core.check_formulas()
    facts = net._facts
    if facts is None:
        facts = {
            "name": net.name,
            "status": net.status,
            "notes": net.notes,
            "statistics": net._core.statistics(False),
            "sampled": net._core.sampled,
        }
    masses, points = net.masses, None if net.mesh is not None and not _has_loose_points(net.mesh) else net.points
    return points, net.springs, net.constants, net.rest, net.contents, masses, net.mesh, facts, net._core.facts


def _has_loose_points(mesh: Any) -> bool:
    # A mesh that is read has no points without cells, such as directors of sheets.
    used = np.unique(np.concatenate([np.ravel(cells) for cells in mesh.cells.values()])) if mesh.cells else np.zeros(0)
    return len(used) < len(mesh.points)


def restored(
    points: Any, springs: Any, constants: Any, rest: Any, contents: Any, masses: Any, mesh: Any, facts: Any, known: Any = None
) -> "Network":
    """The network of a pickle."""
    from .springs import Network

    arrays = {"rest": rest, "contents": contents, "masses": masses, "known": known}
    if points is None:
        net = Network._given(mesh.points, springs, constants, mesh=mesh, **arrays)
    else:
        net = Network._given(points, springs, constants, **arrays)
        net._mesh = mesh
    net._facts = facts
    return net


def lines(net: "Network") -> "pyvista.PolyData":
    """See :meth:`Network.to_pyvista`."""
    import pyvista

    points = np.zeros((len(net.points), 3))
    points[:, : net.points.shape[1]] = net.points
    others = [kind for kind in net.contents if kind["kind"] == "length"]
    ends = np.concatenate([net.springs, *(kind["points"] for kind in others)])
    data = pyvista.PolyData(points, lines=np.column_stack([np.full(len(ends), 2), ends]).ravel())
    data.cell_data["constants"] = np.concatenate([net.constants, *(kind["constants"] for kind in others)])
    data.cell_data["rest"] = np.concatenate([net.rest, *(kind["rest"] for kind in others)])
    return data


def table(net: "Network") -> str:
    """A table of HTML."""
    from html import escape

    statistics = net.statistics
    rows: "list[tuple[str, object]]" = [("points", len(net.points)), ("springs between two points", len(net.springs))]
    rows += [(f"{kind['kind']} springs", len(kind["constants"])) for kind in net.contents]
    rows += [("constants below zero", statistics["negative"])]
    for norm in ("frobenius", "spectral"):
        if statistics[norm] is not None:
            mean, largest = statistics[norm]
            rows.append((f"‖R−K‖/‖R‖, {norm}: mean, largest", f"{mean:.3g}, {largest:.3g}"))
    if statistics["seconds"] is not None:
        rows.append(("fitted in", f"{statistics['seconds']:.3g} s"))
    rows.append(("status", statistics["status"]))
    body = "".join(f"<tr><th style='text-align:left'>{escape(str(k))}</th><td>{escape(str(v))}</td></tr>" for k, v in rows)
    notes = "".join(f"<li>{escape(note)}</li>" for note in net.notes)
    return f"<table><caption>{escape(net.name)}</caption>{body}</table><ul>{notes}</ul>"
