"""Eigenvalues of lambda^2 M + lambda C + K."""

from __future__ import annotations

import enum
import os
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _squeal
from ._arrays import Columns, Floats, Symmetry, columns, dense, flag, is_sparse, none_of, number, path_of, real, text, whole, without
from ._errors import CaseWarning, FailureWarning, refused
from ._frozen import Frozen, frozen
from ._progress import Progress, receiver

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

Complexes = npt.NDArray[np.complex128]
TAU = 2 * np.pi
#: Most degrees of freedom of sparse matrices that are made dense where no box is given.
_MADE_DENSE = 1000
#: Largest border of a box, rad/s.
_LARGEST_BORDER = 1e12


class Verdict(enum.IntEnum):
    """Whether a motion grows, as far as the bound of its eigenvalue tells."""

    #: Re lambda is below zero by more than its bound.
    STABLE = 0
    #: Re lambda is above zero by more than its bound.
    UNSTABLE = 1
    #: Re lambda is zero to within what rounding the matrices to doubles may move it by.
    MARGINAL = 2
    #: The sign of Re lambda could not be settled.
    UNDECIDED = 3


@dataclass(frozen=True)
class Cluster:
    """Eigenvalues that belong together."""

    #: "semisimple", "defective" or "nearly-defective".
    kind: str
    #: Indices of the eigenvalues.
    members: tuple[int, ...]
    #: Mean of the eigenvalues, rad/s.
    mean: complex
    #: Their largest distance from the mean, rad/s.
    spread: float


@dataclass(frozen=True)
class Disc:
    """A disc of the complex plane in which all eigenvalues are known."""

    #: Centre, rad/s.
    centre: complex
    #: Radius, rad/s.
    radius: float
    #: Number of eigenvalues in it.
    eigenvalues: int


