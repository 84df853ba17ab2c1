"""The rectangle of disk_brake4669 at w = 4 pi by `squeal eig --box` and by SciPy, in turn, on one core.

    python3 rectangle.py FOLDER SQUEAL [RUNS]

FOLDER has the matrices as docs/large-problems.md says, SQUEAL is the program. Processor seconds, all of the program's, with reading
and writing, against those of factorisations and eigenvalues in SciPy. SciPy gives neither left vectors nor error bounds; it is called as
its documentation shows it, and with what was found to be fastest here.
"""
import json
import os

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"
import gzip
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.io
import scipy.sparse as sp
import scipy.sparse.linalg as sl

RE, IM = (-50.0, 1000.0), (-50.0, 42000.0)
TUNED = dict(permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)


def matrices(folder, w):
    def read(name):
        return sp.csc_matrix(scipy.io.mmread(gzip.open(os.path.join(folder, name + ".mtx.gz"))))

    c = read("D1") + read("DG") * w + read("DR") * (1 / w - 1) + read("D4") / (2 * np.pi * 1600)
    return read("M"), c, read("K1") + read("KR") + read("KGEO") * (w**2 - 1)


def by_scipy(m, c, k, shifts, eigenvalues, tol, **options):
    """Strips of the upper half, each with a shift at its centre: eigenvalues, and whether the discs cover the strips."""
    n, found, covered = m.shape[0], [], True
    edges = np.linspace(0, IM[1], shifts + 1)
    for low, high in zip(edges[:-1], edges[1:]):
        s, radius = complex(sum(RE) / 2, (low + high) / 2), abs(complex(RE[1] - RE[0], high - low)) / 2
        lu = sl.splu((k + s * c + s * s * m).tocsc().astype(complex), **options)
        d, scale = (c + s * m).tocsc(), abs(s)

        def step(x):
            u, v = x[:n], x[n:] * scale
            new = -lu.solve(m @ v + d @ u)
            return np.r_[new, (s * new + u) / scale]

        operator = sl.LinearOperator((2 * n, 2 * n), step, dtype=complex)
        lam = s + 1 / sl.eigs(operator, k=eigenvalues, which="LM", tol=tol, v0=np.ones(2 * n, complex))[0]
        covered &= bool(np.abs(lam - s).max() >= radius)
        inside = (lam.real >= RE[0]) & (lam.real <= RE[1]) & (lam.imag >= low) & (lam.imag <= high)
        found.extend(lam[inside])
    return np.array(found), covered


def by_squeal(program, files):
    box = "--box=%g:%g,%g:%g" % (*RE, *IM)
    args = [program, "eig", "--mass", files[0], "--damping", files[1], "--stiffness", files[2], box, "--json"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = subprocess.run(args, capture_output=True, check=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = [complex(e["re"], e["im"]) for e in json.loads(output)["eigenvalues"]]
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return np.array([l for l in found if l.imag >= 0]), seconds


def main():
    folder, program, runs = sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 3
    system = matrices(folder, 4 * np.pi)
    with tempfile.TemporaryDirectory() as work:
        files = [os.path.join(work, name + ".npz") for name in "MCK"]
        for file, matrix in zip(files, system):
            sp.save_npz(file, matrix, compressed=False)
        times = {"squeal": [], "scipy, default options": [], "scipy, tuned": []}
        for _ in range(runs):
            ours, seconds = by_squeal(program, files)
            times["squeal"].append(seconds)
            for name, tol, options in (("scipy, default options", 0, {}), ("scipy, tuned", 1e-12, TUNED)):
                start = time.process_time()
                theirs, covered = by_scipy(*system, 3, 40, tol, **options)
                times[name].append(time.process_time() - start)
                distance = max(np.abs(theirs - l).min() / abs(l) for l in ours)
                print(f"{name}: {len(theirs)} eigenvalues, covered {covered}, {len(ours)} here, largest distance {distance:.1e}")
    for name, seconds in times.items():
        ratio = np.median(seconds) / np.median(times["squeal"])
        print(f"{name}: {np.median(seconds):.2f} s ({min(seconds):.2f} to {max(seconds):.2f}), {ratio:.1f}")


main()
