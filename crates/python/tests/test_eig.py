"""Eigenvalues against SciPy, on matrices that are hard, and what is refused."""

import pickle
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import squeal as sq
from conftest import ROOT

HARD = sorted(folder.name for folder in (ROOT / "tests/fixtures/hard").iterdir() if (folder / "M.mtx").is_file())


def companion(M, C, K):
    """The eigenvalues by SciPy's QZ, of the scaled companion pencil."""
    n = len(M)
    gamma = np.sqrt(np.linalg.norm(K) / np.linalg.norm(M))
    scale = 1 / np.linalg.norm(K)
    M, C, K = scale * gamma**2 * M, scale * gamma * C, scale * K
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
    b = np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), M]])
    above, below = scipy.linalg.eigvals(a, b, homogeneous_eigvals=True)
    finite = np.abs(below) > 1e-14 * np.abs(above)
    return gamma * above[finite] / below[finite]


def system(n=6, seed=3, shape=()):
    rng = np.random.default_rng(seed)
    a = rng.standard_normal((*shape, n, n))
    spd = a @ np.swapaxes(a, -1, -2) + n * np.eye(n)
    return spd, 0.1 * rng.standard_normal((*shape, n, n)), 1e4 * rng.standard_normal((*shape, n, n)) + 1e5 * np.eye(n)


def matched(found, other):
    """Distances of eigenvalues to the nearest of others."""
    return np.min(np.abs(found[:, None] - other[None, :]), axis=1)


@pytest.mark.parametrize("name", HARD)
def test_certified_eigenvalues_of_hard_matrices_are_those_of_scipy_within_bounds_and_backward_errors(name):
    folder = ROOT / "tests/fixtures/hard" / name
    M, C, K = (read_one(folder / f"{part}.mtx") for part in "MCK")
    try:
        s = sq.eig(M, C, K, symmetry="whole")
    except sq.SingularPencilError:
        # SciPy says so too: Q is singular wherever it is looked at.
        points = np.exp(1j * np.arange(1, 6)) * np.sqrt(np.linalg.norm(K) / np.linalg.norm(M))
        assert all(np.linalg.cond(lam**2 * M + lam * C + K) > 1e14 for lam in points)
        return
    assert len(s) + s.infinite == 2 * len(M)
    assert s.right.flags.f_contiguous and s.left is None
    # What NumPy computes of the residuals agrees.
    for lam, x in zip(s.eigenvalues, s.right.T, strict=True):
        size = abs(lam) ** 2 * np.linalg.norm(M) + abs(lam) * np.linalg.norm(C) + np.linalg.norm(K)
        assert np.linalg.norm((lam**2 * M + lam * C + K) @ x) <= 1e-12 * size
    # The sign of each that is said to be unstable or stable is that of a double's QZ, to what that is worth.
    other = companion(M, C, K)
    with np.errstate(invalid="ignore"):
        worth = 1e-10 * s.conditions * np.abs(s.eigenvalues) + 1e-8 * np.max(np.abs(other[np.abs(other) < 1e8]))
    told = np.isfinite(s.bounds) & np.isfinite(worth)
    assert np.all(matched(s.eigenvalues[told], other) <= (s.bounds + worth)[told])


def read_one(path):
    (name,) = sq.read_matrices(path, symmetry="whole")
    return sq.read_matrices(path, symmetry="whole")[name].toarray()


def test_layouts_lists_and_sparse_matrices_give_the_same_bits():
    M, C, K = system()
    first = sq.eig(M, C, K)
    wide = np.zeros((12, 12))
    wide[::2, ::2] = K
    for of in (np.asfortranarray(K), wide[::2, ::2], K.tolist(), scipy.sparse.csc_array(K), scipy.sparse.coo_matrix(K)):
        assert np.array_equal(sq.eig(M, C, of).eigenvalues, first.eigenvalues)
    assert np.array_equal(sq.eig(M, None, K).eigenvalues, sq.eig(M, 0 * C, K).eigenvalues)


def test_a_singular_mass_has_infinite_eigenvalues_and_a_free_body_zeros():
    s = sq.eig(np.diag([1.0, 0.0, 1.0]), None, np.diag([4.0, 1.0, 0.0]))
    assert (s.infinite, s.zeros, len(s)) == (2, 2, 4)
    assert np.all(s.verdicts == sq.Verdict.MARGINAL)


