"""The compiled part. The classes of the package wrap it; what they say of shapes and units holds here."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BodyShare",
    "CellConstants",
    "DistributedBody",
    "Element",
    "Factorized",
    "FileError",
    "Mesh",
    "MissingFileError",
    "Network",
    "NetworkShare",
    "Ran",
    "SpringBody",
    "SpringfitError",
    "Studies",
    "Sweep",
    "Tangent",
    "__version__",
    "checked_material",
    "command_line",
    "compare_cases",
    "compare_element",
    "compare_scene",
    "converge",
    "filled_mesh",
    "finite_elements",
    "fit",
    "is_comparison",
    "learning_curve",
    "masses",
    "parsed_element",
    "quantity",
    "restored_mesh",
    "run",
    "shipped_elements",
    "spring_numbers",
    "stability",
    "stability_of_scene",
    "study_line",
    "voxel_mesh",
    "young_and_poisson",
]

__version__: str

_Progress: TypeAlias = Callable[[str, int, int], Any]
_Held: TypeAlias = dict[str, Any]
# `data`, `indices` and `indptr` of a csr_matrix, whose places have 32 bits where that is enough.
_Rows: TypeAlias = tuple[NDArray[np.float64], NDArray[Any], NDArray[Any]]

class SpringfitError(ValueError):
    """A fault of an input; `file`, `line` and `key` are None where they are not known."""

    kind: str
    file: str | None
    line: int | None
    key: str | None

class FileError(SpringfitError, OSError):  # type: ignore[misc]
    """A file cannot be read or written."""

class MissingFileError(SpringfitError, FileNotFoundError):  # type: ignore[misc]
    """A file is not there."""

@final
class Element:
    """An element type: a shipped one by its name, or the one of a TOML file by its path."""

    def __new__(cls, name_or_path: str | PathLike[str]) -> Element: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __copy__(self) -> Element: ...
    def __deepcopy__(self, _memo: Any) -> Element: ...
    @staticmethod
    def parse(text: str) -> Element: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def dimension(self) -> int: ...
    @property
    def nodes(self) -> int: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def springs(self) -> dict[str, list[list[int]]]: ...
    @property
    def vtk(self) -> tuple[int, list[int]] | None: ...

@final
class Mesh:
    @staticmethod
    def of_arrays(
        points: NDArray[np.float64],
        blocks: Sequence[tuple[Element, NDArray[np.int64]]],
        groups: dict[str, NDArray[np.int64]],
        cell_groups: dict[str, NDArray[np.int64]],
        below: str | None = None,
        least: float | None = None,
    ) -> Mesh: ...
    @staticmethod
    def read(
        path: str,
        scale: float = 1.0,
        elements: Sequence[Element] = ...,
        below: str | None = None,
        least: float | None = None,
        space: int | None = None,
    ) -> Mesh: ...
    @property
    def annotations(self) -> list[str]: ...
    @staticmethod
    def of_box(element: Element, size: Sequence[float], cells: Sequence[int], origin: Sequence[float]) -> Mesh: ...
    @property
    def dimension(self) -> int: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def blocks(self) -> list[tuple[str, NDArray[np.int64]]]: ...
    @property
    def groups(self) -> dict[str, NDArray[np.int64]]: ...
    @property
    def cell_groups(self) -> dict[str, NDArray[np.int64]]: ...
    @property
    def elements(self) -> list[Element]: ...
    @property
    def content(self) -> float: ...
    def refined(self) -> Mesh: ...
    def boundary(self) -> list[tuple[str, NDArray[np.int64], NDArray[np.int64]]]: ...
    @property
    def numbers(self) -> NDArray[np.int64] | None: ...
    @property
    def checksum(self) -> str: ...
    @property
    def quality(self) -> dict[str, Any]: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __copy__(self) -> Mesh: ...
    def __deepcopy__(self, _memo: Any) -> Mesh: ...

def measure_arrays(network: dict[str, Any], mesh: Mesh | None, options: dict[str, Any]) -> str: ...
def measure_file(
    path: str,
    points: str | None,
    cell: NDArray[np.float64] | None,
    periodic: bool | None,
    options: dict[str, Any],
) -> str: ...
def read_matrix(path: str) -> NDArray[np.float64]: ...
def fit_stiffness(
    stiffness: NDArray[np.float64],
    points: NDArray[np.float64],
    springs: NDArray[np.int64] | None,
    displacements: NDArray[np.int64] | None,
    objective: str,
    weight: str | None,
    nonnegative: bool,
) -> tuple[NDArray[np.int64], NDArray[np.float64], float, float, bool, bool, float | None, int]: ...

@final
class Network:
    @staticmethod
    def of_arrays(
        points: NDArray[np.float64],
        springs: NDArray[np.int64],
        constants: NDArray[np.float64],
        rest: NDArray[np.float64] | None,
        contents: Sequence[dict[str, Any]],
        masses: NDArray[np.float64] | None = None,
        mesh: Mesh | None = None,
        facts: str | None = None,
    ) -> Network: ...
    @staticmethod
    def read(
        path: str | PathLike[str], elements: Sequence[Element]
    ) -> tuple[Network, Mesh | None, tuple[str | None, str | None, list[str]]]: ...
    def changed(
        self, constants: NDArray[np.float64] | None, rest: NDArray[np.float64] | None, others: Sequence[dict[str, Any]]
    ) -> Network: ...
    @property
    def facts(self) -> str: ...
    @property
    def dimension(self) -> int: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def springs(self) -> NDArray[np.int64]: ...
    @property
    def constants(self) -> NDArray[np.float64]: ...
    @property
    def rest(self) -> NDArray[np.float64]: ...
    @property
    def masses(self) -> NDArray[np.float64] | None: ...
    @property
    def others(self) -> list[dict[str, Any]]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def name(self) -> str | None: ...
    @property
    def status(self) -> str | None: ...
    @property
    def negative(self) -> int: ...
    def statistics(self, measures: bool) -> dict[str, Any] | None: ...
    @property
    def sampled(self) -> tuple[str, dict[str, Any], dict[str, Any]] | None: ...
    def check_formulas(self) -> None: ...
    def energy(self, x: NDArray[np.float64] | None = None) -> NDArray[np.float64]: ...
    def forces(self, x: NDArray[np.float64] | None = None) -> NDArray[np.float64]: ...
    def stiffness(self, x: NDArray[np.float64] | None = None) -> _Rows: ...
    def factorized(self, held: NDArray[np.bool_]) -> Factorized: ...
    def equilibrium(
        self,
        forces: NDArray[np.float64],
        held: NDArray[np.bool_],
        prescribed: NDArray[np.float64],
        start: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.float64], bool, int]: ...
    def simulate(
        self, keys: dict[str, Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], int]: ...
    def group_forces(self, group: str, force: list[float]) -> NDArray[np.float64]: ...
    def write(self, path: str) -> None: ...
    def export(self, to: str, folder: str, gravity: Sequence[float] | None = None) -> tuple[list[Path], list[str], str]: ...
    def __len__(self) -> int: ...
    def __copy__(self) -> Network: ...
    def __deepcopy__(self, _memo: Any) -> Network: ...

@final
class Factorized:
    def solve(
        self, forces: NDArray[np.float64], prescribed: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], str | None]: ...
    @property
    def is_stable(self) -> bool: ...
    def __copy__(self) -> Factorized: ...
    def __deepcopy__(self, _memo: Any) -> Factorized: ...

def shipped_elements() -> list[str]: ...
def parsed_element(text: str) -> Element: ...
def restored_mesh(
    points: NDArray[np.float64],
    blocks: Sequence[tuple[Element, NDArray[np.int64]]],
    groups: dict[str, NDArray[np.int64]],
    numbers: tuple[str, NDArray[np.uint64]] | None,
    counts: tuple[float, list[int], list[int | None], bool, str | None],
    cell_groups: dict[str, NDArray[np.int64]],
) -> Mesh: ...
def filled_mesh(
    path: str | None,
    surface: tuple[NDArray[np.float64], list[NDArray[np.int64]]] | None,
    element: Element,
    cell: float | None,
    points: int | None,
    options: tuple[str | None, str | None, bool],
    scale: float,
) -> Mesh: ...
def quantity(key: str, kind: str, text: str) -> float: ...
def voxel_mesh(
    path: str,
    element: Element,
    spacing: Sequence[float],
    origin: Sequence[float],
    names: list[tuple[str, list[int]]] | None,
) -> Mesh: ...
def checked_material(material: Any, keys: list[str]) -> list[float | None]: ...
def young_and_poisson(constants: dict[str, Any]) -> tuple[float, float]: ...
def command_line(arguments: list[str]) -> int: ...
def fit(
    mesh: Mesh,
    material: Any,
    keys: dict[str, Any],
    held: NDArray[np.bool_] | None = None,
    progress: _Progress | None = None,
    functions: dict[str, Any] | None = None,
) -> Network: ...
def learning_curve(
    mesh: Mesh,
    material: Any,
    keys: dict[str, Any],
    counts: list[int],
    seeds: list[int],
    progress: _Progress | None = None,
    functions: dict[str, Any] | None = None,
) -> str: ...
def finite_elements(mesh: Mesh, material: Any) -> _Rows: ...
def masses(mesh: Mesh, material: Any, share: float) -> _Rows: ...
def run(
    scene: Path | dict[str, Any],
    folder: Path,
    settings: dict[str, Any],
    held: _Held,
    out: Path | None = None,
    progress: _Progress | None = None,
) -> tuple[str, dict[str, dict[str, NDArray[np.float64]]], list[Path], Ran]: ...

@final
class Ran:
    @property
    def fits(self) -> list[str]: ...
    def mesh(self) -> Mesh: ...
    def network(self, fit: int) -> Network: ...

@final
class Sweep:
    def __new__(
        cls,
        scene: Path | dict[str, Any],
        folder: Path,
        settings: dict[str, Any],
        held: _Held,
        sweep: dict[str, Any] | None = None,
    ) -> Sweep: ...
    @property
    def scene(self) -> tuple[str, Path]: ...
    @property
    def marks(self) -> list[str]: ...
    def table(self, lines: Studies) -> tuple[list[str], str]: ...

@final
class Studies:
    def __new__(cls, path: Path, sweep: Sweep) -> Studies: ...
    def __contains__(self, mark: str, /) -> bool: ...
    def push(self, line: str) -> None: ...

def study_line(
    text: str, path: Path, settings: dict[str, Any], values: str, held: _Held, progress: _Progress | None = None
) -> str: ...

_Numbers: TypeAlias = NDArray[np.float64]
_Inputs: TypeAlias = tuple[_Numbers, _Numbers, _Numbers]

@final
class CellConstants:
    def __new__(cls, element: Element, keys: dict[str, Any], plane: str | None = None) -> CellConstants: ...
    @property
    def pairs(self) -> NDArray[np.int64]: ...
    @property
    def springs(self) -> int: ...
    @property
    def is_restless(self) -> bool: ...
    def moduli(self, young: _Numbers, poisson: _Numbers, thickness: _Numbers) -> tuple[_Numbers, _Numbers]: ...
    def values(
        self, points: _Numbers, cells: NDArray[np.int64], young: _Numbers, poisson: _Numbers, thickness: _Numbers
    ) -> tuple[_Numbers, _Numbers]: ...
    def along(
        self,
        points: _Numbers,
        cells: NDArray[np.int64],
        lambda_: _Numbers,
        mu: _Numbers,
        first: _Inputs,
        second: _Inputs | None,
    ) -> tuple[_Numbers, _Numbers]: ...
    def gradient(
        self,
        points: _Numbers,
        cells: NDArray[np.int64],
        lambda_: _Numbers,
        mu: _Numbers,
        weights: tuple[_Numbers, _Numbers],
        change: _Inputs | None,
    ) -> _Inputs: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __copy__(self) -> CellConstants: ...
    def __deepcopy__(self, _memo: Any) -> CellConstants: ...

_Given: TypeAlias = tuple[Path | dict[str, Any], Path, dict[str, Any], _Held]
_Springs: TypeAlias = tuple[_Numbers, _Numbers, _Numbers, _Numbers]

@final
class SpringBody:
    def __new__(
        cls,
        points: int,
        dimension: int,
        pairs: NDArray[np.int64],
        blocks: Sequence[tuple[CellConstants, NDArray[np.int64]]],
    ) -> SpringBody: ...
    @staticmethod
    def of_network(network: Network) -> SpringBody: ...
    def at_rest(self, points: _Numbers, numbers: _Springs, held: NDArray[np.bool_]) -> Tangent: ...
    def equilibrium(
        self,
        points: _Numbers,
        numbers: _Springs,
        forces: _Numbers,
        held: NDArray[np.bool_],
        prescribed: _Numbers,
        guess: _Numbers | None,
    ) -> tuple[_Numbers, bool, Tangent]: ...

def spring_numbers(network: Network) -> tuple[NDArray[np.int64], _Springs]: ...
@final
class Tangent:
    @property
    def is_stable(self) -> bool: ...
    def solve(self, forces: _Numbers, prescribed: _Numbers) -> tuple[_Numbers, float]: ...
    def product(self, v: _Numbers) -> _Numbers: ...
    def sensitivities(self, a: _Numbers, u: _Numbers | None = None) -> tuple[_Springs, _Numbers]: ...
    def change(self, numbers: _Springs, points: _Numbers, u: _Numbers | None = None) -> _Numbers: ...


def compare_scene(given: _Given, progress: _Progress | None = None) -> str: ...
def compare_cases(comparison: Any, folder: str | PathLike[str], progress: _Progress | None = None) -> str: ...
def is_comparison(text: str) -> bool: ...
def compare_element(
    element: Element, poisson: float, plane: str | None, shapes: int, iterations: int, progress: _Progress | None = None
) -> str: ...
def converge(
    given: _Given, levels: int | None = None, truth: _Given | None = None, progress: _Progress | None = None
) -> str: ...
def stability(element: Element | None = None, progress: _Progress | None = None) -> str: ...
def stability_of_scene(given: _Given, progress: _Progress | None = None) -> str: ...

_Blocks: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]
_Load: TypeAlias = tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.float64]]

@final
class DistributedBody:
    def __new__(cls, scene: Path | dict[str, Any], folder: Path, settings: dict[str, Any]) -> DistributedBody: ...
    @property
    def source(self) -> tuple[str, Path]: ...
    @property
    def title(self) -> str: ...
    @property
    def fits(self) -> list[str]: ...
    @property
    def loads(self) -> list[str]: ...
    @property
    def counts(self) -> tuple[int, int]: ...
    @property
    def elements(self) -> list[str]: ...
    @property
    def sizes(self) -> list[int]: ...
    @property
    def checksum(self) -> str: ...
    @property
    def is_numbered(self) -> bool: ...
    def points(self, first: int, count: int) -> NDArray[np.float64]: ...
    def numbers(self, first: int, count: int) -> NDArray[np.int64]: ...
    def cells(self, block: int, first: int, count: int) -> NDArray[np.int64]: ...
    def load(self, load: int, first: int, count: int) -> _Load: ...

@final
class BodyShare:
    def __new__(
        cls,
        text: str,
        path: Path,
        settings: dict[str, Any],
        points: NDArray[np.float64],
        blocks: Sequence[tuple[str, NDArray[np.int64]]],
    ) -> BodyShare: ...
    def stiffness(self) -> _Blocks: ...
    def fit(self, fit: int) -> tuple[_Blocks, float, NetworkShare]: ...
    def write(
        self,
        share: NetworkShare,
        path: Path,
        place: tuple[int, int],
        run: tuple[str, int, int, str],
        places: NDArray[np.int64],
        numbers: NDArray[np.int64] | None,
        is_inside: NDArray[np.bool_],
    ) -> None: ...

@final
class NetworkShare: ...
