"""The stiffness of a network under a support, factorised once for many loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arguments import failure, warn
from ._supports import check_acting, displacement_of, forces_of

if TYPE_CHECKING:
    from .springs import Network
else:
    Network = Any

#: A solution that leaves more of the forces than this is warned of.
_LEFT = 1e-6


class Factorized:
    """The stiffness of a network at rest under a support, factorised once; :meth:`Network.factorized` makes it.

    It is called as that of ``scipy.sparse.linalg.factorized``, with forces, and returns displacements."""

    def __init__(self, network: "Network", core: "_core.Factorized", held: np.ndarray) -> None:
        self.network, self._core, self._held = network, core, held
        self._held.flags.writeable = False

    @property
    def held(self) -> np.ndarray:
        """Which components are held, shape (points, dimension), read-only."""
        return self._held

    @property
    def is_stable(self) -> bool:
        """Whether the stiffness is positive definite: no motion releases energy."""
        return self._core.is_stable

    def __call__(self, forces: Any = None, displacement: Any = None) -> np.ndarray:
        """Small displacements, m.

        Args:
            forces: As in :meth:`Network.solve`, N: (points, dimension), of several loads (loads, points, dimension), or totals by group.
            displacement: Of what is held, m, in the same shapes, zero elsewhere; zero if None.

        Returns:
            Displacements in the shape of ``forces`` and ``displacement``, whichever has more loads.

        Raises:
            SpringfitError: An array has a wrong shape, or forces act on a motion without stiffness.
        """
        acting = forces_of(self.network, forces)
        moved = displacement_of(self.network, displacement, self._held)
        try:
            shape = np.broadcast_shapes(acting.shape, moved.shape)
        except ValueError as unlike:
            raise failure("displacement", f"as many loads as forces, of shape {acting.shape}", f"those of shape {moved.shape}") from unlike
        stacked = [np.ascontiguousarray(np.broadcast_to(given, shape)).reshape(-1, *shape[-2:]) for given in (acting, moved)]
        check_acting(*stacked, self._held)
        u, left, beyond = self._core.solve(*stacked)
        if not self.is_stable:
            warn("the network is indefinite with these supports: some motion releases energy")
        largest = left.max(initial=0.0)
        if not largest < _LEFT:
            warn(f"the solution leaves {largest:.1e} of the forces: the network is nearly a mechanism")
        if beyond is not None:
            warn(f"{beyond}; Network.equilibrium solves at large deformation")
        return u.reshape(shape)

    def __reduce__(self) -> "tuple[Any, ...]":
        # A copy factorises again: the factor is larger than the network.
        return self.network.factorized, (self._held,)

    def __repr__(self) -> str:
        return f"<springfit.Factorized: {self._held.sum()} of {self._held.size} components are held>"
