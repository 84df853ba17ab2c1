"""Studies of brakes, and what else is asked of them."""

from __future__ import annotations

import functools
import json
import os
import pathlib
import re
import shutil
import tempfile
import warnings
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _squeal
from ._arrays import Floats, flag, listed, mapped, names as names_of, number, path_of, text as text_of
from ._brake import AnyBrake, _whole, native_of, table_of, with_design
from ._eig import workers
from ._errors import FailureWarning, FolderError, MissingFolderError, refused
from ._frozen import Frozen
from ._progress import Progress, receiver
from ._tables import Table, Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Folder = str | os.PathLike[str]
#: What one process keeps for itself in a folder.
_LOCK = "run.lock"


def _optional(tables: Tables, name: str, needed: str) -> Table:
    if name not in tables:
        raise AttributeError(f"{name}: not there; allowed: {needed}")
    return tables[name]


class _Owned:
    """A folder that goes with the results that are in it."""

    def __init__(self) -> None:
        self.name = tempfile.mkdtemp(prefix="squeal-")
        weakref.finalize(self, shutil.rmtree, self.name, ignore_errors=True)


@dataclass(frozen=True, eq=False, repr=False)
class Results(Frozen):
    """What a study has found: the files of its folder."""

    #: The folder; one that the results own and take with them where the study was run without `out`: give `out` where they leave the process.
    folder: pathlib.Path
    #: All tables, by the names of their files without `.csv`.
    tables: Tables
    #: The file `manifest.json`: what made the results.
    manifest: dict[str, Any]
    #: The summary that the program prints; of loaded results the file `summary.md`.
    text: str
    _owned: _Owned | None = field(default=None, repr=False, compare=False)

    @property
    def occurrence(self) -> Table:
        """How often each mode is unstable in each scene and arrangement, with limits at 95 %."""
        return self.tables["occurrence"]

    @property
    def modes(self) -> Table:
        """The modes of each set of constraints where they have their names."""
        return self.tables["modes"]

    @property
    def links(self) -> Table:
        """Which mode of a set of constraints is which of another."""
        return self.tables["links"]

    @property
    def panels(self) -> Table:
        """Numbers of unstable modes by constraints, law, speed and number of contacts."""
        return self.tables["panels"]

    @property
    def differences(self) -> Table:
        """Differences of panels, on the same draws."""
        return self.tables["differences"]

    @property
    def net_work(self) -> Table:
        """Work of friction and damping in unstable modes, by body."""
        return self.tables["net_work"]

    @property
    def family_work(self) -> Table:
        """The same by family of forces."""
        return self.tables["family_work"]

    @property
    def sensitivities(self) -> Table:
        """What changes the unstable modes, at the medians."""
        return self.tables["sensitivities"]

    @property
    def growth(self) -> Table:
        """How fast each mode grows where it is unstable."""
        return self.tables["growth"]

    @property
    def unstable_modes(self) -> Table:
        """Which modes grow in each sample, in a row each; only with `keep_samples`."""
        return _optional(self.tables, "unstable_modes", "results of `run` with keep_samples=True")

    @property
    def every_mode(self) -> Table:
        """Every mode of each sample, stable ones too, in a row each; only with `every_mode`."""
        return _optional(self.tables, "every_mode", "results of `run` with every_mode=True")

    @property
    def failures(self) -> Table:
        """Samples that could not be evaluated."""
        return self.tables["failures"]

    @property
    def samples(self) -> Table:
        """What was drawn and what grew; only with `keep_samples`."""
        return _optional(self.tables, "samples", "results of `run` with keep_samples=True")

    @property
    def influence(self) -> Table:
        """Which input makes squeal vary; only with `keep_samples`."""
        return _optional(self.tables, "influence", "results of `run` with keep_samples=True")

    @property
    def cycles_of_draws(self) -> Table:
        """Motions of draws, a row for each unstable mode; only with `cycles`. `tables` has them by mode and by scene."""
        return _optional(self.tables, "cycles_of_draws", "results of `run` with cycles")

    @property
    def estimates(self) -> Table:
        """Occurrences by the cheapest estimator; only with `half_width`."""
        return _optional(self.tables, "estimates", "results of `run` with half_width")

    def save(self, folder: Folder) -> None:
        """Write all files into a new or empty folder: those that the program writes, which it can continue."""
        to = pathlib.Path(path_of("folder", folder))
        try:
            is_taken = to.exists() and (not to.is_dir() or any(to.iterdir()))
        except OSError as error:
            raise FolderError(f"{to}: {error}; allowed: a folder that can be written", path=str(to)) from None
        if is_taken:
            raise FolderError(f"{to}: is not empty; allowed: a new or empty folder", path=str(to))
        if not self.folder.is_dir():
            raise MissingFolderError(f"{self.folder}: is gone; allowed: `run` with `out` where results leave the process", path=str(self.folder))
        try:
            to.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=to.parent, prefix=f".{to.name}.") as made:
                whole = pathlib.Path(made, "whole")
                shutil.copytree(self.folder, whole, ignore=shutil.ignore_patterns(_LOCK))
                whole.replace(to)
        except OSError as error:
            raise FolderError(f"{to}: {error}; allowed: a folder that can be written", path=str(to)) from None

    def plot_occurrence(self, ax: Axes | None = None, **chosen: str | int) -> Axes:
        """Occurrence of each mode with its limits; `chosen` are columns of `occurrence` and their values, as law="lugre"."""
        from .plot import occurrence

        return occurrence(self.occurrence, ax, chosen)

    def plot_modes(self, ax: Axes | None = None) -> Axes:
        """Damping ratio against frequency of the modes where they have their names."""
        from .plot import modes

        return modes(self.modes, ax)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"Results({str(self.folder)!r}, {self.manifest.get('samples')} samples, {len(self.tables)} tables)"