def test_stacks_are_broadcast_and_agree_with_numpy():
    M, C, K = system(shape=(7, 3))
    w = sq.eigvals(M, C, K)
    assert w.shape == (7, 3, 12)
    for at in np.ndindex(7, 3):
        other = companion(M[at], C[at], K[at])
        assert np.max(matched(w[at], other)) < 1e-9 * np.max(np.abs(other))
        assert np.array_equal(w[at], w[at][np.lexsort((w[at].imag, w[at].real, np.abs(w[at].imag)))])
    assert np.array_equal(sq.eigvals(M[0, 0], None, K, threads=1)[2, 1], sq.eigvals(M[0, 0], None, K[2, 1]))
    with pytest.warns(sq.FailureWarning, match="1 of 2 systems"):
        w = sq.eigvals(np.array([np.eye(2), np.diag([1.0, 0.0])]), None, np.eye(2))
    assert np.all(np.isfinite(w[0])) and np.all(np.isnan(w[1]))


def test_stacks_are_read_whatever_their_memory_and_may_be_empty():
    M, C, K = system(shape=(5,))
    packed = np.zeros(5, dtype=[("flag", "i1"), ("K", "f8", (6, 6))])
    packed["K"] = K
    assert not packed["K"].flags.aligned
    for of in (packed["K"], K.astype(">f8"), K[::-1][::-1], np.asfortranarray(K)):
        assert np.array_equal(sq.eigvals(M, C, of), sq.eigvals(M, C, K))
        assert np.array_equal(sq.eig(M[0], C[0], of[0]).eigenvalues, sq.eig(M[0], C[0], K[0]).eigenvalues)
    assert sq.eigvals(M[:0], C[0], K[:0]).shape == (0, 12)
    assert sq.eigvals(np.zeros((2, 0, 3, 3)), None, np.eye(3)).shape == (2, 0, 6)


def test_a_box_has_what_the_whole_spectrum_has_there():
    n = 600
    k = scipy.sparse.diags([np.full(n, 2.0), np.full(n - 1, -1.0), np.full(n - 1, -1.0)], [0, 1, -1], format="csr")
    M, C, K = scipy.sparse.eye(n), 1e-3 * k, 1e6 * k
    s = sq.eig(M, C, K, box=((-50, 10), (100, 300)), progress=False)
    # A chain of masses has its eigenvalues in closed form.
    omega2 = 4e6 * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2
    exact = -0.5e-9 * omega2 + 1j * np.sqrt(omega2 - (0.5e-9 * omega2) ** 2)
    exact = exact[(exact.imag > 100) & (exact.imag < 300)]
    assert len(s) == len(exact) and s.route == "sparse"
    assert np.max(matched(s.eigenvalues, exact)) < 1e-8
    assert s.coverage.discs and s.coverage.counted == "argument-principle"
    few = sq.eig(M, C, K, box=((-50, 10), (100, 300)), rightmost=3, left=True, progress=False)
    assert np.array_equal(few.growth, np.sort(s.growth)[::-1][:3]) and few.left.shape == (n, 3)
    band = sq.eig(M, C, K, band_hz=(100 / (2 * np.pi), 300 / (2 * np.pi)), progress=False)
    assert len(band) == len(exact)


@pytest.mark.parametrize("side", ["upper", "lower"])
def test_a_triangle_is_what_is_said_of_it(side):
    random = np.random.default_rng(7)
    for n in (2, 5, 40):
        A = random.normal(size=(n, n))
        M, K = np.eye(n), A @ A.T + n * np.eye(n)
        part = np.triu(K) if side == "upper" else np.tril(K)
        box = {"box": ((-1, 1), (0, 1e3)), "progress": False}
        for given in (part, scipy.sparse.csr_array(part), scipy.sparse.csc_matrix(part)):
            for options in ({}, box):
                with pytest.raises(sq.ArgumentError, match="nothing says whether"):
                    sq.eig(M, None, given, **options)
                mirrored = sq.eig(M, None, given, symmetry={"K": side}, **options)
                assert np.allclose(mirrored.eigenvalues, sq.eig(M, None, K, **options).eigenvalues, rtol=1e-10, atol=1e-10)
        as_given = sq.eig(M, None, part, symmetry="whole")
        # The eigenvalues of a triangle are its diagonal; those of a large one are ill conditioned.
        if n <= 5:
            above = as_given.eigenvalues.imag[as_given.eigenvalues.imag > 0]
            assert np.allclose(np.sort(above), np.sort(np.sqrt(np.diag(K))), rtol=1e-6)
        stack = np.stack([part, 2 * part])
        with pytest.raises(sq.ArgumentError, match="nothing says whether"):
            sq.eigvals(M, None, stack)
        assert np.array_equal(sq.eigvals(M, None, stack, symmetry=side), sq.eigvals(M, None, stack + np.swapaxes(np.tril(stack, -1) + np.triu(stack, 1), 1, 2)))


