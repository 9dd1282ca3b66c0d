"""The script of an export in Python."""
import bodies


def load(folder):
    return bodies.module(folder / "run.py", folder.name)