def _read(folder: pathlib.Path, text: str | None, owned: _Owned | None) -> Results:
    try:
        manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
        if not isinstance(manifest, dict):
            raise ValueError("manifest.json is no manifest")
        tables = Tables([Table.read(path) for path in sorted(folder.glob("*.csv"))])
        said = (folder / "summary.md").read_text(encoding="utf-8") if text is None else text
        if "occurrence" not in tables:
            raise FileNotFoundError("occurrence.csv is not there")
        for column in ("samples", "unstable", "occurrence", "lower", "upper"):
            if column not in tables["occurrence"] or tables["occurrence"][column].dtype.kind not in "if":
                raise ValueError(f"occurrence.csv has no numbers {column!r}")
    except (OSError, ValueError, RecursionError) as error:
        kind = MissingFolderError if isinstance(error, FileNotFoundError) else FolderError
        raise kind(f"{folder}: {error}; allowed: the folder of a study that has finished", path=str(folder)) from None
    return Results(folder, tables, manifest, said, owned)


def load(folder: Folder) -> Results:
    """The results in the folder of a study that has finished, of `run` or the program."""
    return _read(pathlib.Path(path_of("folder", folder)), None, None)


def _in_folder(out: Folder | None) -> tuple[pathlib.Path, _Owned | None]:
    if out is not None:
        return pathlib.Path(path_of("out", out)), None
    owned = _Owned()
    return pathlib.Path(owned.name, "study"), owned


def _number(argument: str, given: float | None) -> float | None:
    return None if given is None else number(argument, given)


def _text(argument: str, given: str | None) -> str | None:
    return None if given is None else text_of(argument, given)


def _of_run(folder: pathlib.Path, ran: tuple[str, str | None], owned: _Owned | None) -> Results:
    text, complaint = ran
    if complaint is not None:
        warnings.warn(complaint, FailureWarning, stacklevel=3)
    return _read(folder, text, owned)


