"""Reads a mesh file without springfit, and prints what it holds as JSON: python readers.py FILE

Gmsh files are read by Gmsh (pip install gmsh), those of VTK by VTK (pip install vtk), also .ply, decks of Nastran by pyNastran
(pip install pyNastran). Other formats are counted here by a few lines each. The keys:

    cells    how many of each kind; the names are those of springfit's elements, and VTK's or the file's for other kinds
    body     the same, of the highest dimension alone
    loose    cells of fewer dimensions that lie on no cell of the body, such as a rod between two solids
    points   how many points cells of the body have
    extent   the size of the box around them
    volume   of the body, an area or a length below three dimensions; null if a kind has no formula here
    groups   cells of the body, sides (one dimension below) and points by group
"""
import collections
import json
import re
import sys
from pathlib import Path

import numpy as np

# VTK's numbers, dimensions and numbers of nodes of the kinds that springfit ships.
KINDS = {
    "bar2": (3, 1, 2), "bar3": (21, 1, 3), "tri3": (5, 2, 3), "tri6": (22, 2, 6), "tri10": (69, 2, 10), "quad4": (9, 2, 4),
    "quad8": (23, 2, 8), "quad9": (28, 2, 9), "quad12": (70, 2, 12), "pentagon5": (7, 2, 5), "tet4": (10, 3, 4), "tet10": (24, 3, 10),
    "tet20": (71, 3, 20), "hex8": (12, 3, 8), "hex20": (25, 3, 20), "hex27": (29, 3, 27), "wedge6": (13, 3, 6),
    "wedge15": (26, 3, 15), "pyramid5": (14, 3, 5), "pyramid13": (27, 3, 13),
}  # fmt: skip
OF_VTK = {number: kind for kind, (number, _, _) in KINDS.items() if number < 68 and number != 7}
OF_GMSH = {1: "bar2", 8: "bar3", 2: "tri3", 9: "tri6", 21: "tri10", 3: "quad4", 16: "quad8", 10: "quad9", 39: "quad12", 4: "tet4",
           11: "tet10", 29: "tet20", 5: "hex8", 17: "hex20", 12: "hex27", 6: "wedge6", 18: "wedge15", 7: "pyramid5",
           19: "pyramid13"}  # fmt: skip


class Found:
    """A mesh: places by number of point, cells as (kind, dimension, numbers of points, names of groups), sets of points."""

    def __init__(self):
        self.places, self.cells, self.sets = {}, [], {}

    def cell(self, kind, nodes, groups=(), dimension=None):
        self.cells.append((kind, KINDS[kind][1] if dimension is None else dimension, tuple(nodes), tuple(groups)))

    def record(self):
        """What is printed."""
        highest = max((dimension for _, dimension, _, _ in self.cells), default=0)
        body = [cell for cell in self.cells if cell[1] == highest]
        used = sorted({node for _, _, nodes, _ in body for node in nodes})
        lost = [node for node in used if node not in self.places]
        places = np.array([self.places[node] for node in used if node not in lost], dtype=float).reshape(-1, 3)
        of_node = collections.defaultdict(set)
        for number, (_, _, nodes, _) in enumerate(body):
            for node in nodes:
                of_node[node].add(number)
        loose = collections.Counter()
        for kind, dimension, nodes, _ in self.cells:
            if 0 < dimension < highest and not set.intersection(*[of_node.get(node, set()) for node in nodes]):
                loose[kind] += 1
        groups = collections.defaultdict(lambda: {"cells": 0, "sides": 0, "points": 0})
        sides = collections.defaultdict(set)
        for _, dimension, nodes, names in self.cells:
            for name in set(names):
                groups[name]["cells"] += dimension == highest
                if dimension == highest - 1:
                    sides[name].add(tuple(sorted(nodes)))
        for name, parts in sides.items():
            groups[name]["sides"] = len(parts)
        ofbody = set(used)
        if highest == 1:  # the sides of lines are points
            for name, parts in sides.items():
                self.sets.setdefault(name, []).extend(node for part in parts for node in part)
                groups[name]["sides"] = 0
        for name, nodes in self.sets.items():
            groups[name]["points"] = len(set(nodes) & ofbody)
        return {
            "cells": dict(collections.Counter(kind for kind, _, _, _ in self.cells)),
            "body": dict(collections.Counter(kind for kind, _, _, _ in body)),
            "dimension": highest,
            "loose": dict(loose),
            "points": len(used),
            "undefined points": len(lost),
            "all points": len(self.places),
            "extent": [float(x) for x in np.ptp(places, axis=0)] if len(places) else [],
            "volume": None if lost else volume(body, self.places),
            "groups": groups,
        }


