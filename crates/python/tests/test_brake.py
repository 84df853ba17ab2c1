"""Brakes of arrays against the same brakes as case files, callables against expressions, samples of one's own, the plain function."""

import itertools
import pickle
import time

import numpy as np
import pandas
import pytest
import scipy.sparse

import squeal as sq
from test_study import same_table

SPRINGS = [[2.0, 1.0], [1.0, 2.0]]


def hoffmann(**changed):
    """The brake of cases/hoffmann.toml."""
    parts = {
        "name": "Hoffmann's two-degree-of-freedom oscillator",
        "samples": 400,
        "dofs": ["x", "y"],
        "terms": [
            sq.Term("springs", mass=np.eye(2), stiffness=scipy.sparse.csr_array(SPRINGS)),
            sq.Term("dashpots", damping=0.05 * np.eye(2)),
        ],
        "contacts": [sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu="mu")],
        "parameters": {"mu": sq.Uniform(0.5, 1.1, unit="1")},
        "bodies": {"mass": ["x", "y"]},
    }
    return sq.Brake(**{**parts, **changed})


def damped(**changed):
    """One in which two parameters are drawn, of which friction depends on both."""
    parts = {"parameters": {"t": sq.Uniform(0.2, 1.5), "c": sq.LogNormal(1.0, 0.3)}}
    of = hoffmann(**{**parts, **changed})
    return of


EXPRESSIONS = {
    "terms": [
        sq.Term("springs", mass=np.eye(2), stiffness=SPRINGS),
        sq.Term("dashpots", damping=0.05 * np.eye(2), coefficient="c * t"),
    ],
    "contacts": [sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu="0.4 + 0.5 * t", slope="-0.01 * c")],
}
OPEN = {"contacts": [sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3})]}


def callable_(p):
    return {"dashpots": p["c"] * p["t"], "belt.mu": 0.4 + 0.5 * p["t"], "belt.slope": -0.01 * p["c"]}


def same_results(r, other, but=()):
    assert set(r.tables) == set(other.tables)
    for name in set(r.tables) - set(but):
        for column in r.tables[name]:
            a, b = r.tables[name][column], other.tables[name][column]
            assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), (name, column)


def test_a_brake_of_arrays_is_the_case_file(cases, tmp_path):
    b = hoffmann()
    same_results(
        sq.run(b, keep_samples=True, progress=False),
        sq.run(sq.Case(cases / "hoffmann.toml", samples=400), keep_samples=True, progress=False),
    )
    # As a case file it is the brake too.
    (tmp_path / "brake.toml").write_text(b.text)
    r = sq.run(sq.Case(tmp_path / "brake.toml"), out=tmp_path / "out", progress=False)
    same_table(sq.run(b, progress=False).occurrence, tmp_path / "out" / "occurrence.csv")
    assert r.manifest["samples"] == 400


def test_a_callable_is_the_expressions_to_the_bit():
    expected = sq.run(damped(**EXPRESSIONS), keep_samples=True, progress=False)
    sizes = []

    def told(p):
        sizes.append(len(p["t"]))
        return callable_(p)

    for threads in (1, 2):
        found = sq.run(damped(**OPEN, coefficients=told), keep_samples=True, threads=threads, progress=False)
        same_results(found, expected)
    assert max(sizes) > 10 and 0 < expected.occurrence["occurrence"].max() < 1
    # Sweeps, screens and single analyses ask it too.
    brakes = damped(**OPEN, coefficients=callable_), damped(**EXPRESSIONS)
    first, second = (sq.sweep(b, t=(0.2, 1.5), progress=False) for b in brakes)
    assert np.array_equal(first.onsets["t"], second.onsets["t"]) and first.onsets.rows == 1
    first, second = (sq.cea(b, why=True).json for b in brakes)
    assert first == second
    first, second = (sq.influence(b, samples=200, progress=False).table for b in brakes)
    assert np.array_equal(first["value"], second["value"])
    first, second = (sq.screen(b, kinds=["dashpot"], up_to=1, samples=20, progress=False).ranked for b in brakes)
    assert first.to_pandas().equals(second.to_pandas())