def run(
    brake: AnyBrake,
    *,
    samples: int | None = None,
    seed: int | None = None,
    design: Any = None,
    half_width: float | None = None,
    until_half_width: float | None = None,
    keep_samples: bool = False,
    every_mode: bool = False,
    cycles: int | None = None,
    threads: int | None = None,
    out: Folder | None = None,
    progress: Progress = None,
) -> Results:
    """Run the study of a brake: every draw in every scene.

    `samples` and `seed` stand for those of the brake. `design` has samples of your own instead, a DataFrame, structured array or dict of
    columns with a column for each parameter (of brakes given by their matrices). `half_width` adds every occurrence to this half width
    by the cheapest estimator; `until_half_width` takes as many samples as every occurrence needs for it. `keep_samples` keeps what was drawn
    and which modes grow, `every_mode` stable ones too, for surrogates. `cycles` unstable draws of each scene are followed into their motion. With `out` the study is in
    this folder, as that of `squeal run`: an interrupt leaves what there is, and the same call goes on. `progress` is None for a bar
    where standard error is a terminal, False, or a function of (stage, done, total).
    """
    native, kept = native_of(brake), (flag("keep_samples", keep_samples), flag("every_mode", every_mode), _whole("cycles", cycles, 1))
    if design is not None:
        given = {"samples": samples, "half_width": half_width, "until_half_width": until_half_width}
        for name in (name for name, of in given.items() if of is not None):
            raise refused(name, given[name], "None beside `design`")
        native, samples = with_design(brake, design)
    if samples is not None and until_half_width is not None:
        raise refused("samples", samples, "None beside `until_half_width`")
    native = native.with_run(_whole("samples", samples, 1), _whole("seed", seed, 0))
    folder, owned = _in_folder(out)
    widths = (_number("half_width", half_width), _number("until_half_width", until_half_width))
    ran = _squeal.run(native, os.fspath(folder), widths, kept, workers(threads), receiver(progress))
    return _of_run(folder, ran, owned)


@dataclass(frozen=True)
class Part:
    """A part of a study that is complete."""

    #: Its folder.
    folder: pathlib.Path
    #: First sample, and the one after the last.
    samples: range
    #: Number of evaluations.
    evaluations: int
    #: Number of draws and evaluations that failed.
    failures: int