# Volumes: the integral of |det J| by Gauss's rule of three points along each axis, as springfit's elements integrate or finer. Shape
# functions are those of the monomials below at VTK's places of the nodes.
def powers(text):
    return np.array([[int(digit) for digit in word] for word in text.split()])


SIMPLEX = {2: [(0, 0), (1, 0), (0, 1)], 3: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]}
CUBE = {2: [(0, 0), (1, 0), (1, 1), (0, 1)]}
CUBE[3] = [(*p, z) for z in (0, 1) for p in CUBE[2]]
PRISM = [(*p, z) for z in (0, 1) for p in SIMPLEX[2]]
EDGES = {
    "tri": [(0, 1), (1, 2), (2, 0)], "quad": [(0, 1), (1, 2), (2, 3), (3, 0)],
    "tet": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "hex": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
    "wedge": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "pyramid": [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
}  # fmt: skip


# Gmsh numbers the nodes on edges in its own order, and those on the faces of hexahedra in the order of FACES by VTK's places.
GMSH_EDGES = {
    "tet10": [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)],
    "hex20": [(0, 1), (3, 0), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (7, 4), (5, 6), (6, 7)],
    "wedge15": [(0, 1), (2, 0), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (5, 3), (4, 5)],
    "pyramid13": [(0, 1), (3, 0), (0, 4), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)],
}  # fmt: skip
GMSH_EDGES["hex27"] = GMSH_EDGES["hex20"]
GMSH_FACES = {"hex27": [24, 22, 20, 21, 23, 25, 26]}


def gmsh_order(kind):
    """VTK's places of the nodes, in Gmsh's order."""
    if kind not in GMSH_EDGES:
        return list(range(KINDS[kind][2]))
    shape = kind.rstrip("0123456789")
    corners = {"tet": 4, "hex": 8, "wedge": 6, "pyramid": 5}[shape]
    places = [corners + EDGES[shape].index(edge) for edge in GMSH_EDGES[kind]]
    return list(range(corners)) + places + GMSH_FACES.get(kind, [])


def with_middles(corners, edges):
    corners = np.array(corners, dtype=float)
    return np.vstack([corners] + [corners[[a, b]].mean(axis=0)[None] for a, b in edges])


FORMULAS = {
    "tri3": (SIMPLEX[2], "00 10 01"),
    "tri6": (with_middles(SIMPLEX[2], EDGES["tri"]), "00 10 01 11 20 02"),
    "quad4": (CUBE[2], "00 10 01 11"),
    "quad8": (with_middles(CUBE[2], EDGES["quad"]), "00 10 01 11 20 02 21 12"),
    "quad9": (np.vstack([with_middles(CUBE[2], EDGES["quad"]), [[0.5, 0.5]]]), "00 10 01 11 20 02 21 12 22"),
    "tet4": (SIMPLEX[3], "000 100 010 001"),
    "tet10": (with_middles(SIMPLEX[3], EDGES["tet"]), "000 100 010 001 110 101 011 200 020 002"),
    "hex8": (CUBE[3], "000 100 010 001 110 101 011 111"),
    "hex20": (with_middles(CUBE[3], EDGES["hex"]),
              "000 100 010 001 110 101 011 111 200 020 002 210 201 120 021 102 012 211 121 112"),
    "wedge6": (PRISM, "000 100 010 001 101 011"),
    "wedge15": (with_middles(PRISM, EDGES["wedge"]), "000 100 010 110 200 020 001 101 011 111 201 021 002 102 012"),
}  # fmt: skip


