"""Runs the notebooks and writes them as pages of the book, docs/src/notebooks/NAME.md with figures beside them.

    python render.py [NAME …] [--into FOLDER]

A notebook is a script with cells (`# %%`), which Jupyter opens by Jupytext: right click, "Open with", "Notebook". It runs in an empty
folder. Requires jupytext, nbclient, ipykernel, matplotlib and what the notebook imports.
"""
import argparse
import os
import sys
import tempfile
from pathlib import Path

import jupytext
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell

HERE = Path(__file__).resolve().parent
BOOK = HERE.parents[1] / "docs/src/notebooks"
NAMES = ["fit_my_mesh", "add_an_element", "norms", "sampled", "into_a_simulator", "inclusion"]
# Figures are the same from run to run, and their text is text.
STYLE = """
%config InlineBackend.figure_formats = ["svg"]
%config InlineBackend.print_figure_kwargs = {"bbox_inches": "tight", "facecolor": "white", "metadata": {"Date": None, "Creator": None}}
import matplotlib
matplotlib.rcParams.update({"svg.hashsalt": "springfit", "svg.fonttype": "none", "font.family": "sans-serif", "axes.grid": True,
    "axes.spines.top": False, "axes.spines.right": False, "grid.alpha": 0.3, "figure.figsize": (7, 3.2), "legend.frameon": False})
"""


def source(name):
    """The cells of a notebook."""
    return jupytext.read(HERE / f"{name}.py", fmt="py:percent").cells


def run(name):
    """The cells with their outputs."""
    notebook = jupytext.read(HERE / f"{name}.py", fmt="py:percent")
    notebook.cells.insert(0, new_code_cell(STYLE))
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    with tempfile.TemporaryDirectory() as folder:
        # What a cell prints comes in pieces whose number depends on time: they are one.
        options = {"timeout": 120, "startup_timeout": 60, "coalesce_streams": True}
        client = NotebookClient(notebook, resources={"metadata": {"path": folder}}, **options)
        kernel = client.create_kernel_manager()
        # Not over the network.
        kernel.transport, kernel.ip = "ipc", str(Path(folder) / "kernel")
        # The command is beside the interpreter.
        search = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        client.execute(env={**os.environ, "PATH": search})
    return notebook.cells[1:]


def page(name, cells):
    """The page, and its figures by file name."""
    parts, figures = [], {}
    for cell in cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/svg+xml" in data:
                file = f"{name}-{len(figures) + 1}.svg"
                figures[file] = data["image/svg+xml"].rstrip() + "\n"
                # The cell says in its first comment what the figure shows.
                comments = [line[2:] for line in cell.source.splitlines() if line.startswith("# ")]
                parts.append(f"![{comments[0].rstrip('.')}]({file})")
            elif output.output_type == "stream" and output.name == "stderr":
                raise ValueError(f"{name}: {output.text}")
            else:
                text = output.text if output.output_type == "stream" else data["text/plain"]
                parts.append(f"```text\n{text.rstrip()}\n```")
    parts.append(f"This page is `python/notebooks/{name}.py`, run by `python/notebooks/render.py`.")
    return "\n\n".join(parts) + "\n", figures


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("names", nargs="*", metavar="NAME", help=", ".join(NAMES))
    arguments.add_argument("--into", type=Path, default=BOOK, help="the folder of the pages")
    options = arguments.parse_args()
    options.into.mkdir(parents=True, exist_ok=True)
    for name in options.names or NAMES:
        text, figures = page(name, run(name))
        (options.into / f"{name}.md").write_text(text)
        for file, figure in figures.items():
            (options.into / file).write_text(figure)
        print(f"written: {options.into / name}.md, {len(figures)} figures of {sum(map(len, figures.values())) // 1000} kB")


if __name__ == "__main__":
    main()
