import os
from pathlib import Path

import pytest
import springfit as sf


@pytest.fixture
def scenes() -> Path:
    """The folder of the shipped scenes."""
    return Path(__file__).resolve().parents[2] / "scenes"


@pytest.fixture
def command() -> str:
    """The command that the module installs."""
    if "SPRINGFIT" not in os.environ:
        pytest.skip("SPRINGFIT does not name the command")
    return os.environ["SPRINGFIT"]


@pytest.fixture
def jax():
    """JAX with double precision."""
    module = pytest.importorskip("jax", reason="not run: jax is not installed; .ci/python runs this")
    module.config.update("jax_enable_x64", True)
    # Most of what tests with JAX take is its compiler, which optimises what is called once.
    module.config.update("jax_disable_most_optimizations", True)
    return module


def raised(call, key) -> str:
    """What a call is refused with, whose key is this one."""
    with pytest.raises(sf.SpringfitError) as error:
        call()
    assert error.value.key == key, str(error.value)
    return str(error.value)


def square(cells: int) -> dict:
    """The scene of a square of so many cells along each side, pulled at its upper edge."""
    return {
        "mesh": {"box": {"element": "quad4", "size": [1.0, 1.0], "cells": [cells, cells]}},
        "material": {"young": 1e4, "poisson": 0.3},
        "fix": [{"group": "ymin"}],
        "load": [{"name": "tension", "group": "ymax", "traction": [0.0, 100.0]}],
        "fit": [{"objective": "frobenius"}, {"objective": "exact"}],
    }
