#!/usr/bin/env python3
"""A machine on soft mounts: matrices and study.

What it does
============
It writes `machine/K.mtx`, `machine/M_x.mtx`, `machine/M_y.mtx` and `machine.toml`
into the folder of this file.

The machine
===========
A flat lattice of steel bars, 29 cells of 40 mm x 30 mm in a row with one diagonal
each: 60 joints, two displacements each (x along the row, y up), 120 degrees of
freedom.  Joint j (from 1) has the degrees of freedom 2 j - 1 (x) and 2 j (y); odd
joints are below, even ones above, from left to right.  Each bar has EA = 8.4e7 N
and gives half of its mass to either end; a motor and a head add mass to some of the
upper joints.  Elastic modes go from 129 Hz to 33 kHz (2.1e5 rad/s).

The cells are triangles of 3, 4 and 5, so all entries of K are integers and the
written K has the three rigid motions in its null space exactly.  Masses are
multiples of 1/1024 kg.

The mounts
==========
Air springs below every joint, chosen for equal static deflection: stiffness kappa
times the mass on it, upwards; their valves answer late, by tau, which is a damping
of -tau kappa times mass; dampers add c times mass.  Sideways there are passive
springs and dampers in proportion to mass as well.  A bar between the lower corners
resists pitch.  The lattice has damping in proportion to stiffness.

Stability in closed form
========================
With m the masses, D_y and D_x those of y and x alone and K the lattice,

    damping    (c - tau kappa) D_y + c_x D_x + beta K
    stiffness  kappa D_y + kappa_x D_x + bar + K

Moving up as a whole (bounce) is in the null space of K and of the bar, so it
decouples exactly: lambda^2 + (c - tau kappa) lambda + kappa = 0.  Surge does as
well: lambda^2 + c_x lambda + kappa_x = 0.  Where c > tau kappa the damping matrix
is positive definite and all is stable; where c < tau kappa bounce flutters.  tau
kappa always lies between the bounds of c, so the stable share is

    (c_upper - mean(tau) mean(kappa)) / (c_upper - c_lower)
    = (0.0252 - 0.012 * 1.6) / 0.02 = 0.3 exactly.

How to run it
=============
    python3 make_machine.py      Python 3.10, nothing else
"""

from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent
CELLS = 29
EA = 84_000_000  # N
PER_LENGTH = Fraction(314, 100)  # kg/m: 7850 * 4e-4
EXTRA = {18: Fraction(3), 20: Fraction(4), 22: Fraction(3), 48: Fraction(3, 2), 50: Fraction(3, 2)}  # kg, by joint


def joints():
    """x and y of the joints, in units of 10 mm."""
    return [(4 * i, 3 * j) for i in range(CELLS + 1) for j in range(2)]


def bars():
    """Pairs of joints, from 0."""
    for i in range(CELLS + 1):
        yield 2 * i, 2 * i + 1
        if i < CELLS:
            yield 2 * i, 2 * i + 2
            yield 2 * i + 1, 2 * i + 3
            yield 2 * i, 2 * i + 3


def matrices():
    place = joints()
    K = {}
    mass = [EXTRA.get(joint + 1, Fraction(0)) for joint in range(len(place))]
    for a, b in bars():
        dx, dy = (place[b][axis] - place[a][axis] for axis in (0, 1))
        length = {9: 3, 16: 4, 25: 5}[dx * dx + dy * dy]
        stiffness = Fraction(100 * EA, length)
        way = {2 * a: -dx, 2 * a + 1: -dy, 2 * b: dx, 2 * b + 1: dy}
        for i in way:
            for j in way:
                if j <= i and way[i] * way[j]:
                    key = (i + 1, j + 1)
                    K[key] = K.get(key, 0) + stiffness * way[i] * way[j] / length**2
        for joint in (a, b):
            mass[joint] += PER_LENGTH * length / 200
    mass = [Fraction(round(m * 1024), 1024) for m in mass]
    assert all(value == int(value) for value in K.values())
    x = {(2 * j + 1, 2 * j + 1): m for j, m in enumerate(mass)}
    y = {(2 * j + 2, 2 * j + 2): m for j, m in enumerate(mass)}
    return K, x, y


def write_matrix(path, size, matrix, remark):
    """Matrix Market, the lower triangle by columns, 17 digits."""
    lines = ["%%MatrixMarket matrix coordinate real symmetric", f"% {remark}", f"{size} {size} {len(matrix)}"]
    for row, column in sorted(matrix, key=lambda key: (key[1], key[0])):
        lines.append(f"{row} {column} {float(matrix[row, column]):.16e}")
    path.write_text("\n".join(lines) + "\n")


STUDY = """
# A machine of 120 degrees of freedom on soft mounts: bounce 0.20 Hz, surge 0.30 Hz, pitch 0.38 Hz; lattice from 129 Hz to 33 kHz.
# It is stable where c > tau*kappa, exactly 30 % of the box; elsewhere it bounces (flutter). Bounce and surge decouple exactly:
# lambda^2 + (c - tau*kappa) lambda + kappa = 0 and lambda^2 + c_x lambda + kappa_x = 0. See make_machine.py.
format = 1
name = "machine"

[model]
kind = "matrices"
M = [{ file = "machine/M_x.mtx" }, { file = "machine/M_y.mtx" }]        # kg
C = [
    { file = "machine/M_y.mtx", factor = "c - tau*kappa" },
    { file = "machine/M_x.mtx", factor = "c_x" },
    { file = "machine/K.mtx", factor = "beta" },
]
K = [
    { file = "machine/K.mtx" },                                         # N/m
    { file = "machine/M_y.mtx", factor = "kappa" },
    { file = "machine/M_x.mtx", factor = "kappa_x" },
    { size = 120, form = "symmetric", factor = "bar", entries = [[2, 2, 1], [118, 118, 1], [118, 2, -1]] },
]

[model.constants]
kappa_x = 3.5625                         # 1/s^2, sideways
c_x = 0.0234375                          # 1/s, sideways
bar = 7.625                              # N/m, against pitch
beta = 4.76837158203125e-7               # s, of the lattice; 2^-21

[inputs]
c = { distribution = "uniform", lower = 0.0052, upper = 0.0252 }         # 1/s, damping over mass
tau = { distribution = "uniform", lower = 0.010, upper = 0.014 }         # s, lag of the valves
kappa = { distribution = "uniform", nominal = 1.6, spread = 0.05 }       # 1/s^2, stiffness over mass

[spectrum]
modes = [1, 2, 3]
"""


def main():
    K, x, y = matrices()
    folder = HERE / "machine"
    folder.mkdir(exist_ok=True)
    size = 4 * (CELLS + 1)
    write_matrix(folder / "K.mtx", size, K, "stiffness of the lattice, N/m; by make_machine.py")
    write_matrix(folder / "M_x.mtx", size, x, "mass along x, kg; by make_machine.py")
    write_matrix(folder / "M_y.mtx", size, y, "mass along y, kg; by make_machine.py")
    (HERE / "machine.toml").write_text(STUDY.lstrip("\n"))


if __name__ == "__main__":
    main()
