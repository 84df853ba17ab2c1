"""Plots with matplotlib; each takes `ax` and returns it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ._arrays import Floats
from ._errors import refused
from ._tables import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Colours of what is unstable and of the rest.
UNSTABLE, REST = "tab:red", "0.45"
#: Least range of an axis, as a part of its largest number; chosen: ticks have a few digits.
_LEAST_RANGE = 1e-4


def axes(ax: Axes | None) -> Axes:
    """Axes that were given, or new ones."""
    if ax is not None:
        if not hasattr(ax, "set_xlabel"):
            raise refused("ax", repr(ax), "axes of matplotlib")
        return ax
    import matplotlib.pyplot

    made: Axes = matplotlib.pyplot.subplots()[1]
    return made


def _plain_ticks(ax: Axes) -> None:
    """Ticks with their own numbers, and ranges in which these differ: of modes that are one but for rounding there would be none."""
    for low, high, set_range in ((*ax.get_xlim(), ax.set_xlim), (*ax.get_ylim(), ax.set_ylim)):
        middle, least = (low + high) / 2, _LEAST_RANGE * max(abs(low), abs(high))
        if high - low < least:
            set_range(middle - least / 2, middle + least / 2)
    ax.ticklabel_format(useOffset=False)


def spectrum(frequencies_hz: Floats, damping_ratios: Floats, unstable: npt.NDArray[np.bool_], ax: Axes | None) -> Axes:
    """Damping ratio against frequency; red where it grows."""
    ax = axes(ax)
    for shown, colour, name in ((~unstable, REST, "not unstable"), (unstable, UNSTABLE, "unstable")):
        ax.plot(frequencies_hz[shown], damping_ratios[shown], "o", color=colour, label=f"{name} ({np.sum(shown)})")
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set_xlabel("frequency, Hz")
    ax.set_ylabel("damping ratio")
    ax.legend()
    _plain_ticks(ax)
    return ax


def occurrence(table: Table, ax: Axes | None, chosen: Mapping[str, str | int]) -> Axes:
    """Occurrence of each mode with its limits."""
    ax = axes(ax)
    mask = np.ones(table.rows, dtype=bool)
    for column, wanted in chosen.items():
        if column not in table:
            raise refused(column, wanted, f"the columns {', '.join(table.columns)}")
        if not isinstance(wanted, str | int | float | np.integer | np.floating):
            raise refused(column, repr(wanted), "a value of this column")
        mask &= table[column] == wanted
    if not mask.any():
        raise refused("occurrence", dict(chosen), "values that the table has")
    names = list(dict.fromkeys(table["mode"][mask]))
    at = np.array([names.index(name) for name in table["mode"][mask]])
    value, lower, upper = (table[column][mask] for column in ("occurrence", "lower", "upper"))
    ax.errorbar(at, value, yerr=[np.maximum(value - lower, 0), np.maximum(upper - value, 0)], fmt="o", color=REST, capsize=3)
    ax.set_xticks(range(len(names)), names)
    ax.set_xlabel("mode")
    ax.set_ylabel("occurrence of instability, 95 %")
    return ax


def modes(table: Table, ax: Axes | None) -> Axes:
    """Damping ratio against frequency of modes, by set of constraints."""
    ax = axes(ax)
    for name in dict.fromkeys(table["constraints"]):
        own = table["constraints"] == name
        ax.plot(table["frequency_hz"][own], table["damping_ratio"][own], "o", label=name)
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set_xlabel("frequency, Hz")
    ax.set_ylabel("damping ratio")
    ax.legend()
    _plain_ticks(ax)
    return ax


def boundary(table: Table, parameters: Sequence[str], ax: Axes | None) -> Axes:
    """Boundary of stability over two parameters."""
    ax = axes(ax)
    # By their places: parameters may have any name.
    x, y = table.columns[2:4]
    for curve in dict.fromkeys(table["curve"]):
        own = table["curve"] == curve
        ax.plot(table[x][own], table[y][own], color=UNSTABLE)
    ax.set_xlabel(parameters[0])
    ax.set_ylabel(parameters[1])
    return ax


def branches(table: Table, name: str, onsets: Floats, ax: Axes | None) -> Axes:
    """Growth rates over one parameter, and its onsets."""
    ax = axes(ax)
    x, growth = table.columns[2], table.columns[4]
    for branch in dict.fromkeys(table["branch"]):
        own = table["branch"] == branch
        ax.plot(table[x][own], table[growth][own], color=REST)
    for onset in onsets:
        ax.axvline(onset, color=UNSTABLE, linestyle=":")
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set_xlabel(name)
    ax.set_ylabel("growth rate, 1/s")
    return ax


def influence(table: Table, ax: Axes | None) -> Axes:
    """First-order and total indices of the growth rate of anything, with their limits."""
    ax = axes(ax)
    of_growth = (table["mode"] == "any") & (table["output"] == "growth")
    names = list(dict.fromkeys(table["input"][of_growth]))
    for shift, kind in enumerate(dict.fromkeys(table["index"][of_growth])):
        own = of_growth & (table["index"] == kind)
        at = np.array([names.index(name) for name in table["input"][own]]) + 0.2 * shift
        value, lower, upper = (table[column][own] for column in ("value", "lower", "upper"))
        ax.errorbar(at, value, yerr=[np.maximum(value - lower, 0), np.maximum(upper - value, 0)], fmt="o", capsize=3, label=kind)
    ax.set_xticks(range(len(names)), names)
    ax.set_ylabel("Sobol' index of the growth rate, 95 %")
    ax.legend()
    return ax


def screen(table: Table, ax: Axes | None) -> Axes:
    """Unstable modes in one analysis with each set of changes that was confirmed, with limits; what is not changed is a line."""
    ax = axes(ax)
    left = table["unstable_modes"]
    shown = np.flatnonzero(np.isfinite(left))
    shown = shown[np.argsort(-left[shown], kind="stable")]
    names = [f"{places} ({kind})" for places, kind in zip(table["places"][shown], table["kind"][shown], strict=True)]
    value, lower, upper = (table[column][shown] for column in ("unstable_modes", "unstable_modes_lower", "unstable_modes_upper"))
    errors = [np.maximum(value - lower, 0), np.maximum(upper - value, 0)]
    ax.errorbar(value, range(len(shown)), xerr=errors, fmt="o", color=REST, capsize=3)
    for unchanged in left[(table["count"] == 0) & np.isfinite(left)][:1]:
        ax.axvline(unchanged, color=UNSTABLE, linestyle=":")
    ax.set_yticks(range(len(shown)), names)
    ax.set_xlabel("unstable modes in one analysis, 95 %")
    return ax
