"""Rectangles of the refined disc and pad by `squeal eig --box` and by SLEPc with MUMPS, in turn, on one thread.

    python3 slepc.py SQUEAL FOLDER [PARTS...]

SQUEAL is the program; FOLDER has the meshes and matrices of cost.py, a folder parts-N each, or those that `sh cases/make.sh cases/disc-pad N FOLDER/parts-N`
makes. Needs petsc4py and slepc4py for complex numbers (Debian: python3-slepc4py-complex, whose folders may have to be on PYTHONPATH) and GNU time.

The brake is that of the case at mu = 0.5, all patches closed. squeal finds all eigenvalues of 0.5 to 8 kHz with left and right vectors and counts as a whole command,
with reading; SLEPc finds the 24 nearest to 4.2 kHz with right vectors (PEP, TOAR, one factorisation) and counts from its matrices on. Processor seconds and the
largest memory of each. The unstable ones of SLEPc must be among squeal's, within 1e-6.
"""
import gzip
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp

MU, BACK, CONTACT, RAYLEIGH = 0.5, (1.08e8, 1.08e8, 2.16e7), 4.05e8, (100.0, 1.25e-6)


def assembled(brake):
    """K, C and M of the brake with contact and friction."""
    row = {tuple(map(int, label.split("."))): at for at, label in enumerate(gzip.open(brake / "disc-pad.dof.gz", "rt"))}
    n = len(row)

    def read(name):
        i, j, value = np.loadtxt(gzip.open(brake / f"disc-pad.{name}.gz"), unpack=True)
        i, j = i.astype(int) - 1, j.astype(int) - 1
        off = i != j
        return sp.csc_matrix((np.r_[value, value[off]], (np.r_[i, j[off]], np.r_[j, i[off]])), (n, n))

    stiffness, mass = read("sti"), read("mas")
    places, sets = {}, {}
    for block in (brake / "disc-pad.inp").read_text().split("*"):
        head, _, lines = block.partition("\n")
        if head.startswith("NODE,"):
            places = {int(node): list(map(float, at)) for node, *at in (line.split(",") for line in lines.split("\n") if line)}
        elif head.startswith("NSET,"):
            sets[head.split("=")[1].strip()] = list(map(int, re.findall(r"\d+", lines)))
    back, pairs = sets["PADBACK"], list(zip(sets["PADFACE"], sets["DISCFACE"]))
    entries = [(row[node, axis + 1],) * 2 + (of / len(back),) for node in back for axis, of in enumerate(BACK)]
    spring = CONTACT / len(pairs)
    for pad, disc in pairs:
        x, y, _ = places[pad]
        along = MU / np.hypot(x, y)
        for axis, force in ((3, 1.0), (1, -along * y), (2, along * x)):
            for node, acts in ((pad, force), (disc, -force)):
                entries += [(row[node, axis], row[pad, 3], acts * spring), (row[node, axis], row[disc, 3], -acts * spring)]
    i, j, value = zip(*entries)
    contact = sp.csc_matrix((value, (i, j)), (n, n))
    return (stiffness + contact).tocsc(), (RAYLEIGH[0] * mass + RAYLEIGH[1] * stiffness).tocsc(), mass


def timed(*command):
    """Standard output of a command, its processor seconds and its memory in GB."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(["/usr/bin/time", "-f", "%U %S %M", *map(str, command)], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(done.stderr)
    user, system, kilobytes = map(float, done.stderr.strip().splitlines()[-1].split())
    return done.stdout, user + system, kilobytes / 1e6


def by_slepc(files):
    """Prints the eigenvalues above the axis that SLEPc finds, and the processor seconds that it took."""
    import time

    import slepc4py

    slepc4py.init([])
    from petsc4py import PETSc
    from slepc4py import SLEPc

    def matrix(file):
        of = sp.load_npz(file).tocsr().astype(complex)
        of.sort_indices()
        return PETSc.Mat().createAIJ(of.shape, csr=(of.indptr, of.indices, of.data))

    operators, start = [matrix(file) for file in files], time.process_time()
    problem = SLEPc.PEP().create()
    problem.setOperators(operators)
    problem.setType("toar")
    problem.setScale(SLEPc.PEP.Scale.SCALAR)
    problem.setTarget(2j * np.pi * 4.2e3)
    problem.setWhichEigenpairs(SLEPc.PEP.Which.TARGET_MAGNITUDE)
    problem.setDimensions(24)
    transform = problem.getST()
    transform.setType("sinvert")
    transform.setTransform(True)
    solver = transform.getKSP()
    solver.setType("preonly")
    solver.getPC().setType("lu")
    solver.getPC().setFactorSolverType("mumps")
    problem.setTolerances(1e-10)
    problem.solve()
    found = [problem.getEigenpair(at) for at in range(problem.getConverged())]
    print(json.dumps([time.process_time() - start, [[of.real, of.imag] for of in found if of.imag > 0]]))


def main(squeal, folder, *parts):
    print("| degrees of freedom | squeal: s, GB | SLEPc and MUMPS: s, GB |\n| ---: | ---: | ---: |")
    for part in parts or ("2", "3", "4", "5"):
        brake = Path(folder) / f"parts-{part}"
        matrices = assembled(brake)
        files = [brake / f"{name}.npz" for name in "KCM"]
        for file, of in zip(files, matrices):
            sp.save_npz(file, of, compressed=False)
        arguments = zip(("--stiffness", "--damping", "--mass"), files)
        box = "--box=-2000:2000,3141.6:50265.5"
        out, seconds, memory = timed(squeal, "eig", *(argument for pair in arguments for argument in pair), box, "--json")
        own = np.array([complex(of["re"], of["im"]) for of in json.loads(out)["eigenvalues"]])
        out, _, peer_memory = timed(sys.executable, __file__, "--slepc", *files)
        peer_seconds, found = json.loads(out)
        for re_, im in found:
            if re_ > 0:
                assert np.abs(own - complex(re_, im)).min() < 1e-6 * im, (part, re_, im)
        print(f"| {matrices[0].shape[0]:,} | {seconds:.1f}, {memory:.2f} | {peer_seconds:.1f}, {peer_memory:.2f} |", flush=True)


if sys.argv[1] == "--slepc":
    by_slepc(sys.argv[2:])
else:
    main(*sys.argv[1:])
