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


def test_an_interrupted_spectrum_is_left_behind():
    prepared = "a = np.random.default_rng(1).standard_normal((3, 700, 700))"
    assert interrupted(prepared, "sq.eig(np.eye(700) + 0.01 * a[0], a[1], a[2])", 0.5) == "interrupted"


def test_an_interrupted_function_ends(cases):
    prepared = f"case = sq.Case({str(cases / 'two-by-two.toml')!r}); points = {{'mu': np.linspace(0, 1, 10_000_000)}}"
    assert interrupted(prepared, "sq.evaluate(case, points)") == "interrupted"


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
