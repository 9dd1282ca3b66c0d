"""Mass-spring models that answer like finite elements.

>>> import numpy as np, springfit as sf
>>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[4, 4, 4])
>>> net = sf.fit(mesh, sf.Material(young=1e4, poisson=0.3))
>>> net.springs.shape[1], net.status
(2, 'fitted')

Lengths are in metres, forces in newtons, stresses in pascals, masses in kilograms.
"""

from ._core import Element, SpringfitError, __version__, shipped_elements
from .gradients import Gradient, SpringConstants
from .material import Material
from .matrix import MatrixFit, fit_matrix
from .measure import Elasticity, Measurement, Region, measure
from .mesh import Mesh
from .network import Network, fit, mass, sampled, stiffness, whole
from .report import Report, run
from .studies import compare, converge, learning_curve, stability
from .sweep import sweep

__all__ = [
    "Elasticity",
    "Element",
    "Gradient",
    "Material",
    "MatrixFit",
    "Measurement",
    "Mesh",
    "Network",
    "Region",
    "Report",
    "SpringConstants",
    "SpringfitError",
    "__version__",
    "compare",
    "converge",
    "fit",
    "fit_matrix",
    "learning_curve",
    "mass",
    "measure",
    "run",
    "sampled",
    "shipped_elements",
    "stability",
    "stiffness",
    "sweep",
    "whole",
]
