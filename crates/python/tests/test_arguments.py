"""Every argument of every public function with values that are wrong: what comes out is an exception of squeal, in one line."""

import dataclasses
import inspect
import pathlib
import warnings

import matplotlib
import numpy as np
import pytest
import scipy.sparse

import squeal as sq
from conftest import ROOT

matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402

K = np.array([[2.0, 1.0 - 0.8 * 4 / 3], [1.0, 2.0]])
SPRINGS = [[2.0, 1.0], [1.0, 2.0]]
SPRING = {"name": "springs", "mass": np.eye(2), "stiffness": SPRINGS}
BELT = {"name": "belt", "force": {"x": -1.0}, "reading": {"y": 4 / 3}, "mu": "mu"}
PARTS = {
    "terms": [sq.Term(**SPRING), sq.Term("dashpots", damping=0.05 * np.eye(2))],
    "contacts": [sq.Contact(**BELT)],
    "parameters": {"mu": sq.Uniform(0.5, 1.1)},
    "dofs": ["x", "y"],
    "samples": 3,
}
BRAKE = sq.Brake(**PARTS)
HOFFMANN = ROOT / "cases" / "hoffmann.toml"


def with_distribution(made):
    """A brake of which a parameter has a distribution."""
    return lambda **arguments: sq.Brake(**{**PARTS, "parameters": {"mu": made(**arguments)}})


def with_contact(**arguments):
    return sq.Brake(**{**PARTS, "contacts": [sq.Contact(**arguments)]})


def with_lag(**arguments):
    return with_contact(**BELT, lag=sq.Lag(**arguments))


def with_term(**arguments):
    return sq.Brake(**{**PARTS, "terms": [sq.Term(**arguments)]})


#: Of each public function what is called, whose signature says the arguments, and arguments that are right.
CALLS = {
    "eig": (sq.eig, sq.eig, {"M": np.eye(2), "C": None, "K": K}),
    "eig of a box": (sq.eig, sq.eig, {"M": np.eye(2), "C": None, "K": K, "box": ((-1, 1), (0, 3))}),
    "eig of a band": (sq.eig, sq.eig, {"M": np.eye(2), "C": None, "K": scipy.sparse.csr_array(K), "band_hz": (0.1, 1.0)}),
    "eigvals": (sq.eigvals, sq.eigvals, {"M": np.eye(2), "C": None, "K": K}),
    "check": (sq.check, sq.check, {"M": np.eye(2), "C": None, "K": K}),
    "read_matrices": (sq.read_matrices, sq.read_matrices, {"path": ROOT / "tests/fixtures/hard/spring5/K.mtx"}),
    "Case": (sq.Case, sq.Case, {"path": HOFFMANN}),
    "Brake": (sq.Brake, sq.Brake, PARTS),
    "Term": (with_term, sq.Term, SPRING),
    "Contact": (with_contact, sq.Contact, BELT),
    "Lag": (with_lag, sq.Lag, {"decay": 1.0, "drive": 0.1, "force": "mu"}),
    "run": (sq.run, sq.run, {"brake": BRAKE}),
    "shard": (sq.shard, sq.shard, {"brake": BRAKE, "number": 1, "of": 2, "out": "part"}),
    "merge": (sq.merge, sq.merge, {"brake": BRAKE, "parts": ["part"]}),
    "estimate": (sq.estimate, sq.estimate, {"brake": BRAKE}),
    "cea": (sq.cea, sq.cea, {"brake": BRAKE}),
    "sweep": (sq.sweep, sq.sweep, {"brake": BRAKE, "over": {"mu": (0.5, 1.1)}}),
    "influence": (sq.influence, sq.influence, {"brake": BRAKE, "samples": 100}),
    "cycle": (sq.cycle, sq.cycle, {"brake": BRAKE}),
    "cycle over": (sq.cycle, sq.cycle, {"brake": BRAKE, "over": {"mu": (0.7, 0.8)}}),
    "rare": (sq.rare, sq.rare, {"brake": BRAKE, "budget": 100}),
    "screen": (sq.screen, sq.screen, {"brake": BRAKE, "kinds": ["dashpot"], "up_to": 1, "draws": 1}),
    "evaluate": (sq.evaluate, sq.evaluate, {"brake": BRAKE, "points": {"mu": [0.7]}}),
    "load": (sq.load, sq.load, {"folder": "none"}),
    "Constant": (with_distribution(sq.Constant), sq.Constant, {"value": 0.5}),
    "Uniform": (with_distribution(sq.Uniform), sq.Uniform, {"from_": 0.5, "to": 1.0}),
    "Normal": (with_distribution(sq.Normal), sq.Normal, {"mean": 0.5, "deviation": 0.1}),
    "LogNormal": (with_distribution(sq.LogNormal), sq.LogNormal, {"median": 0.5, "sigma": 0.1}),
    "LogUniform": (with_distribution(sq.LogUniform), sq.LogUniform, {"from_": 0.5, "to": 1.0}),
    "Triangular": (with_distribution(sq.Triangular), sq.Triangular, {"from_": 0.5, "mode": 0.7, "to": 1.0}),
    "Weibull": (with_distribution(sq.Weibull), sq.Weibull, {"shape": 3.0, "scale": 1.0}),
    "Quantiles": (with_distribution(sq.Quantiles), sq.Quantiles, {"probabilities": [0.0, 1.0], "values": [0.5, 1.0]}),
    "Discrete": (with_distribution(sq.Discrete), sq.Discrete, {"values": [0.5, 1.0]}),
    "Empirical": (with_distribution(sq.Empirical), sq.Empirical, {"values": [0.5, 0.7]}),
}

