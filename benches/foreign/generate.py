"""Writes many small meshes, and has springfit make a scene for each and run it.

    python generate.py --springfit PROGRAM [--folder FOLDER] [--seed 1] [--only TEXT]

Every kind of cell is written flat (plane surfaces, straight solids) and bent (surfaces that curve in space, warped faces, moved middle
nodes), alone and mixed with another kind: of the same dimension, or of one less on the boundary. Every mesh is written in every format
that can hold it, by Gmsh, VTK and meshio (pip install gmsh vtk meshio) or the few lines below. Then `springfit new FILE -o FILE.toml` and
`springfit run FILE.toml` have to end with exit code 0. A table has the failures by message, and results.csv in FOLDER a row for each
file. Exit code 1 if one was refused.

Coordinates are random, and the same for the same seed. Groups: body, fixed (the sides at one end) and load (those at the other).
"""
import argparse
import collections
import csv
import itertools
import struct
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import meshio
import numpy as np
from compare import error, kind_of
from readers import EDGES, KINDS, OF_GMSH, gmsh_order

MESHIO = {"bar2": "line", "bar3": "line3", "tri3": "triangle", "tri6": "triangle6", "quad4": "quad", "quad8": "quad8", "quad9": "quad9",
          "tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20", "hex27": "hexahedron27", "wedge6": "wedge",
          "wedge15": "wedge15", "pyramid5": "pyramid", "pyramid13": "pyramid13"}  # fmt: skip
SHAPE = {"bar": [(0, 1)], **EDGES}
# Faces that get a node of their own, in VTK's order.
FACES = {"quad9": [(0, 1, 2, 3)], "hex27": [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]}
QUADRATIC = {"bar2": ["bar3"], "tri3": ["tri6"], "quad4": ["quad8", "quad9"], "tet4": ["tet10"], "hex8": ["hex20", "hex27"],
             "wedge6": ["wedge15"], "pyramid5": ["pyramid13"]}  # fmt: skip
LINEAR = {higher: lower for lower, all_higher in QUADRATIC.items() for higher in all_higher}
SIDES = {"tri": [(0, 1), (1, 2), (2, 0)], "quad": [(0, 1), (1, 2), (2, 3), (3, 0)],
         "tet": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
         "hex": [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)],
         "wedge": [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (0, 2, 5, 3)],
         "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]}  # fmt: skip
LENGTH = 3


class Mesh:
    """Points, cells by kind, and the sides at both ends."""

    def __init__(self, points, cells):
        self.points, self.cells, self.ends = points, cells, {"fixed": {}, "load": {}}


def stem(kind):
    return kind.rstrip("0123456789")


def grid(dimension):
    """Corners of a grid and, for each of its boxes, their indices in VTK's order."""
    counts = [LENGTH, 2, 2][:dimension]
    corners = np.array(list(itertools.product(*[range(n + 1) for n in counts])), dtype=float)
    index = {tuple(corner.astype(int)): k for k, corner in enumerate(corners)}
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    offsets = {1: [(0,), (1,)], 2: square, 3: [(*p, z) for z in (0, 1) for p in square]}[dimension]
    boxes = []
    for first in itertools.product(*[range(n) for n in counts]):
        boxes.append([index[tuple(np.add(first, offset))] for offset in offsets])
    return np.hstack([corners, np.zeros((len(corners), 3 - dimension))]), boxes


