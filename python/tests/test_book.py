"""The examples of the book and of the README run as a reader runs them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("page", ["docs/src/start/python.md", "docs/src/start/calibrate.md", "docs/src/start/gradients.md", "docs/src/start/measure.md", "docs/src/theory/gradients.md", "python/README.md"])
def test_the_examples_run_in_an_empty_folder(page, tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    assert blocks
    if "import jax" in "".join(blocks):
        pytest.importorskip("jax", reason="not run: jax is not installed; .ci/python runs this")
    # The module that these tests have, whether it is installed or beside them.
    import springfit

    path = os.pathsep.join([str(Path(springfit.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", "\n".join(blocks)],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=300,
    )
    assert run.returncode == 0, run.stderr
    for written in re.findall(r"""net\.save\("(.*?)"\)""", "".join(blocks)):
        assert (tmp_path / written).exists()


def test_a_cloth_falls_in_a_loop_of_its_own(tmp_path):
    """The loop of the page on cloths moves what `export` writes, to where the page says."""
    page = (ROOT / "docs/src/start/cloth.md").read_text()
    for name, text in re.findall(r"<!-- file: (.*?) -->\n```\w+\n(.*?)```", page, re.DOTALL):
        (tmp_path / name).write_text(text)
    import springfit

    path = os.pathsep.join([str(Path(springfit.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])

    def run(*words):
        made = subprocess.run(words, cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=300)
        assert made.returncode == 0, made.stderr
        return made.stdout

    (tmp_path / "cloth.obj").write_text(run("awk", "-f", "cloth.awk"))
    run(sys.executable, "-m", "springfit", "export", "cloth.toml", "--fit", "hinges", "--to", "npz", "--gravity", "0 0 -9.81", "--out", "arrays")
    (printed,) = re.findall(r"python loop.py 1\n(.*?)\n", page)
    assert run(sys.executable, "loop.py", "1").strip() == printed
