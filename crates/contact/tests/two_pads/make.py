"""Makes two_pads.txt: a disc and two pads of C3D20 whose faces do not match, and what numpy makes of their contact and of the turning disc.

Points of Gauss of the pads' quadratic faces (3 x 3), each on the disc's face; mm, t, s. Needs numpy. A matrix A is written as y = A x with
x_i = sin(1 + 0.37 i) over three rows for each node in the order of the nodes: rows that are not 0.
"""
import numpy as np

D = np.pi / 180
LN = np.array([[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1],
 [0,-1,-1],[1,0,-1],[0,1,-1],[-1,0,-1],[0,-1,1],[1,0,1],[0,1,1],[-1,0,1],[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], float)
GAUSS = [(-np.sqrt(.6), 5/9), (0, 8/9), (np.sqrt(.6), 5/9)]
STIFFNESS, DENSITY = 110.0, 7.2e-9


def shape(p):
    """Serendipity functions as products with the sum of coordinates, derivatives by complex steps."""
    def values(q):
        out = []
        for c in LN:
            f = [1 - q[i]**2 if c[i] == 0 else 1 + c[i] * q[i] for i in range(3)]
            corner = all(c != 0)
            out.append(f[0] * f[1] * f[2] * (c @ q - 2 if corner else 1) / (8 if corner else 4))
        return np.array(out)
    q = np.array(p, complex)
    d = np.zeros((20, 3))
    for i in range(3):
        e = q.copy()
        e[i] += 1e-200j
        d[:, i] = values(e).imag / 1e-200
    return values(q).real, d


class Body:
    def __init__(self, first):
        self.next, self.number, self.xyz, self.elements = first, {}, {}, []

    def grid(self, rs, ths, zs, closed):
        nt = len(ths) - 1
        at = lambda a, h: a[h // 2] if h % 2 == 0 else .5 * (a[h // 2] + a[h // 2 + 1])
        for i in range(len(rs) - 1):
            for j in range(nt):
                for k in range(len(zs) - 1):
                    con = []
                    for c in LN:
                        a, b, d = (2 * i + 1 + int(c[0]), 2 * j + 1 + int(c[1]), 2 * k + 1 + int(c[2]))
                        key = (a, b % (2 * nt) if closed else b, d)
                        if key not in self.number:
                            self.number[key] = self.next
                            r, t, z = at(rs, a), at(ths, key[1]), at(zs, d)
                            # Nine digits, as a deck has them.
                            self.xyz[self.next] = np.array([float("%.9g" % x) for x in (r * np.cos(t), r * np.sin(t), z)])
                            self.next += 1
                        con.append(self.number[key])
                    self.elements.append(con)


disc, out, inn = Body(1), Body(1001), Body(2001)
disc.grid([80, 104, 127, 150.], [j * 36 * D for j in range(11)], [-24, 0.], True)
angles = [(62 + 56 * j / 3) * D for j in range(4)]
out.grid([106, 126, 147.], angles, [0, 11.], False)
inn.grid([106, 126, 147.], angles, [-35, -24.], False)
xyz = {**disc.xyz, **out.xyz, **inn.xyz}
labels = sorted(xyz)
place = {label: i for i, label in enumerate(labels)}
n = 3 * len(labels)
probe = np.sin(1 + 0.37 * np.arange(n))


def locate(z0, p):
    side = 1 if z0 == 0 else -1
    for con in disc.elements:
        X = np.array([xyz[k] for k in con])
        if np.linalg.norm(X.mean(0)[:2] - p[:2]) > 60:
            continue
        s = np.zeros(2)
        for _ in range(40):
            N, d = shape((s[0], s[1], side))
            step = np.linalg.solve((d.T @ X)[:2, :2].T, p[:2] - (N @ X)[:2])
            s += step
            if np.abs(step).max() < 1e-14 or np.abs(s).max() > 9:
                break
        if np.abs(s).max() <= 1 + 1e-9:
            return con, N
    raise Exception("not on disc")


A = {name: np.zeros((n, n)) for name in ("normal", "friction", "lateral", "along", "gyroscopic", "centripetal")}
areas = {}
for tag, body, z0, nz in (("OUT", out, 0., 1.), ("IN", inn, -24., -1.)):
    side = -1 if tag == "OUT" else 1
    for e, con in enumerate(body.elements):
        X = np.array([xyz[k] for k in con])
        patch = tag + str(1 + e // 3)
        for x, wx in GAUSS:
            for y, wy in GAUSS:
                N, d = shape((x, y, side))
                J = d.T @ X
                w, P = wx * wy * np.linalg.norm(np.cross(J[0], J[1])), N @ X
                opposite, M = locate(z0, P)
                areas[patch] = areas.get(patch, 0) + w
                r = np.hypot(P[0], P[1])
                t, lat, nn = np.array([-P[1], P[0], 0]) / r, np.array([P[0], P[1], 0]) / r, np.array([0, 0, nz])
                row = {v: np.zeros(n) for v in "gsa"}
                for v, vec in (("g", nn), ("s", t), ("a", lat)):
                    for nodes, weights, sign in ((con, N, 1), (opposite, M, -1)):
                        for k, weight in zip(nodes, weights):
                            row[v][3 * place[k]:3 * place[k] + 3] += sign * weight * vec
                A["normal"] += STIFFNESS * w * np.outer(row["g"], row["g"])
                A["friction"] += STIFFNESS * w * np.outer(row["s"], row["g"])
                # Forces of 2 N/mm^2 at Omega = 5 rad/s.
                A["lateral"] += 2 * w / (5 * r) * np.outer(row["a"], row["a"])
                A["along"] += 2 * w * np.outer(row["s"], row["s"])
for con in disc.elements:
    X = np.array([xyz[k] for k in con])
    g, p = np.zeros((20, 20)), np.zeros((20, 20))
    for x, wx in GAUSS:
        for y, wy in GAUSS:
            for z, wz in GAUSS:
                N, d = shape((x, y, z))
                J = d.T @ X
                P = N @ X
                turned = d @ np.linalg.inv(J).T @ np.array([-P[1], P[0], 0])
                w = wx * wy * wz * np.linalg.det(J) * DENSITY
                g += w * np.outer(N, turned)
                p += w * np.outer(turned, turned)
    g = (g - g.T) / 2
    for a in range(20):
        for b in range(20):
            for q in range(3):
                i, j = 3 * place[con[a]] + q, 3 * place[con[b]] + q
                A["gyroscopic"][i, j] += g[a, b]
                A["centripetal"][i, j] += p[a, b]

with open("two_pads.txt", "w") as f:
    for label in labels:
        f.write("node %d %.9g %.9g %.9g\n" % (label, *xyz[label]))
    number = 0
    for name, body in (("DISC", disc), ("OUT", out), ("IN", inn)):
        for con in body.elements:
            number += 1
            f.write("element %d %s %s\n" % (number, name, " ".join(map(str, con))))
    for name, area in areas.items():
        f.write("area %s %.16e\n" % (name, area))
    for name, matrix in A.items():
        y = matrix @ probe
        scale = np.abs(matrix).max()
        f.write("matrix %s %.16e\n" % (name, scale))
        for i in np.flatnonzero(np.abs(matrix).max(1)):
            f.write("%d %.16e\n" % (i, y[i]))
