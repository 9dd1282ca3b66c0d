"""Progress of long work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ._arguments import failure, shown

#: A function that receives the progress of long work: the name of the stage, the steps that are done, and all steps of the stage, 0 where
#: it is not known.
Told = Callable[[str, int, int], Any]


@contextmanager
def listener(progress: bool | Told | None) -> Iterator[Told | None]:
    """What reports each step: nothing, the caller's function, or a bar of ``tqdm``; without that, nothing."""
    if callable(progress):
        yield progress
        return
    if not isinstance(progress, (bool, np.bool_, type(None))):
        raise failure("progress", "True, False or a function of (stage, done, total)", shown(progress))
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    bar = None

    def told(stage: str, done: int, total: int) -> None:
        nonlocal bar
        if bar is None or bar.desc.rstrip(": ") != stage:
            if bar is not None:
                bar.close()
            bar = tqdm(total=total or None, desc=stage)
        bar.total = total or None
        bar.update(done - bar.n)

    try:
        yield told
    finally:
        if bar is not None:
            bar.close()
