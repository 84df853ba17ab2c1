"""Plots draw what their tables have, into axes that are given."""

import matplotlib
import numpy as np
import pytest

import squeal as sq

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture
def ax():
    figure, ax = pyplot.subplots()
    yield ax
    pyplot.close(figure)


def test_a_spectrum_shows_what_oscillates(ax):
    s = sq.eig(np.eye(2), 0.05 * np.eye(2), [[2.0, 1.0 - 0.8 * 4 / 3], [1.0, 2.0]])
    assert s.plot(ax) is ax
    shown = np.sort(np.concatenate([line.get_ydata() for line in ax.lines[:2]]))
    assert np.array_equal(shown, np.sort(s.damping_ratios[s.eigenvalues.imag > 0]))
    assert len(ax.lines[1].get_xdata()) == np.sum(s.unstable & (s.eigenvalues.imag > 0)) == 1


def test_studies_sweeps_and_influence_are_shown(cases, ax):
    case = sq.Case(cases / "two-by-two.toml")
    r = sq.run(case, samples=20, keep_samples=True, progress=False)
    r.plot_occurrence(ax, law="amontons-coulomb", constraints="none")
    assert [label.get_text() for label in ax.get_xticklabels()] == list(
        dict.fromkeys(r.occurrence["mode"][(r.occurrence["law"] == "amontons-coulomb") & (r.occurrence["constraints"] == "none")])
    )
    with pytest.raises(sq.ArgumentError, match="the columns"):
        r.plot_occurrence(ax, color=3)
    with pytest.raises(sq.ArgumentError, match="values that the table has"):
        r.plot_occurrence(ax, law="glue")
    ax.clear()
    r.plot_modes(ax)
    assert np.isin(ax.lines[0].get_xdata(), r.modes["frequency_hz"]).all()
    ax.clear()
    w = sq.sweep(case, mu=(0, 1.3), progress=False)
    w.plot(ax)
    branches = set(w.branches["branch"])
    assert len(ax.lines) == len(branches) + w.onsets.rows + 1
    # Of all branches Re lambda is drawn, which is zero at the onsets.
    drawn = np.concatenate([line.get_ydata() for line in ax.lines[: len(branches)]])
    assert np.array_equal(np.sort(drawn), np.sort(w.branches["growth"])) and drawn.min() < 0 < drawn.max()
    ax.clear()
    m = sq.sweep(case, mu=(0, 1.3), x_damping=(50, 400), progress=False)
    m.plot(ax)
    assert len(ax.lines) == len(set(m.boundary["curve"]))
    ax.clear()
    sq.influence(case, samples=200, total=100, law="velocity-dependent", progress=False).plot(ax)
    assert len(ax.get_xticks()) > 1


def test_an_analysis_and_a_screen_are_shown(cases, ax):
    case = sq.Case(cases / "hoffmann.toml")
    a = sq.cea(case)
    assert a.plot(ax) is ax
    assert np.array_equal(ax.lines[1].get_ydata(), a.damping_ratios[a.unstable]) and a.unstable.any()
    ax.clear()
    s = sq.screen(case, variants={"stiff": sq.Case(cases / "hoffmann.toml", set={"mu.to": 0.8})}, samples=200, progress=False)
    s.plot(ax)
    confirmed = s.ranked["unstable_modes"]
    assert np.array_equal(ax.lines[0].get_xdata(), np.sort(confirmed)[::-1]) and len(confirmed) == 2
    assert [label.get_text() for label in ax.get_yticklabels()] == ["none (set of constraints)", "stiff (variant)"]


def test_axes_of_modes_that_are_one_have_ticks_of_their_own(cases, ax):
    r = sq.run(sq.Case(cases / "hoffmann.toml", samples=20), progress=False)
    assert np.ptp(r.modes["frequency_hz"]) < 1e-9
    r.plot_modes(ax)
    ax.figure.canvas.draw()
    for axis in (ax.xaxis, ax.yaxis):
        assert axis.get_offset_text().get_text() == ""
        labels = [label.get_text() for label in axis.get_ticklabels()]
        assert len(set(labels)) == len(labels) > 1
    low, high = ax.get_xlim()
    assert low < r.modes["frequency_hz"].min() and high > r.modes["frequency_hz"].max()
    # Only these are widened.
    ax.clear()
    sq.eig(np.eye(2), 0.05 * np.eye(2), [[2.0, 1.0], [1.0, 9.0]]).plot(ax)
    assert np.ptp(ax.get_xlim()) < 1.0
