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