@pytest.mark.parametrize("options", [{}, {"box": ((-10, 10), (-10, 10))}])
def test_rows_that_huge_entries_hold_are_taken_out_and_named(options):
    M, C, K = system()
    K = K / 1e5
    held = K.copy()
    held[2, 2] = 1e30
    rest = [0, 1, 3, 4, 5]
    with pytest.warns(sq.CaseWarning, match="rows 2 are held"):
        s = sq.eig(M, C, held, left=True, **options)
    free = sq.eig(*(part[np.ix_(rest, rest)] for part in (M, C, K)), left=True, **options)
    assert s.held == (2,) and np.array_equal(s.eigenvalues, free.eigenvalues) and len(s) > 0
    assert np.array_equal(s.right[rest], free.right) and not s.right[2].any() and not s.left[2].any()
    with pytest.warns(sq.CaseWarning):
        sparse = sq.eig(scipy.sparse.csr_array(M), C, scipy.sparse.csr_array(held), **options)
    assert np.array_equal(sparse.eigenvalues, s.eigenvalues)


def test_health_names_what_is_wrong():
    h = sq.check(np.diag([1.0, 1.0, 0.0]), None, np.array([[1.0, -1, 0], [-1, 1, 0], [0, 0.5, 1]]))
    assert list(h.mass.empty_rows) == [2] and h.mass.asymmetry == 0 and h.damping.entries == 0
    assert h.stiffness.asymmetry == 0.5


def test_files_of_scipy_are_read_back(tmp_path):
    import scipy.io

    K = scipy.sparse.random(20, 20, density=0.2, random_state=1, format="csc") + scipy.sparse.eye(20)
    scipy.io.mmwrite(tmp_path / "K.mtx", K)
    scipy.io.savemat(tmp_path / "brake.mat", {"K": K, "M": np.eye(20)})
    scipy.sparse.save_npz(tmp_path / "K.npz", K.tocsc())
    (name,) = sq.read_matrices(tmp_path / "K.mtx")
    for of in (sq.read_matrices(tmp_path / "K.mtx")[name], sq.read_matrices(tmp_path / "brake.mat")["K"]):
        assert np.array_equal(of.toarray(), K.toarray()) and np.array_equal(of.tocsc().toarray(), K.toarray())
    files = sq.read_matrices(tmp_path / "brake.mat")
    assert list(files) == ["K", "M"]
    for name in ("K", "stiffness", "mass", "damping", "glue", None):
        try:
            files[name]
        except KeyError:
            assert name not in files
        else:
            assert name in files and name is not None
    (npz,) = sq.read_matrices(tmp_path / "K.npz").all
    assert np.array_equal(npz.toarray(), K.toarray())
    # A matrix of a file goes where a matrix of SciPy does.
    assert len(sq.eig(np.eye(20), None, npz)) == 40


def test_a_spectrum_is_a_table():
    M, C, K = system()
    s = sq.eig(M, C, K)
    table = s.to_pandas()
    assert list(table.columns) == list(s.to_structured().dtype.names)
    assert np.array_equal(table["lambda"], s.eigenvalues) and len(str(s).splitlines()) == len(s) + 1
    assert np.array_equal(s.damping_ratios, -s.eigenvalues.real / np.abs(s.eigenvalues))