WRONG = [
    None, True, 0, 3, -1, 2**70, 10**400, 1.5, np.nan, np.inf, 1j, "abc", "", "a\nb", "\udc80", "\ud800", "a\0b", b"x", [], [1], ["a"], [None],
    [[1, 0.5], [0.5, 1]], [[1.0], [1.0, 2.0]], (1, 2), ((1, 2), (3, "a")), {}, {"a": 1}, {1: "a"}, {"mu": None}, {"mu": [1.0]}, {"mu": ["a"]},
    {"x": "y"}, set(), object(), object, len, np.eye(3), np.float64(0.5), np.int64(1), np.array("a"), np.array([None, 1]), np.datetime64("2020"),
    range(2), (number for number in range(2)), pathlib.Path("none"), scipy.sparse.eye_array(3), scipy.sparse.coo_array([1.0, 2.0]), scipy.sparse.coo_array([1.0, 2.0]).tocsr(), pyplot, BRAKE, sq.Uniform(0.5, 1.1),
]
#: Arguments that are functions of the user, whose exceptions are passed on.
FUNCTIONS = {"progress", "coefficients"}


def arguments_of(signature):
    return [name for name in inspect.signature(signature).parameters if name not in ("self", "ranges")]


ARGUMENTS = [(name, argument) for name, (_, signature, _) in CALLS.items() for argument in arguments_of(signature)]


def only_errors_of_squeal(call, what):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call()
        except sq.SquealError as error:
            # The name of a file may have more than one line.
            assert "\n" not in str(error).replace("a\nb", ""), (what, error)
            assert not isinstance(error, sq.CaseError) or "line " not in str(error).split(";")[0], (what, error)
            assert error.allowed is None or error.allowed, what
        except Exception as error:
            raise AssertionError(f"{what}: {type(error).__name__}: {error}") from error


