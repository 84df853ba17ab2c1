"""Studies against the files that the program writes for the same case, and parts, sweeps, influence and screens against its tables."""

import csv
import filecmp
import json
import math
import pickle
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

import squeal as sq
from conftest import ROOT

#: Cases, and samples of each that take little time.
SAMPLES = {"hoffmann.toml": 300, "two-by-two.toml": 40, "wobbling-disc.toml": 60}
#: What differs between any two runs.
OWN = {"manifest.json", "run.lock"}


def program(*arguments):
    done = subprocess.run([sys.executable, "-m", "squeal", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def same_files(folder, other):
    names = sorted({path.name for path in folder.iterdir()} - OWN)
    assert names == sorted({path.name for path in other.iterdir()} - OWN)
    matching, different, errors = filecmp.cmpfiles(folder, other, names, shallow=False)
    assert (different, errors) == ([], []) and len(matching) > 10


def same_table(table, path):
    """Whether the columns of a table are those of a CSV file, to the last bit."""
    with path.open(newline="") as file:
        columns, *rows = csv.reader(file)
    assert table.columns == columns and table.rows == len(rows)
    for at, name in enumerate(columns):
        cells, column = [row[at] for row in rows], table[name]
        if column.dtype.kind == "f":
            expected = [float(cell) if cell else np.nan for cell in cells]
            assert np.array_equal(column, expected, equal_nan=True)
        else:
            assert [str(cell) for cell in column] == cells


def test_cells_have_no_apostrophe_against_spreadsheets(tmp_path):
    (tmp_path / "samples.csv").write_text("law,mode\n'-z,'=a\n''-z,-1\n'a,-\n")
    table = sq.Table.read(tmp_path / "samples.csv")
    assert (list(table["law"]), list(table["mode"])) == (["-z", "'-z", "'a"], ["=a", "-1", "-"])


@pytest.mark.parametrize("name", SAMPLES)
def test_a_study_is_that_of_the_program_table_by_table(name, cases, tmp_path):
    program("run", cases / name, "--samples", SAMPLES[name], "--seed", 5, "--keep-samples", "--out", tmp_path / "program")
    r = sq.run(sq.Case(cases / name, samples=SAMPLES[name], seed=5), keep_samples=True, progress=False)
    written = {path.stem for path in (tmp_path / "program").glob("*.csv")}
    assert set(r.tables) == written and {"occurrence", "samples", "influence"} <= written
    for name in written:
        same_table(r.tables[name], tmp_path / "program" / f"{name}.csv")
    r.save(tmp_path / "saved")
    same_files(tmp_path / "program", tmp_path / "saved")
    again = sq.load(tmp_path / "saved")
    assert again.manifest["seed"] == 5 and again.occurrence.to_pandas().equals(r.occurrence.to_pandas())
    with pytest.raises(ValueError, match="read-only"):
        r.occurrence["occurrence"][:] = 0


def test_a_saved_study_goes_on(cases, tmp_path):
    case = sq.Case(cases / "hoffmann.toml")
    sq.run(case, samples=100, progress=False).save(tmp_path / "s")
    with pytest.raises(sq.FolderError, match="is not empty"):
        sq.run(case, samples=100, progress=False).save(tmp_path / "s")
    longer = sq.run(case, samples=200, out=tmp_path / "s", progress=False)
    once = sq.run(case, samples=200, out=tmp_path / "once", progress=False)
    same_files(tmp_path / "s", tmp_path / "once")
    assert np.array_equal(longer.occurrence["unstable"], once.occurrence["unstable"])
    assert set(once.occurrence["samples"]) == {200}
    with pytest.raises(sq.FolderError, match="holds 200 samples already"):
        sq.run(case, samples=100, out=tmp_path / "s", progress=False)
    with pytest.raises(sq.FolderError) as other:
        sq.run(case, samples=100, seed=2, out=tmp_path / "s", progress=False)
    assert other.value.path == str(tmp_path / "s") and "allowed" in str(other.value)
    with pytest.raises(sq.FolderError, match="a study that has finished"):
        sq.load(tmp_path)


def test_occurrence_is_the_closed_form(cases):
    r = sq.run(sq.Case(cases / "hoffmann.toml"), samples=4000, half_width=0.01, progress=False)
    (found,) = [at for at in range(r.occurrence.rows) if r.occurrence["mode"][at] == "2"]
    assert r.occurrence["lower"][found] < 0.577083 < r.occurrence["upper"][found]
    assert r.estimates.rows > 0 and "0.57" in r.text
    looked = sq.run(sq.Case(cases / "hoffmann.toml"), until_half_width=0.05, progress=False)
    assert looked.manifest["stopped"]["half_width"] == 0.05


def test_parts_are_put_together_to_one_run(cases, tmp_path):
    case = sq.Case(cases / "hoffmann.toml", samples=500)
    parts = [sq.shard(case, at, 3, out=tmp_path / f"p{at}", progress=False) for at in (1, 2, 3)]
    assert sorted(index for part in parts for index in part.samples) == list(range(500))
    assert sq.shard(case, 2, 3, out=tmp_path / "p2", progress=False) == parts[1]
    sq.merge(case, [tmp_path / "p3", parts[0], parts[1]], out=tmp_path / "whole", progress=False)
    sq.run(case, out=tmp_path / "once", progress=False)
    same_files(tmp_path / "whole", tmp_path / "once")
    with pytest.raises(sq.FolderError, match="no part has the samples"):
        sq.merge(case, parts[1:], progress=False)
    with pytest.raises(sq.FolderError, match="is no part of a study; allowed: complete parts"):
        sq.merge(case, [tmp_path / "none"], progress=False)
    with pytest.raises(sq.ArgumentError, match="shard = 4/3"):
        sq.shard(case, 4, 3, out=tmp_path / "p4", progress=False)


@pytest.mark.parametrize("name", SAMPLES)
def test_one_analysis_is_that_of_the_program(name, cases):
    e = sq.cea(sq.Case(cases / name), why=True)
    assert e.json == json.loads(program("cea", cases / name, "--json", "--modes", "--why"))
    assert e.shapes.shape[1] == len(e) and np.all(e.eigenvalues.imag > 0) and e.work["net"].shape[0] == len(e)
    assert [why is not None for why in e.why] == list(e.unstable)


def test_sweeps_are_those_of_the_program(cases, tmp_path):
    case = sq.Case(cases / "two-by-two.toml")
    program("sweep", cases / "two-by-two.toml", "--over", "mu=0:1.3", "--out", tmp_path / "one")
    w = sq.sweep(case, mu=(0, 1.3), progress=False)
    for name in ("branches", "onsets", "coalescences"):
        same_table(getattr(w, name), tmp_path / "one" / f"{name}.csv")
    hoffmann = sq.sweep(sq.Case(cases / "hoffmann.toml"), {"mu": (0.5, 1.1)}, progress=False)
    assert abs(hoffmann.onsets["mu"][0] - 0.75375) < 1e-9
    program("sweep", cases / "two-by-two.toml", "--over", "mu=0:1.3", "--over", "x_damping=50:400", "--out", tmp_path / "two")
    m = sq.sweep(case, mu=(0, 1.3), x_damping=(50, 400), progress=False)
    for name in ("boundary", "regions"):
        same_table(getattr(m, name), tmp_path / "two" / f"{name}.csv")
    with pytest.raises(sq.ArgumentError, match="one or two"):
        sq.sweep(case, progress=False)
    with pytest.raises(sq.ArgumentError) as unknown:
        sq.sweep(case, friction=(0, 1), progress=False)
    assert "mu" in unknown.value.allowed


def test_influence_is_that_of_the_program(cases, tmp_path):
    arguments = ("--samples", 400, "--total", 100, "--law", "velocity-dependent")
    program("influence", cases / "two-by-two.toml", *arguments, "--out", tmp_path / "i")
    i = sq.influence(sq.Case(cases / "two-by-two.toml"), samples=400, total=100, law="velocity-dependent", progress=False)
    same_table(i.table, tmp_path / "i" / "influence.csv")
    with pytest.raises(sq.ArgumentError, match="100 to 1000000"):
        sq.influence(sq.Case(cases / "hoffmann.toml"), samples=5, progress=False)


def test_a_motion_is_that_of_the_program(cases, tmp_path):
    case = sq.Case(cases / "hoffmann.toml")
    program("cycle", cases / "hoffmann.toml", "--harmonics", 5, "--out", tmp_path / "c")
    m = sq.cycle(case, harmonics=5, progress=False)
    for table, name in ((m.cycles, "cycles"), (m.contacts, "cycle_contacts"), (m.spectrum, "cycle_spectrum")):
        same_table(table, tmp_path / "c" / f"{name}.csv")
    assert m.cycles["kind"][0] == "cycle" and "multiplier" in m.text
    program("cycle", cases / "hoffmann.toml", "--over", "mu=0.7:0.8", "--out", tmp_path / "b")
    over = sq.cycle(case, mu=(0.7, 0.8), progress=False)
    same_table(over.branches, tmp_path / "b" / "cycle_branches.csv")
    with pytest.raises(AttributeError, match="a motion at the medians"):
        over.cycles
    noise = sq.cycle(sq.Case(cases / "paper.toml"), law="velocity-dependent", speed=3.2, from_="noise", progress=False)
    assert list(noise.cycles["from_mode"]) == [f"noise {stream}" for stream in (1, 2, 3, 4)]
    for wrong, said in (
        ({"from_": 7}, "from_ = 7; allowed: noise, or the rank of an unstable mode: 2"),
        ({"from_": "mode"}, "from_ = "),
        ({"harmonics": 600}, "harmonics = 600; allowed: 1 to 100"),
        ({"stick": 0.0}, "stick = 0"),
        ({"mu": (0.7, 0.8), "from_": 2}, "None beside a range"),
        ({"mu": (0.7, 0.8), "c": (1, 2)}, "one parameter"),
    ):
        with pytest.raises(sq.ArgumentError, match=re.escape(said)):
            sq.cycle(case, progress=False, **wrong)
    with pytest.raises(sq.SquealError, match="no mode oscillates and grows"):
        sq.cycle(sq.Case(cases / "hoffmann.toml", set={"mu": 0.1}), progress=False)


def test_motions_of_draws_are_those_of_the_program(cases, tmp_path):
    program("run", cases / "hoffmann.toml", "--samples", 40, "--cycles", 4, "--out", tmp_path / "d")
    r = sq.run(sq.Case(cases / "hoffmann.toml"), samples=40, cycles=4, progress=False)
    same_table(r.cycles_of_draws, tmp_path / "d" / "cycles_of_draws.csv")
    assert len(r.cycles_of_draws["kind"]) == 4 and {"cycles_by_mode", "cycles_by_scene"} <= set(r.tables)
    with pytest.raises(AttributeError, match="run. with cycles"):
        sq.run(sq.Case(cases / "hoffmann.toml"), samples=20, progress=False).cycles_of_draws


def test_rare_squeal_is_that_of_the_program(cases, tmp_path):
    scene = ("--law", "velocity-dependent", "--constraints", "corners-4-6")
    program("rare", cases / "paper.toml", *scene, "--out", tmp_path / "r")
    r = sq.rare(sq.Case(cases / "paper.toml"), law="velocity-dependent", constraints="corners-4-6", progress=False)
    same_table(r.table, tmp_path / "r" / "rare.csv")
    same_table(r.design_points, tmp_path / "r" / "design_points.csv")
    lower, upper = r.limits
    assert 0 < lower <= r.probability <= upper < 1 and r.json["spectra"] > 0
    # One input: the onset and the tail of a normal distribution say it in closed form.
    case = sq.Case(cases / "hoffmann.toml", set={"mu": sq.Normal(0.5, 0.06)})
    onset = sq.sweep(case, mu=(0.5, 1.1), progress=False).onsets["mu"][0]
    exact = 0.5 * math.erfc((onset - 0.5) / 0.06 / math.sqrt(2))
    assert abs(sq.rare(case, progress=False).probability / exact - 1) < 1e-6
    with pytest.raises(sq.ArgumentError, match="relative = 2"):
        sq.rare(case, relative=2.0, progress=False)
    with pytest.raises(sq.ArgumentError, match="budget = 5"):
        sq.rare(case, budget=5, progress=False)


def test_a_screen_is_that_of_the_program(cases, tmp_path):
    options = ("--kinds", "constraint,dashpot", "--up-to", 1, "--samples", 20)
    program("screen", cases / "two-by-two.toml", *options, "--out", tmp_path / "x")
    x = sq.screen(sq.Case(cases / "two-by-two.toml"), kinds=("constraint", "dashpot"), up_to=1, samples=20, progress=False)
    same_table(x.ranked, tmp_path / "x" / "screen.csv")
    same_table(x.differences, tmp_path / "x" / "screen_differences.csv")
    with pytest.raises(sq.ArgumentError, match="kinds = \"glue\""):
        sq.screen(sq.Case(cases / "hoffmann.toml"), kinds=["glue"], progress=False)


def test_variants_are_those_of_the_program(cases, tmp_path):
    (tmp_path / "variants.toml").write_text(
        f"""
        [[variants]]
        name = "dashpots"
        set = ["terms.dashpots.coefficient=8"]
        [[variants]]
        name = "less-friction"
        case = '{(cases / "hoffmann.toml").resolve()}'
        set = ["mu.from=0.3", "mu.to=0.9"]
        """
    )
    options = ("--kinds", "scale", "--factor", 1.5, "--variants", tmp_path / "variants.toml", "--samples", 200)
    program("screen", cases / "hoffmann.toml", *options, "--out", tmp_path / "x")
    case = sq.Case(cases / "hoffmann.toml")
    variants = {
        "dashpots": sq.Case(cases / "hoffmann.toml", set={"terms.dashpots.coefficient": 8}),
        "less-friction": sq.Case(cases / "hoffmann.toml", set={"mu.from": 0.3, "mu.to": 0.9}),
    }
    x = sq.screen(case, kinds=["scale"], factor=1.5, variants=variants, samples=200, progress=False)
    same_table(x.ranked, tmp_path / "x" / "screen.csv")
    same_table(x.differences, tmp_path / "x" / "screen_differences.csv")
    alone = sq.screen(case, variants=variants, samples=200, progress=False)
    assert list(alone.ranked["kind"]) == ["set of constraints", "variant", "variant"]
    with pytest.raises(sq.SquealError, match="variant \"other\": laws = "):
        sq.screen(case, variants={"other": sq.Case(cases / "two-by-two.toml")}, samples=10, progress=False)


def test_fields_are_set_by_name(cases, tmp_path):
    path = cases / "hoffmann.toml"
    case = sq.Case(path, set={"parameters.mu": sq.Constant(0.9, unit="1"), "terms.dashpots.damping": [[0.2, 0], [0, 0.2]]})
    lam = sq.cea(case).eigenvalues
    # s^2 + c s + 2 = +- i sqrt(k3 mu - 1), in closed form.
    exact = np.concatenate([np.roots([1, 0.2, 2 - sign * 1j * np.sqrt(4 / 3 * 0.9 - 1)]) for sign in (1, -1)])
    assert np.max(np.min(np.abs(lam[:, None] - exact), axis=1)) < 1e-12
    assert sq.Case(path, set={"parameters.mu.to": 1.0, "study.samples": 7}).samples == 7
    fixed = sq.Case(path, set={"mu": 0.9, "terms.dashpots.damping": [[0.2, 0], [0, 0.2]]})
    assert np.array_equal(sq.cea(fixed).eigenvalues, lam)
    for field, wrong in (("nothing.mu", 1.0), ("terms.none.mass", [[1.0]]), ("terms", 1.0), ("parameters.mu.to", -1.0)):
        with pytest.raises(sq.CaseError) as refused:
            sq.Case(path, set={field: wrong})
        assert "\n" not in str(refused.value)
    with pytest.raises(sq.ArgumentError, match="numbers, text"):
        sq.Case(path, set={"study.name": object()})


def test_fields_of_what_python_cannot_read_are_set(cases, tmp_path):
    text = (cases / "hoffmann.toml").read_text()
    path = tmp_path / "brake.toml"
    path.write_text("\ufeff" + text, encoding="utf-8")
    assert sq.Case(path, set={"study.samples": 7}).samples == 7
    # Inline tables over lines are TOML 1.1.
    assert 'force = { x = -1.0 }' in text
    path.write_text(text.replace("force = { x = -1.0 }", "force = {\n x = -1.0 }"))
    assert sq.Case(path, set={"study.samples": 7}).samples == 7


def test_what_is_not_there_is_named(cases, tmp_path):
    case = sq.Case(cases / "two-by-two.toml", samples=5)
    line = sq.sweep(case, mu=(0, 1.3), progress=False)
    area = sq.sweep(case, mu=(0, 1.3), x_damping=(50, 400), progress=False)
    for of, name in ((line, "boundary"), (line, "regions"), (area, "onsets"), (area, "branches"), (area, "coalescences")):
        with pytest.raises(AttributeError, match="allowed: a sweep of"):
            getattr(of, name)
    r = sq.run(case, progress=False)
    (tmp_path / "file").write_text("")
    with pytest.raises(sq.FolderError, match="can be written"):
        r.save(tmp_path / "file" / "x")
    left = pickle.loads(pickle.dumps(r))
    shutil.rmtree(r.folder)
    with pytest.raises(sq.FolderError, match="is gone; allowed: `run` with `out`"):
        left.save(tmp_path / "s")
    assert left.occurrence.rows == r.occurrence.rows


def not_written(of):
    """Whether nothing of arrays, dicts and lists can be written to."""
    if isinstance(of, np.ndarray):
        return not of.flags.writeable
    if isinstance(of, dict):
        with pytest.raises(TypeError, match="not written to"):
            of["seed"] = 99
        with pytest.raises(TypeError, match="not written to"):
            of.update(seed=99)
        return all(map(not_written, of.values()))
    if isinstance(of, list):
        with pytest.raises(TypeError, match="not written to"):
            of.append(1)
        return all(map(not_written, of))
    return True


def test_results_are_not_written_to(cases):
    case = sq.Case(cases / "hoffmann.toml", samples=100)
    r, e = sq.run(case, progress=False), sq.cea(case, why=True)
    w, y = sq.sweep(case, mu=(0.5, 1.1), progress=False), sq.evaluate(case, {"mu": [0.6, 0.9]})
    for of in (r, e, w, y, *(pickle.loads(pickle.dumps(of)) for of in (r, e, w, y))):
        for name, part in of.__dict__.items():
            assert not_written(part), name
    for again in (r, pickle.loads(pickle.dumps(r))):
        assert not_written(again.occurrence["unstable"])
    with pytest.raises(AttributeError):
        r.tables.occurrence = None
    # They are plain data to others: JSON, copies, comparison.
    assert json.loads(json.dumps(r.manifest)) == r.manifest and {**r.manifest, "seed": 99}["seed"] == 99
    assert r.manifest.copy()["seed"] == 1 and isinstance(r.manifest, dict)


def test_every_mode_is_a_table_of_a_run_and_of_a_merge(cases, tmp_path):
    case = sq.Case(cases / "hoffmann.toml", samples=100)
    r = sq.run(case, every_mode=True, out=tmp_path / "s", progress=False)
    same_table(r.every_mode, tmp_path / "s" / "every_mode.csv")
    assert r.every_mode.rows == 200 and np.sum(r.every_mode["growth_rate"] > 0) == r.occurrence["unstable"].sum()
    parts = [sq.shard(case, number, 2, out=tmp_path / str(number), progress=False) for number in (1, 2)]
    sq.merge(case, parts, every_mode=True, out=tmp_path / "m", progress=False)
    assert (tmp_path / "m" / "every_mode.csv").read_bytes() == (tmp_path / "s" / "every_mode.csv").read_bytes()
    with pytest.raises(AttributeError, match="every_mode=True"):
        sq.run(case, progress=False).every_mode  # noqa: B018


def test_results_say_in_a_line_what_they_are_and_print_what_the_program_prints(cases, tmp_path):
    case = sq.Case(cases / "hoffmann.toml", samples=100)
    r = sq.run(case, keep_samples=True, out=tmp_path / "s", progress=False)
    assert "\n" not in repr(r) and len(repr(r)) < 200 + len(str(tmp_path)) and "100 samples" in repr(r)
    for name in ("growth", "unstable_modes"):
        same_table(getattr(r, name), tmp_path / "s" / f"{name}.csv")
    for options in ((), ("--why",)):
        e = sq.cea(case, why=bool(options))
        assert str(e) == program("cea", cases / "hoffmann.toml", *options) == str(pickle.loads(pickle.dumps(e)))
        assert "\n" not in repr(e) and len(repr(e)) < 100


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("occurrence.csv", lambda text: "a,b\n1,2,3\n", "3 values in row 2, and 2 columns"),
        ("occurrence.csv", lambda text: "a,b\n1,2\n", "no numbers 'samples'"),
        ("occurrence.csv", lambda text: "", "occurrence.csv is empty"),
        ("occurrence.csv", lambda text: text.replace(",50,", ",x,"), "no numbers 'samples'"),
        ("occurrence.csv", lambda text: text[: text.rindex(",")], "row"),
        ("modes.csv", lambda text: text + "1,2\n", "2 values in row"),
        ("manifest.json", lambda text: "[1]", "no manifest"),
        ("manifest.json", lambda text: "{", "manifest|Expecting"),
        ("manifest.json", lambda text: "[" * 100_000, "."),
    ],
)
def test_a_folder_that_is_damaged_is_refused(name, change, words, cases, tmp_path):
    sq.run(sq.Case(cases / "hoffmann.toml"), samples=50, out=tmp_path / "s", progress=False)
    path = tmp_path / "s" / name
    path.write_text(change(path.read_text()))
    with pytest.raises(sq.FolderError, match=words) as damaged:
        sq.load(tmp_path / "s")
    assert damaged.value.path == str(tmp_path / "s") and damaged.value.allowed == "the folder of a study that has finished"