def volume(body, places):
    """The volume of the cells; None if one has no formula."""
    blocks = collections.defaultdict(list)
    for kind, _, nodes, _ in body:
        if kind == "pyramid5":  # a hexahedron whose upper corners are one point
            kind, nodes = "hex8", (*nodes[:4], *[nodes[4]] * 4)
        blocks[kind].append([places[node] for node in nodes])
    total = 0.0
    if set(blocks) - {"bar2", *FORMULAS}:
        return None
    for kind, points in blocks.items():
        points = np.array(points, dtype=float)
        if kind == "bar2":
            total += np.linalg.norm(points[:, 1] - points[:, 0], axis=1).sum()
            continue
        corners, monomials = FORMULAS[kind]
        corners, monomials = np.array(corners, dtype=float), powers(monomials)
        dimension = corners.shape[1]
        coefficients = np.linalg.inv(np.prod(corners[:, None, :] ** monomials[None], axis=2))
        at, weights = np.polynomial.legendre.leggauss(3)
        at, weights = (at + 1) / 2, weights / 2
        for index in np.ndindex(*[3] * dimension):
            place, weight = np.array([at[i] for i in index]), np.prod([weights[i] for i in index])
            if kind.startswith(("tri", "wedge", "tet")):  # Duffy's map of the cube to the simplex
                axes = 3 if kind.startswith("tet") else 2
                for axis in range(1, axes):
                    shrink = 1 - place[:axis].sum()
                    weight *= shrink
                    place[axis] *= shrink
            slopes = []
            for axis in range(dimension):
                lower = monomials.copy()
                lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
                slopes.append(monomials[:, axis] * np.prod(place**lower, axis=1) @ coefficients)
            jacobian = np.einsum("an,cnx->cax", np.array(slopes), points)
            gram = np.einsum("cax,cbx->cab", jacobian, jacobian)
            total += weight * np.sqrt(np.maximum(np.linalg.det(gram), 0)).sum()
    return float(total)


def gmsh(path):
    import gmsh as program

    program.initialize(interruptible=False)
    program.option.setNumber("General.Terminal", 0)
    program.open(str(path))
    found = Found()
    mesh = program.model.mesh
    numbers, places, _ = mesh.getNodes()
    found.places = dict(zip(numbers.tolist(), places.reshape(-1, 3)))
    for dimension, entity in program.model.getEntities():
        groups = []
        for tag in program.model.getPhysicalGroupsForEntity(dimension, entity):
            groups.append(program.model.getPhysicalName(dimension, tag) or f"{dimension}:{tag}")
        for number, _, nodes in zip(*mesh.getElements(dimension, entity)):
            name, _, _, count, _, _ = mesh.getElementProperties(number)
            for cell in nodes.reshape(-1, count).tolist():
                kind = OF_GMSH.get(number, name)
                if kind in KINDS:
                    order = gmsh_order(kind)
                    cell = [cell[order.index(place)] for place in range(count)]
                found.cell(kind, cell, groups, dimension)
    return found


