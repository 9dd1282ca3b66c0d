"""What a checker of types says of programs that use the module."""

import pytest

PROGRAM = """
from pathlib import Path
from typing_extensions import assert_type
import numpy as np
import springfit as sf

points = np.zeros((3, 2))
cells = np.array([[0, 1, 2]])
by_name, by_path, by_element = {"tri3": cells}, {Path("own.toml"): cells}, {sf.Element("tri3"): cells}
sf.Mesh(points, by_name), sf.Mesh(points, by_path), sf.Mesh(points, by_element), sf.Mesh(points, [("tri3", cells)])
mesh = sf.Mesh.box("quad4", size=np.array([1.0, 1.0]), cells=np.array([2, 2]))
sf.Mesh(mesh.points, mesh.cells, mesh.groups), sf.Mesh(mesh.points, dict(mesh.cells), elements=[Path("own.toml")])
assert_type(sf.compare("scene.toml", set={"material.poisson": 0.4}), sf.Report)
net = sf.fit(mesh, sf.Material(1e4, 0.3))
assert_type(net.energy(), float)
sf.compare("scene.toml", shapes=3)  # type: ignore[call-overload]
net.solve(fix=0).nothing  # type: ignore[attr-defined]
"""
# Their types are large, and are none of ours.
SETTINGS = """
[mypy]
warn_unused_ignores = True
[mypy-jax.*,pandas.*,pyvista.*,scipy.*,torch.*]
follow_imports = skip
"""


def test_programs_have_types(tmp_path):
    api = pytest.importorskip("mypy.api", reason="not run: mypy is not installed")
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "mypy.ini").write_text(SETTINGS)
    arguments = ["--config-file", str(tmp_path / "mypy.ini"), "--cache-dir", str(tmp_path / "cache"), str(tmp_path / "program.py")]
    told, _, code = api.run(arguments)
    assert code == 0, told