def test_time_and_memory_are_expected(cases):
    e = sq.estimate(sq.Case(cases / "hoffmann.toml"), samples=1000)
    assert e.seconds == e.preparation + e.samples + e.report and e.bytes > 0


def test_progress_is_told_and_may_end_a_run(cases, tmp_path):
    told = []
    sq.run(sq.Case(cases / "hoffmann.toml"), samples=20_000, progress=lambda *of: told.append(of))
    last = {stage: (done, total) for stage, done, total in told}
    assert last["evaluations"] == (20_000, 20_000)

    def stop(stage, done, total):
        if stage == "evaluations":
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        sq.run(sq.Case(cases / "two-by-two.toml"), samples=1_000_000, out=tmp_path / "s", progress=stop)
    assert (tmp_path / "s" / "checkpoint.json").is_file()


def test_what_is_wrong_with_a_case_is_named(cases, tmp_path):
    with pytest.raises(sq.CaseError) as missing:
        sq.Case(tmp_path / "none.toml")
    assert missing.value.path == str(tmp_path / "none.toml") and isinstance(missing.value, ValueError)
    text = (cases / "hoffmann.toml").read_text().replace("from = 0.5", "from = 2.5")
    (tmp_path / "wrong.toml").write_text(text)
    with pytest.raises(sq.CaseError) as wrong:
        sq.Case(tmp_path / "wrong.toml")
    error = wrong.value
    assert (error.field, error.value) == ("parameters.mu.to", "1.1") and "2.5" in error.allowed
    case = sq.Case(cases / "two-by-two.toml")
    for arguments, argument in (({"law": "glue"}, "law"), ({"contact": [9]}, "contact"), ({"speed": -1.0}, "speed")):
        with pytest.raises(sq.ArgumentError) as refused:
            sq.cea(case, **arguments)
        assert refused.value.argument == argument
    for arguments in ({"samples": 0}, {"samples": 1.5}, {"seed": -1}, {"half_width": 0.5}, {"until_half_width": "a"}, {"threads": 0}):
        with pytest.raises(sq.ArgumentError) as refused:
            sq.run(case, progress=False, **arguments)
        assert refused.value.argument == next(iter(arguments))


