"""Mass-spring models that answer like finite elements.

>>> import numpy as np, springfit as sf
>>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[4, 4, 4])
>>> net = sf.fit(mesh, sf.Material(young=1e4, poisson=0.3))
>>> net.springs.shape[1], net.status
(2, 'fitted')

Lengths are in metres, forces in newtons, stresses in pascals, masses in kilograms.
"""

from ._core import Element, SpringfitError, __version__, shipped_elements
from .adjoint import Statics, StaticsGradient, StaticsSolution
from .factorized import Factorized
from .calibration import Calibration, calibrate
from .gradients import Gradient, SpringBlock, SpringConstants, SpringValues
from .material import Material
from .matrix import MatrixFit, fit_matrix
from .measure import Elasticity, Measurement, Region, measure
from .mesh import Mesh
from .motion import Motion
from .network import fit, mass, sampled, stiffness, whole
from .report import Report, run
from .springs import Network
from .studies import compare, converge, learning_curve, stability
from .sweep import sweep

__all__ = [
    "Calibration",
    "Elasticity",
    "Element",
    "Factorized",
    "Gradient",
    "Material",
    "MatrixFit",
    "Measurement",
    "Mesh",
    "Motion",
    "Network",
    "Region",
    "Report",
    "SpringBlock",
    "SpringConstants",
    "SpringValues",
    "Statics",
    "StaticsGradient",
    "StaticsSolution",
    "SpringfitError",
    "__version__",
    "calibrate",
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