def test_a_spectrum_prints_the_table_of_the_program(tmp_path):
    import scipy.io

    M, C, K = system()
    for name, matrix in (("M", M), ("C", C), ("K", K)):
        scipy.io.mmwrite(tmp_path / f"{name}.mtx", matrix, precision=17)
    options = [f"--{kind}={tmp_path / name}.mtx" for kind, name in (("mass", "M"), ("damping", "C"), ("stiffness", "K"))]
    for more, box in (((), {}), (("--box=-1000:1000,0:500",), {"box": ((-1000, 1000), (0, 500)), "progress": False})):
        s = sq.eig(M, C, K, **box)
        said = subprocess.run([sys.executable, "-m", "squeal", "eig", *options, *more], capture_output=True, text=True, check=True)
        assert said.stdout.startswith(str(s) + "\n"), (said.stdout, str(s))
        assert "\n" not in repr(s) and len(repr(s)) < 100 and f"{len(s)} eigenvalues" in repr(s)


def test_a_spectrum_is_not_written_to():
    M, C, K = system()
    s = sq.eig(M, C, K, left=True)
    for of in (s, pickle.loads(pickle.dumps(s))):
        for name in ("eigenvalues", "bounds", "verdicts", "right", "left", "on_border", "growth", "frequencies_hz", "damping_ratios", "stable"):
            with pytest.raises(ValueError, match="read-only"):
                getattr(of, name)[:] = 0
    (k,) = sq.read_matrices(ROOT / "tests/fixtures/hard/spring5/K.mtx").all
    for array in (k.values, k.rows, sq.check(M, C, K).mass.empty_rows):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0
    # What is made of them is the user's own.
    s.to_structured()["bound"][:] = 0
    k.tocsc().data[:] = 0


def corrupt(layout, change):
    matrix = scipy.sparse.eye(4, format=layout)
    change(matrix)
    return matrix


def put(part, at, value):
    def change(matrix):
        getattr(matrix, part)[at] = value

    return change


@pytest.mark.parametrize("options", [{}, {"box": ((-1, 1), (0, 5)), "progress": False}])
@pytest.mark.parametrize(
    ("layout", "change", "argument", "allowed"),
    [
        ("csr", put("indices", 1, 77), "K.indices[1]", "0 to 3"),
        ("csc", put("indices", 2, -1), "K.indices[2]", "0 to 3"),
        ("bsr", put("indices", 0, 4), "K.indices[0]", "0 to 3"),
        ("coo", put("row", 3, 4), "K.row[3]", "0 to 3"),
        ("coo", put("col", 3, 9), "K.col[3]", "0 to 3"),
        ("csr", put("indptr", 1, 3), "K.indptr", "5 that ascend"),
        ("csc", put("indptr", 4, 9), "K.indptr", "5 that ascend"),
        ("csr", put("indptr", 0, 1), "K.indptr", "5 that ascend"),
        ("csr", lambda matrix: setattr(matrix, "data", matrix.data[:2]), "K.indptr", "5 that ascend"),
        ("csc", lambda matrix: setattr(matrix, "indptr", matrix.indptr[:3]), "K.indptr", "5 that ascend"),
    ],
)
def test_sparse_matrices_whose_parts_do_not_fit_are_refused(layout, change, argument, allowed, options):
    for ask in (lambda K: sq.eig(scipy.sparse.eye(4), None, K, **options), lambda K: sq.check(np.eye(4), None, K)):
        with pytest.raises(sq.ArgumentError) as caught:
            ask(corrupt(layout, change))
        assert caught.value.argument == argument and caught.value.allowed.startswith(allowed)


NAN_BELOW = np.array([[1.0, 2.0, 0.0], [0.0, 3.0, 0.0], [0.0, np.nan, 4.0]])


