"""Packages that are not required, as names in annotations."""

from __future__ import annotations

import importlib
from typing import Any


class Package:
    """A package that is imported where one of its names is asked for, as ``typing.get_type_hints`` does."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module(self._name), name)