def test_a_function_given_by_points_is_the_callable_that_interpolates():
    at, value = np.array([0.0, 0.4, 1.0, 1.5]), [0.4, 0.9, 0.7, 1.1]
    belt = sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu="friction(t)")
    drawn = {"t": sq.Uniform(0.2, 1.4)}
    by_points = sq.run(hoffmann(contacts=[belt], parameters=drawn, tables={"friction": (at, value)}), keep_samples=True, progress=False)
    called = hoffmann(**OPEN, parameters=drawn, coefficients=lambda p: {"belt.mu": np.interp(p["t"], at, value)})
    by_callable = sq.run(called, keep_samples=True, progress=False)
    assert np.array_equal(by_points.samples["t"], by_callable.samples["t"])
    # `np.interp` rounds otherwise.
    growth, expected = (np.array([float(of.split(":")[1]) if of else 0.0 for of in r.samples["unstable"]]) for r in (by_points, by_callable))
    assert 0 < np.count_nonzero(growth) < len(growth) and np.allclose(growth, expected, rtol=0.0, atol=1e-6)


def test_a_callable_is_asked_for_blocks():
    sizes = []

    def told(p):
        assert not np.any([np.shape(of) != np.shape(p["t"]) for of in p.values()])
        sizes.append(len(p["t"]))
        return callable_(p)

    b, expected = damped(**OPEN, coefficients=told), damped(**EXPRESSIONS)
    rng = np.random.default_rng(2)
    points = {"t": rng.uniform(0.2, 1.5, 500), "c": rng.uniform(0.5, 2.0, 500)}
    for ask, of in (
        (lambda brake: sq.run(brake, samples=500, keep_samples=True, progress=False), lambda r: r.samples["growth"]),
        (lambda brake: sq.run(brake, design=points, keep_samples=True, progress=False), lambda r: r.samples["growth"]),
        (lambda brake: sq.evaluate(brake, points), lambda y: y.growth),
        (lambda brake: sq.evaluate(brake, points, threads=1), lambda y: y.frequency_hz),
    ):
        sizes.clear()
        assert np.array_equal(of(ask(b)), of(ask(expected)))
        # The medians, what the report differentiates by, and nothing else is asked for alone.
        assert len(sizes) <= 30 and sum(sizes) >= 500 and sizes.count(1) <= 8, sizes
    # A screen confirms on blocks too, changes as well as variants.
    for options in ({"kinds": ["dashpot"], "up_to": 1}, {"variants": {"other": None}}):
        sizes.clear()
        of = [
            sq.screen(brake, **{**options, **({"variants": {"other": brake}} if "variants" in options else {})}, samples=500, progress=False)
            for brake in (b, expected)
        ]
        assert of[0].ranked.to_pandas().equals(of[1].ranked.to_pandas())
        assert sizes.count(1) <= 10 and sizes.count(63) >= 7, sizes


def test_a_callable_is_asked_by_one_thread_at_a_time():
    inside, most = [0], [0]

    def told(p):
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        time.sleep(0.01)
        inside[0] -= 1
        return callable_(p)

    b = damped(**OPEN, coefficients=told)
    sq.evaluate(b, {"t": np.linspace(0.2, 1.5, 1000)}, threads=4)
    assert most[0] == 1


def test_a_study_of_a_callable_goes_on_and_another_is_refused(tmp_path):
    b = damped(**OPEN, coefficients=callable_)
    sq.run(b, samples=100, out=tmp_path / "s", progress=False)
    r = sq.run(b, samples=200, out=tmp_path / "s", progress=False)
    same_results(r, sq.run(damped(**EXPRESSIONS), samples=200, progress=False))
    other = damped(**OPEN, coefficients=lambda p: {**callable_(p), "belt.mu": 0.5 + 0.5 * p["t"]})
    with pytest.raises(sq.FolderError, match="draws"):
        sq.run(other, samples=200, out=tmp_path / "s", progress=False)