def linear(kinds):
    """A grid whose boxes are divided into cells of these linear kinds in turn."""
    dimension = KINDS[kinds[0]][1]
    points, boxes = grid(dimension)
    cells = collections.defaultdict(list)
    centres = []
    uses = collections.Counter(tuple(sorted(box[k] for k in face)) for box in boxes for face in SIDES["hex"]) if dimension == 3 else {}
    for number, b in enumerate(boxes):
        # Kinds whose faces agree take turns by box along the second axis; pyramids and tetrahedra share a box.
        kind = kinds[number % 2 if dimension == 2 else number // 2 % 2] if len(kinds) == 2 else kinds[0]
        if set(kinds) == {"pyramid5", "tet4"} or kinds == ["pyramid5"]:
            centre = len(points) + len(centres)
            centres.append(points[b].mean(axis=0))
            for face in SIDES["hex"]:
                base = [b[k] for k in face[::-1]]
                if "tet4" in kinds and uses[tuple(sorted(base))] == 1:
                    cells["tet4"] += [[base[0], base[1], base[2], centre], [base[0], base[2], base[3], centre]]
                else:
                    cells["pyramid5"].append(base + [centre])
        elif kind == "tet4":
            for way in itertools.permutations([1, 3, 4]):
                path = [0, way[0], {frozenset((1, 3)): 2, frozenset((1, 4)): 5, frozenset((3, 4)): 7}[frozenset(way[:2])], 6]
                cell = [b[k] for k in path]
                edges = points[cell[1:]] - points[cell[0]]
                cells["tet4"].append(cell if np.linalg.det(edges) > 0 else [cell[0], cell[2], cell[1], cell[3]])
        elif kind == "wedge6":
            cells["wedge6"] += [[b[k] for k in (0, 1, 2, 4, 5, 6)], [b[k] for k in (0, 2, 3, 4, 6, 7)]]
        elif kind == "tri3":
            cells["tri3"] += [[b[0], b[1], b[2]], [b[0], b[2], b[3]]]
        else:
            cells[kind].append(b)
    return np.vstack([points, *[centre[None] for centre in centres]]), dict(cells)


def deform(points, dimension, bent, random):
    """Flat bodies are sheared and, in the plane, jittered; bent ones curve as well, and their corners move in space."""
    points = points.copy()
    if dimension == 2:
        points[:, :2] += random.uniform(-0.15, 0.15, (len(points), 2))
    points[:, 0] += 0.2 * points[:, 1]
    points *= random.uniform(0.8, 1.2)
    if bent:
        points[:, 2] += 0.15 * np.sin(points[:, 0] + random.uniform(0, 6)) + 0.1 * points[:, 1] ** 2
        points += random.uniform(-0.06, 0.06, points.shape)
    return points


def middles(mesh, higher, bent, random):
    """The mesh with the quadratic kinds that the table names in place of linear ones."""
    points, node = list(mesh.points), {}

    def middle(corners):
        key = frozenset(corners)
        if key not in node:
            node[key] = len(points)
            shift = random.uniform(-0.04, 0.04, 3) if bent else 0
            points.append(np.mean([mesh.points[k] for k in corners], axis=0) + shift)
        return node[key]

    def raised(kind, cells):
        into = higher.get(kind, kind)
        if into == kind:
            return kind, cells
        full = []
        for cell in cells:
            more = cell + [middle([cell[a], cell[b]]) for a, b in SHAPE[stem(kind)]]
            more += [middle([cell[k] for k in face]) for face in FACES.get(into, [])]
            full.append(more + ([middle(cell)] if into == "hex27" else []))
        return into, full

    result = Mesh(None, dict(raised(kind, cells) for kind, cells in mesh.cells.items()))
    result.ends = {name: dict(raised(kind, cells) for kind, cells in parts.items()) for name, parts in mesh.ends.items()}
    result.points = np.array(points)
    return result


def end_sides(points, cells):
    """The sides of cells at the least and greatest place along the grid, by kind."""
    ends = {"fixed": collections.defaultdict(list), "load": collections.defaultdict(list)}
    for kind, all_cells in cells.items():
        for cell in all_cells:
            for side in SIDES.get(stem(kind), []):
                nodes = [cell[k] for k in side]
                for name, at in (("fixed", 0), ("load", LENGTH)):
                    if all(points[node][0] == at for node in nodes):
                        ends[name][{2: "bar2", 3: "tri3", 4: "quad4"}[len(nodes)]].append(nodes)
    return ends


def meshes(random):
    """Names and meshes."""
    bases = [["bar2"], ["tri3"], ["quad4"], ["tet4"], ["hex8"], ["wedge6"], ["pyramid5"]]
    bases += [["tri3", "quad4"], ["hex8", "wedge6"], ["pyramid5", "tet4"]]
    for kinds, bent, skin in itertools.product(bases, (False, True), (False, True)):
        dimension = KINDS[kinds[0]][1]
        if skin and dimension == 1:
            continue
        rest, cells = linear(kinds)
        mesh = Mesh(deform(rest, dimension, bent, random), cells)
        mesh.ends = end_sides(rest, cells)
        if skin:  # the sides at both ends are cells of the file without a group
            for sides in mesh.ends.values():
                for kind, parts in sides.items():
                    mesh.cells.setdefault(kind, []).extend(parts)
            mesh.ends = {"fixed": {}, "load": {}}
        choices = [{}]
        every = {kind for kind in [*mesh.cells, *itertools.chain(*mesh.ends.values())]}
        for pick in range(2):
            if pick == 0 or {"quad4", "hex8"} & every and not {"wedge6", "pyramid5"} & every:
                choices.append({kind: QUADRATIC[kind][min(pick, len(QUADRATIC[kind]) - 1)] for kind in every})
        for higher in choices:
            result = middles(mesh, higher, bent, random)
            yield "-".join([*result.cells, "bent" if bent else "flat"]), result


def blocks(mesh):
    """Kind, cells and number of the group: 1 body, 2 fixed, 3 load, of sides only where the file may have them."""
    for kind, cells in mesh.cells.items():
        yield kind, cells, 1
    for number, name in ((2, "fixed"), (3, "load")):
        for kind, cells in mesh.ends[name].items():
            yield kind, cells, number


def by_meshio(file_format, **options):
    def write(mesh, path):
        only(mesh, *(kind for kind in MESHIO if kind not in ("wedge15", "pyramid13")))  # which it has no dimension for
        parts = list(blocks(mesh)) if "gmsh" in file_format else [(kind, cells, 1) for kind, cells in mesh.cells.items()]
        cells = [(MESHIO[kind], np.array(cells)) for kind, cells, _ in parts]
        tags = [np.full(len(cells), number, dtype=np.int32) for _, cells, number in parts]
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags} if "gmsh" in file_format else {"part": tags}
        out = meshio.Mesh(mesh.points, cells, cell_data=data)
        if "gmsh" in file_format:
            dimension = max(KINDS[kind][1] for kind in mesh.cells)
            out.field_data = {"body": np.array([1, dimension])}
            for number, name in ((2, "fixed"), (3, "load")):
                if mesh.ends[name]:
                    out.field_data[name] = np.array([number, dimension - 1])
        out.write(path, file_format=file_format, **options)

    return write


