"""A body in a simulator, for `springfit referee`: a request in JSON on each line of standard input, an answer on each of standard output.

    python serve.py mujoco | newton | lammps | xpbd

    at the start                                        {"version": "4.0.0"}, or {"missing": words}
    {"open": {"folder", "solver", "told", "damping"}}   {"step": s}: springs of an export; elements if E and nu are told; damping in 1/s
    {"load": [[x, y, z] of each point in N]}            {}: the body is where it was at first, without a velocity
    {"advance": steps}                                  {"positions": [[x, y, z]] in m, or null if it has diverged, "warnings": [words]}
"""
import importlib
import importlib.util
import json
import os
import sys
from pathlib import Path

# What a program prints goes to standard error.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
sys.path.insert(0, str(Path(__file__).resolve().parent))


def answer(**words):
    answers.write(json.dumps(words) + "\n")
    answers.flush()


def script(folder):
    """The script of an export as a module."""
    spec = importlib.util.spec_from_file_location("exported", Path(folder) / "run.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def main():
    try:
        import numpy as np

        engine = importlib.import_module(f"with_{sys.argv[1]}")
    except ImportError as error:
        return answer(missing=str(error))
    answer(version=engine.version)
    body = None
    for line in sys.stdin:
        asked = json.loads(line)
        if "open" in asked:
            given = asked["open"]
            folder = Path(given["folder"])
            source = script(folder) if (folder / "run.py").exists() else folder
            body = engine.Body(source, given["solver"], given["told"], given["damping"])
            answer(step=body.step)
        elif "load" in asked:
            body.load(np.array(asked["load"]))
            answer()
        else:
            body.advance(asked["advance"])
            x = body.positions()
            answer(positions=x.tolist() if np.all(np.isfinite(x)) else None, warnings=body.warnings())


main()