@dataclass(frozen=True)
class Coverage:
    """Why the eigenvalues of a box are all that it has."""

    #: Borders ((re from, re to), (im from, im to)), rad/s.
    box: tuple[tuple[float, float], tuple[float, float]]
    #: Discs that cover the box; none where the whole spectrum was certified.
    discs: tuple[Disc, ...]
    #: Second count: "argument-principle", "second-block", or "not" where there was none.
    counted: str
    #: Number of sparse factorisations.
    factorisations: int
    #: Number of right-hand sides solved.
    solves: int


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(Frozen):
    """Eigenvalues, each with what is known of its error; arrays of one length k, by frequency."""

    #: Eigenvalues lambda, rad/s, (k,).
    eigenvalues: Complexes
    #: Bound of the error of each, rad/s, (k,); infinite where nothing is known.
    bounds: Floats
    #: Backward error of each with its right vector, (k,).
    backward_errors: Floats
    #: Condition number of each, (k,).
    conditions: Floats
    #: `Verdict` of each, (k,).
    verdicts: npt.NDArray[np.int8]
    #: Right eigenvectors, (n, k), unit 2-norm.
    right: Complexes
    #: Left eigenvectors, (n, k), unit 2-norm; None unless they were asked for.
    left: Complexes | None
    #: Whether the border of the box is within the bound of each, (k,).
    on_border: npt.NDArray[np.bool_]
    #: How they were found.
    route: str
    #: Rows, from 0, that were taken out because huge entries hold them; the vectors are zero there.
    held: tuple[int, ...]
    #: Number of infinite eigenvalues, of a singular M; None with a box.
    infinite: int | None
    #: Number of eigenvalues that are exactly zero; None with a box.
    zeros: int | None
    #: Eigenvalues that belong together; none with a box.
    clusters: tuple[Cluster, ...]
    #: Why these are all of a box; None without one.
    coverage: Coverage | None

    def __len__(self) -> int:
        return len(self.eigenvalues)

    @property
    def frequencies_hz(self) -> Floats:
        """Im lambda / 2 pi, Hz."""
        return _kept(self.eigenvalues.imag / TAU)

    @property
    def growth(self) -> Floats:
        """Re lambda, 1/s."""
        return _kept(self.eigenvalues.real)

    @property
    def damping_ratios(self) -> Floats:
        """``-Re lambda / |lambda|``, negative where a motion grows; NaN of lambda = 0."""
        size = np.abs(self.eigenvalues)
        ratios = np.full(len(self), np.nan)
        np.divide(-self.eigenvalues.real, size, out=ratios, where=size > 0)
        return _kept(ratios)

    @property
    def unstable(self) -> npt.NDArray[np.bool_]:
        """Which are unstable, as a mask."""
        return _kept(self.verdicts == Verdict.UNSTABLE)

    @property
    def stable(self) -> npt.NDArray[np.bool_]:
        """Which are stable, as a mask."""
        return _kept(self.verdicts == Verdict.STABLE)

    def to_structured(self) -> npt.NDArray[np.void]:
        """One record for each eigenvalue."""
        parts: dict[str, npt.NDArray[Any]] = {
            "lambda": self.eigenvalues,
            "bound": self.bounds,
            "backward_error": self.backward_errors,
            "condition": self.conditions,
            "verdict": self.verdicts,
            "frequency_hz": self.frequencies_hz,
            "damping": self.damping_ratios,
        }
        records = np.empty(len(self), dtype=[(name, part.dtype) for name, part in parts.items()])
        for name, part in parts.items():
            records[name] = part
        return records

    def to_pandas(self) -> pandas.DataFrame:
        """One row for each eigenvalue; verdicts in words."""
        import pandas

        table = pandas.DataFrame(self.to_structured())
        table["verdict"] = [Verdict(verdict).name.lower() for verdict in self.verdicts]
        return table

    def plot(self, ax: Axes | None = None) -> Axes:
        """Damping ratio against frequency of what oscillates; red where it grows."""
        from .plot import spectrum

        shown = self.eigenvalues.imag > 0
        return spectrum(self.frequencies_hz[shown], self.damping_ratios[shown], self.unstable[shown], ax)

    def __str__(self) -> str:
        """The table of `squeal eig`."""
        titles = ("Re lambda, rad/s", "Im lambda, rad/s", "f, Hz", "damping", "backward", "condition")
        lines = [_ROW.format("no.", *titles, "verdict")]
        for at, value in enumerate(self.eigenvalues):
            said = Verdict(self.verdicts[at]).name.lower() + (", on the border" if self.on_border[at] else "")
            damping = self.damping_ratios[at] if value != 0 else 0.0
            errors = (_decimal(of[at], 1) for of in (self.backward_errors, self.conditions))
            parts = (_decimal(value.real, 16), _decimal(value.imag, 16), f"{self.frequencies_hz[at]:.6f}", _decimal(damping, 4))
            lines.append(_ROW.format(at + 1, *parts, *errors, said))
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"Spectrum({len(self)} eigenvalues, {self.unstable.sum()} unstable, route {self.route!r})"


#: A line of the table of `squeal eig`.
_ROW = "{:>5} {:>24} {:>24} {:>14} {:>12} {:>9} {:>9}  {}"


def _decimal(value: float, digits: int) -> str:
    """A number with an exponent, as the program prints it."""
    mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa.replace("nan", "NaN")


