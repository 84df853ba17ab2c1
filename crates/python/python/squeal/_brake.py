"""Brakes: of a case file, and of arrays."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _squeal, _toml
from ._arrays import Floats, dense, doubles, listed, mapped, names as names_of, number, path_of, real, text
from ._errors import CaseWarning, refused
from .distributions import Distribution

#: A number, or an expression in the parameters.
Formula = float | str
#: From the parameters of a block of samples, arrays of one length, to the coefficients that it computes, arrays or numbers.
Coefficients = Callable[[dict[str, Floats]], Mapping[str, npt.ArrayLike]]


_Made = tuple[str, list[str], str | None, Coefficients | None, list[str] | None, int | None, int | None]


class AnyBrake:
    """What a study, a sweep and the like are asked of."""

    _native: _squeal.Brake
    #: What `_native` is made of: path, what is set in it, text, callable and what it computes, samples, seed.
    _made: _Made

    def _make(self, made: _Made) -> None:
        self._made = made
        path, set_, text, coefficients, names, samples, seed = made
        native = _squeal.Brake(path, set_, text, coefficients is not None)
        if coefficients is not None and names is not None:
            native = native.with_callable(coefficients, names)
        self._native = native.with_run(samples, seed)

    def __getstate__(self) -> dict[str, Any]:
        """For other processes, as those of Dask, Ray or multiprocessing; a callable must be one that these can have."""
        return {key: of for key, of in self.__dict__.items() if key != "_native"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._make(self._made)

    @property
    def name(self) -> str:
        """Name of the study."""
        return self._native.header()[0]

    @property
    def samples(self) -> int:
        """Samples of a study."""
        return self._native.header()[1]

    @property
    def seed(self) -> int:
        """Seed of a study."""
        return self._native.header()[2]

    @property
    def constraint_sets(self) -> list[str]:
        """Names of the sets of constraints."""
        return self._native.header()[3]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, samples={self.samples}, seed={self.seed})"


class Case(AnyBrake):
    """The brake of a case file, of any kind.

    `samples` and `seed` stand for those of the file. `set` sets parameters by their names, and fields as `--set` does, those of a list of
    tables by the name of the table: `set={"mu": 0.3, "c": squeal.Uniform(1, 2), "terms.springs.coefficient": "1.1 * E"}`.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        samples: int | None = None,
        seed: int | None = None,
        set: Mapping[str, Any] | None = None,
    ) -> None:
        self.path = path_of("path", path)
        run = (_whole("samples", samples, 1), _whole("seed", seed, 0))
        fields = {} if set is None else mapped("set", set, "values of these fields")
        settings = [_setting(field, value) for field, value in fields.items()]
        self._make((self.path, settings, None, None, None, *run))
        for note in self._native.notes():
            warnings.warn(note, CaseWarning, stacklevel=2)


def _whole(argument: str, given: int | None, least: int, bits: int = 64) -> int | None:
    if given is not None and (isinstance(given, bool) or not (isinstance(given, int | np.integer) and least <= given < 2**bits)):
        raise refused(argument, repr(given), f"a whole number, at least {least} and below 2^{bits}")
    return None if given is None else int(given)


def _setting(field: str, value: Any) -> str:
    """A field that is set, as `NAME=VALUE`."""
    try:
        return text("set", f"{field}={_toml.value(value.table() if isinstance(value, Distribution) else value)}")
    except TypeError as error:
        raise refused("set", f"{field!r}: {error}", "numbers, text, lists, distributions") from None


@dataclass(frozen=True)
class Term:
    """A term of the structure: theta (lambda^2 mass + lambda damping + stiffness)."""

    name: str
    #: Matrices of NumPy or SciPy; None is zero.
    mass: Any = None
    damping: Any = None
    stiffness: Any = None
    #: The factor theta, 1 unless given: a number or an expression in the parameters.
    coefficient: Formula | None = None
    #: Name of its family of forces, where that is not `name`.
    family: str | None = None
    #: Storage of its matrices, "whole", "upper", "lower" or "triangle" to be mirrored: to be said of entries on one side of the diagonal alone.
    symmetry: str | Mapping[str, str] | None = None


@dataclass(frozen=True)
class Lag:
    """An internal state z' = -decay z + drive v, which adds the force `force` z to friction."""

    decay: Formula
    drive: Formula
    force: Formula


