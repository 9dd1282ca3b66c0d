from pathlib import Path

import pytest


@pytest.fixture
def scenes() -> Path:
    """The folder of the shipped scenes."""
    return Path(__file__).resolve().parents[2] / "scenes"


def square(cells: int) -> dict:
    """The scene of a square of so many cells along each side, pulled at its upper edge."""
    return {
        "mesh": {"box": {"element": "quad4", "size": [1.0, 1.0], "cells": [cells, cells]}},
        "material": {"young": 1e4, "poisson": 0.3},
        "fix": [{"group": "ymin"}],
        "load": [{"name": "tension", "group": "ymax", "traction": [0.0, 100.0]}],
        "fit": [{"objective": "frobenius"}, {"objective": "exact"}],
    }