@pytest.mark.parametrize(
    ("call", "argument", "allowed"),
    [
        (lambda: sq.eig(np.eye(3)[:2], None, np.eye(3)), "M", "a square matrix"),
        (lambda: sq.eig(np.eye(3), None, np.eye(2)), "K", "(3, 3), as M has"),
        (lambda: sq.eig(np.eye(2), [[1, np.nan], [0, 1]], np.eye(2)), "C[0, 1]", "a finite number"),
        (lambda: sq.eig(np.eye(2), None, 1j * np.eye(2)), "K", "real numbers"),
        (lambda: sq.eig(np.eye(2), None, [["a", "b"], ["c", "d"]]), "K", "real numbers"),
        (lambda: sq.eig(np.eye(0), None, np.eye(0)), "M", "a square matrix"),
        (lambda: sq.eig(np.eye(1001), None, np.eye(1001)), "M", "at most 1000 degrees of freedom"),
        (lambda: sq.eig(scipy.sparse.eye(2000), None, scipy.sparse.eye(2000)), "M", "at most 1000"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), box=((1, 0), (0, 1))), "box", "each first below its second"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), box=5), "box", "((re from, re to), (im from, im to))"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), band_hz=(5, 1)), "band_hz", "each first below"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), rightmost=1), "rightmost", "with `box`"),
        (lambda: sq.eigvals(np.eye(2), None, np.eye(3)), "M, C, K", "shapes that broadcast"),
        (lambda: sq.eig(np.eye(2), None, [[2.0, 1.0], [0.0, 2.0]]), "K", 'symmetry = "whole" to take them as they are'),
        (lambda: sq.eigvals(np.eye(2), [[[2.0, 0.0], [1.0, 2.0]]] * 3, np.eye(2)), "C", 'symmetry = "whole" to take them as they are, symmetry = "lower"'),
        (lambda: sq.eig(np.eye(2), None, [[2.0, 1.0], [0.0, 2.0]], symmetry="lower"), "K", '"whole", "upper", "triangle"'),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), symmetry="both"), "symmetry", "whole, upper, lower or triangle"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), symmetry={"D": "whole"}), "symmetry", "words on M, C, K"),
        (lambda: sq.eig(np.eye(2), None, np.ma.masked_equal(np.eye(2), 1.0)), "K", "numbers, none masked"),
        (lambda: sq.eig(np.eye(2), None, list(np.ma.masked_equal(np.eye(2), 1.0))), "K", "numbers, none masked"),
        (lambda: sq.eig(np.eye(2), None, [[1.0], [1.0, 2.0]]), "K", "an array of numbers"),
        (lambda: sq.check(np.eye(3), None, scipy.sparse.csr_array(NAN_BELOW)), "K[2, 1]", "a finite number"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), box=((-1, 1), (np.complex128(1 + 2j), 3))), "box", "((re from"),
        (lambda: sq.eig(np.eye(2), None, np.eye(2), box=((-1, 1), (0, 2)), progress=True), "progress", "None, False"),
        (lambda: sq.eigvals(np.eye(2), None, np.eye(2), threads=0), "threads", "1 to 1024"),
    ],
)
def test_what_is_wrong_is_named(call, argument, allowed):
    with pytest.raises(sq.ArgumentError) as caught:
        call()
    error = caught.value
    assert error.argument == argument and error.allowed.startswith(allowed) and "\n" not in str(error)
    assert isinstance(error, ValueError)


def test_faults_of_files_and_pencils_have_classes(tmp_path):
    with pytest.raises(sq.SingularPencilError) as singular:
        sq.eig(np.zeros((2, 2)), None, np.diag([1.0, 0.0]))
    assert isinstance(singular.value, ArithmeticError)
    with pytest.raises(sq.FileError) as missing:
        sq.read_matrices(tmp_path / "none.mtx")
    assert missing.value.path == str(tmp_path / "none.mtx")
    (tmp_path / "low.sti").write_text("1 1 2.0\n2 1 1.0\n2 2 2.0\n")
    assert sq.read_matrices(tmp_path / "low.sti", symmetry="lower").all[0].toarray()[0, 1] == 1.0
    with pytest.raises(sq.FileError, match="triangle"):
        sq.read_matrices(tmp_path / "low.sti")
    assert sq.read_matrices(tmp_path / "low.sti", symmetry="triangle").all[0].toarray()[0, 1] == 1.0
    with pytest.raises(sq.ArgumentError, match="whole, upper, lower or triangle"):
        sq.read_matrices(tmp_path / "low.sti", symmetry="half")
    with pytest.raises(KeyError, match="the file has"):
        sq.read_matrices(tmp_path / "low.sti", symmetry="lower")["mass"]


def test_other_threads_run_while_it_solves():
    M, C, K = system(n=120)
    done, turns = threading.Event(), 0

    def solve():
        sq.eig(M, C, K)
        done.set()

    thread = threading.Thread(target=solve)
    thread.start()
    while not done.is_set():
        turns += 1
        time.sleep(0.001)
    thread.join()
    assert turns > 10
