"""Networks from files of arrays, as ``springfit run`` and :meth:`Network.save` write them."""

from __future__ import annotations

import json
import os
import zipfile
from typing import Any

import numpy as np

from ._arguments import failure
from ._core import SpringfitError


def read_arrays(path: str) -> "tuple[dict[str, Any], np.ndarray, str]":
    """The arguments of :class:`Network` but for the mesh, the corners of the cells that are simplices, and what is known beside them."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, zipfile.BadZipFile, EOFError, AttributeError) as error:
        raise failure(os.path.basename(path), "a file of arrays of NumPy (.npz)", str(error), "syntax") from error
    for name in ("points", "springs", "k", "rest"):
        if name == "k" and "constants" in arrays:
            arrays["k"] = arrays["constants"]
        if name not in arrays:
            known = ", ".join(sorted(arrays)) or "none"
            raise failure(name, "the array of a network, as Network.save writes it", f"the arrays {known}")
    points, cells = arrays["points"], arrays.get("tets", np.zeros((0, 4), np.int64))
    volumes = arrays.get("volumes", np.zeros((0, cells.shape[-1]), np.int64))
    # In the plane z is zero, and cells are triangles.
    d = cells.shape[-1] - 1 if cells.ndim == 2 else 3
    if points.ndim == 2 and points.shape[1] == 3 and d in (1, 2) and not points[:, d:].any():
        points = points[:, :d]
    contents = []
    if len(volumes):
        kind = "area" if volumes.shape[-1] == 3 else "volume"
        values = [arrays.get(name) for name in ("k_volume", "rest_volume")]
        if values[0] is None or values[1] is None:
            raise failure("k_volume", "an array for the springs in volumes, and rest_volume", "none")
        contents = [{"kind": kind, "points": volumes, "constants": values[0], "rest": values[1]}]
    masses = arrays.get("masses")
    given = {
        "points": points,
        "springs": arrays["springs"],
        "constants": arrays["k"],
        "rest": arrays["rest"],
        "contents": contents,
        "masses": masses if masses is not None and len(masses) else None,
    }
    known: "dict[str, Any]" = {}
    if "thickness" in arrays:
        state = str(np.ravel(arrays["plane"])[0]) if "plane" in arrays else "stress"
        known["plane"] = {"state": state, "thickness": float(np.ravel(arrays["thickness"])[0])}
    if "engine" in arrays:
        known["engine"] = json.loads(str(np.ravel(arrays["engine"])[0]))
    return given, cells, json.dumps(known)


def mesh_of(points: np.ndarray, cells: np.ndarray) -> "Any | None":
    """The mesh of these simplices; None unless they are simplices of the space and have every point as a node."""
    from .mesh import Mesh

    names = {2: "bar2", 3: "tri3", 4: "tet4"}
    if cells.ndim != 2 or not len(cells) or len(np.unique(cells)) != len(points) or cells.shape[1] != points.shape[1] + 1:
        return None
    try:
        mesh = Mesh(points, {names[cells.shape[1]]: cells})
    except SpringfitError:
        return None
    return mesh if np.array_equal(mesh.points, points) else None