@dataclass(frozen=True)
class Contact:
    """A contact with friction: the force mu times the reading along `force`."""

    name: str
    #: Direction of the friction force, by names of degrees of freedom.
    force: Mapping[str, float]
    #: What the normal load depends on, N/m, by names of degrees of freedom.
    reading: Mapping[str, float] | None = None
    #: Coefficient of friction.
    mu: Formula | None = None
    #: Normal load times the slope of the coefficient over the sliding velocity, Ns/m.
    slope: Formula | None = None
    #: An internal state, such as the bristle of a LuGre contact.
    lag: Lag | None = None
    #: Name of its family of forces, where that is not `name`.
    family: str | None = None


class Brake(AnyBrake):
    """A brake of arrays: terms with matrices, friction contacts, and parameters that are drawn.

    `coefficients` is a callable by blocks: it gets a dict from the names of the parameters to arrays of one length, and returns a dict
    from names of terms, `"CONTACT.mu"` and `"CONTACT.slope"` to arrays of that length or numbers; it may be called by several threads,
    one at a time. What it does not return has its expressions. `tables` maps names of functions that expressions call to their points
    (at, value), two arrays. `correlation` is (names of parameters, matrix) for a Gaussian copula,
    `constraints` maps names of sets to names of degrees of freedom, `bodies` likewise. A growing mode counts as unstable from a growth
    rate `growth_above`, 1/s, and a damping ratio `damping_ratio_below` on. `text` is the brake as a case file, without `coefficients`.
    """

    def __init__(
        self,
        *,
        terms: Sequence[Term],
        contacts: Sequence[Contact] = (),
        parameters: Mapping[str, Distribution] | None = None,
        tables: Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]] | None = None,
        dofs: Sequence[str] | None = None,
        coefficients: Coefficients | None = None,
        correlation: tuple[Sequence[str], npt.ArrayLike] | None = None,
        constraints: Mapping[str, Sequence[str]] | None = None,
        bodies: Mapping[str, Sequence[str]] | None = None,
        growth_above: float | None = None,
        damping_ratio_below: float | None = None,
        name: str = "brake",
        samples: int = 1000,
        seed: int = 1,
    ) -> None:
        parameters, tables, bodies, constraints = (
            {} if given is None else mapped(argument, given, of)
            for argument, given, of in (
                ("parameters", parameters, "distributions"),
                ("tables", tables, "points (at, value)"),
                ("bodies", bodies, "lists of degrees of freedom"),
                ("constraints", constraints, "lists of degrees of freedom"),
            )
        )
        terms, contacts = listed("terms", terms, "squeal.Term"), listed("contacts", contacts, "squeal.Contact")
        for argument, parts, kind in (("terms", terms, Term), ("contacts", contacts, Contact)):
            for part in parts:
                if not isinstance(part, kind):
                    raise refused(argument, repr(part), f"a list of squeal.{kind.__name__}")
        for parameter, distribution in parameters.items():
            if not isinstance(distribution, Distribution):
                raise refused(f"parameters[{parameter!r}]", repr(distribution), "a distribution, as squeal.Uniform(0, 1)")
        if not terms:
            raise refused("terms", terms, "one squeal.Term or more")
        study: dict[str, Any] = {"name": text("name", name)}
        for argument, given, least in (("samples", samples, 1), ("seed", seed, 0)):
            # Case files have whole numbers of 63 bits.
            study[argument] = _whole(argument, least - 1 if given is None else given, least, 63)
        document: dict[str, Any] = {"study": study, "brake": {"kind": "matrices"}}
        if dofs is not None:
            document["brake"]["dofs"] = names_of("dofs", dofs, "names of degrees of freedom")
        document["parameters"] = {key: distribution.table() for key, distribution in parameters.items()}
        document["tables"] = {key: _points(f"tables[{key!r}]", points) for key, points in tables.items()}
        document["terms"] = [_term(term) for term in terms]
        document["contacts"] = [_contact(contact, coefficients is not None) for contact in contacts]
        document["bodies"] = [{"name": key, "dofs": _dofs(f"bodies[{key!r}]", of)} for key, of in bodies.items()]
        document["constraints"] = [{"name": key, "fixed": _dofs(f"constraints[{key!r}]", of)} for key, of in constraints.items()]
        squeal = {"growth_above": growth_above, "damping_ratio_below": damping_ratio_below}
        document["squeal"] = {key: number(key, of) for key, of in squeal.items() if of is not None}
        if correlation is not None:
            document["correlation"] = _correlation(correlation)
        #: The brake as a case file.
        self.text = _toml.document({key: table for key, table in document.items() if table})
        try:
            self.text.encode()
        except UnicodeEncodeError as error:
            raise refused("names", ascii(error.object[error.start : error.end]), "text that is Unicode") from None
        if coefficients is not None and not callable(coefficients):
            raise refused("coefficients", repr(coefficients), "a function of a dict of arrays")
        self._make(("brake", [], self.text, coefficients, None, None, None))
        if coefficients is not None:
            # Anew for each call: what is handed out may be changed.
            medians = self._native.parameters()
            found = coefficients({of: np.array([median]) for of, _, median in medians})
            if not isinstance(found, Mapping):
                raise refused("coefficients", f"a callable that returns {type(found).__name__}", "a dict of arrays")
            names = [str(key) for key in found]
            _check_computed(names, terms, contacts)
            self._make(("brake", [], self.text, coefficients, names, None, None))
            first = _checked(found, names, 1)
            again = computed(coefficients, {of: np.array([median]) for of, _, median in medians}, names, 1)
            for key, one, other in zip(names, first, again, strict=True):
                if not np.array_equal(one, other):
                    raise refused("coefficients", f"{key!r} once {one[0]} and once {other[0]}, at the medians", "what depends on the parameters alone")


