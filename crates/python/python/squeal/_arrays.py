"""Arrays as the native functions take them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _squeal
from ._errors import ArgumentError, refused

Floats = npt.NDArray[np.float64]
Columns = tuple[int, npt.NDArray[np.int64], npt.NDArray[np.int64], Floats]
#: How matrices are stored, "whole", "upper", "lower" or "triangle": all of them, or each by its name.
Symmetry = str | Mapping[str, str] | None


def is_sparse(matrix: object) -> bool:
    """Whether a matrix is one of scipy.sparse, which need not be installed."""
    return hasattr(matrix, "tocsc") and hasattr(matrix, "shape")


def path_of(argument: str, given: Any) -> str:
    """A path as text."""
    try:
        path = os.fspath(given)
    except TypeError:
        path = None
    if not isinstance(path, str) or not path or "\0" in path:
        raise refused(argument, repr(given), "a path, as text or pathlib.Path")
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        raise refused(argument, ascii(path), "a path that the system can have") from None
    return path


def number(argument: str, given: Any) -> float:
    """A real number."""
    if not isinstance(given, int | float | np.integer | np.floating) or isinstance(given, bool):
        raise refused(argument, given if isinstance(given, np.generic) else repr(given), "a number")
    try:
        return float(given)
    except OverflowError:
        raise refused(argument, given, "a number that a double has") from None


def text(argument: str, given: Any) -> str:
    """A text, of Unicode."""
    if not isinstance(given, str):
        raise refused(argument, repr(given), "text")
    try:
        given.encode()
    except UnicodeEncodeError:
        raise refused(argument, ascii(given), "text that is Unicode") from None
    return given


def flag(argument: str, given: Any) -> bool:
    """A truth value."""
    if not isinstance(given, bool | np.bool_):
        raise refused(argument, repr(given), "True or False")
    return bool(given)


def listed(argument: str, given: Any, of: str) -> list[Any]:
    """A list of things that are said what they are of; a text is none, nor is a mapping."""
    if isinstance(given, str | bytes | Mapping) or not isinstance(given, Iterable):
        raise refused(argument, repr(given), f"a list of {of}")
    try:
        return list(given)
    except TypeError:
        raise refused(argument, repr(given), f"a list of {of}") from None


def names(argument: str, given: Any, of: str) -> list[str]:
    """A list of names."""
    return [text(argument, name) for name in listed(argument, given, of)]


def mapped(argument: str, given: Any, of: str) -> Mapping[str, Any]:
    """A mapping from names."""
    if not isinstance(given, Mapping):
        raise refused(argument, repr(given), f"a dict from names to {of}")
    for name in given:
        text(argument, name)
    return given


def doubles(argument: str, given: Any) -> Floats:
    """An array of doubles as Rust reads them, aligned."""
    # The values below a mask are none.
    if any(map(np.ma.is_masked, given if isinstance(given, list | tuple) else [given])):
        raise refused(argument, "an array with masked entries", "numbers, none masked")
    try:
        array = np.asarray(given)
    except ValueError:
        raise refused(argument, "rows of different lengths", "an array of numbers") from None
    except Exception as error:
        raise refused(argument, f"{type(given).__name__} that is no array ({error})", "an array of numbers") from None
    if array.dtype.kind not in "fiub":
        raise refused(argument, f"an array of dtype {array.dtype}", "real numbers")
    return np.require(np.asarray(array, dtype=np.float64), requirements="A")


def _not_finite(argument: str, place: Sequence[int], value: np.float64) -> ArgumentError:
    at = ", ".join(str(int(index)) for index in place)
    return refused(f"{argument}[{at}]" if at else argument, value, "a finite number")


def real(argument: str, given: Any) -> Floats:
    """An array of finite doubles."""
    array = doubles(argument, given)
    if not np.isfinite(array).all():
        place = tuple(np.argwhere(~np.isfinite(array))[0])
        raise _not_finite(argument, place, array[place])
    return array


def _square(argument: str, shape: tuple[int, ...], order: int | None) -> None:
    if len(shape) != 2 or shape[0] != shape[1] or shape[0] == 0:
        raise refused(argument, f"an array of shape {shape}", "a square matrix")
    if order is not None and shape[0] != order:
        raise refused(argument, f"an array of shape {shape}", f"{(order, order)}, as M has")


def _sound(argument: str, given: Any) -> None:
    """Refuses a matrix of scipy.sparse whose parts do not fit each other: SciPy reads and writes beyond them, or drops entries."""
    layout, shape = getattr(given, "format", None), given.shape
    if len(shape) != 2:
        raise refused(argument, f"an array of shape {shape}", "a square matrix")
    if layout in ("csr", "csc", "bsr"):
        rows, columns = (size // block for size, block in zip(shape, getattr(given, "blocksize", (1, 1)), strict=True))
        major, minor = (columns, rows) if layout == "csc" else (rows, columns)
        offsets, count = given.indptr, min(len(given.indices), len(given.data))
        fits = len(offsets) == major + 1 and offsets[0] == 0 and bool(np.all(offsets[:-1] <= offsets[1:])) and offsets[-1] <= count
        if not fits:
            raise refused(f"{argument}.indptr", "offsets that do not fit the entries", f"{major + 1} that ascend from 0 to at most {count}")
        indices, most = {"indices": given.indices[: offsets[-1]]}, {"indices": minor}
    elif layout == "coo":
        indices, most = {"row": given.row, "col": given.col}, {"row": shape[0], "col": shape[1]}
        if not len(given.row) == len(given.col) == len(given.data):
            raise refused(argument, "row, col and data of different lengths", "one of each for an entry")
    else:
        return
    for name, of in indices.items():
        outside = np.flatnonzero((of < 0) | (of >= most[name]))
        if outside.size:
            raise refused(f"{argument}.{name}[{outside[0]}]", of[outside[0]], f"0 to {most[name] - 1}")


def dense(argument: str, given: Any, order: int | None = None) -> Floats:
    """A square matrix as an array."""
    if is_sparse(given):
        _sound(argument, given)
    array = real(argument, given.toarray() if is_sparse(given) else given)
    _square(argument, array.shape, order)
    return array


def columns(argument: str, given: Any, order: int | None = None) -> Columns:
    """A square matrix in compressed columns."""
    if is_sparse(given):
        _sound(argument, given)
        _square(argument, given.shape, order)
        csc = given.tocsc(copy=True)
        csc.sum_duplicates()
        values = doubles(argument, csc.data)
        if not np.isfinite(values).all():
            entry = int(np.argmin(np.isfinite(values)))
            column = int(np.searchsorted(csc.indptr, entry, side="right")) - 1
            raise _not_finite(argument, (csc.indices[entry], column), values[entry])
        return csc.shape[0], csc.indptr.astype(np.int64), csc.indices.astype(np.int64), values
    array = dense(argument, given, order)
    rows, places = np.nonzero(array.T)
    offsets = np.searchsorted(rows, np.arange(array.shape[0] + 1))
    return array.shape[0], offsets.astype(np.int64), places.astype(np.int64), array.T[rows, places]


def whole(argument: str, given: Any, symmetry: Symmetry) -> Any:
    """A matrix, or a stack of them, as the whole that it is said to be a triangle of; where nothing tells, it is refused."""
    if isinstance(symmetry, Mapping):
        for name in symmetry:
            if name not in ("M", "C", "K"):
                raise refused("symmetry", f"a word on {name!r}", "words on M, C, K")
        symmetry = symmetry.get(argument)
    if symmetry is not None and not isinstance(symmetry, str):
        raise refused("symmetry", repr(symmetry), "whole, upper, lower or triangle, or a dict from M, C, K to these")
    said = None if symmetry is None else text("symmetry", symmetry)
    if is_sparse(given):
        _sound(argument, given)
    matrix = given.tocsc() if is_sparse(given) else real(argument, given)
    entries = matrix if matrix.ndim == 2 else (matrix != 0).any(axis=tuple(range(matrix.ndim - 2)))
    if not _squeal.is_triangle(argument, columns(argument, entries), said):
        return matrix
    if is_sparse(matrix):
        import scipy.sparse

        return matrix + matrix.T - scipy.sparse.diags(matrix.diagonal())
    return np.where(np.eye(matrix.shape[-1], dtype=bool), matrix, matrix + np.swapaxes(matrix, -1, -2))


def none_of(order: int) -> Columns:
    """A matrix of zeros in compressed columns."""
    return order, np.zeros(order + 1, np.int64), np.zeros(0, np.int64), np.zeros(0)


def without(matrix: Columns, rows: tuple[int, ...]) -> Columns:
    """A matrix without some rows and these columns."""
    if not rows:
        return matrix
    order, offsets, places, values = matrix
    is_kept = np.ones(order, dtype=bool)
    is_kept[list(rows)] = False
    number = np.cumsum(is_kept) - 1
    of_columns = np.repeat(np.arange(order), np.diff(offsets))
    kept = is_kept[places] & is_kept[of_columns]
    few = order - len(rows)
    counts = np.bincount(number[of_columns[kept]], minlength=few)
    return few, np.concatenate(([0], np.cumsum(counts))).astype(np.int64), number[places[kept]].astype(np.int64), values[kept]