def test_every_public_function_is_asked():
    made = {name for name in sq.__all__ if callable(getattr(sq, name)) and not name[0].isupper()}
    assert made <= set(CALLS)
    distributions = {of.__name__ for of in sq.Distribution.__subclasses__()}
    assert distributions <= set(CALLS) and {"Case", "Brake", "Term", "Contact", "Lag"} <= set(CALLS)
    assert all(dataclasses.is_dataclass(getattr(sq, name)) for name in distributions)


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
def test_wrong_values_are_refused_in_a_line(name, argument, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, signature, right = CALLS[name]
    quiet = {"progress": False} if "progress" in arguments_of(signature) else {}
    for wrong in WRONG:
        if argument in FUNCTIONS and callable(wrong):
            continue
        given = {**quiet, **right, argument: wrong}
        only_errors_of_squeal(lambda given=given: call(**given), f"{name}({argument}={wrong!r})")


@pytest.fixture(scope="module")
def results():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield {
            "run": sq.run(BRAKE, progress=False),
            "sweep": sq.sweep(BRAKE, mu=(0.5, 1.1), progress=False),
            "influence": sq.influence(BRAKE, samples=100, progress=False),
            "eig": sq.eig(np.eye(2), None, K),
        }


@pytest.mark.parametrize(
    ("of", "method"), [("run", "save"), ("run", "plot_occurrence"), ("run", "plot_modes"), ("sweep", "plot"), ("influence", "plot"), ("eig", "plot")]
)
def test_wrong_values_are_refused_by_results(results, of, method, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for wrong in WRONG:
        only_errors_of_squeal(lambda wrong=wrong: getattr(results[of], method)(wrong), f"{of}.{method}({wrong!r})")
    if method == "plot_occurrence":
        for wrong in WRONG:
            only_errors_of_squeal(lambda wrong=wrong: results[of].plot_occurrence(law=wrong), f"plot_occurrence(law={wrong!r})")
    pyplot.close("all")


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_ranges_of_a_sweep_are_refused(wrong):
    only_errors_of_squeal(lambda: sq.sweep(BRAKE, mu=wrong, progress=False), f"sweep(mu={wrong!r})")


@pytest.mark.parametrize(
    ("call", "argument", "part"),
    [
        (lambda: sq.run("cases/hoffmann.toml"), "brake", "squeal.Case of the path of a case file"),
        (lambda: sq.run(None), "brake", "squeal.Case"),
        (lambda: sq.Case(HOFFMANN, set=[1]), "set", "a dict"),
        (lambda: sq.Brake(**{**PARTS, "dofs": 2}), "dofs", "a list of names"),
        (lambda: sq.Brake(**{**PARTS, "dofs": "xy"}), "dofs", "a list of names"),
        (lambda: sq.Brake(**{**PARTS, "terms": "abc"}), "terms", "a list of squeal.Term"),
        (lambda: sq.Brake(**{**PARTS, "terms": ["abc"]}), "terms", "a list of squeal.Term"),
        (lambda: sq.Brake(**PARTS, correlation=[[1, 0.5], [0.5, 1]]), "correlation", "(names of parameters, matrix)"),
        (lambda: sq.Brake(**PARTS, correlation=(["mu"], [[1.0, 0.5]])), "correlation", "(1, 1)"),
        (lambda: sq.run(BRAKE, progress=False).plot_occurrence(ax=3), "ax", "axes of matplotlib"),
        (lambda: sq.Uniform("a", 1), "from_", "a number"),
        (lambda: sq.run(BRAKE, keep_samples="yes"), "keep_samples", "True or False"),
        (lambda: sq.cea(BRAKE, law=3), "law", "text"),
        (lambda: sq.run(BRAKE, out=""), "out", "a path"),
        (lambda: sq.eig(np.eye(2), None, K, progress=3), "progress", "None, False"),
    ],
)
def test_the_argument_that_is_wrong_is_named(call, argument, part):
    with pytest.raises(sq.ArgumentError) as caught:
        call()
    assert caught.value.argument == argument and part in caught.value.allowed


def test_what_is_missing_is_an_error_of_the_system_too(tmp_path):
    none = tmp_path / "none"
    for ask, kind in ((sq.Case, sq.CaseError), (sq.read_matrices, sq.FileError), (sq.load, sq.FolderError)):
        with pytest.raises(FileNotFoundError) as missing:
            ask(none)
        assert isinstance(missing.value, kind) and missing.value.path == str(none)
    with pytest.raises(sq.FileError) as folder:
        sq.read_matrices(tmp_path)
    assert folder.value.allowed == "a regular file" and not isinstance(folder.value, OSError)
    with pytest.raises(sq.FolderError) as part:
        sq.merge(BRAKE, [tmp_path], progress=False)
    assert part.value.path == str(tmp_path) and part.value.allowed.startswith("complete parts")