def test_samples_of_ones_own_are_the_study_of_its_draws():
    b = damped(**EXPRESSIONS)
    r = sq.run(b, samples=300, keep_samples=True, progress=False)
    drawn = {name: r.samples[name] for name in ("t", "c")}
    own = sq.run(b, design=drawn, keep_samples=True, progress=False)
    for column in ("mode", "samples", "unstable", "open", "occurrence", "lower", "upper"):
        assert np.array_equal(own.occurrence[column], r.occurrence[column])
    assert np.array_equal(own.samples["growth"], r.samples["growth"])
    frame = r.samples.to_pandas()[["c", "t"]]
    again = sq.run(damped(**OPEN, coefficients=callable_), design=frame, progress=False)
    assert np.array_equal(again.occurrence["unstable"], r.occurrence["unstable"])
    structured = frame.to_records(index=False)
    assert sq.run(b, design=structured, progress=False).occurrence.rows == r.occurrence.rows


def test_a_folder_of_one_design_is_refused_to_another(tmp_path):
    b, points = hoffmann(), np.linspace(0.5, 1.1, 40)
    sq.run(b, design={"mu": points}, out=tmp_path / "s", progress=False)
    assert sq.run(b, design={"mu": points}, out=tmp_path / "s", progress=False).manifest["samples"] == 40
    points[39] += 1e-9
    with pytest.raises(sq.FolderError, match="design"):
        sq.run(b, design={"mu": points}, out=tmp_path / "s", progress=False)


def test_the_plain_function_is_numpy(cases):
    b = damped(**EXPRESSIONS)
    rng = np.random.default_rng(1)
    points = {"t": rng.uniform(0.2, 1.5, 200), "c": rng.uniform(0.5, 2.0, 200)}
    y = sq.evaluate(b, points)
    for at, (t, c) in enumerate(zip(points["t"], points["c"], strict=True)):
        k = np.array(SPRINGS) - (0.4 + 0.5 * t) * np.array([[0, 4 / 3], [0, 0]])
        damping = 0.05 * c * t * np.eye(2) + np.array([[-0.01 * c, 0], [0, 0]])
        lam = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-k, -damping]]))
        assert abs(y.growth[at] - lam.real.max()) < 1e-7
        assert y.unstable[at] == np.sum((lam.real > 1e-9) & (lam.imag > 0))
    assert np.all(y.open == 0) and not y.failures
    # A callable gives the same bits, and one parameter alone leaves the other at its median.
    again = sq.evaluate(damped(**OPEN, coefficients=callable_), points, threads=1)
    assert np.array_equal(again.growth, y.growth)
    assert np.array_equal(
        sq.evaluate(b, {"t": points["t"]}).growth, sq.evaluate(b, {**points, "c": np.full(200, 1.0)}).growth
    )
    lattice = sq.evaluate(sq.Case(cases / "two-by-two.toml"), {"mu": [0.0, 1.3]}, law="amontons-coulomb")
    assert lattice.unstable[0] == 0 < lattice.unstable[1]


def test_points_that_fail_are_named():
    b = hoffmann(contacts=[sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu="sqrt(mu - 0.5)")])
    with pytest.warns(sq.FailureWarning, match="1 of 2 points failed"):
        y = sq.evaluate(b, {"mu": [0.0, 1.0]})
    assert list(y.failures) == [0] and np.isnan(y.growth[0]) and y.unstable[0] == -1 and np.isfinite(y.growth[1])