def of_dataset(data):
    """A data set of VTK."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    every = vtk.vtkAppendFilter()
    every.AddInputData(data)
    every.Update()
    grid = every.GetOutput()
    found = Found()
    if grid.GetNumberOfPoints():
        found.places = dict(enumerate(vtk_to_numpy(grid.GetPoints().GetData()).astype(float)))
    arrays = []
    for index in range(grid.GetCellData().GetNumberOfArrays()):
        array = grid.GetCellData().GetArray(index)
        if array is not None and array.GetNumberOfComponents() == 1 and not isinstance(array, (vtk.vtkFloatArray, vtk.vtkDoubleArray)):
            arrays.append((array.GetName(), vtk_to_numpy(array)))
    ids = vtk.vtkIdList()
    for number in range(grid.GetNumberOfCells()):
        grid.GetCellPoints(number, ids)
        nodes = [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
        groups = [f"{name}={values[number]}" for name, values in arrays]
        add_vtk(found, grid.GetCellType(number), nodes, groups, grid.GetCell)
    return found


def add_vtk(found, number, nodes, groups=(), cell=None):
    count = len(nodes)
    if number == 6:
        for k in range(count - 2):
            found.cell("tri3", nodes[k : k + 3], groups)
    elif number == 4:
        for k in range(count - 1):
            found.cell("bar2", nodes[k : k + 2], groups)
    elif number == 2:
        for node in nodes:
            found.cell("vertex", [node], groups, 0)
    elif number in (8, 11):
        order = [0, 1, 3, 2] if number == 8 else [0, 1, 3, 2, 4, 5, 7, 6]
        found.cell("quad4" if number == 8 else "hex8", [nodes[k] for k in order], groups)
    elif number == 7:
        kind = {3: "tri3", 4: "quad4", 5: "pentagon5"}.get(count, "polygon of 6 and more")
        found.cell(kind, nodes, groups, 2)
    elif number == 1:
        found.cell("vertex", nodes, groups, 0)
    elif number in OF_VTK:
        found.cell(OF_VTK[number], nodes, groups)
    else:
        import vtk

        kind = {(68, 2): "bar2", (68, 3): "bar3", (69, 3): "tri3", (69, 6): "tri6", (69, 10): "tri10", (70, 4): "quad4", (70, 9): "quad9",
                (71, 4): "tet4", (71, 10): "tet10", (71, 20): "tet20", (72, 8): "hex8", (73, 6): "wedge6"}  # fmt: skip
        name = vtk.vtkCellTypes.GetClassNameFromTypeId(number)
        dimension = vtk.vtkGenericCell.InstantiateCell(number).GetCellDimension()
        found.cell(kind.get((number, count), f"{name} of {count}"), nodes, groups, dimension)


def vtk_file(path):
    import vtk

    if path.suffix == ".vtk":
        reader = vtk.vtkGenericDataObjectReader()
        for switch in ("Scalars", "Vectors", "Fields"):
            getattr(reader, f"ReadAll{switch}On")()
    else:
        reader = vtk.vtkXMLGenericDataObjectReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    if data is None or not data.IsA("vtkDataSet"):
        raise ValueError(f"VTK finds {data.GetClassName() if data else 'nothing'}")
    return of_dataset(data)


def ply(path):
    import vtk

    reader = vtk.vtkPLYReader()
    reader.SetDuplicatePointsForFaceTexture(False)
    reader.SetFileName(str(path))
    reader.Update()
    return of_dataset(reader.GetOutput())


def stl(path):
    content, found, numbers = path.read_bytes(), Found(), {}
    count = int.from_bytes(content[80:84], "little")
    if len(content) == 84 + 50 * count:
        rows = np.frombuffer(content[84:], dtype=np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("more", "<u2")]))
        places = rows["corners"].reshape(-1, 3)
    else:
        words = re.findall(rb"(?i)vertex\s+(\S+)\s+(\S+)\s+(\S+)", content)
        places = np.array([[float(re.match(rb"[-+.\deE]+", word)[0].rstrip(b"eE")) for word in row] for row in words]).reshape(-1, 3)
    for face in places.reshape(-1, 3, 3).tolist():
        found.cell("tri3", [numbers.setdefault(tuple(place), len(numbers)) for place in face])
    found.places = {number: place for place, number in numbers.items()}
    return found


def lines_of(path):
    for line in path.read_text("utf-8", "replace").splitlines():
        if line := line.split("#")[0].strip():
            yield line.split()


def obj(path):
    found, groups = Found(), []
    for words in lines_of(path):
        if words[0] == "v":
            found.places[len(found.places)] = ([float(x) for x in words[1:4]] + [0.0] * 3)[:3]
        elif words[0] in "go":
            groups = words[1:2] if words[0] == "o" else words[1:]
        elif words[0] in "fl":
            numbers = [int(word.split("/")[0]) for word in words[1:]]
            nodes = [number - 1 if number > 0 else len(found.places) + number for number in numbers]
            add_vtk(found, 7 if words[0] == "f" else 4, nodes, groups)
    return found


def off(path):
    """Numbers may be anywhere on lines, but what follows the corners of a face on its line is a colour."""
    found, rows = Found(), list(lines_of(path))
    if re.fullmatch(r"(ST)?(C)?(N)?OFF", rows[0][0]):
        rows[0] = rows[0][1:]
    counts = [int(word) for row in rows[:2] for word in row][:2]
    rows = rows[next(k for k, row in enumerate(rows) if row) + 1 :]
    for number, row in enumerate(rows[: counts[0]]):
        found.places[number] = [float(x) for x in row[:3]]
    rows = iter(rows[counts[0] :])
    for _ in range(counts[1]):
        words = next(rows)
        while len(words) <= int(words[0]):
            words = words + next(rows)
        nodes = [int(word) for word in words[1 : 1 + int(words[0])]]
        add_vtk(found, {1: 1, 2: 3}.get(len(nodes), 7), nodes)
    return found


def tetgen(path):
    found = Found()
    nodes = list(lines_of(path.with_suffix(".node")))
    count, dimension = int(nodes[0][0]), int(nodes[0][1])
    for row in nodes[1 : 1 + count]:
        found.places[int(row[0])] = [float(x) for x in row[1 : 1 + dimension]] + [0.0] * (3 - dimension)
    cells = list(lines_of(path.with_suffix(".ele")))
    count, corners = int(cells[0][0]), int(cells[0][1])
    kind = {(2, 3): "tri3", (2, 6): "tri6", (3, 4): "tet4", (3, 10): "tet10"}[dimension, corners]
    for row in cells[1 : 1 + count]:
        numbers = [int(word) for word in row[1 : 1 + corners]]
        groups = [f"region={float(row[-1]):g}"] if len(row) > 1 + corners else []
        if kind in ("tri6", "tet10"):  # the node of each edge is the one nearest to its middle, whatever the order
            ends, middles = numbers[: dimension + 1], numbers[dimension + 1 :]
            place = {number: np.array(found.places[number]) for number in numbers}
            edges = [(place[ends[a]] + place[ends[b]]) / 2 for a, b in EDGES[kind[:3]]]
            numbers = ends + [min(middles, key=lambda node: np.linalg.norm(place[node] - middle)) for middle in edges]
        found.cell(kind, numbers, groups)
    return found


NASTRAN = {"CTETRA": {4: "tet4", 10: "tet10"}, "CHEXA": {8: "hex8", 20: "hex20"}, "CPENTA": {6: "wedge6", 15: "wedge15"},
           "CPYRAM": {5: "pyramid5", 13: "pyramid13"}, "CTRIA3": {3: "tri3"}, "CTRIAR": {3: "tri3"}, "CTRIA6": {3: "tri3", 6: "tri6"},
           "CQUAD4": {4: "quad4"}, "CQUADR": {4: "quad4"}, "CQUAD8": {4: "quad4", 8: "quad8"}, "CBAR": {2: "bar2"}, "CBEAM": {2: "bar2"},
           "CROD": {2: "bar2"}, "CTUBE": {2: "bar2"}, "CONROD": {2: "bar2"}, "CSHEAR": {4: "shear panel"}}  # fmt: skip
UPRIGHT = {"hex20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15], "wedge15": [*range(9), 12, 13, 14, 9, 10, 11]}


def add_card(found, name, nodes, group):
    """An element card with these grid points, without empty fields."""
    kinds = NASTRAN[name]
    kind = kinds.get(len(nodes), f"{name} of {len(nodes)}")
    if kind in UPRIGHT:
        nodes = [nodes[k] for k in UPRIGHT[kind]]
    dimension = None if kind in KINDS else KINDS[kinds[min(kinds)]][1] if kinds[min(kinds)] in KINDS else 2
    found.cell(kind, nodes, [group] if group else [], dimension)


def nastran(path):
    """By pyNastran, or as cards where it refuses the deck or some of its elements."""
    counted = nastran_cards(path)
    try:
        found = nastran_model(path)
    except (Exception, SystemExit):
        return counted
    return counted if len(counted.cells) > len(found.cells) else found


def nastran_model(path):
    from pyNastran.bdf.bdf import BDF

    text = path.read_text("latin-1")
    model = BDF(debug=None)
    model.set_error_storage(nparse_errors=0, stop_on_parsing_error=True)
    punch = not re.search(r"(?im)^\s*begin\s+bulk", text)
    model.read_bdf(str(path), xref=False, punch=punch, validate=False, encoding="latin-1")
    for coord in model.coords.values():
        coord.cross_reference(model)
    for coord in model.coords.values():
        coord.setup()
    found = Found()
    for number, node in model.nodes.items():
        found.places[number] = model.coords[node.cp].transform_node_to_global(node.xyz)
    for card in model.elements.values():
        if card.type in NASTRAN:
            pid = getattr(card, "pid", 0)
            add_card(found, card.type, [node for node in card.node_ids if node], f"pid={pid}" if pid else "")
    return found


def nastran_lines(path, depth=0):
    for line in path.read_text("latin-1").splitlines():
        include = re.match(r"(?i)include\s*['\"]?([^'\"]+)", line)
        if include and depth < 8 and (path.parent / include.group(1).strip()).is_file():
            yield from nastran_lines(path.parent / include.group(1).strip(), depth + 1)
        elif line.split("$")[0].strip():
            yield line.split("$")[0].rstrip().expandtabs(8)


def nastran_cards(path):
    """GRID cards and elements, with places in the basic system alone."""
    cards = []
    for line in nastran_lines(path):
        if "," in line:
            fields = [field.strip() for field in line.split(",")]
        else:
            wide = 16 if "*" in line[:8] else 8
            fields = [line[:8].strip()] + [line[k : k + wide].strip() for k in range(8, 72, wide)]
        fields = fields[: 5 if "*" in fields[0] else 9]
        first = fields[0].rstrip("*").upper()
        if first[:1] in ("", "+") or fields[0][:1] == "*":
            if cards:
                cards[-1] += fields[1:] + [""] * ((4 if "*" in fields[0] else 8) - len(fields[1:]))
        else:
            cards.append([first] + fields[1:] + [""] * ((4 if "*" in fields[0] else 8) - len(fields[1:])))
    found = Found()
    for name, *fields in cards:
        if name == "GRID":
            places = [(word or "0").lower().replace("d", "e") for word in fields[2:5]]
            places = [re.sub(r"(?<=[\d.])([+-])", r"e\1", word) for word in places]  # 1.5-3 is 1.5e-3
            found.places[int(fields[0])] = [float(word) for word in places]
        elif name in NASTRAN:
            first, most = (1, 2) if name == "CONROD" else (2, max(NASTRAN[name]))
            nodes = [int(word) for word in fields[first : first + most] if word not in ("", "0")]
            add_card(found, name, nodes, f"pid={fields[1] or fields[0]}" if first == 2 else "")
    return found


ABAQUS = [
    (r"D?C3D4", "tet4"), (r"D?C3D10", "tet10"), (r"(D?C3D8|CSS8|SC8)", "hex8"), (r"D?C3D20", "hex20"), (r"D?C3D27", "hex27"),
    (r"(D?C3D6|SC6)", "wedge6"), (r"D?C3D15", "wedge15"), (r"C3D5", "pyramid5"), (r"C3D13", "pyramid13"),
    (r"(CPS|CPE|DC2D|S|STRI|M3D|SFM3D|R3D|CPEG|DS|AC2D)3", "tri3"),
    (r"(CPS|CPE|DC2D|S|M3D|SFM3D|R3D|CPEG|DS|AC2D)4", "quad4"), (r"(CPS|CPE|DC2D|S|M3D|SFM3D|CPEG)6|STRI65", "tri6"),
    (r"(CPS|CPE|DC2D|S|M3D|SFM3D|CPEG)8", "quad8"), (r"(M3D9|S9)", "quad9"), (r"(T[23]D2|B[23]1|B[23]3)", "bar2"),
    (r"(T[23]D3|B[23]2)", "bar3"),
]  # fmt: skip


def abaqus(path):
    """Decks of Abaqus and CalculiX: parts, instances with their places, generated sets, included files."""
    parts = collections.defaultdict(lambda: {"nodes": {}, "cells": [], "nsets": collections.defaultdict(list),
                                             "elsets": collections.defaultdict(list)})  # fmt: skip
    instances, part, keyword, options, instance = [], "", "", {}, None

    def deck(path, depth=0):
        for line in path.read_text("latin-1").splitlines():
            if line.startswith("**") or not line.strip():
                continue
            include = re.match(r"(?i)\*include\s*,\s*input\s*=\s*\"?([^\s\",]+)", line)
            if include and depth < 8:
                yield from deck(path.parent / include.group(1), depth + 1)
            else:
                yield line.strip()

    waiting = []
    for line in deck(path):
        if line.startswith("*"):
            words = [word.strip() for word in line[1:].split(",")]
            if waiting and words[0] == "":
                continue
            keyword = re.sub(r"\s+", "", words[0]).lower()
            options = {}
            for word in words[1:]:
                key, _, value = word.partition("=")
                options[key.strip().lower()] = value.strip().strip('"').upper()
            waiting = []
            if keyword == "part":
                part = options.get("name", "")
            elif keyword == "instance":
                instance = {"name": options.get("name", ""), "part": options.get("part", ""), "rows": []}
                instances.append(instance)
                part = options.get("part", "")
            elif keyword in ("endpart", "endinstance", "assembly"):
                part, instance = "", None
            continue
        words = [word.strip() for word in line.rstrip(",").split(",")]
        here = parts[part]
        if keyword == "instance":
            instance["rows"].append([float(word) for word in words if word])
        elif keyword == "node":
            place = [float(word.replace("d", "e").replace("D", "e") or 0) for word in words[1:4]]
            here["nodes"][int(words[0])] = place + [0.0] * (3 - len(place))
            if "nset" in options:
                here["nsets"][options["nset"]].append(int(words[0]))
        elif keyword == "element":
            waiting += [int(word) for word in words if word]
            kind, nodes = abaqus_kind(options.get("type", "")), len(waiting) - 1
            if nodes >= (KINDS[kind][2] if kind in KINDS else nodes) and not line.endswith(","):
                here["cells"].append((kind, waiting[0], waiting[1:], options.get("elset")))
                waiting = []
        elif keyword in ("nset", "elset"):
            name, into = options.get(keyword, ""), here[keyword + "s"]
            if "generate" in options:
                first, last, step = ([int(word) for word in words if word] + [1])[:3]
                into[name] += range(first, last + 1, step)
            else:
                for word in words:
                    if word.lstrip("-").isdigit():
                        into[name].append(int(word))
                    elif word:
                        into[name] += into[word.upper()]
    found = Found()
    for instance in instances or [{"name": name, "part": name, "rows": []} for name in parts]:
        here = parts[instance["part"]]
        shift, key = (instance["rows"][:1] or [[0, 0, 0]])[0], instance["name"]
        for number, place in here["nodes"].items():
            found.places[key, number] = np.array(place) + (list(shift) + [0, 0, 0])[:3]
        of = collections.defaultdict(list)
        for name, numbers in here["elsets"].items():
            for number in numbers:
                of[number].append(name)
        for kind, number, nodes, elset in here["cells"]:
            if kind is None:
                continue
            dimension = None if kind in KINDS else 2
            names = of[number] + ([elset] if elset else [])
            found.cell(kind, [(key, node) for node in nodes], names, dimension)
        for name, numbers in here["nsets"].items():
            found.sets.setdefault(name, []).extend((key, number) for number in numbers)
    return found


def abaqus_kind(name):
    """The kind of an element type; None for one without a solid body: CalculiX's D and F3D4 to F3D8 are of flows."""
    if re.match(r"D$|F3D\d|MASS|ROTARYI|SPRING|DASHPOT|CONN|GAP|DCOUP|JOINT|ITS|DRAG|RB|R2D2|U\d|VU\d|HEATCAP", name):
        return None
    for pattern, kind in ABAQUS:
        if re.fullmatch(f"(?:{pattern})[A-Z]*5?", name):
            return kind
    return f"element {name}"


READERS = {"msh": gmsh, "inp": abaqus, "bdf": nastran, "nas": nastran, "dat": nastran, "node": tetgen, "ele": tetgen, "obj": obj,
           "off": off, "stl": stl, "ply": ply, **dict.fromkeys(["vtk", "vtu", "vtp", "vti", "vts", "vtr"], vtk_file)}  # fmt: skip


def main():
    path = Path(sys.argv[1])
    record = READERS[path.suffix[1:].lower()](path).record()
    print("\n" + json.dumps(record))


if __name__ == "__main__":
    main()
