from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

from ._arrays import Columns, Floats

__all__ = ["Brake", "cea", "check", "cycle", "eig", "eig_in_box", "eigvals", "estimate", "evaluate", "held", "influence", "is_triangle", "main", "merge", "rare", "read_matrices", "run", "screen", "shard", "sweep"]

def main(arguments: Sequence[str]) -> int: ...
def eig(m: Floats, c: Floats, k: Floats) -> dict[str, Any]: ...
def eig_in_box(
    m: Columns,
    c: Columns,
    k: Columns,
    borders: tuple[float, float, float, float],
    is_counted: bool,
    progress: Callable[[str, int, int], object] | None,
) -> dict[str, Any]: ...
def held(m: Columns, c: Columns, k: Columns) -> list[int]: ...
def eigvals(m: Floats, c: Floats, k: Floats, threads: int | None) -> tuple[npt.NDArray[np.complex128], int, str | None]: ...
def check(m: Columns, c: Columns, k: Columns) -> list[dict[str, Any]]: ...
def is_triangle(name: str, matrix: Columns, symmetry: str | None) -> bool: ...
def read_matrices(path: str, symmetry: str | None) -> tuple[list[dict[str, Any]], list[tuple[str, str]]]: ...

@final
class Brake:
    def __new__(cls, path: str, set: list[str], text: str | None, is_open: bool) -> Brake: ...
    def with_run(self, samples: int | None, seed: int | None) -> Brake: ...
    def only(
        self,
        scene: tuple[str | None, list[int] | None, str | None],
        speed: float | None,
        range: str | None,
        is_drawn: bool,
    ) -> Brake: ...
    def with_callable(self, callable: Callable[..., Any], names: list[str]) -> Brake: ...
    def with_design(self, values: Floats) -> Brake: ...
    def parameters(self) -> list[tuple[str, str, float]]: ...
    def notes(self) -> list[str]: ...
    def header(self) -> tuple[str, int, int, list[str]]: ...

_Told = Callable[[str, int, int], object] | None
_AsTable = tuple[str, list[str], list[list[str]]]
_Screening = tuple[list[str] | None, int, tuple[float | None, float | None, float | None, float | None], int, int, str]
_Integers = npt.NDArray[np.int64]

def run(
    brake: Brake,
    out: str,
    half_widths: tuple[float | None, float | None],
    kept: tuple[bool, bool, int | None],
    threads: int | None,
    progress: _Told,
) -> tuple[str, str | None]: ...
def shard(
    brake: Brake, part: tuple[int, int, int], out: str, keep_samples: bool, threads: int | None, progress: _Told
) -> tuple[int, int, int, int]: ...
def merge(
    brake: Brake,
    parts: tuple[list[str], bool, bool],
    out: str,
    half_width: float | None,
    threads: int | None,
    progress: _Told,
) -> tuple[str, str | None]: ...
def estimate(brake: Brake) -> tuple[float, float, float, float]: ...
def cea(brake: Brake, why: bool, json: bool) -> str: ...
def sweep(
    brake: Brake, over: list[tuple[str, float, float]], threads: int | None, progress: _Told
) -> tuple[list[_AsTable], str, str]: ...
def influence(
    brake: Brake, draws: int, total: int | None, threads: int | None, progress: _Told
) -> tuple[_AsTable, int, int, str]: ...
def cycle(
    brake: Brake,
    over: tuple[str, float, float] | None,
    motion: tuple[bool, int | None, int, int, float],
    threads: int | None,
    progress: _Told,
) -> tuple[list[_AsTable], str]: ...
def rare(
    brake: Brake, asked: tuple[float, int, int], threads: int | None, progress: _Told
) -> tuple[list[_AsTable], str, str]: ...
def screen(
    brake: Brake, variants: list[tuple[str, Brake]], screening: _Screening, set: int, threads: int | None, progress: _Told
) -> tuple[list[_AsTable], str, str]: ...
def evaluate(
    brake: Brake, names: list[str], values: Floats, threads: int | None, progress: _Told
) -> tuple[Floats, Floats, _Integers, _Integers, list[tuple[int, str]]]: ...