def test_every_distribution_is_that_of_the_case_files():
    all_of = {
        "a": sq.Constant(1.0),
        "b": sq.Normal(1.0, 0.1),
        "c": sq.Normal(1.0, 0.1, 0.8, 1.2),
        "d": sq.LogNormal(1.0, 0.1, at_most=1.3),
        "e": sq.LogUniform(0.5, 2.0),
        "f": sq.Triangular(0.5, 1.0, 2.0),
        "g": sq.Weibull(3.0, 1.0, 0.1),
        "h": sq.Quantiles([0.0, 0.5, 1.0], [0.1, 0.5, 2.0]),
        "i": sq.Discrete([0.5, 1.0], [1.0, 3.0]),
        "j": sq.Empirical(np.array([1.2, 0.7, 1.0])),
        "k": sq.Uniform(0.5, 1.1),
    }
    mu = " + ".join(f"0.07 * {name}" for name in all_of)
    of = hoffmann(parameters=all_of, contacts=[sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu=mu)])
    medians = {name: median for name, _, median in of._native.parameters()}
    assert medians["j"] == 1.0 and medians["e"] == pytest.approx(1.0) and medians["h"] == 0.5
    r = sq.run(of, samples=50, keep_samples=True, progress=False)
    assert r.failures.rows == 0 and set(all_of) - {"a"} < set(r.samples)
    tied = damped(**EXPRESSIONS, correlation=(["t", "c"], [[1.0, 0.9], [0.9, 1.0]]))
    samples = sq.run(tied, samples=400, keep_samples=True, progress=False).samples
    assert np.corrcoef(samples["t"], np.log(samples["c"]))[0, 1] > 0.8


#: Another number each time.
COUNT = itertools.count(1)


def nothing(p):
    return {}


