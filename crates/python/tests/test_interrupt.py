"""An interrupt ends what takes long, with what there is written; processes that are forked after a study work."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import squeal as sq

#: A process that says when it begins, and how long after the interrupt it could go on.
SCRIPT = """
import signal, sys, time
import numpy as np
import squeal as sq
at = []
def interrupted(*_):
    at.append(time.perf_counter())
    raise KeyboardInterrupt
signal.signal(signal.SIGINT, interrupted)
{prepared}
print("begun", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("ended", flush=True)
"""


def interrupted(prepared, work, seconds=1.0):
    """What the process says that is interrupted after some seconds."""
    script = SCRIPT.format(prepared=prepared, work=work)
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begun\n"
    time.sleep(seconds)
    child.send_signal(signal.SIGINT)
    said, _ = child.communicate(timeout=60)
    return said.strip()


def test_an_interrupted_study_goes_on_to_the_same_bytes(cases, tmp_path):
    prepared = f"case = sq.Case({str(cases / 'two-by-two.toml')!r}, samples=1_000_000)"
    assert interrupted(prepared, f"sq.run(case, out={str(tmp_path / 's')!r}, progress=False)") == "interrupted"
    state = (tmp_path / "s" / "checkpoint.json").read_text().splitlines()[2]
    done = int(state.split('"samples":')[1].split(",")[0])
    assert 0 < done < 1_000_000
    # As many samples at once give the state that was written.
    case = sq.Case(cases / "two-by-two.toml", samples=done)
    sq.run(case, out=tmp_path / "once", progress=False)
    sq.run(case, out=tmp_path / "s", progress=False)
    for name in ("checkpoint.json", "occurrence.csv", "report.html"):
        assert (tmp_path / "s" / name).read_bytes() == (tmp_path / "once" / name).read_bytes()


def test_an_interrupted_preparation_is_left_behind(cases, tmp_path):
    prepared = f"case = sq.Case({str(cases / 'disc-pad' / 'disc-pad.toml')!r})"
    assert interrupted(prepared, f"sq.run(case, out={str(tmp_path / 's')!r}, progress=False)", 0.3) == "interrupted"
    assert not (tmp_path / "s").exists()


def test_an_interrupted_spectrum_is_left_behind():
    prepared = "a = np.random.default_rng(1).standard_normal((3, 700, 700))"
    assert interrupted(prepared, "sq.eig(np.eye(700) + 0.01 * a[0], a[1], a[2])", 0.5) == "interrupted"


def test_an_interrupted_function_ends(cases):
    prepared = f"case = sq.Case({str(cases / 'two-by-two.toml')!r}); points = {{'mu': np.linspace(0, 1, 10_000_000)}}"
    assert interrupted(prepared, "sq.evaluate(case, points)") == "interrupted"


#: A brake whose callable takes half a second, and the time at which it came back last.
SLOW = """
returned = [0.0]
def slow(p):
    time.sleep(0.5 if prepared else 0.0)
    returned[0] = time.perf_counter()
    return {"belt.mu": 0.4 + 0.5 * p["mu"]}
prepared = False
terms = [sq.Term("springs", mass=np.eye(2), stiffness=[[2.0, 1.0], [1.0, 2.0]])]
contacts = [sq.Contact("belt", force={"x": -1.0}, reading={"y": 4 / 3})]
brake = sq.Brake(terms=terms, contacts=contacts, parameters={"mu": sq.Uniform(0.5, 1.1)}, dofs=["x", "y"], coefficients=slow, samples=500)
prepared = True
def timed(ask):
    try:
        ask()
    except KeyboardInterrupt:
        now = time.perf_counter()
        # The call that ran at the interrupt has come back, and no other was begun.
        late = now - max(returned[0], at[0])
        print("late", late, "after", now - at[0], flush=True)
        raise
"""


@pytest.mark.parametrize("seconds", [0.2, 0.7, 1.2])
@pytest.mark.parametrize(
    "ask",
    [
        "sq.run(brake, out={out!r}, progress=False)",
        "sq.run(brake, threads=1, progress=False)",
        "sq.evaluate(brake, {{'mu': np.linspace(0.5, 1.1, 1000)}})",
        "sq.sweep(brake, mu=(0.5, 1.1), progress=False)",
        "sq.screen(brake, kinds=['dashpot'], up_to=1, progress=False)",
        "sq.estimate(brake)",
    ],
)
def test_an_interrupted_callable_is_not_asked_again(ask, seconds, tmp_path):
    ask = ask.format(out=str(tmp_path / "s"))
    late, end = interrupted(SLOW, f"timed(lambda: {ask})", seconds).splitlines()
    _, late, _, after = late.split()
    # A tenth of a second where the machine is free; another call would take five.
    assert end == "interrupted" and float(late) < 0.25 and float(after) < 0.75


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_forked_process_works_after_a_study(cases):
    case = sq.Case(cases / "hoffmann.toml", samples=200)
    expected = sq.run(case, progress=False).occurrence["unstable"]
    child = os.fork()
    if child == 0:
        same = np.array_equal(sq.run(case, progress=False).occurrence["unstable"], expected)
        os._exit(0 if same else 1)
    assert os.waitpid(child, 0)[1] == 0
