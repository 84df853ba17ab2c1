"""Eigenvalues by numpy and scipy: state matrices on standard input, then numbers of routes; processor times on standard output."""

import json
import sys
import time

import numpy

count, order = int(sys.argv[1]), int(sys.argv[2])
data = sys.stdin.buffer.read(8 * count * order * order)
# Column by column, as LAPACK wants them.
matrices = [m.T for m in numpy.frombuffer(data, dtype="<f8").reshape(count, order, order)]

routes = {f"numpy {numpy.__version__} eigvals": numpy.linalg.eigvals}
try:
    import scipy
    import scipy.linalg

    routes[f"scipy {scipy.__version__} eigvals"] = scipy.linalg.eigvals
    routes[f"scipy {scipy.__version__} eig, with vectors"] = scipy.linalg.eig
except ImportError:
    pass


def values(route, matrix):
    found = route(matrix)
    found = found[0] if isinstance(found, tuple) else found
    return [[z.real, z.imag] for z in found.astype(complex).tolist()]


spectra = [[values(route, matrix) for matrix in matrices] for route in routes.values()]
print(json.dumps({"routes": list(routes), "spectra": spectra}), flush=True)

for line in sys.stdin:
    route = list(routes.values())[int(line)]
    start = time.thread_time()
    for matrix in matrices:
        route(matrix)
    print(time.thread_time() - start, flush=True)
