"""Notebooks: they run, what they assert holds, and the pages of the book are what they give."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "python" / "notebooks"
sys.path.insert(0, str(FOLDER))
# What renders notebooks is installed with the extra "notebooks".
render = pytest.importorskip("render", exc_type=ImportError)

NUMBER = re.compile(r"-?\d+\.?\d*(?:e[-+]\d+)?")


def test_every_notebook_is_in_the_book():
    contents = (ROOT / "docs/src/SUMMARY.md").read_text()
    assert sorted(render.NAMES) == sorted(path.stem for path in FOLDER.glob("*.py") if path.stem != "render")
    for name in render.NAMES:
        assert f"(notebooks/{name}.md)" in contents
        assert 8 <= len(render.source(name)) <= 20, "long enough to say something, short enough to read"


@pytest.mark.long
@pytest.mark.parametrize("name", render.NAMES)
def test_a_notebook_runs_and_its_page_is_what_it_gives(name):
    pytest.importorskip("mujoco" if name == "into_a_simulator" else "springfit")
    text, figures = render.page(name, render.run(name))
    known = (render.BOOK / f"{name}.md").read_text()
    assert NUMBER.sub("#", text) == NUMBER.sub("#", known), f"python python/notebooks/render.py {name} writes the page anew"
    for new, old in zip(NUMBER.findall(text), NUMBER.findall(known), strict=True):
        # Printed digits: the last one may differ from machine to machine.
        assert float(new) == pytest.approx(float(old), rel=0.02, abs=0.02), f"{name}: {new} instead of {old}"
    # The page has a picture for each figure, and each loads at once.
    assert sorted(path.name for path in render.BOOK.glob(f"{name}-*.svg")) == sorted(figures)
    for file, figure in figures.items():
        assert f"]({file})" in known and len(figure) < 100_000, file
        assert (render.BOOK / file).stat().st_size < 100_000, file
    assert figures