@pytest.mark.parametrize(
    ("make", "kind", "part"),
    [
        (lambda: hoffmann(terms=[sq.Term("springs", mass=np.eye(3)[:2])]), sq.ArgumentError, "terms 'springs'.mass"),
        (lambda: hoffmann(terms=[sq.Term("springs", mass=[[np.inf]])]), sq.ArgumentError, "a finite number"),
        (lambda: hoffmann(terms=[sq.Term("springs", mass=np.eye(2), stiffness=np.triu(SPRINGS))]), sq.CaseError, 'symmetry = "upper"'),
        (lambda: hoffmann(terms=[sq.Term("springs", mass=1j * np.eye(2))]), sq.ArgumentError, "real numbers"),
        (lambda: hoffmann(parameters={"mu": 0.5}), sq.ArgumentError, "parameters['mu'] = 0.5"),
        (lambda: hoffmann(parameters={"mu": sq.Uniform(1.0, 0.5)}), sq.CaseError, "parameters.mu.to"),
        (lambda: hoffmann(parameters={"nu": sq.Uniform(0.5, 1.0)}), sq.CaseError, "mu"),
        (lambda: hoffmann(tables={"f": 3}), sq.ArgumentError, "tables['f'] = 3; allowed: (at, value)"),
        (lambda: hoffmann(tables={"f": ([0.0, 1.0], [1.0])}), sq.ArgumentError, "shapes (2,) and (1,)"),
        (lambda: hoffmann(tables={"f": ([0.0, 1.0], [1.0, np.nan])}), sq.ArgumentError, "tables['f']: value[1] = nan"),
        (lambda: hoffmann(tables={"f": ([1.0, 0.0], [1.0, 2.0])}), sq.CaseError, "tables.f.at"),
        (lambda: hoffmann(tables={"f": ([0.0, 1.0], [1.0, 2.0])}), sq.CaseError, "tables.f = used nowhere"),
        (lambda: hoffmann(dofs=["x"]), sq.CaseError, "brake.dofs"),
        (lambda: hoffmann(constraints={"held": ["z"]}), sq.CaseError, "constraints"),
        (lambda: hoffmann(samples=0), sq.ArgumentError, "samples = 0"),
        (lambda: hoffmann(coefficients=lambda p: 5), sq.ArgumentError, "a dict of arrays"),
        (lambda: hoffmann(coefficients=lambda p: {"glue": p["mu"]}), sq.ArgumentError, '"springs", "dashpots", "belt.mu"'),
        (lambda: hoffmann(coefficients=lambda p: {"belt.mu": p["mu"]}), sq.ArgumentError, "one of them"),
        (lambda: hoffmann(coefficients=5), sq.ArgumentError, "coefficients = 5; allowed: a function"),
        (lambda: damped(**OPEN, coefficients=lambda p: {"belt.mu": np.ones(len(p["t"]) + 1)}), sq.ArgumentError, "one for each sample"),
        (lambda: damped(**OPEN, coefficients=lambda p: {"belt.mu": np.array([])}), sq.ArgumentError, "one for each sample"),
        (lambda: damped(**OPEN, coefficients=lambda p: {"belt.mu": np.nan}), sq.ArgumentError, "a finite number"),
        (lambda: damped(**OPEN, coefficients=lambda p: {"belt.mu": "a"}), sq.ArgumentError, "real numbers"),
        (lambda: damped(**OPEN, coefficients=lambda p: {"belt.mu": next(COUNT)}), sq.ArgumentError, "depends on the parameters alone"),
        (lambda: hoffmann(dofs=["\udc80", "y"]), sq.ArgumentError, "text that is Unicode"),
        (lambda: hoffmann(samples=2**64), sq.ArgumentError, "below 2^63"),
        (lambda: hoffmann(seed="1"), sq.ArgumentError, "seed = '1'"),
        (lambda: sq.Case(3), sq.ArgumentError, "path = 3; allowed: a path"),
        (lambda: sq.read_matrices(b"K.mtx"), sq.ArgumentError, "path = b'K.mtx'; allowed: a path"),
        (lambda: sq.load(None), sq.ArgumentError, "folder = None; allowed: a path"),
        (lambda: sq.run(hoffmann(), out=4), sq.ArgumentError, "out = 4; allowed: a path"),
        (lambda: sq.merge(hoffmann(), "parts"), sq.ArgumentError, "parts = 'parts'; allowed: a list of folders"),
        (lambda: damped(**OPEN, coefficients=nothing), sq.ArgumentError, "friction of every contact"),
        (lambda: hoffmann(correlation=(["mu"], [[np.nan]])), sq.ArgumentError, "correlation[0, 0]"),
        (lambda: sq.run(hoffmann(), design={"nu": [1.0]}), sq.ArgumentError, "one for each parameter: ['mu']"),
        (lambda: sq.run(hoffmann(), design={"mu": [np.nan]}), sq.ArgumentError, "design['mu'][0] = nan"),
        (lambda: sq.run(hoffmann(), design={"mu": []}), sq.ArgumentError, "at least 1"),
        (lambda: sq.run(hoffmann(), design=[1.0]), sq.ArgumentError, "a DataFrame"),
        (lambda: sq.run(hoffmann(), design={"mu": [1.0]}, samples=4), sq.ArgumentError, "None beside `design`"),
        (lambda: sq.run(hoffmann(), design={"mu": np.ma.masked_equal([0.7, 0.8], 0.7)}), sq.ArgumentError, "none masked"),
        (lambda: sq.run(hoffmann(), design={1: [1.0], "1": [1.0]}), sq.ArgumentError, "each of them once"),
        (lambda: sq.run(hoffmann(), design={"mu": [0.7, [0.8, 0.9]]}), sq.ArgumentError, "an array of numbers"),
        (lambda: hoffmann(contacts=[sq.Contact("belt", force={"x": np.complex128(1 + 2j)}, mu=1.0)]), sq.ArgumentError, "belt'.force['x']"),
        (lambda: hoffmann(parameters={"mu": sq.Empirical(np.array([0.5, 1 + 1j]))}), sq.ArgumentError, "real numbers"),
        (lambda: sq.cea(hoffmann(), contact=1), sq.ArgumentError, "a list of numbers of contacts"),
        (lambda: sq.cea(hoffmann(), speed=np.complex128(1 + 2j)), sq.ArgumentError, "speed = (1+2j); allowed: a number"),
        (lambda: sq.run(hoffmann(), half_width=np.complex128(0.1 + 2j), progress=False), sq.ArgumentError, "half_width"),
        (lambda: sq.sweep(hoffmann(), mu=(0.5, np.complex128(1 + 2j))), sq.ArgumentError, "mu = "),
        (lambda: sq.sweep(hoffmann(), {"mu": (0.5, 1.1)}, mu=(0.5, 0.9)), sq.ArgumentError, "one range"),
        (lambda: sq.screen(hoffmann(), kinds="mass"), sq.ArgumentError, "kinds = 'mass'"),
        (lambda: sq.screen(hoffmann(), variants=[hoffmann()]), sq.ArgumentError, "a mapping of names to brakes"),
        (lambda: sq.screen(hoffmann(), variants={"a b": hoffmann()}), sq.ArgumentError, "variants = 'a b'; allowed: names of 1 to 60"),
        (lambda: sq.screen(hoffmann(), variants={"a": 1.0}), sq.ArgumentError, "variants['a'] = 1.0; allowed: a brake or a case"),
        (lambda: sq.screen(hoffmann(), factor=1.0), sq.ArgumentError, "factor = 1.0; allowed: a number > 1"),
        (lambda: sq.shard(hoffmann(), None, 3, out="s"), sq.ArgumentError, "number = None"),
        (lambda: sq.run(hoffmann(), progress=True), sq.ArgumentError, "progress = True"),
        (lambda: sq.evaluate(hoffmann(), {1: [1.0]}), sq.ArgumentError, "a column \"1\"; allowed: mu"),
        (lambda: sq.evaluate(hoffmann(), pandas.DataFrame({1: [1.0]})), sq.ArgumentError, "a column \"1\"; allowed: mu"),
        (lambda: sq.evaluate(hoffmann(), {"nu": [1.0]}), sq.ArgumentError, "allowed: mu"),
    ],
)
def test_what_is_wrong_with_a_brake_is_named(make, kind, part):
    with pytest.raises(kind) as caught:
        make()
    assert part in str(caught.value) and "\n" not in str(caught.value)


