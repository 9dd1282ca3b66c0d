"""Chooses mesh files of public projects, and gets those that were chosen.

    python files.py choose --clones CLONES            write files.csv beside this script
    python files.py get --clones CLONES --files FILES  write FILES/PROJECT/PATH for every row of files.csv

CLONES holds a git clone of every project, CLONES/OWNER+NAME (a work tree or a bare repository); FILES then holds their files under
OWNER+NAME/PATH. No file is chosen by hand. The rule:

1. All files of a project's commit whose ending is one of ENDINGS, of at most LARGEST bytes, whose content begins as the format's does
   (`is_mesh`) or which is a deck that includes files of the project, each content once over all projects.
2. In the order of the SHA-256 of "project/path", at most PER_ENDING of an ending, or PER_DECK of .inp, .bdf, .nas and .dat, whose
   files differ most, and at most PER_PROJECT of a project.
3. What they need: the .node of an .ele and the other way round, a .face beside them, and files named by INCLUDE. These rows have the
   role "beside"; the others have the role "mesh".
"""
import argparse
import csv
import hashlib
import re
import subprocess
from pathlib import Path, PurePosixPath

LIST = Path(__file__).resolve().parent / "files.csv"
COLUMNS = ["project", "commit", "path", "sha256", "bytes", "role"]
ENDINGS = "msh vtk vtu vtp vti vts vtr inp bdf nas dat node ele obj off ply stl".split()
DECKS = ["inp", "bdf", "nas", "dat"]
LARGEST = 4 * 1024 * 1024 - 1
PER_ENDING = 14
PER_DECK = 40
PER_PROJECT = 60


def git(clone, *arguments):
    """What git prints, as bytes."""
    return subprocess.run(["git", "-C", str(clone), *arguments], check=True, capture_output=True).stdout


def clones(folder):
    """Project names and their clones."""
    for path in sorted(folder.iterdir()):
        if (path / ".git").exists() or (path / "HEAD").exists():
            yield path.name, path


def is_mesh(ending, content):
    """Whether the content begins as a file of this format does: .dat and .inp are endings of much else."""
    head = content[:4096]
    if head.startswith(b"version https://git-lfs"):
        return False
    if ending == "msh":
        return any(word in head for word in (b"$MeshFormat", b"$NOD"))
    if ending == "vtk":
        return head.startswith(b"# vtk DataFile")
    if ending.startswith("vt"):
        return b"<VTKFile" in head
    if ending == "inp":
        return bool(re.search(rb"(?im)^\*node\s*(,.*)?$", content))
    if ending in ("bdf", "nas", "dat"):
        return bool(re.search(rb"(?im)^grid[ ,*\t]", content))
    if ending in ("node", "ele"):
        lines = [line for line in head.splitlines() if line.strip() and not line.lstrip().startswith(b"#")]
        return bool(lines) and bool(re.fullmatch(rb"\s*\d+(\s+\d+){1,3}\s*(#.*)?", lines[0]))
    if ending == "obj":
        return bool(re.search(rb"(?m)^v\s", content))
    return {"off": b"OFF" in head[:16], "ply": head.startswith(b"ply"), "stl": len(content) > 80}[ending]


def needed(path, content, tree):
    """The paths of the files that a mesh file is read with."""
    folder = PurePosixPath(path).parent
    ending = path.rsplit(".", 1)[1].lower()
    if ending in ("node", "ele"):
        return [other for end in ("node", "ele", "face") if (other := f"{path.rsplit('.', 1)[0]}.{end}") in tree and other != path]
    names = []
    if ending == "inp":
        names = re.findall(rb"(?im)^\*include\s*,\s*input\s*=\s*\"?([^\s\",]+)", content)
    elif ending in ("bdf", "nas", "dat"):
        names = re.findall(rb"(?im)^include\s*'?\"?([^'\"\r\n]+)", content)
    paths = []
    for name in names:
        parts = []
        for part in (folder / name.decode("utf-8", "replace").strip().replace("\\", "/")).parts:
            parts = parts[:-1] if part == ".." else parts + [part] if part != "." else parts
        paths.append("/".join(parts))
    return [other for other in paths if other in tree]


def choose(folder):
    """The rows of the list."""
    rows, seen = [], set()
    for project, clone in clones(folder):
        commit = git(clone, "rev-parse", "HEAD").decode().strip()
        tree = {}
        for line in git(clone, "ls-tree", "-r", "-l", "-z", "HEAD").decode("utf-8", "replace").split("\0"):
            about, _, path = line.partition("\t")
            if about and about.split()[3].isdigit():  # neither a submodule nor a file that the clone lacks
                tree[path] = int(about.split()[3])
        order = sorted(tree, key=lambda path: hashlib.sha256(f"{project}/{path}".encode()).hexdigest())
        taken, chosen = dict.fromkeys(ENDINGS, 0), {}

        def row(path, content, role):
            return dict(zip(COLUMNS, [project, commit, path, hashlib.sha256(content).hexdigest(), len(content), role]))

        for path in order:
            ending = path.rsplit(".", 1)[-1].lower()
            most = PER_DECK if ending in DECKS else PER_ENDING
            if ending not in taken or taken[ending] == most or sum(taken.values()) == PER_PROJECT or tree[path] > LARGEST:
                continue
            content = git(clone, "show", f"HEAD:{path}")
            found = row(path, content, "mesh")
            if found["sha256"] in seen or not (is_mesh(ending, content) or ending in DECKS and needed(path, content, tree)):
                continue
            seen.add(found["sha256"])
            taken[ending] += 1
            chosen[path] = found
            rows.append(found)
            waiting = [(path, content)]
            while waiting:
                for other in needed(*waiting.pop(), tree):
                    if other not in chosen:
                        beside = git(clone, "show", f"HEAD:{other}")
                        chosen[other] = row(other, beside, "beside")
                        rows.append(chosen[other])
                        waiting.append((other, beside))
    return rows


def get(folder, files):
    """Writes the files of the list, and proves that they are those of the list."""
    where = dict(clones(folder))
    for row in csv.DictReader(LIST.open()):
        content = git(where[row["project"]], "show", f"{row['commit']}:{row['path']}")
        if hashlib.sha256(content).hexdigest() != row["sha256"]:
            raise SystemExit(f"{row['project']}/{row['path']}: expected the content of the list, found another")
        path = files / row["project"] / row["path"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["choose", "get"])
    parser.add_argument("--clones", type=Path, required=True, help="the folder of the clones")
    parser.add_argument("--files", type=Path, help="where the files go")
    options = parser.parse_args()
    if options.what == "get":
        if options.files is None:
            parser.error("get requires --files")
        return get(options.clones, options.files)
    rows = choose(options.clones)
    with LIST.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    meshes = [row for row in rows if row["role"] == "mesh"]
    print(f"{len(meshes)} files of {len({row['project'] for row in meshes})} projects")


if __name__ == "__main__":
    main()
