"""The examples in the docstrings of the package run, and each public name has one."""

import doctest
import importlib
import inspect
import pkgutil

import pytest

import springfit as sf

#: Public names without an example so far. The list may only become shorter.
WITHOUT = {
    "Calibration",
    "Elasticity",
    "Element",
    "Factorized",
    "Gradient",
    "MatrixFit",
    "Measurement",
    "Motion",
    "Network",
    "Region",
    "SpringBlock",
    "SpringConstants",
    "SpringValues",
    "SpringfitError",
    "Statics",
    "StaticsGradient",
    "StaticsSolution",
    "__version__",
    "fit",
    "mass",
    "sampled",
    "shipped_elements",
    "stiffness",
    "whole",
}
MODULES = ["springfit"] + [f"springfit.{module.name}" for module in pkgutil.iter_modules(sf.__path__) if not module.ispkg and module.name not in ("_core", "__main__")]
#: What examples need besides NumPy.
OTHERS = {"meshio", "pandas", "pyvista", "scipy", "skfem", "trimesh", "jax", "torch"}


def examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    for name in MODULES:
        for test in finder.find(importlib.import_module(name)):
            if test.examples:
                yield pytest.param(test, id=test.name)


@pytest.mark.parametrize("test", examples())
@pytest.mark.filterwarnings("ignore")
def test_examples_run(test, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for package in sorted(OTHERS):
        if any(package in example.source for example in test.examples):
            pytest.importorskip(package)
    told = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    runner.run(test, out=told.append)
    assert runner.failures == 0, "".join(told)


def test_public_names_have_examples():
    without = {name for name in sf.__all__ if not doctest.DocTestParser().get_examples(inspect.getdoc(getattr(sf, name)) or "")}
    assert without <= WITHOUT, f"without an example: {sorted(without - WITHOUT)}"