def test_parameters_with_the_names_of_columns_lose_none():
    """Tables of the same brake whose one parameter has another name."""
    plain = sq.sweep(hoffmann(), mu=(0.5, 1.1), progress=False)
    kept = sq.run(hoffmann(), samples=50, keep_samples=True, progress=False).samples
    for name in ("growth", "speed", "error", "frequency_hz", "unstable", "index"):
        contact = sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3}, mu=name)
        b = hoffmann(contacts=[contact], parameters={name: sq.Uniform(0.5, 1.1, unit="1")})
        w = sq.sweep(b, {name: (0.5, 1.1)}, progress=False)
        for table, own in ((plain.branches, w.branches), (plain.onsets, w.onsets), (plain.coalescences, w.coalescences)):
            assert len(own) == len(table)
            for expected, found in zip(table.values(), own.values(), strict=True):
                assert found.dtype == expected.dtype and np.array_equal(found, expected)
        drawn = sq.run(b, samples=50, keep_samples=True, progress=False).samples
        assert len(drawn) == len(kept)
        for expected, found in zip(kept.values(), drawn.values(), strict=True):
            assert found.dtype == expected.dtype and np.array_equal(found, expected)
    assert plain.onsets["error"].dtype.kind == "f" and plain.coalescences["other_mode"].dtype.kind == "U"


def test_unstable_modes_of_samples_are_text_even_if_there_are_none():
    b = hoffmann(parameters={"mu": sq.Uniform(0.1, 0.2)})
    unstable = sq.run(b, samples=10, keep_samples=True, progress=False).samples["unstable"]
    assert unstable.dtype.kind == "U" and not unstable.astype(bool).any()