def shard(
    brake: AnyBrake,
    number: int,
    of: int,
    *,
    out: Folder,
    first: int = 0,
    samples: int | None = None,
    seed: int | None = None,
    keep_samples: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Part:
    """Sample part `number` (from 1) of `of` parts of a study in a folder of its own, for `merge`; `first` is the first sample of all.

    The same call goes on where it was stopped, and returns at once where the part is complete, so that any engine may call it again.
    """
    for name, given in (("number", number), ("of", of), ("first", first)):
        if given is None:
            raise refused(name, None, "a whole number")
    keep_samples = flag("keep_samples", keep_samples)
    part = tuple(_whole(name, given, 0) for name, given in (("number", number), ("of", of), ("first", first)))
    native = native_of(brake).with_run(_whole("samples", samples, 1), _whole("seed", seed, 0))
    found = _squeal.shard(native, part, path_of("out", out), keep_samples, workers(threads), receiver(progress))  # type: ignore[arg-type]
    begin, end, evaluations, failures = found
    return Part(pathlib.Path(out), range(begin, end), evaluations, failures)


def merge(
    brake: AnyBrake,
    parts: Sequence[Folder | Part],
    *,
    out: Folder | None = None,
    half_width: float | None = None,
    every_mode: bool = False,
    mixed: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Results:
    """Put the parts of a study together, in any order: the files of one run, byte for byte.

    `half_width` and `every_mode` are as of `run`. `mixed` lets parts of other programs, and of processors that round differently, pass.
    """
    native, mixed, every_mode = native_of(brake), flag("mixed", mixed), flag("every_mode", every_mode)
    given = listed("parts", parts, "folders of `shard` or `squeal run --shard`")
    folders = [path_of("parts", part.folder if isinstance(part, Part) else part) for part in given]
    if not folders:
        raise refused("parts", "none", "folders of `shard` or `squeal run --shard`")
    folder, owned = _in_folder(out)
    given_parts, width = (folders, mixed, every_mode), _number("half_width", half_width)
    ran = _squeal.merge(native, given_parts, os.fspath(folder), width, workers(threads), receiver(progress))
    return _of_run(folder, ran, owned)


@dataclass(frozen=True)
class Expected:
    """What a study takes, roughly, on this machine."""

    #: Time of what all samples share, s.
    preparation: float
    #: Time of the samples, s.
    samples: float
    #: Time of the report, s.
    report: float
    #: Memory, bytes.
    bytes: float

    @property
    def seconds(self) -> float:
        """Time in all, s."""
        return self.preparation + self.samples + self.report


def estimate(brake: AnyBrake, *, samples: int | None = None) -> Expected:
    """Time and memory that the study of a brake takes; some of its samples are timed."""
    return Expected(*_squeal.estimate(native_of(brake).with_run(_whole("samples", samples, 1), None)))


def _only(
    brake: AnyBrake,
    law: str | None,
    contact: Sequence[int] | None,
    constraints: str | None,
    speed: float | None,
    drawn: tuple[str | None] | None = None,
) -> _squeal.Brake:
    native = native_of(brake)
    given = None if contact is None else listed("contact", contact, "numbers of contacts, from 1")
    numbers = None if given is None else [_whole("contact", -1 if number is None else number, 1) or 0 for number in given]
    scene = (_text("law", law), numbers, _text("constraints", constraints))
    return native.only(scene, _number("speed", speed), drawn and _text("speed_range", drawn[0]), drawn is not None)


@dataclass(frozen=True, eq=False, repr=False)
class Analysis(Frozen):
    """One complex eigenvalue analysis at median parameters; arrays of one length, a place for each oscillating mode."""

    #: Eigenvalues with Im lambda > 0, rad/s.
    eigenvalues: npt.NDArray[np.complex128]
    #: Frequencies, Hz.
    frequencies_hz: Floats
    #: Damping ratios, negative where a mode grows.
    damping_ratios: Floats
    #: Verdicts in words.
    verdicts: tuple[str, ...]
    #: Shapes over all degrees of freedom, a column for each mode.
    shapes: npt.NDArray[np.complex128]
    #: Work of each family of forces in each mode by body, by the name of the family; "net" is all of it.
    work: dict[str, Floats]
    #: Why unstable modes grow, one entry for each mode, None for the others; only with `why`.
    why: tuple[dict[str, Any] | None, ...]
    #: All of it, as `squeal cea --json` says it.
    json: dict[str, Any]
    #: What was asked: the brake, and whether reasons were.
    _asked: tuple[_squeal.Brake, bool] | None = None

    @property
    def unstable(self) -> npt.NDArray[np.bool_]:
        """Which grow, as a mask."""
        return np.array([verdict.lower() == "unstable" for verdict in self.verdicts], dtype=bool)

    @functools.cached_property
    def text(self) -> str:
        """What `squeal cea` prints; asked for when it is wanted first."""
        return "" if self._asked is None else _squeal.cea(*self._asked, False)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Damping ratio against frequency, unstable modes apart."""
        from .plot import spectrum

        return spectrum(self.frequencies_hz, self.damping_ratios, self.unstable, ax)

    def __getstate__(self) -> dict[str, Any]:
        """For other processes, which do not have the brake."""
        return {**self.__dict__, "text": self.text, "_asked": None}

    def __len__(self) -> int:
        return len(self.eigenvalues)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"Analysis({len(self)} modes, {self.unstable.sum()} unstable)"


def cea(
    brake: AnyBrake,
    *,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    why: bool = False,
) -> Analysis:
    """One analysis of a brake at its medians, in the scene that the arguments choose; the first that it has where they do not."""
    native, why = _only(brake, law, contact, constraints, speed), flag("why", why)
    found = json.loads(_squeal.cea(native, why, True))
    modes = found["modes"]
    eigenvalues = np.array([complex(mode["re"], mode["im"]) for mode in modes])
    shapes = np.array([[complex(*u) for u in mode["shape"]] for mode in modes]).T
    families = [key.removesuffix("_work") for key in (modes[0] if modes else {}) if key.endswith("_work")]
    return Analysis(
        eigenvalues=eigenvalues,
        frequencies_hz=np.array([mode["frequency_hz"] for mode in modes]),
        damping_ratios=np.array([mode["damping_ratio"] for mode in modes]),
        verdicts=tuple(mode["verdict"] for mode in modes),
        shapes=shapes,
        work={family: np.array([mode[f"{family}_work"] for mode in modes]) for family in families},
        why=tuple(mode.get("why") for mode in modes),
        json=found,
        _asked=(native, why),
    )


@dataclass(frozen=True, eq=False)
class Sweep(Frozen):
    """What is found over one parameter, or two."""

    #: Names of the parameters.
    parameters: tuple[str, ...]
    #: Over one `branches`, `onsets`, `coalescences`; over two `boundary`, `regions`: the tables of `squeal sweep`.
    tables: Tables
    #: What is found, as `squeal sweep --json` says it.
    json: dict[str, Any] = field(repr=False)
    #: The same in words.
    text: str = field(repr=False)

    @property
    def onsets(self) -> Table:
        """Where stability changes, of one parameter."""
        return _optional(self.tables, "onsets", "a sweep of one parameter")

    @property
    def coalescences(self) -> Table:
        """Where two eigenvalues meet, of one parameter."""
        return _optional(self.tables, "coalescences", "a sweep of one parameter")

    @property
    def branches(self) -> Table:
        """The eigenvalues of each branch, of one parameter."""
        return _optional(self.tables, "branches", "a sweep of one parameter")

    @property
    def boundary(self) -> Table:
        """The boundary of stability, of two parameters."""
        return _optional(self.tables, "boundary", "a sweep of two parameters")

    @property
    def regions(self) -> Table:
        """The regions that it bounds, of two parameters."""
        return _optional(self.tables, "regions", "a sweep of two parameters")

    def plot(self, ax: Axes | None = None) -> Axes:
        """Growth rates of the branches, or the boundary of stability."""
        from .plot import boundary, branches

        if len(self.parameters) == 2:
            return boundary(self.boundary, self.parameters, ax)
        name = self.parameters[0]
        return branches(self.branches, name, self.onsets[name], ax)

    def __str__(self) -> str:
        return self.text


def _ranges(
    over: dict[str, tuple[float, float]] | None, ranges: dict[str, tuple[float, float]]
) -> list[tuple[str, float, float]]:
    """Names of parameters with the ends of their ranges, given by a dict and by keywords."""
    first = {} if over is None else mapped("over", over, "(from, to)")
    for name in first.keys() & ranges.keys():
        raise refused(name, ranges[name], f"one range; `over` has {first[name]}")
    found = []
    for name, ends in {**first, **ranges}.items():
        try:
            begin, end = (number(name, of) for of in ends)
        except (TypeError, ValueError):
            raise refused(name, repr(ends), "(from, to)") from None
        found.append((name, begin, end))
    return found


def sweep(
    brake: AnyBrake,
    over: dict[str, tuple[float, float]] | None = None,
    *,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **ranges: tuple[float, float],
) -> Sweep:
    """Sweep one parameter or two, all others at their medians: `sweep(brake, mu=(0, 1.3))`, or by a dict from name to (from, to)."""
    parameters = _ranges(over, ranges)
    native = _only(brake, law, contact, constraints, speed)
    tables, found, text = _squeal.sweep(native, parameters, workers(threads), receiver(progress))
    return Sweep(tuple(name for name, _, _ in parameters), Tables([Table(*of) for of in tables]), json.loads(found), text)


@dataclass(frozen=True, eq=False)
class Influence(Frozen):
    """Which input makes squeal vary: Sobol' indices."""

    #: The table of `squeal influence`.
    table: Table
    #: Draws and points that failed.
    failures: int
    #: Number of analyses.
    evaluations: int
    #: The same in words.
    text: str = field(repr=False)

    def plot(self, ax: Axes | None = None) -> Axes:
        """First-order and total indices of the growth rate, with their limits."""
        from .plot import influence as drawn

        return drawn(self.table, ax)

    def __str__(self) -> str:
        return self.text


def influence(
    brake: AnyBrake,
    *,
    samples: int | None = None,
    total: int | None = None,
    seed: int | None = None,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    speed_range: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Influence:
    """First-order indices of each input from draws of the study, in one scene; with `total` also total ones, from so many points."""
    for name, given in (("samples", samples), ("total", total)):
        if given is not None and not (isinstance(given, int | np.integer) and 100 <= given <= 1_000_000):
            raise refused(name, repr(given), "100 to 1000000")
    native = _only(brake, law, contact, constraints, speed, (speed_range,)).with_run(samples, _whole("seed", seed, 0))
    draws = min(max(native.header()[1], 100), 1_000_000)
    table, failures, evaluations, text = _squeal.influence(native, draws, total, workers(threads), receiver(progress))
    return Influence(Table(*table), failures, evaluations, text)


@dataclass(frozen=True, eq=False)
class Motion(Frozen):
    """The motion after the onset: at the medians, or cycles over a parameter."""

    #: At the medians `cycles`, `cycle_contacts`, `cycle_spectrum`; over a parameter `cycle_branches`: the tables of `squeal cycle`.
    tables: Tables
    #: The same in words.
    text: str = field(repr=False)

    @property
    def cycles(self) -> Table:
        """What became of each start: kind, frequency, loudness, shares of the period open and stuck, power."""
        return _optional(self.tables, "cycles", "a motion at the medians")

    @property
    def contacts(self) -> Table:
        """Normal force and sliding velocity of each contact over the period of each cycle."""
        return _optional(self.tables, "cycle_contacts", "a motion at the medians")

    @property
    def spectrum(self) -> Table:
        """The harmonics of each cycle."""
        return _optional(self.tables, "cycle_spectrum", "a motion at the medians")

    @property
    def branches(self) -> Table:
        """The cycles of each branch, from each onset."""
        return _optional(self.tables, "cycle_branches", "a motion over a parameter")

    def __str__(self) -> str:
        return self.text


def cycle(
    brake: AnyBrake,
    over: dict[str, tuple[float, float]] | None = None,
    *,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    from_: int | str | None = None,
    harmonics: int = 9,
    time_samples: int = 512,
    stick: float = 0.01,
    threads: int | None = None,
    progress: Progress = None,
    **ranges: tuple[float, float],
) -> Motion:
    """Follow unstable modes into the motion that they grow to, in one scene: contacts open, slide and stick, and mostly a limit cycle is reached.

    At the medians from each unstable mode, or `from_` the one of a rank, or "noise"; over a parameter, `cycle(brake, mu=(0.5, 1.1))`, the branches
    of cycles from each onset. `harmonics` and `time_samples` are those of the harmonic balance; below the part `stick` of the sliding speed it smooths friction.
    """
    ranged = _ranges(over, ranges)
    if len(ranged) > 1:
        raise refused("over", ", ".join(name for name, _, _ in ranged), "one parameter")
    if from_ is not None and ranged:
        raise refused("from_", from_, "None beside a range")
    is_noise = isinstance(from_, str) and from_ == "noise"
    rank = None if from_ is None or is_noise else _whole("from_", from_ if isinstance(from_, int | np.integer) else -1, 1)
    asked = tuple(_whole(name, -1 if given is None else given, 1) or 0 for name, given in (("harmonics", harmonics), ("time_samples", time_samples)))
    native = _only(brake, law, contact, constraints, speed)
    motion = (is_noise, rank, asked[0], asked[1], number("stick", stick))
    tables, text = _squeal.cycle(native, ranged[0] if ranged else None, motion, workers(threads), receiver(progress))
    return Motion(Tables([Table(*of) for of in tables]), text)


@dataclass(frozen=True, eq=False)
class Rare(Frozen):
    """How probable squeal is where it is rare."""

    #: `rare` and `design_points`: the tables of `squeal rare`.
    tables: Tables
    #: The probability with its limits, the certified bound, what was spent and what speaks against it.
    json: dict[str, Any] = field(repr=False)
    #: The same in words.
    text: str = field(repr=False)

    @property
    def probability(self) -> float:
        """Probability that any mode grows."""
        return float(self.table["probability"][0])

    @property
    def limits(self) -> tuple[float, float]:
        """Its limits at 95 %."""
        return float(self.table["lower"][0]), float(self.table["upper"][0])

    @property
    def table(self) -> Table:
        """The probability that any mode grows in the first row, that of each mode below."""
        return self.tables["rare"]

    @property
    def design_points(self) -> Table:
        """The likeliest squealing brakes, a row for each input."""
        return self.tables["design_points"]

    def __str__(self) -> str:
        return self.text


def rare(
    brake: AnyBrake,
    *,
    relative: float = 0.1,
    budget: int = 2000,
    directions: int = 32,
    seed: int | None = None,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    speed_range: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Rare:
    """How probable squeal is in one scene, mode by mode, down to 1e-9, and which brakes are the likeliest to squeal.

    To the standard error `relative`, by some `budget` spectra; `directions` are random ones from which likely squealing brakes are looked for.
    """
    counts = [_whole(name, -1 if given is None else given, 0) or 0 for name, given in (("budget", budget), ("directions", directions))]
    native = _only(brake, law, contact, constraints, speed, (speed_range,)).with_run(None, _whole("seed", seed, 0))
    asked = (number("relative", relative), counts[0], counts[1])
    tables, found, text = _squeal.rare(native, asked, workers(threads), receiver(progress))
    return Rare(Tables([Table(*of) for of in tables]), json.loads(found), text)


@dataclass(frozen=True, eq=False)
class Screen(Frozen):
    """What helps, ranked and confirmed."""

    #: `screen` and `screen_differences`: the tables of `squeal screen`.
    tables: Tables
    #: What is found, as `squeal screen --json` says it.
    json: dict[str, Any] = field(repr=False)
    #: The same in words.
    text: str = field(repr=False)

    @property
    def ranked(self) -> Table:
        """All sets of changes, with prediction and confirmation."""
        return self.tables["screen"]

    @property
    def differences(self) -> Table:
        """Differences of what was confirmed, on the same draws."""
        return self.tables["screen_differences"]

    def plot(self, ax: Axes | None = None) -> Axes:
        """Unstable modes in one analysis that are left by what was confirmed, with limits, the fewest on top."""
        from .plot import screen as drawn

        return drawn(self.ranked, ax)

    def __str__(self) -> str:
        return self.text


def _variants(
    variants: Mapping[str, AnyBrake] | None, samples: int | None, seed: int | None
) -> list[tuple[str, _squeal.Brake]]:
    """Brakes by their names, as the native module takes them."""
    if variants is None:
        return []
    if not isinstance(variants, Mapping):
        raise refused("variants", repr(variants), "a mapping of names to brakes")
    for name, variant in variants.items():
        if not (isinstance(name, str) and re.fullmatch(r"[A-Za-z0-9_-]{1,60}", name)):
            raise refused("variants", repr(name), "names of 1 to 60 letters, digits, - and _")
        if not isinstance(variant, AnyBrake):
            raise refused(f"variants[{name!r}]", repr(variant), "a brake or a case")
    run = (_whole("samples", samples, 2), _whole("seed", seed, 0))
    return [(name, variant._native.with_run(*run)) for name, variant in variants.items()]


def screen(
    brake: AnyBrake,
    *,
    kinds: Sequence[str] | None = None,
    variants: Mapping[str, AnyBrake] | None = None,
    up_to: int = 2,
    constraints: str | None = None,
    criterion: str = "occurrence",
    confirm: int = 1,
    mass: float | None = None,
    spring: float | None = None,
    dashpot: float | None = None,
    factor: float | None = None,
    draws: int = 8,
    samples: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Screen:
    """Screen a brake for what helps: "constraint", "mass", "spring", "dashpot", "contact" at every place, "scale" of every part, singly and in sets `up_to`.

    All are ranked by a few analyses on `draws` draws, by `criterion`: "occurrence" (unstable modes in one analysis), "probability" (anything is
    unstable), "growth-quantile" (the growth that 95 % of the draws do not exceed) or "loudness" (that of the motion, likewise; lattices and
    matrices), and the best of each kind, `confirm` single ones and one of each larger size, are
    confirmed on `samples` other draws. `mass`, kg, `spring`, N/m, and `dashpot`, Ns/m, are what is attached; parts of the place's own
    unless given. Parts are scaled by `factor`, 1.1 unless given, up and down.

    `variants` are other brakes by their names, as `{"shim": Case(path, set={...})}`, which are confirmed on the same draws and ranked with the rest. Beside them
    no kind of changes is searched unless `kinds` says so.
    """
    kinds = None if kinds is None else names_of("kinds", kinds, "kinds of changes")
    constraints, criterion = _text("constraints", constraints), text_of("criterion", criterion)
    for name, given, least, most in (("up_to", up_to, 1, 20), ("draws", draws, 1, 10_000), ("confirm", confirm, 0, 65_535)):
        if not (isinstance(given, int | np.integer) and least <= given <= most):
            raise refused(name, repr(given), f"{least} to {most}")
    given_sizes = (("mass", mass, 0), ("spring", spring, 0), ("dashpot", dashpot, 0), ("factor", factor, 1))
    sizes = [_number(name, given) for name, given, _ in given_sizes]
    for (name, _, above), size in zip(given_sizes, sizes, strict=True):
        if size is not None and not (np.isfinite(size) and size > above):
            raise refused(name, size, f"a number > {above}")
    native = native_of(brake).with_run(_whole("samples", samples, 2), _whole("seed", seed, 0))
    _, count, _, sets = native.header()
    if count < 2:
        raise refused("samples", count, "2 or more, for an interval")
    if constraints is not None and constraints not in sets:
        raise refused("constraints", constraints, ", ".join(sets))
    named = _variants(variants, samples, seed)
    if kinds is None and named:
        kinds = []
    screening = (
        kinds,
        up_to,
        (sizes[0], sizes[1], sizes[2], sizes[3]),
        draws,
        confirm,
        criterion,
    )
    at = 0 if constraints is None else sets.index(constraints)
    tables, found, text = _squeal.screen(native, named, screening, at, workers(threads), receiver(progress))
    return Screen(Tables([Table(*of) for of in tables]), json.loads(found), text)


@dataclass(frozen=True, eq=False, repr=False)
class Evaluated(Frozen):
    """What a brake is at given points; arrays of one length."""

    #: Largest Re lambda of all eigenvalues, 1/s, below zero where all decay; NaN where the point failed.
    growth: Floats
    #: Frequency of that eigenvalue, Hz.
    frequency_hz: Floats
    #: Number of unstable modes, -1 where the point failed.
    unstable: npt.NDArray[np.int64]
    #: Number of eigenvalues of which it is open whether they count, or that are on the threshold, -1 where the point failed.
    open: npt.NDArray[np.int64]
    #: Indices of points that failed, and why.
    failures: dict[int, str]

    def __repr__(self) -> str:
        return f"Evaluated({len(self.growth)} points, {len(self.failures)} failed)"


def evaluate(
    brake: AnyBrake,
    points: Any,
    *,
    law: str | None = None,
    contact: Sequence[int] | None = None,
    constraints: str | None = None,
    speed: float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Evaluated:
    """What a brake is at points: the plain function for SALib, OpenTURNS and surrogates; nothing is counted or named.

    `points` is a DataFrame, a structured array or a dict of columns, by the names of parameters; those that have no column are at their
    medians. For lattices and brakes given by their matrices.
    """
    names, rows = table_of(points, "points")
    native = _only(brake, law, contact, constraints, speed)
    growth, hertz, unstable, open_, failed = _squeal.evaluate(native, names, rows, workers(threads), receiver(progress))
    if failed:
        warnings.warn(f"{len(failed)} of {len(rows)} points failed; first: {failed[0][1]}", FailureWarning, stacklevel=2)
    return Evaluated(growth, hertz, unstable, open_, dict(failed))