def test_the_program_is_in_the_module(cases):
    assert "valid" in program("check", cases / "hoffmann.toml")
    done = subprocess.run([sys.executable, "-m", "squeal", "run", "none.toml"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1


@pytest.mark.filterwarnings("ignore:.*contacts in equilibrium")
def test_finite_elements_are_studied_as_the_program_does(cases, tmp_path):
    """The case of the tutorial's page, without its checks against the whole brake."""
    for ending in ("inp", "mas.gz", "sti.gz", "dof.gz"):
        shutil.copy(cases / "two-pads" / f"two-pads.{ending}", tmp_path)
    blocks = re.findall(r"^```toml\n(.*?)^```", (ROOT / "docs/tutorial.md").read_text(), re.M | re.S)
    path = tmp_path / "brake.toml"
    path.write_text("".join(blocks) + "full_checks = 0\n")
    program("run", path, "--samples", 2, "--out", tmp_path / "program")
    r = sq.run(sq.Case(path, samples=2), out=tmp_path / "python", progress=False)
    for name in r.tables:
        same_table(r.tables[name], tmp_path / "program" / f"{name}.csv")
    same_files(tmp_path / "program", tmp_path / "python")
    with pytest.raises(sq.ArgumentError, match="a lattice, or a brake given by its matrices"):
        sq.evaluate(sq.Case(path), {"mu": [0.5]})