def _plain(given: Mapping[str, Any]) -> dict[str, Any]:
    return {key: of for key, of in given.items() if of is not None}


def _dofs(argument: str, given: Any) -> str | list[str]:
    """Names of degrees of freedom; a text is one, or a range as "first-last"."""
    return text(argument, given) if isinstance(given, str) else names_of(argument, given, "names of degrees of freedom")


def _correlation(given: Any) -> dict[str, Any]:
    """A table of a correlation."""
    allowed = "(names of parameters, matrix)"
    if not isinstance(given, tuple | list) or len(given) != 2 or isinstance(given[0], str) or not isinstance(given[0], Iterable):
        raise refused("correlation", repr(given), allowed)
    of = list(given[0])
    if not all(isinstance(name, str) for name in of):
        raise refused("correlation", repr(given), allowed)
    matrix = real("correlation", given[1])
    if matrix.shape != (len(of), len(of)):
        raise refused("correlation", f"a matrix of shape {matrix.shape}", f"{(len(of), len(of))}, a row for each of its parameters")
    return {"parameters": of, "matrix": matrix}


def _points(argument: str, given: Any) -> dict[str, Any]:
    """A table of the points of a function."""
    if not isinstance(given, tuple | list) or len(given) != 2:
        raise refused(argument, repr(given), "(at, value), two arrays of one length")
    at, value = (real(f"{argument}: {key}", numbers) for key, numbers in zip(("at", "value"), given, strict=True))
    if at.ndim != 1 or at.shape != value.shape:
        raise refused(argument, f"arrays of shapes {at.shape} and {value.shape}", "(at, value), two arrays of one length")
    return {"at": at, "value": value}


def _formula(argument: str, given: Any) -> Formula:
    """A number or an expression."""
    if isinstance(given, str):
        return text(argument, given)
    if isinstance(given, bool) or not isinstance(given, int | float | np.integer | np.floating):
        raise refused(argument, repr(given), "a number or an expression")
    as_double = number(argument, given)
    return given if isinstance(given, int | float) else as_double


def _if_given(check: Callable[[str, Any], Any], argument: str, given: Any) -> Any:
    """What a check makes of an argument, None of one that is not given."""
    return None if given is None else check(argument, given)


def _storage(argument: str, given: Any) -> Any:
    """How matrices are stored: a word on all of them, or one on each."""
    words, matrices = ("whole", "upper", "lower", "triangle"), ("mass", "damping", "stiffness")
    given_words = given.items() if isinstance(given, Mapping) else [(None, given)]
    for matrix, word in given_words:
        if not isinstance(word, str) or word not in words or matrix not in (None, *matrices):
            raise refused(argument, repr(given), f"{', '.join(words)}, or a dict from {', '.join(matrices)} to these")
    return given


def _term(term: Term) -> dict[str, Any]:
    text("terms: name", term.name)
    at = f"terms {term.name!r}"
    matrices = {key: getattr(term, key) for key in ("mass", "damping", "stiffness")}
    orders = {key: dense(f"{at}.{key}", of) for key, of in matrices.items() if of is not None}
    of = {
        "name": term.name,
        "family": _if_given(text, f"{at}.family", term.family),
        "coefficient": _if_given(_formula, f"{at}.coefficient", term.coefficient),
        "symmetry": _if_given(_storage, f"{at}.symmetry", term.symmetry),
    }
    return _plain(of | orders)


