#!/usr/bin/env python3
"""Writes two-pads.inp: a brake disc between two pads, of twenty-node bricks (C3D20), for CalculiX, in mm, t, s, N and MPa.

The disc is an annulus about the z axis. Each pad is a sector on one of its faces, a lining on a backplate, with an angle and radii of its own, so
that no node of a pad lies at one of the disc. The disc turns anticlockwise seen from above: the leading end of a pad is the one at the smaller angle.

Usage: python3 mesh.py > two-pads.inp
       python3 mesh.py 3 > two-pads.inp      each brick divided into 3 x 3 x 3
"""

import sys
from math import cos, pi, sin

DISC = {"cells": 18, "radii": [60.0, 88.0, 140.0], "heights": [-20.0, 0.0]}
PAD = {"radii": [97.0, 117.0, 135.0], "cells": 4, "first": 61.0, "last": 117.0}  # degrees
LINING, BACKPLATE = 10.0, 5.0
# name: Young's modulus in MPa, Poisson's ratio, density in t/mm^3
MATERIALS = {"IRON": (120e3, 0.26, 7.2e-9), "FRICTION": (2.0e3, 0.30, 2.5e-9), "STEEL": (207e3, 0.29, 7.85e-9)}
SECTIONS = {"ROTOR": "IRON", "LININGS": "FRICTION", "BACKPLATES": "STEEL"}
# Corners of a brick, then the two corners between which each of its other nodes is.
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def between(places, at):
    """Coordinate with half an index: that of a place, or the middle of two."""
    return places[at // 2] if at % 2 == 0 else (places[at // 2] + places[at // 2 + 1]) / 2


class Body:
    """Bricks over radii, angles and heights; places have half indices, and a closed body meets its own beginning."""

    def __init__(self, first, radii, angles, heights, closed):
        self.next, self.number, self.position, self.closed = first, {}, {}, closed
        self.radii, self.heights = radii, heights
        self.angles = angles + [2 * pi] if closed else angles

    def node(self, place):
        radius, angle, height = place
        if self.closed:
            place = (radius, angle % (2 * (len(self.angles) - 1)), height)
        if place not in self.number:
            r, t, z = between(self.radii, radius), between(self.angles, angle), between(self.heights, height)
            self.number[place], self.position[self.next] = self.next, (r * cos(t), r * sin(t), z)
            self.next += 1
        return self.number[place]

    def bricks(self, layer):
        """The nodes of each brick of a layer, in the order of C3D20, also where heights descend."""
        corners = CORNERS if self.heights[-1] > self.heights[0] else CORNERS[4:] + CORNERS[:4]
        for i in range(len(self.radii) - 1):
            for j in range(len(self.angles) - 1):
                own = [(2 * (i + a), 2 * (j + b), 2 * (layer + c)) for a, b, c in corners]
                middles = [tuple((x + y) // 2 for x, y in zip(own[a], own[b])) for a, b in EDGES]
                yield [self.node(place) for place in own + middles]

    def nodes(self, wanted):
        """The numbers of the nodes whose half indices are wanted."""
        return sorted(number for place, number in self.number.items() if wanted(*place))


def divided(places, parts):
    """Places with others in between, that divide the distance of two into so many parts."""
    return [a + (b - a) * k / parts for a, b in zip(places, places[1:]) for k in range(parts)] + places[-1:]


def wrapped(numbers):
    """Lines of at most sixteen numbers, as CalculiX wants them."""
    for at in range(0, len(numbers), 16):
        yield ", ".join(map(str, numbers[at : at + 16])) + ("," if at + 16 < len(numbers) else "")


def main():
    parts = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    side = 2 * parts  # half indices of what is one cell without division
    cells = PAD["cells"] * parts
    angles = [(PAD["first"] + k * (PAD["last"] - PAD["first"]) / cells) * pi / 180 for k in range(cells + 1)]
    around = [k * 2 * pi / (DISC["cells"] * parts) for k in range(DISC["cells"] * parts)]
    top, bottom = DISC["heights"][-1], DISC["heights"][0]
    disc = Body(1, divided(DISC["radii"], parts), around, divided(DISC["heights"], parts), True)
    pads = [
        Body(number * parts**3 + 1, divided(PAD["radii"], parts), angles, divided(heights, parts), False)
        for number, heights in (
            (10000, [top, top + LINING, top + LINING + BACKPLATE]),
            (20000, [bottom, bottom - LINING, bottom - LINING - BACKPLATE]),
        )
    ]
    layers = range(parts)
    elements = {"ROTOR": [brick for layer in layers for brick in disc.bricks(layer)], "LININGS": [], "BACKPLATES": []}
    for pad in pads:
        for layer in layers:
            elements["LININGS"] += pad.bricks(layer)
        for layer in layers:
            elements["BACKPLATES"] += pad.bricks(parts + layer)
    sets = {
        "HUB": disc.nodes(lambda radius, angle, height: radius == 0),
        "TOP": disc.nodes(lambda radius, angle, height: height == side and radius >= side),
        "BOTTOM": disc.nodes(lambda radius, angle, height: height == 0 and radius >= side),
    }
    for name, pad in zip(("OUTER", "INNER"), pads):
        sets |= {
            f"FACE_{name}": pad.nodes(lambda radius, angle, height: height == 0),
            f"BACK_{name}": pad.nodes(lambda radius, angle, height: height == 2 * side),
            # The piston presses on the middle half of the back.
            f"PISTON_{name}": pad.nodes(
                lambda radius, angle, height: height == 2 * side and side <= angle <= 2 * cells - side
            ),
            f"LEADING_{name}": pad.nodes(lambda radius, angle, height: height >= side and angle == 0),
            f"TRAILING_{name}": pad.nodes(lambda radius, angle, height: height >= side and angle == 2 * cells),
        }
    print("*HEADING\nA disc between two pads; written by mesh.py, in mm, t, s\n*NODE, NSET=NALL")
    for body in (disc, *pads):
        for number, (x, y, z) in body.position.items():
            print(f"{number}, {x:.9f}, {y:.9f}, {z:.9f}")
    label = 0
    for name, bricks in elements.items():
        print(f"*ELEMENT, TYPE=C3D20, ELSET={name}")
        for brick in bricks:
            label += 1
            print(", ".join(map(str, [label] + brick[:15])) + ",\n" + ", ".join(map(str, brick[15:])))
    for name, numbers in sets.items():
        print(f"*NSET, NSET={name}", *wrapped(numbers), sep="\n")
    for name, (young, poisson, density) in MATERIALS.items():
        print(f"*MATERIAL, NAME={name}\n*ELASTIC\n{young:g}, {poisson:g}\n*DENSITY\n{density:g}")
    for name, material in SECTIONS.items():
        print(f"*SOLID SECTION, ELSET={name}, MATERIAL={material}")
    print("*BOUNDARY\nHUB, 1, 3\n*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n10\n*END STEP")


if __name__ == "__main__":
    main()