def vtk_data(mesh, data):
    """The mesh as an unstructured grid, or as polygonal data."""
    import vtk

    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for place in mesh.points:
        points.InsertNextPoint(place)
    data.SetPoints(points)
    data.Allocate(64)
    for kind, cells in mesh.cells.items():
        for cell in cells:
            data.InsertNextCell(KINDS[kind][0], len(cell), cell)
    return data


def by_vtk(compressor, mode):
    def write(mesh, path):
        import vtk

        flat = path.suffix == ".vtp"
        if flat:
            only(mesh, "bar2", "tri3", "quad4")
        writer = vtk.vtkXMLPolyDataWriter() if flat else vtk.vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(vtk_data(mesh, vtk.vtkPolyData() if flat else vtk.vtkUnstructuredGrid()))
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.Write()

    return write


def by_vtk_legacy(version, mode):
    def write(mesh, path):
        import vtk

        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(vtk_data(mesh, vtk.vtkUnstructuredGrid()))
        writer.SetFileVersion(version)
        getattr(writer, f"SetFileTypeTo{mode}")()
        writer.Write()

    return write


class Unheld(Exception):
    """The format cannot hold the mesh."""


def only(mesh, *kinds):
    if not set(mesh.cells) <= set(kinds):
        raise Unheld


def by_gmsh(version, binary):
    def write(mesh, path):
        import gmsh

        if not gmsh.isInitialized():
            gmsh.initialize(interruptible=False)
            gmsh.option.setNumber("General.Terminal", 0)
        gmsh.clear()
        numbers = {kind: number for number, kind in OF_GMSH.items()}
        highest = max(KINDS[kind][1] for kind in mesh.cells)
        entity = gmsh.model.addDiscreteEntity(highest)
        gmsh.model.mesh.addNodes(highest, entity, range(1, len(mesh.points) + 1), mesh.points.ravel())
        entities = {}
        for kind, cells, group in blocks(mesh):
            dimension = KINDS[kind][1]
            key = (dimension, group)
            if key not in entities:
                entities[key] = entity if key == (highest, 1) else gmsh.model.addDiscreteEntity(dimension)
            nodes = np.array(cells)[:, gmsh_order(kind)] + 1
            gmsh.model.mesh.addElementsByType(entities[key], numbers[kind], [], nodes.ravel())
        for (dimension, group), tag in entities.items():
            if group > 1 or dimension == highest:
                gmsh.model.addPhysicalGroup(dimension, [tag], group, ["body", "fixed", "load"][group - 1])
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.option.setNumber("Mesh.SaveAll", 1)
        gmsh.write(str(path))

    return write