def _contact(contact: Contact, is_open: bool) -> dict[str, Any]:
    text("contacts: name", contact.name)
    at = f"contacts {contact.name!r}"
    if contact.lag is not None and not isinstance(contact.lag, Lag):
        raise refused(f"{at}.lag", repr(contact.lag), "squeal.Lag(decay, drive, force)")
    lag = contact.lag and {key: _formula(f"{at}.lag.{key}", getattr(contact.lag, key)) for key in ("decay", "drive", "force")}
    force, reading = (
        {dof: number(f"{at}.{key}[{dof!r}]", part) for dof, part in mapped(f"{at}.{key}", given, "numbers").items()}
        for key, given in (("force", contact.force), ("reading", {} if contact.reading is None else contact.reading))
    )
    of = {
        "mu": _if_given(_formula, f"{at}.mu", contact.mu),
        "slope": _if_given(_formula, f"{at}.slope", contact.slope),
        "lag": lag,
        "family": _if_given(text, f"{at}.family", contact.family),
    }
    if is_open and contact.mu is None and contact.slope is None and contact.lag is None:
        of["mu"] = 0.0  # Computed, as `_check_computed` sees to.
    return _plain({"name": contact.name, "force": force, "reading": reading or None, **of})


def _check_computed(names: Sequence[str], terms: Sequence[Term], contacts: Sequence[Contact]) -> None:
    """Refuses what a callable computes beside an expression, and a contact that has neither."""
    given = {term.name: term.coefficient for term in terms}
    given |= {f"{contact.name}.mu": contact.mu for contact in contacts}
    given |= {f"{contact.name}.slope": contact.slope for contact in contacts}
    for name in names:
        if given.get(name) is not None:
            raise refused("coefficients", f"{name!r}, which has an expression too", "one of them")
    for contact in contacts:
        own = contact.mu is not None or contact.slope is not None or contact.lag is not None
        if not own and not {f"{contact.name}.mu", f"{contact.name}.slope"} & set(names):
            raise refused("coefficients", f"a callable without {contact.name + '.mu'!r}", "friction of every contact")


def computed(callable_: Coefficients, given: dict[str, Floats], names: list[str], length: int) -> list[Floats]:
    """What a callable computes for a block: of each name an array, checked. Called by the native module.

    Of a sample for which a number is not finite the native module says that it failed.
    """
    return _checked(callable_(given), names, length, doubles)


def _checked(found: object, names: list[str], length: int, array_of: Callable[[str, Any], Floats] = real) -> list[Floats]:
    if not isinstance(found, Mapping) or set(found) != set(names):
        keys = sorted(map(str, found)) if isinstance(found, Mapping) else type(found).__name__
        raise refused("coefficients", f"a callable that returns {keys}", f"{sorted(names)}, as at the medians")
    columns = []
    for name in names:
        array = array_of(f"coefficients: {name!r}", found[name])
        if array.shape not in ((), (length,)):
            raise refused(f"coefficients: {name!r}", f"an array of shape {array.shape}", f"({length},), one for each sample, or a number")
        columns.append(np.broadcast_to(array, (length,)).copy())
    return columns


def table_of(points: Any, argument: str) -> tuple[list[str], Floats]:
    """Names and rows of points: a DataFrame, a structured array, or a mapping of columns."""
    if hasattr(points, "dtype") and getattr(points.dtype, "names", None):
        names = list(points.dtype.names)
        columns = [points[name] for name in names]
    elif isinstance(points, Mapping) or hasattr(points, "columns"):
        keys = list(points.columns if hasattr(points, "columns") else points)
        names, columns = [str(key) for key in keys], [points[key] for key in keys]
    else:
        raise refused(argument, type(points).__name__, "a DataFrame, a structured array or a dict, a column for each parameter")
    if len(set(names)) != len(names):
        raise refused(argument, f"the columns {names}", "each of them once")
    arrays = [real(f"{argument}[{name!r}]", column) for name, column in zip(names, columns, strict=True)]
    shapes = {array.shape for array in arrays}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or next(iter(shapes)) == (0,):
        raise refused(argument, f"columns of shapes {sorted(shapes)}", "columns of one length, at least 1")
    return names, np.ascontiguousarray(np.stack(arrays, axis=1))


def native_of(brake: Any) -> _squeal.Brake:
    """What a brake is to the native module."""
    if not isinstance(brake, AnyBrake):
        raise refused("brake", repr(brake), "a brake: squeal.Case of the path of a case file, or squeal.Brake of arrays")
    return brake._native


def with_design(brake: AnyBrake, design: Any) -> tuple[_squeal.Brake, int]:
    """The brake whose samples are the rows of a design, and their number."""
    names, rows = table_of(design, "design")
    native = native_of(brake)
    known = [name for name, _, _ in native.parameters()]
    if sorted(names) != sorted(known):
        raise refused("design", f"the columns {names}", f"one for each parameter: {known}")
    return native.with_design(rows[:, [names.index(name) for name in known]]), len(rows)
