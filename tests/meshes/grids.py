"""Writes the voxels, structured grids and polygons of tests/voxels.rs with NumPy and VTK.

pip install numpy==2.4.6 vtk==9.7.2
python grids.py          # beside the files that it writes
"""

from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

here = Path(__file__).parent

# Labels of 4 x 3 x 2 voxels: a[i, j, k] is 0 on a diagonal plane and differs along all axes.
labels = np.fromfunction(lambda i, j, k: (i + 2 * j + 3 * k) % 4, (4, 3, 2)).astype("<i4")
np.save(here / "labels.npy", labels)
np.save(here / "labels_fortran.npy", np.asfortranarray(labels.astype(">u2")))
np.save(here / "labels_plane.npy", labels[:, :, 1] > 0)


def named(values, name):
    array = numpy_to_vtk(values.ravel(order="F").copy(), deep=True)
    array.SetName(name)
    return array


def image(points, origin):
    grid = vtk.vtkImageData()
    grid.SetDimensions(*points)
    grid.SetOrigin(*origin)
    grid.SetSpacing(0.5, 0.25, 2.0)
    return grid


def write(writer, grid, name, mode=None):
    writer.SetFileName(str(here / name))
    writer.SetInputData(grid)
    if mode:
        getattr(writer, mode)()
    assert writer.Write()


cells = image((5, 4, 3), (1.0, 2.0, 3.0))
cells.GetCellData().SetScalars(named(labels, "tissue"))
write(vtk.vtkXMLImageDataWriter(), cells, "labels.vti")
write(vtk.vtkStructuredPointsWriter(), cells, "labels_image.vtk", "SetFileTypeToASCII")

# The same voxels by their middles.
points = image((4, 3, 2), (1.25, 2.125, 4.0))
points.GetPointData().SetScalars(named(labels, "tissue"))
write(vtk.vtkXMLImageDataWriter(), points, "labels_points.vti", "SetDataModeToAscii")
write(vtk.vtkStructuredPointsWriter(), points, "labels_points.vtk", "SetFileTypeToBinary")

# A sheared block of 3 x 2 x 2 cells, and one with steps of different length.
along = [np.array([0.0, 1.0, 1.5, 4.0]), np.array([0.0, 2.0, 3.0]), np.array([-1.0, 0.0, 0.5])]
rectilinear = vtk.vtkRectilinearGrid()
rectilinear.SetDimensions(4, 3, 3)
for axis, values in zip("XYZ", along):
    getattr(rectilinear, f"Set{axis}Coordinates")(numpy_to_vtk(values, deep=True))
structured = vtk.vtkStructuredGrid()
structured.SetDimensions(4, 3, 3)
corners = vtk.vtkPoints()
corners.SetDataTypeToDouble()
for z in along[2]:
    for y in along[1]:
        for x in along[0]:
            corners.InsertNextPoint(x + 0.5 * z, y, z)
structured.SetPoints(corners)
part = np.arange(12) % 3
for grid in [rectilinear, structured]:
    grid.GetCellData().AddArray(named(part.astype("i4"), "part"))
write(vtk.vtkXMLRectilinearGridWriter(), rectilinear, "steps.vtr")
write(vtk.vtkRectilinearGridWriter(), rectilinear, "steps.vtk", "SetFileTypeToBinary")
write(vtk.vtkXMLStructuredGridWriter(), structured, "sheared.vts", "SetDataModeToAscii")
write(vtk.vtkStructuredGridWriter(), structured, "sheared.vtk", "SetFileTypeToASCII")

# A point, a chain of two lines, a triangle, a quadrangle and a strip of three triangles.
polygons = vtk.vtkPolyData()
corners = vtk.vtkPoints()
corners.SetDataTypeToDouble()
for x in [0.0, 1.0, 2.0, 3.0, 4.0]:
    for y in [0.0, 1.0]:
        corners.InsertNextPoint(x, y, 0.0)
polygons.SetPoints(corners)
for kind, lists in [("Verts", [[0]]), ("Lines", [[0, 2, 4]]), ("Polys", [[0, 2, 1], [2, 4, 5, 3]]), ("Strips", [[5, 4, 7, 6, 9]])]:
    array = vtk.vtkCellArray()
    for nodes in lists:
        array.InsertNextCell(len(nodes), nodes)
    getattr(polygons, f"Set{kind}")(array)
polygons.GetCellData().AddArray(named(np.array([7, 8, 1, 2, 3], "i4"), "part"))
write(vtk.vtkXMLPolyDataWriter(), polygons, "polygons.vtp")
write(vtk.vtkPolyDataWriter(), polygons, "polygons.vtk", "SetFileTypeToASCII")
write(vtk.vtkPolyDataWriter(), polygons, "polygons_binary.vtk", "SetFileTypeToBinary")
