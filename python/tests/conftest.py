from pathlib import Path

import pytest


@pytest.fixture
def scenes() -> Path:
    """The folder of the shipped scenes."""
    return Path(__file__).resolve().parents[2] / "scenes"
