"""Writes the meshes of tests/formats.rs with the programs that those formats come from.

pip install gmsh==4.15.2 meshio==5.3.5 vtk==9.7.2 trimesh==5.2.0 pyvista==0.49.1 tetgen==0.8.4
python formats.py        # beside the meshes that it converts
"""

from pathlib import Path

import gmsh
import meshio
import numpy as np
import pyvista
import tetgen
import trimesh
import vtk

here = Path(__file__).parent
FORMATS = {"free": 0, "small": 1, "large": 2}  # Mesh.BdfFieldFormat


def by_gmsh(source, target, layout="large"):
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.open(str(here / source))
    gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
    gmsh.option.setNumber("Mesh.BdfFieldFormat", FORMATS[layout])
    gmsh.write(str(here / target))
    gmsh.finalize()
    path = here / target
    path.write_text(path.read_text().replace(str(path), target))


by_gmsh("bar_41_ascii.msh", "bar.inp")
for layout in FORMATS:
    by_gmsh("bar_41_ascii.msh", f"bar_{layout}.bdf", layout)
for name in ["hex20", "wedge15", "tet10", "tri6", "quad8", "pyramid13", "curve3"]:
    by_gmsh(f"{name}.msh", f"{name}.inp")
    if name not in ["pyramid13", "curve3"]:  # Gmsh writes no such cards
        by_gmsh(f"{name}.msh", f"{name}.bdf")

# Old versions of Gmsh's own format, which it writes as text alone.
for source, target, version in [
    ("bar_41_ascii", "bar_1_ascii", 1),
    ("bar_41_ascii", "bar_40_ascii", 4),
    ("hex20", "hex20_v1", 1),
    ("hex20", "hex20_v40", 4),
]:
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.open(str(here / f"{source}.msh"))
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write(str(here / f"{target}.msh"))
    gmsh.finalize()

hexahedra = meshio.read(here / "hex20.vtu")
hexahedra.point_data, hexahedra.cell_data = {}, {}
meshio.write(here / "hex20_meshio.bdf", hexahedra)
meshio.write(here / "hex20_meshio.inp", hexahedra)

# An egg of 80 triangles in every format of surfaces.
egg = trimesh.creation.icosphere(subdivisions=1)
egg.apply_scale([1.0, 0.8, 1.3])
egg.vertices = np.float32(egg.vertices)
for name, options in [
    ("egg.off", {}),
    ("egg.obj", {"header": None}),
    ("egg_ascii.ply", {"encoding": "ascii"}),
    ("egg.ply", {}),
    ("egg.stl", {}),
]:
    content = egg.export(file_type=name.rsplit(".")[-1], **options)
    (here / name).write_bytes(content if isinstance(content, bytes) else content.encode())
(here / "egg_ascii.stl").write_text(egg.export(file_type="stl_ascii"))
faces = pyvista.PolyData.from_regular_faces(egg.vertices, egg.faces)
writer = vtk.vtkPLYWriter()
writer.SetInputData(faces)
writer.SetFileTypeToBinary()
writer.SetDataByteOrderToBigEndian()
writer.SetFileName(str(here / "egg_big_endian.ply"))
writer.Write()

# The bar in the other compressions of VTK, in several blocks.
bar = vtk.vtkXMLUnstructuredGridReader()
bar.SetFileName(str(here / "bar_zlib.vtu"))
bar.Update()
for name, compression in [("bar_lz4.vtu", "LZ4"), ("bar_xz.vtu", "LZMA")]:
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(bar.GetOutput())
    getattr(writer, f"SetCompressorTypeTo{compression}")()
    writer.SetBlockSize(128)
    writer.SetDataModeToBinary()
    writer.SetFileName(str(here / name))
    writer.Write()

# The tetrahedra of a brick, of ten nodes in TetGen's own order, and of four as meshio writes them.
filled = tetgen.TetGen(pyvista.Cube(x_length=2.0).triangulate())
nodes, cells = filled.tetrahedralize(order=2)[:2]
rows = [f"{len(nodes)} 3 0 0"] + [f"{i} " + " ".join(map(repr, map(float, p))) for i, p in enumerate(nodes)]
(here / "brick10.node").write_text("\n".join(rows) + "\n")
rows = [f"{len(cells)} 10 0"] + [f"{i} " + " ".join(map(str, c)) for i, c in enumerate(cells)]
(here / "brick10.ele").write_text("\n".join(rows) + "\n# in the order of TetGen\n")
corners = meshio.Mesh(nodes, [("tetra", cells[:, :4])])
meshio.write(here / "brick4.ele", corners)
