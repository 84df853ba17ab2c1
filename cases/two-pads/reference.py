#!/usr/bin/env python3
"""Prints eigenvalues of the brake of two-pads.toml by NumPy and SciPy alone: matrices of CalculiX, contact, equilibrium and rotation made here.

Usage: python3 reference.py [MU [PRESSURE [SHIM]]] > reference.csv
"""

import gzip
import re
import sys
from itertools import product

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

mu, pressure, shim = (list(map(float, sys.argv[1:])) + [0.5, 2.0, 1.0][len(sys.argv) - 1 :])[:3]
OMEGA, PER_AREA, ABUTMENT, CARRIER, SHIM, ALPHA, BETA, DENSITY = 20.0, 150.0, 3e4, 5e3, 0.006, 20.0, 1e-7, 7.2e-9

row = {tuple(map(int, name.split("."))): i for i, name in enumerate(gzip.open("two-pads.dof.gz", "rt"))}
n = len(row)


def matrix(kind):
    i, j, v = np.loadtxt(f"two-pads.{kind}.gz").T
    upper = sp.csc_matrix((v, (i.astype(int) - 1, j.astype(int) - 1)), (n, n))
    return upper + sp.triu(upper, 1).T


place, sets, elements = {}, {}, {}
for block in open("two-pads.inp").read().split("*"):
    head, _, lines = block.partition("\n")
    if head.startswith("NODE,"):
        place = {int(f[0]): np.array(f[1:], float) for f in (line.split(",") for line in lines.split("\n") if line)}
    elif head.startswith("NSET,"):
        sets[head.split("=")[1]] = [int(name) for name in re.findall(r"\d+", lines)]
    elif head.startswith("ELEMENT,"):
        numbers = np.array(re.findall(r"\d+", lines), int).reshape(-1, 21)
        elements[head.split("ELSET=")[1]] = numbers[:, 1:]

EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])
PLACES = np.vstack([CORNERS] + [(CORNERS[a] + CORNERS[b]) / 2 for a, b in EDGES])
ROOTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


def serendipity(at, places):
    """Quadratic shape functions of a brick or, of its first two coordinates, a face, and their derivatives."""
    d = len(at)
    values, slopes = np.empty(len(places)), np.empty((len(places), d))
    for k, own in enumerate(places):
        factors = np.array([1 + own[c] * at[c] if own[c] else 1 - at[c] ** 2 for c in range(d)])
        derived = np.array([own[c] if own[c] else -2 * at[c] for c in range(d)])
        others = [np.prod(np.delete(factors, c)) for c in range(d)]
        is_corner = np.all(own != 0)
        last = own @ at - (d - 1) if is_corner else 1.0
        scale = 1 / 2**d if is_corner else 1 / 2 ** (d - 1)
        values[k] = scale * np.prod(factors) * last
        for c in range(d):
            slopes[k, c] = scale * (derived[c] * others[c] * last + (np.prod(factors) * own[c] if is_corner else 0))
    return values, slopes


FACE = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)], float)


def faces(kind, name):
    """The eight nodes of each face of bricks whose corners are all in a set."""
    wanted = set(sets[name])
    for brick in elements[kind]:
        for corners, middles in (([0, 1, 2, 3], [8, 9, 10, 11]), ([4, 5, 6, 7], [12, 13, 14, 15])):
            if all(brick[c] in wanted for c in corners):
                yield [brick[c] for c in corners + middles]


def gauss(nodes):
    """Shape functions, place and area of each point of a face that is level."""
    xyz = np.array([place[node] for node in nodes])
    for (a, wa), (b, wb) in product(zip(ROOTS, WEIGHTS), repeat=2):
        values, slopes = serendipity(np.array([a, b]), FACE)
        yield values, values @ xyz, wa * wb * np.linalg.norm(np.cross(*(slopes.T @ xyz)))


def opposite(masters, at):
    """Nodes and shape functions of the face of the disc at a place."""
    for nodes in masters:
        xyz, own = np.array([place[node][:2] for node in nodes]), np.zeros(2)
        for _ in range(30):
            values, slopes = serendipity(own, FACE)
            own = own - np.linalg.solve((slopes.T @ xyz).T, values @ xyz - at[:2])
            if np.max(np.abs(own)) > 3:
                break
        if np.max(np.abs(own)) <= 1 + 1e-9:
            return nodes, serendipity(own, FACE)[0]
    raise ValueError(at)


def vector(entries):
    """A vector over all rows from (node, direction from 1, value); nodes that are held have none."""
    out = np.zeros(n)
    for node, direction, value in entries:
        if (node, direction) in row:
            out[row[node, direction]] += value
    return out