@pytest.mark.parametrize("what", ["raises", "long", "complex", "masked", "other"])
def test_a_callable_that_goes_wrong_ends_the_study_and_spoils_nothing(what, tmp_path):
    state = {"wrong": False, "calls": 0}

    def sometimes(p):
        found = callable_(p)
        state["calls"] += 1
        if state["wrong"] and state["calls"] > 20:
            if what == "raises":
                raise ZeroDivisionError("mine")
            if what == "other":
                return {"dashpots": 1.0}
            wrong = {"long": np.ones(len(p["t"]) + 1), "complex": np.complex128(0.5 + 0.1j)}
            found["belt.mu"] = wrong.get(what, np.ma.masked_greater(p["t"], 0.0))
        return found

    b = damped(**OPEN, coefficients=sometimes, samples=2000)
    state.update(wrong=True, calls=0)
    with pytest.raises(ZeroDivisionError if what == "raises" else sq.ArgumentError, match="mine|coefficients"):
        sq.run(b, out=tmp_path / "s", progress=False)
    state.update(wrong=False)
    r = sq.run(b, out=tmp_path / "s", progress=False)
    assert r.failures.rows == 0
    same_results(r, sq.run(damped(**EXPRESSIONS, samples=2000), progress=False))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_of_a_callable_that_are_not_finite_fail_their_samples_alone(bad, cases):
    def sometimes(p):
        found = callable_(p)
        found["belt.mu"] = np.where(p["t"] > 1.1, bad, found["belt.mu"])
        return found

    b = damped(**OPEN, coefficients=sometimes, samples=600)
    points = {"t": np.linspace(0.2, 1.5, 300), "c": np.full(300, 1.0)}
    fails = points["t"] > 1.1
    with pytest.warns(sq.FailureWarning, match=f"{fails.sum()} of 300 points failed; first: coefficients: .belt.mu. = .*; allowed: a finite number"):
        y = sq.evaluate(b, points)
    assert sorted(y.failures) == list(np.flatnonzero(fails)) and np.isnan(y.growth[fails]).all()
    whole = sq.evaluate(damped(**OPEN, coefficients=callable_), points)
    assert np.array_equal(y.growth[~fails], whole.growth[~fails]) and np.array_equal(y.unstable[~fails], whole.unstable[~fails])
    # In a study they are failures with their reason; where most fail it says so, as of any other reason.
    r = sq.run(b, design=points, progress=False)
    assert r.failures.rows == fails.sum() and all("a finite number" in reason for reason in r.failures["error"])
    with pytest.warns(sq.FailureWarning, match="2 of 2 evaluations failed.*a finite number"):
        sq.run(b, design={"t": [1.2, 1.3], "c": [1.0, 1.0]}, progress=False)


def test_only_matrices_take_samples_of_ones_own(cases):
    with pytest.raises(sq.ArgumentError, match="given by its matrices"):
        sq.run(sq.Case(cases / "two-by-two.toml"), design={"mu": [0.5]})


def test_brakes_go_to_other_processes(cases):
    for b in (hoffmann(), sq.Case(cases / "hoffmann.toml", samples=50, set={"parameters.mu.to": 1.0}), damped(**OPEN, coefficients=callable_)):
        again = pickle.loads(pickle.dumps(b))
        assert repr(again) == repr(b) and again.samples == b.samples
        assert np.array_equal(sq.cea(again).eigenvalues, sq.cea(b).eigenvalues)


def test_a_callable_that_goes_wrong_ends_other_questions():
    state = {"calls": 0}

    def third(p):
        state["calls"] += 1
        if state["calls"] > 3:
            raise ZeroDivisionError("mine")
        return callable_(p)

    for ask in (
        lambda b: sq.evaluate(b, {"t": np.linspace(0.2, 1.5, 500)}),
        lambda b: sq.sweep(b, t=(0.2, 1.5), progress=False),
        lambda b: sq.influence(b, samples=200, progress=False),
        lambda b: sq.screen(b, kinds=["dashpot"], up_to=1, samples=20, progress=False),
    ):
        state["calls"] = 0
        b = damped(**OPEN, coefficients=third)
        with pytest.raises(ZeroDivisionError, match="mine"):
            ask(b)
