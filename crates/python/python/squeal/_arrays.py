"""Arrays as the native functions take them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
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
    if not isinstance(path, str):
        raise refused(argument, repr(given), "a path, as text or pathlib.Path")
    return path


def number(argument: str, given: Any) -> float:
    """A real number."""
    if not isinstance(given, int | float | np.integer | np.floating) or isinstance(given, bool):
        raise refused(argument, given, "a number")
    return float(given)


def _doubles(argument: str, given: Any) -> Floats:
    """An array of doubles as Rust reads them, aligned."""
    # The values below a mask are none.
    if any(map(np.ma.is_masked, given if isinstance(given, list | tuple) else [given])):
        raise refused(argument, "an array with masked entries", "numbers, none masked")
    try:
        array = np.asarray(given)
    except ValueError:
        raise refused(argument, "rows of different lengths", "an array of numbers") from None
    if array.dtype.kind not in "fiub":
        raise refused(argument, f"an array of dtype {array.dtype}", "real numbers")
    return np.require(np.asarray(array, dtype=np.float64), requirements="A")


def _not_finite(argument: str, place: Sequence[int], value: np.float64) -> ArgumentError:
    at = ", ".join(str(int(index)) for index in place)
    return refused(f"{argument}[{at}]" if at else argument, value, "a finite number")


def real(argument: str, given: Any) -> Floats:
    """An array of finite doubles."""
    array = _doubles(argument, given)
    if not np.isfinite(array).all():
        place = tuple(np.argwhere(~np.isfinite(array))[0])
        raise _not_finite(argument, place, array[place])
    return array


def _square(argument: str, shape: tuple[int, ...], order: int | None) -> None:
    if len(shape) != 2 or shape[0] != shape[1] or shape[0] == 0:
        raise refused(argument, f"an array of shape {shape}", "a square matrix")
    if order is not None and shape[0] != order:
        raise refused(argument, f"an array of shape {shape}", f"{(order, order)}, as M has")


def dense(argument: str, given: Any, order: int | None = None) -> Floats:
    """A square matrix as an array."""
    array = real(argument, given.toarray() if is_sparse(given) else given)
    _square(argument, array.shape, order)
    return array


def columns(argument: str, given: Any, order: int | None = None) -> Columns:
    """A square matrix in compressed columns."""
    if is_sparse(given):
        _square(argument, given.shape, order)
        csc = given.tocsc(copy=True)
        csc.sum_duplicates()
        values = _doubles(argument, csc.data)
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
    matrix = given.tocsc() if is_sparse(given) else real(argument, given)
    listed = matrix if matrix.ndim == 2 else (matrix != 0).any(axis=tuple(range(matrix.ndim - 2)))
    if not _squeal.is_triangle(argument, columns(argument, listed), symmetry):
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