gaps, slips, across, springs, speeds = [], [], [], [], []
for pad, disc, up in (("FACE_OUTER", "TOP", 1.0), ("FACE_INNER", "BOTTOM", -1.0)):
    masters = list(faces("ROTOR", disc))
    for nodes in faces("LININGS", pad):
        for values, at, area in gauss(nodes):
            below, others = opposite(masters, at)
            r = np.hypot(*at[:2])
            both = list(zip(nodes, values)) + list(zip(below, -others))
            t, w = (-at[1] / r, at[0] / r), np.cross([0, 0, up], [-at[1] / r, at[0] / r, 0])
            gaps.append(vector((node, 3, up * value) for node, value in both))
            slips.append(vector((node, c, t[c - 1] * value) for node, value in both for c in (1, 2)))
            across.append(vector((node, c, w[c - 1] * value) for node, value in both for c in (1, 2)))
            springs.append(PER_AREA * area)
            speeds.append(OMEGA * r)
gaps, slips, across, springs, speeds = map(np.array, (gaps, slips, across, springs, speeds))

M, K = matrix("mas"), matrix("sti")
C = ALPHA * M + BETA * K
held = sp.lil_matrix((n, n))
damped = sp.lil_matrix((n, n))
for name in ("OUTER", "INNER"):
    for group, angle, stiffness in ((f"LEADING_{name}", 151, ABUTMENT), (f"TRAILING_{name}", 207, ABUTMENT), (f"BACK_{name}", 89, CARRIER)):
        direction = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        for node in sets[group]:
            rows = [row[node, 1], row[node, 2]]
            held[np.ix_(rows, rows)] += stiffness / len(sets[group]) * np.outer(direction, direction)
    for node in sets[f"BACK_{name}"]:
        damped[row[node, 3], row[node, 3]] += shim * SHIM / len(sets[f"BACK_{name}"])

# The turning disc: int rho N^T N_,theta and int rho N_,theta^T N_,theta.
turned, transported = sp.lil_matrix((n, n)), sp.lil_matrix((n, n))
for brick in elements["ROTOR"]:
    xyz = np.array([place[node] for node in brick])
    first, second = np.zeros((20, 20)), np.zeros((20, 20))
    for (a, wa), (b, wb), (c, wc) in product(zip(ROOTS, WEIGHTS), repeat=3):
        values, slopes = serendipity(np.array([a, b, c]), PLACES)
        jacobian = slopes.T @ xyz
        x, y, _ = values @ xyz
        around = np.linalg.solve(jacobian, slopes.T).T @ np.array([-y, x, 0.0])
        weight = DENSITY * wa * wb * wc * abs(np.linalg.det(jacobian))
        first += weight * np.outer(values, around)
        second += weight * np.outer(around, around)
    for direction in (1, 2, 3):
        own = [k for k in range(20) if (brick[k], direction) in row]
        rows = [row[brick[k], direction] for k in own]
        turned[np.ix_(rows, rows)] += (first - first.T)[np.ix_(own, own)] / 2
        transported[np.ix_(rows, rows)] += second[np.ix_(own, own)]
C = C + damped + 2 * OMEGA * turned
K = (K + held - OMEGA**2 * transported).tocsc()

load = np.zeros(n)
for name, down in (("OUTER", -1.0), ("INNER", 1.0)):
    for nodes in faces("BACKPLATES", f"PISTON_{name}"):
        for values, _, area in gauss(nodes):
            load += vector((node, 3, down * pressure * area * value) for node, value in zip(nodes, values))

# Springs that press and do not pull, with friction: closed points until none pulls and none that is open overlaps.
closed = np.ones(len(springs), bool)
while True:
    k, g, s = springs[closed], sp.csc_matrix(gaps[closed]), sp.csc_matrix(slips[closed])
    whole = (K + (g + mu * s).T @ sp.diags(k) @ g).tocsc()
    forces = -springs * (gaps @ sl.spsolve(whole, load))
    if np.array_equal(forces > 0, closed):
        break
    closed = forces > 0
loads = np.where(closed, forces, 0.0)
print(f"{closed.sum()} of {len(closed)} points are closed, {loads.sum():.6e} N", file=sys.stderr)
C = (C + sp.csc_matrix(across).T @ sp.diags(mu * loads / speeds) @ sp.csc_matrix(across)).tocsc()

found = []
for shift in 2j * np.pi * np.array([1.5e3, 3e3, 4.5e3, 6e3, 7e3]):
    lu = sl.splu((whole + shift * C + shift**2 * M).tocsc())

    def solve(z):  # z = (u, v / |shift|), v = lambda u
        u, v = z[:n], z[n:] * abs(shift)
        new = -lu.solve(M @ v + C @ u + shift * (M @ u))
        return np.concatenate([new, (u + shift * new) / abs(shift)])

    inverse, _ = sl.eigs(sl.LinearOperator((2 * n, 2 * n), matvec=solve, dtype=complex), k=24, v0=np.ones(2 * n, complex))
    for l in shift + 1 / inverse:
        if 1e3 < l.imag / 2 / np.pi < 7e3 and -500 < l.real < 20000 and all(abs(l - other) > 1e-6 * abs(l) for other in found):
            found.append(l)
print("re,im")
for l in sorted(found, key=lambda l: l.imag):
    print(f"{l.real:.12e},{l.imag:.12e}")