def _kept(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """An array that is not written to."""
    made: npt.NDArray[Any] = frozen(np.asarray(array))
    return made


Box = tuple[tuple[float, float], tuple[float, float]]


def _borders(box: Box | None, band_hz: tuple[float, float] | None) -> Box | None:
    if box is not None and band_hz is not None:
        raise refused("band_hz", "given beside `box`", "one of them")
    if band_hz is not None:
        try:
            low, high = (TAU * number("band_hz", hertz) for hertz in band_hz)
        except (TypeError, ValueError):
            raise refused("band_hz", band_hz, "(from, to) in Hz") from None
        # Faster growth or decay than the highest frequency is no vibration.
        name, given, box = "band_hz", band_hz, ((-high, high), (low, high))
    elif box is not None:
        name, given = "box", box  # type: ignore[assignment]
    else:
        return None
    try:
        (re0, re1), (im0, im1) = ((number("box", a), number("box", b)) for a, b in box)
    except (TypeError, ValueError):
        raise refused("box", box, "((re from, re to), (im from, im to)) in rad/s") from None
    borders = (re0, re1, im0, im1)
    if not (re0 < re1 and im0 < im1 and all(abs(border) <= _LARGEST_BORDER for border in borders)):
        raise refused(name, given, f"each first below its second, none above {_LARGEST_BORDER:g} rad/s")
    return (re0, re1), (im0, im1)


def eig(
    M: Any,
    C: Any,
    K: Any,
    *,
    box: Box | None = None,
    band_hz: tuple[float, float] | None = None,
    rightmost: int | None = None,
    count: bool = False,
    left: bool = False,
    symmetry: Symmetry = None,
    progress: Progress = None,
) -> Spectrum:
    """Eigenvalues of lambda^2 M + lambda C + K, each with a bound of its error.

    M, C, K are square matrices of NumPy or SciPy of one order; `C` may be None. Without `box` or `band_hz` all eigenvalues are found by
    dense matrices (sparse ones are made dense up to 1000 degrees of freedom) and certified up to rounding; M may be singular. With
    `box`, ((re from, re to), (im from, im to)) in rad/s, those of the rectangle are, of more than 300 degrees of freedom by sparse
    matrices. `band_hz=(from, to)` is the box of these frequencies in which nothing grows or decays faster than the highest of them.
    `rightmost` keeps so many of a box, those of largest Re lambda, that first. `count` counts what is in the box a second time however
    long that takes. `left` adds the left eigenvectors. A matrix with entries on one side of the diagonal alone is refused until
    `symmetry` says what it is, "whole", or "upper", "lower" or "triangle" to be mirrored; a dict says it of each, as `{"K": "upper"}`.
    """
    borders = _borders(box, band_hz)
    count, left, told = flag("count", count), flag("left", left), receiver(progress)
    for name, given in (("rightmost", rightmost is not None), ("count", count)):
        if given and borders is None:
            raise refused(name, "given", "with `box` or `band_hz`")
    if rightmost is not None and not (isinstance(rightmost, int | np.integer) and rightmost >= 1):
        raise refused("rightmost", repr(rightmost), "a whole number, at least 1")
    if borders is None:
        for name, matrix in (("M", M), ("C", C), ("K", K)):
            if is_sparse(matrix) and max(matrix.shape) > _MADE_DENSE:
                raise refused(name, f"a sparse matrix of shape {matrix.shape}", "at most 1000 without `box` or `band_hz`")
        m = dense("M", whole("M", M, symmetry))
        c = np.zeros_like(m) if C is None else dense("C", whole("C", C, symmetry), len(m))
        k = dense("K", whole("K", K, symmetry), len(m))
        held = _held(columns("M", m), columns("C", c), columns("K", k))
        m, c, k = (np.delete(np.delete(matrix, held, 0), held, 1) for matrix in (m, c, k))
        found = _squeal.eig(m, c, k)
        coverage = None
    else:
        first = columns("M", whole("M", M, symmetry))
        damping = none_of(first[0]) if C is None else columns("C", whole("C", C, symmetry), first[0])
        all_of = [first, damping, columns("K", whole("K", K, symmetry), first[0])]
        held = _held(*all_of)
        (re0, re1), (im0, im1) = borders
        m_few, c_few, k_few = (without(matrix, held) for matrix in all_of)
        found = _squeal.eig_in_box(m_few, c_few, k_few, (re0, re1, im0, im1), count, told)
        discs = tuple(Disc(*disc) for disc in found["discs"])
        coverage = Coverage(borders, discs, found["counted"], found["factorisations"], found["solves"])
    at = np.arange(len(found["eigenvalues"]))
    if rightmost is not None:
        at = np.lexsort((found["eigenvalues"].imag, -found["eigenvalues"].real))[:rightmost]
    parts = {name: found[name][at] for name in ("eigenvalues", "bounds", "backward_errors", "conditions", "verdicts", "on_border")}
    return Spectrum(
        **parts,
        right=_with_held(found["right"][:, at], held),
        left=_with_held(found["left"][:, at], held) if left else None,
        held=held,
        route=found["route"],
        infinite=found.get("infinite"),
        zeros=found.get("zeros"),
        clusters=tuple(Cluster(kind, tuple(who), mean, spread) for kind, who, mean, spread in found.get("clusters", ())),
        coverage=coverage,
    )


def _held(*matrices: Columns) -> tuple[int, ...]:
    """Rows of M, C and K that huge entries hold; what is left has no digits beside them."""
    held = tuple(_squeal.held(*matrices))
    if len(held) == matrices[0][0]:
        raise refused("K", "all degrees of freedom held by huge entries", "one or more that are not")
    if held:
        warnings.warn(f"rows {', '.join(map(str, held))} are held by huge entries and taken out", CaseWarning, stacklevel=3)
    return held


def _with_held(vectors: Complexes, held: tuple[int, ...]) -> Complexes:
    """Vectors over all rows, zero in those that were taken out."""
    if not held:
        return vectors
    whole = np.zeros((len(vectors) + len(held), vectors.shape[1]), np.complex128, order="F")
    whole[np.setdiff1d(np.arange(len(whole)), held)] = vectors
    return whole


def eigvals(M: Any, C: Any, K: Any, *, symmetry: Symmetry = None, threads: int | None = None) -> Complexes:
    """Eigenvalues of stacks of systems, (..., 2 n), over all cores; no bounds.

    Those of a system ascend by ``|Im lambda|``, then Re lambda, then Im lambda: real ones first, conjugates next to each other. A column is
    no mode: where frequencies cross, modes change places.
    M, C, K are arrays (..., n, n) whose leading dimensions are broadcast against each other; `C` may be None. A system that the solver
    refuses, as one whose M is singular, has NaN, and there is a `FailureWarning`; `eig` takes those. `symmetry` as in `eig`, of what
    all matrices of a stack have entries in.
    """
    m, k = real("M", M), real("K", K)
    c = np.zeros_like(m) if C is None else real("C", C)
    for name, array in (("M", m), ("C", c), ("K", k)):
        if array.ndim < 2 or array.shape[-1] != array.shape[-2] or array.shape[-1] == 0:
            raise refused(name, f"an array of shape {array.shape}", "(..., n, n)")
    try:
        shape = np.broadcast_shapes(m.shape, c.shape, k.shape)
    except ValueError:
        raise refused("M, C, K", f"arrays of shapes {m.shape}, {c.shape}, {k.shape}", "shapes that broadcast") from None
    n = shape[-1]
    if not m.shape[-1] == c.shape[-1] == k.shape[-1]:
        raise refused("M, C, K", f"matrices of orders {m.shape[-1]}, {c.shape[-1]}, {k.shape[-1]}", "one order")
    if 0 in shape[:-2]:
        return np.empty((*shape[:-2], 2 * n), np.complex128)
    m, c, k = whole("M", m, symmetry), whole("C", c, symmetry), whole("K", k, symmetry)
    stacks = [np.broadcast_to(array, shape).reshape(-1, n, n) for array in (m, c, k)]
    values, failed, first = _squeal.eigvals(stacks[0], stacks[1], stacks[2], workers(threads))
    if failed:
        warnings.warn(f"{failed} of {len(values)} systems have no eigenvalues here; first: {first}", FailureWarning, stacklevel=2)
    return np.asarray(values.reshape(*shape[:-2], 2 * n))


def workers(threads: int | None) -> int | None:
    """A number of worker threads that is allowed."""
    if threads is not None and not (isinstance(threads, int | np.integer) and 1 <= threads <= 1024):
        raise refused("threads", repr(threads), "1 to 1024, or None for one a core")
    return None if threads is None else int(threads)


@dataclass(frozen=True, eq=False)
class MatrixHealth(Frozen):
    """What a matrix is, as far as it matters for a model."""

    #: Entries that are not zero.
    entries: int
    #: The largest ``|a_ij - a_ji|`` as a part of the largest ``|a_ij|``: 0 for a symmetric matrix, 2 for an antisymmetric one.
    asymmetry: float
    #: Rows, from 0, without an entry, neither in their column.
    empty_rows: npt.NDArray[np.int64]
    #: Numbers of negative, null and positive eigenvalues of the symmetric part, scaled; None where they are not known, as of a saddle point.
    signs: tuple[int, int, int] | None
    #: The eigenvalue of the scaled symmetric part that is nearest to zero, as a part of its norm.
    smallest: float
    #: Rows, from 0, that motions move which the matrix does not resist, those of the largest share first.
    null_rows: npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Health:
    """What the matrices of a system are."""

    #: Of M.
    mass: MatrixHealth
    #: Of C.
    damping: MatrixHealth
    #: Of K.
    stiffness: MatrixHealth


def check(M: Any, C: Any, K: Any) -> Health:
    """Symmetry, definiteness and singular rows of M, C (may be None) and K, dense or sparse."""
    m = columns("M", M)
    c = none_of(m[0]) if C is None else columns("C", C, m[0])
    return Health(*(MatrixHealth(**found) for found in _squeal.check(m, c, columns("K", K, m[0]))))


@dataclass(frozen=True, eq=False, repr=False)
class Matrix(Frozen):
    """A matrix of a file."""

    #: Name in the file.
    name: str
    #: "mass", "damping" or "stiffness", where the file says it.
    kind: str | None
    #: Number of rows and columns.
    shape: tuple[int, int]
    #: Row of each entry, from 0; entries are sorted by column, then row, without repeats.
    rows: npt.NDArray[np.int64]
    #: Column of each entry, from 0.
    columns: npt.NDArray[np.int64]
    #: Value of each entry.
    values: Floats
    #: Names of the rows, as "1042.z", where the file has them.
    labels: tuple[str, ...] | None
    #: How the entries were taken, in words.
    taken: str

    def toarray(self) -> Floats:
        """The matrix as an array."""
        array = np.zeros(self.shape)
        array[self.rows, self.columns] = self.values
        return array

    def tocsc(self, copy: bool = False) -> Any:
        """The matrix as a `scipy.sparse.csc_array`, always a copy."""
        import scipy.sparse

        return scipy.sparse.csc_array((self.values, (self.rows, self.columns)), shape=self.shape)

    def __repr__(self) -> str:
        return f"Matrix({self.name!r}, {self.shape[0]} x {self.shape[1]}, {len(self.values)} entries)"


@dataclass(frozen=True, eq=False)
class Matrices:
    """The matrices of a file: a mapping by name, or by kind."""

    #: All of them, in the order of the file.
    all: tuple[Matrix, ...]
    #: Names of what else is in the file, each with the reason why it was left out.
    left_out: tuple[tuple[str, str], ...]

    def __len__(self) -> int:
        return len(self.all)

    def __iter__(self) -> Iterator[str]:
        return (matrix.name for matrix in self.all)

    def __contains__(self, name: object) -> bool:
        return any(name in (matrix.name, matrix.kind) for matrix in self.all)

    def keys(self) -> Sequence[str]:
        """Names of the matrices."""
        return list(self)

    def __getitem__(self, name: str) -> Matrix:
        for matrix in self.all:
            if name in (matrix.name, matrix.kind):
                return matrix
        raise KeyError(f"{name!r}; the file has {', '.join(self)}")


def read_matrices(path: str | os.PathLike[str], *, symmetry: str | None = None) -> Matrices:
    """The matrices of a file: Matrix Market, CalculiX, Abaqus, Nastran, MATLAB, NumPy, Harwell-Boeing, plain or compressed by gzip.

    By the name in the file, or by "mass", "damping", "stiffness" where it says so. `symmetry`, "whole", "upper", "lower" or "triangle", says how
    matrices are stored of which the file does not say it; without it a list on one side of the diagonal is refused.
    """
    said = None if symmetry is None else text("symmetry", symmetry)
    found, left_out = _squeal.read_matrices(path_of("path", path), said)
    matrices = []
    for parts in found:
        for doubt in parts.pop("doubts"):
            warnings.warn(f"{path_of('path', path)}: {doubt}", CaseWarning, stacklevel=2)
        labels = parts.pop("labels")
        matrices.append(Matrix(**parts, labels=None if labels is None else tuple(labels)))
    return Matrices(tuple(matrices), tuple(left_out))