def abaqus(shell, assembly):
    plane = {"tri": "S3 S6", "quad": "S4R S8R"} if shell else {"tri": "CPS3 CPS6", "quad": "CPE4 CPE8R"}
    names = {"bar2": "T3D2", "bar3": "T3D3" if shell else "B32", "tet4": "C3D4", "tet10": "C3D10", "hex8": "C3D8R", "hex20": "C3D20",
             "wedge6": "C3D6", "wedge15": "C3D15", "pyramid5": "C3D5", "pyramid13": "C3D13"}  # fmt: skip
    for kind, places in (("tri", ("tri3", "tri6")), ("quad", ("quad4", "quad8"))):
        names.update(zip(places, plane[kind].split()))

    def write(mesh, path):
        only(mesh, *names)
        if not shell and max(KINDS[kind][1] for kind in mesh.cells) == 2 and np.ptp(mesh.points[:, 2]) > 0:
            raise Unheld
        lines = ["*HEADING", "small"] + (["*PART, NAME=one"] if assembly else []) + ["*NODE"]
        lines += [f"{k + 1}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(mesh.points.tolist())]
        first = 1
        for kind, cells in mesh.cells.items():
            lines.append(f"*ELEMENT, TYPE={names[kind]}, ELSET=E{kind}")
            for cell in cells:
                if kind == "bar3":  # the middle node comes second
                    cell = [cell[0], cell[2], cell[1]]
                words = [str(first)] + [str(node + 1) for node in cell]
                lines += [", ".join(words[:10]) + ("," if len(words) > 10 else "")] + ([", ".join(words[10:])] if len(words) > 10 else [])
                first += 1
        for name, parts in mesh.ends.items():
            nodes = sorted({node + 1 for cells in parts.values() for cell in cells for node in cell})
            if nodes:
                lines += [f"*NSET, NSET={name}"] + [", ".join(map(str, nodes[k : k + 8])) for k in range(0, len(nodes), 8)]
        if assembly:
            lines += ["*END PART", "*ASSEMBLY, NAME=all", "*INSTANCE, NAME=one-1, PART=one", "0.5, 0., 0.", "*END INSTANCE"]
            lines += ["*END ASSEMBLY"]
        path.write_text("\n".join([*lines, ""]))

    return write


def nastran(field):
    names = {"bar2": "CROD", "tri3": "CTRIA3", "tri6": "CTRIA6", "quad4": "CQUAD4", "quad8": "CQUAD8", "tet4": "CTETRA", "tet10": "CTETRA",
             "hex8": "CHEXA", "hex20": "CHEXA", "wedge6": "CPENTA", "wedge15": "CPENTA", "pyramid5": "CPYRAM",
             "pyramid13": "CPYRAM"}  # fmt: skip
    order = {"hex20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15], "wedge15": [*range(9), 12, 13, 14, 9, 10, 11]}

    def number(x):
        if field == "small":
            text = f"{x:.6f}"[:8]
            return text if "." in text else f"{x:.1f}"
        return f"{x:.9E}" if field == "large" else repr(float(x))

    def card(name, words):
        if field == "free":
            rows = [words[k : k + 8] for k in range(0, len(words), 8)]
            return [",".join([name if k == 0 else "", *row]) for k, row in enumerate(rows)]
        width, per = (16, 4) if field == "large" else (8, 8)
        star = "*" if field == "large" else ""
        rows = [words[k : k + per] for k in range(0, len(words), per)]
        return [((name if k == 0 else "") + star).ljust(8) + "".join(word.rjust(width) for word in row) for k, row in enumerate(rows)]

    def write(mesh, path):
        only(mesh, *names)
        lines = ["CEND", "BEGIN BULK"]
        for k, place in enumerate(mesh.points.tolist()):
            lines += card("GRID", [str(k + 1), "", *map(number, place)])
        count = itertools.count(1)
        for group, (kind, cells) in enumerate(mesh.cells.items()):
            for cell in cells:
                nodes = [cell[k] for k in order[kind]] if kind in order else cell
                lines += card(names[kind], [str(next(count)), str(group + 1)] + [str(node + 1) for node in nodes])
        path.write_text("\n".join([*lines, "ENDDATA", ""]))

    return write


def tetgen(mesh, path):
    (kind, cells), *others = mesh.cells.items()
    only(mesh, "tri3", "tri6", "tet4", "tet10")
    dimension = KINDS[kind][1]
    if others or dimension == 2 and np.ptp(mesh.points[:, 2]) > 0:
        raise Unheld
    # Triangle has each middle opposite to its corner; TetGen those of the edges 2-3, 0-3, 0-1, 1-2, 1-3, 0-2.
    order = {"tri6": [0, 1, 2, 4, 5, 3], "tet10": [0, 1, 2, 3, 9, 7, 4, 5, 8, 6]}.get(kind, range(KINDS[kind][2]))
    rows = [f"{k + 1} " + " ".join(repr(x) for x in place[:dimension]) for k, place in enumerate(mesh.points.tolist())]
    path.with_suffix(".node").write_text("\n".join([f"{len(rows)} {dimension} 0 0", *rows, ""]))
    rows = [f"{k + 1} " + " ".join(str(cell[place] + 1) for place in order) for k, cell in enumerate(cells)]
    path.write_text("\n".join([f"{len(rows)} {KINDS[kind][2]} 0", *rows, ""]))


def stl(binary):
    def write(mesh, path):
        only(mesh, "tri3")
        faces = mesh.points[np.array(mesh.cells["tri3"])]
        if binary:
            data = b"".join(struct.pack("<12fH", 0, 0, 0, *face.ravel(), 0) for face in faces)
            path.write_bytes(bytes(80) + struct.pack("<I", len(faces)) + data)
            return
        lines = ["solid small"]
        for face in faces:
            corners = [f"vertex {x} {y} {z}" for x, y, z in face]
            lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
        path.write_text("\n".join([*lines, "endsolid small", ""]))

    return write


def obj(mesh, path):
    only(mesh, "tri3", "quad4", "bar2")
    lines = ["o small"] + [f"v {x} {y} {z}" for x, y, z in mesh.points]
    for kind, cells in mesh.cells.items():
        lines += [("l " if kind == "bar2" else "f ") + " ".join(str(node + 1) for node in cell) for cell in cells]
    path.write_text("\n".join([*lines, ""]))


def off(mesh, path):
    only(mesh, "tri3", "quad4")
    cells = [cell for cells in mesh.cells.values() for cell in cells]
    lines = ["OFF", f"{len(mesh.points)} {len(cells)} 0"] + [f"{x} {y} {z}" for x, y, z in mesh.points]
    path.write_text("\n".join(lines + [" ".join(map(str, [len(cell), *cell])) for cell in cells] + [""]))


def ply(order):
    def write(mesh, path):
        only(mesh, "tri3", "quad4")
        cells = [cell for cells in mesh.cells.values() for cell in cells]
        form = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
        head = ["ply", f"format {form} 1.0", f"element vertex {len(mesh.points)}", "property double x", "property double y",
                "property double z", f"element face {len(cells)}", "property list uchar int vertex_indices", "end_header", ""]  # fmt: skip
        if order:
            body = mesh.points.astype(order + "f8").tobytes()
            body += b"".join(struct.pack(f"{order}B{len(cell)}i", len(cell), *cell) for cell in cells)
        else:
            rows = [f"{x} {y} {z}" for x, y, z in mesh.points] + [" ".join(map(str, [len(cell), *cell])) for cell in cells]
            body = "\n".join([*rows, ""]).encode()
        path.write_bytes("\n".join(head).encode() + body)

    return write


WRITERS = {
    "gmsh22.msh": by_meshio("gmsh22", binary=False), "gmsh22-binary.msh": by_meshio("gmsh22", binary=True),
    "gmsh41.msh": by_gmsh(4.1, 0), "gmsh41-binary.msh": by_gmsh(4.1, 1), "gmsh40.msh": by_gmsh(4.0, 0), "gmsh1.msh": by_gmsh(1, 0),
    "vtk42.vtk": by_vtk_legacy(42, "ASCII"), "vtk42-binary.vtk": by_vtk_legacy(42, "Binary"), "vtk51.vtk": by_vtk_legacy(51, "ASCII"),
    "vtk51-binary.vtk": by_meshio("vtk", binary=True), "ascii.vtu": by_vtk("None", "Ascii"), "zlib.vtu": by_meshio("vtu", binary=True),
    "lzma.vtu": by_vtk("LZMA", "Binary"),
    "lz4.vtu": by_vtk("LZ4", "Appended"), "appended.vtu": by_vtk("None", "Appended"), "zlib.vtp": by_vtk("ZLib", "Appended"),
    "ascii.vtp": by_vtk("None", "Ascii"), "flat.inp": abaqus(False, False), "shell.inp": abaqus(True, False),
    "assembly.inp": abaqus(True, True), "small.bdf": nastran("small"), "large.nas": nastran("large"), "free.dat": nastran("free"),
    "tetgen.ele": tetgen, "ascii.stl": stl(False), "binary.stl": stl(True), "obj.obj": obj, "off.off": off, "ascii.ply": ply(""),
    "little.ply": ply("<"), "big.ply": ply(">"),
}  # fmt: skip


def trial(program, path):
    """The command that failed and its message; empty if none did."""
    scene = path.with_name(path.name + ".toml")
    scene.unlink(missing_ok=True)
    commands = [[program, "new", path, "-o", scene], [program, "run", scene, "-q", "--out", path.with_name(path.name + ".out")]]
    for command in commands:
        done = subprocess.run(command, capture_output=True, timeout=300)
        if done.returncode != 0:
            text = error(done.stderr.decode("utf-8", "replace")) or f"exit code {done.returncode}"
            return command[1], text.replace(str(scene), "SCENE")
    return "", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--springfit", default="springfit", help="the program")
    parser.add_argument("--folder", type=Path, default=Path("generated"), help="where the files go")
    parser.add_argument("--seed", type=int, default=1, help="of the coordinates")
    parser.add_argument("--only", default="", help="only files whose names have this text")
    parser.add_argument("--jobs", type=int, default=2, help="how many at once")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, mesh in meshes(np.random.default_rng(options.seed)):
        for ending, write in WRITERS.items():
            path = options.folder / f"{name}-{ending}"
            if options.only not in path.name:
                continue
            try:
                write(mesh, path)
            except Unheld:
                path.unlink(missing_ok=True)
                continue
            paths.append(path)
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda path: trial(options.springfit, path), paths))
    failures = collections.defaultdict(list)
    with (options.folder / "results.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["file", "command", "message"])
        for path, (command, message) in zip(paths, results):
            table.writerow([path.name, command, message])
            if command:
                failures[command, kind_of(message, path)].append(path.name)
    for (command, kind), names in sorted(failures.items(), key=lambda item: -len(item[1])):
        print(f"{len(names):5}  {command}: {kind}\n         such as {', '.join(names[:3])}")
    refused = sum(map(len, failures.values()))
    print(f"{len(paths)} files, {len(paths) - refused} run, {refused} refused")
    sys.exit(1 if refused else 0)


if __name__ == "__main__":
    main()
