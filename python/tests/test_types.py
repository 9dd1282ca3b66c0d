"""What a checker of types says of programs that use the module."""

import inspect
import typing

import pytest

import springfit as sf

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
STRICT = """
import numpy as np
import springfit as sf
from typing_extensions import assert_type

mesh = sf.Mesh.voxels(np.ones((2, 2, 2), int), spacing=1e-3)
nodes = mesh.cells["hex8"]
name, again = mesh.cells[0]
for name, nodes in mesh.cells.items():
    print(name, nodes.shape)
young = np.linspace(1e4, 2e4, len(mesh.centers))
material = sf.Material(young, "0.3", density="1 g/cm^3")
net = sf.fit(mesh, {"label=1": material, None: sf.Material(1e4, 0.3)})
surface = mesh.refine().boundary()
assert_type(surface.volume, float)
report = sf.run({"mesh": mesh, "material": material, "fit": [{"objective": "exact"}]})
assert_type(report.mesh, sf.Mesh)
assert_type(report.networks["exact"], sf.Network)
grid = mesh.to_pyvista(np.zeros((27, 3)))
"""
# Their types are large, and are none of ours.
SETTINGS = """
[mypy]
warn_unused_ignores = True
[mypy-jax.*,meshio.*,pandas.*,pyvista.*,scipy.*,torch.*]
follow_imports = skip
"""


def test_programs_have_types(tmp_path):
    api = pytest.importorskip("mypy.api", reason="not run: mypy is not installed")
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "mypy.ini").write_text(SETTINGS)
    arguments = ["--config-file", str(tmp_path / "mypy.ini"), "--cache-dir", str(tmp_path / "cache"), str(tmp_path / "program.py")]
    told, _, code = api.run(arguments)
    assert code == 0, told


@pytest.mark.parametrize("name", [name for name in sf.__all__ if not name.startswith("_")])
def test_hints_of_types_are_found(name):
    for package in ("pandas", "pyvista", "meshio", "scipy"):
        pytest.importorskip(package)
    owner = getattr(sf, name)
    if not inspect.isfunction(owner) and not hasattr(owner, "__dict__"):
        return
    own = [owner] if inspect.isfunction(owner) else [f for f in vars(owner).values() if inspect.isfunction(f)]
    own += [f.fget for f in vars(owner).values() if isinstance(f, property)] if inspect.isclass(owner) else []
    own += [f.__func__ for f in vars(owner).values() if isinstance(f, classmethod)] if inspect.isclass(owner) else []
    for function in own:
        typing.get_type_hints(function)


def test_annotations_are_written_once():
    for owner in (sf.run, sf.sweep, sf.compare, sf.Mesh.read, sf.Mesh.box, sf.Material.isotropic):
        assert "'" not in str(inspect.signature(owner).return_annotation)


def test_a_strict_program_has_types(tmp_path):
    """What the calls return is known to the strictest checker of a user's program."""
    api = pytest.importorskip("mypy.api", reason="not run: mypy is not installed")
    (tmp_path / "program.py").write_text(STRICT)
    (tmp_path / "mypy.ini").write_text(SETTINGS)
    arguments = ["--strict", "--config-file", str(tmp_path / "mypy.ini"), "--cache-dir", str(tmp_path / "cache"), str(tmp_path / "program.py")]
    told, _, code = api.run(arguments)
    assert code == 0, told
