"""Rectangles of two large brakes by `squeal eig --box` and by SciPy, in turn, on one core.

    python3 rectangle.py FOLDER SQUEAL [RUNS]

FOLDER has the files of disk_brake4669, here at w = 4 pi, or of ccx_brake, here with three coefficients of friction, as
crates/validation/tests/all/large.rs says; SQUEAL is the program. Processor seconds, all of the program's, with reading and writing,
against those of factorisations and eigenvalues in SciPy. SciPy gives neither left vectors nor error bounds; it is called as its
documentation shows it, and with what was found to be fastest here.
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

TUNED = dict(permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)


def disk_brake(folder, w):
    def read(name):
        return sp.csc_matrix(scipy.io.mmread(gzip.open(os.path.join(folder, name + ".mtx.gz"))))

    c = read("D1") + read("DG") * w + read("DR") * (1 / w - 1) + read("D4") / (2 * np.pi * 1600)
    return read("M"), c, read("K1") + read("KR") + read("KGEO") * (w**2 - 1)


def ccx_brake(folder):
    """M, C, and K by the coefficient of friction."""
    path = lambda name: os.path.join(folder, name)
    labels = gzip.open(path("brake.dof.gz"), "rt").read().split()
    row, n = {label: i for i, label in enumerate(labels)}, len(labels)

    def read(name):
        i, j, value = np.loadtxt(gzip.open(path(name)), unpack=True)
        i, j = i.astype(int) - 1, j.astype(int) - 1
        below = i != j
        return sp.csc_matrix((np.r_[value, value[below]], (np.r_[i, j[below]], np.r_[j, i[below]])), shape=(n, n))

    places = {}
    for line in open(path("brake.inp")).read().split("*NODE")[1].split("*ELEMENT")[0].splitlines()[1:]:
        node, *place = line.split(",")
        places[node.strip()] = [float(x) for x in place[:3]]
    springs, friction = sp.lil_matrix((n, n)), sp.lil_matrix((n, n))
    back = open(path("brake.back.csv")).read().split()[1:]
    for node in back:
        for direction, stiffness in (("1", 4e6), ("2", 4e6), ("3", 2e6)):
            if (i := row.get(f"{node}.{direction}")) is not None:
                springs[i, i] += stiffness * 24 / len(back)
    pairs = [line.split(",") for line in open(path("brake.pairs.csv")).read().split()[1:]]
    k = 4e8 * 6 / len(pairs)
    for pad, disc in pairs:
        p, d = row[f"{pad}.3"], row[f"{disc}.3"]
        for i, j, sign in ((p, p, 1), (d, d, 1), (p, d, -1), (d, p, -1)):
            springs[i, j] += sign * k
        x, y, _ = places[pad]
        for direction, along in (("1", -y / np.hypot(x, y)), ("2", x / np.hypot(x, y))):
            pc, dc = row[f"{pad}.{direction}"], row[f"{disc}.{direction}"]
            for i, j, sign in ((pc, d, -1), (pc, p, 1), (dc, d, 1), (dc, p, -1)):
                friction[i, j] += sign * k * along
    m, stiffness = read("brake.mas.gz"), read("brake.sti.gz")
    return m, 2e-7 * stiffness + 5.0 * m, lambda mu: (stiffness + springs + mu * friction).tocsc()


def problems(folder):
    """Name, (M, C, K), the rectangle, file of the reference eigenvalues, and shifts and eigenvalues at each for SciPy."""
    if os.path.exists(os.path.join(folder, "brake.sti.gz")):
        m, c, k = ccx_brake(folder)
        box = (-500.0, 1000.0), (2 * np.pi * 800, 2 * np.pi * 10500)
        return [(f"ccx_brake, mu = {mu}", (m, c, k(mu)), box, f"box_mu{mu}.csv", 3, 40) for mu in (0.0, 0.3, 0.5)]
    box = (-50.0, 1000.0), (-50.0, 42000.0)
    return [("disk_brake4669, w = 4 pi", disk_brake(folder, 4 * np.pi), box, "box_eigs_bs_w4pi.csv", 3, 40)]


def by_scipy(m, c, k, box, shifts, eigenvalues, tol, **options):
    """Strips of the upper half, each with a shift at its centre: eigenvalues, and whether the discs cover the strips."""
    n, found, covered, (re, im) = m.shape[0], [], True, box
    edges = np.linspace(max(im[0], 0), im[1], shifts + 1)
    for low, high in zip(edges[:-1], edges[1:]):
        s, radius = complex(sum(re) / 2, (low + high) / 2), abs(complex(re[1] - re[0], high - low)) / 2
        lu = sl.splu((k + s * c + s * s * m).tocsc().astype(complex), **options)
        d, scale = (c + s * m).tocsc(), abs(s)

        def step(x):
            u, v = x[:n], x[n:] * scale
            new = -lu.solve(m @ v + d @ u)
            return np.r_[new, (s * new + u) / scale]

        operator = sl.LinearOperator((2 * n, 2 * n), step, dtype=complex)
        lam = s + 1 / sl.eigs(operator, k=eigenvalues, which="LM", tol=tol, v0=np.ones(2 * n, complex))[0]
        covered &= bool(np.abs(lam - s).max() >= radius)
        inside = (lam.real >= re[0]) & (lam.real <= re[1]) & (lam.imag >= low) & (lam.imag <= high)
        found.extend(lam[inside])
    return np.array(found), covered


def by_squeal(program, files, box):
    box = "--box=%r:%r,%r:%r" % (*box[0], *box[1])
    args = [program, "eig", "--mass", files[0], "--damping", files[1], "--stiffness", files[2], box, "--json"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = subprocess.run(args, capture_output=True, check=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = [complex(e["re"], e["im"]) for e in json.loads(output)["eigenvalues"]]
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return np.array([l for l in found if l.imag >= 0]), seconds


def compare(program, runs, folder, name, system, box, references, shifts, eigenvalues):
    rows = np.loadtxt(os.path.join(folder, references), delimiter=",", skiprows=1)
    references = rows[:, 0] + 1j * rows[:, 1]

    def distance(found):
        if len(found) != len(references):
            return np.inf
        return max(np.abs(found - l).min() / abs(l) for l in references)

    with tempfile.TemporaryDirectory() as work:
        files = [os.path.join(work, name + ".npz") for name in "MCK"]
        for file, matrix in zip(files, system):
            sp.save_npz(file, matrix, compressed=False)
        times = {"squeal": [], "scipy, default options": [], "scipy, tuned": []}
        for _ in range(runs):
            ours, seconds = by_squeal(program, files, box)
            times["squeal"].append(seconds)
            for method, tol, options in (("scipy, default options", 0, {}), ("scipy, tuned", 1e-12, TUNED)):
                start = time.process_time()
                theirs, covered = by_scipy(*system, box, shifts, eigenvalues, tol, **options)
                times[method].append(time.process_time() - start)
    print(f"{name}: {len(references)} references; squeal {len(ours)}, distance {distance(ours):.1e}; "
          f"scipy, tuned {len(theirs)}, distance {distance(theirs):.1e}, covered {covered}")
    for method, seconds in times.items():
        ratio = np.median(seconds) / np.median(times["squeal"])
        print(f"    {method}: {np.median(seconds):.2f} s ({min(seconds):.2f} to {max(seconds):.2f}), {ratio:.1f}")


def main():
    folder, program, runs = sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 3
    for problem in problems(folder):
        compare(program, runs, folder, *problem)


main()
