#!/usr/bin/env python3
"""Free-free beams of 20, 80 and 200 elements: matrices and studies.

What it does
============
It writes into the folder of this file

    beam-N/K.mtx, beam-N/M.mtx   stiffness (N/m, N, N m) and mass (kg, kg m, kg m2)
    beam-N.toml                  on soft springs, dashpots and negative damping at both ends
    beam-N-free.toml             free in space, damping in proportion to stiffness

for N = 20, 80, 200 elements.  Each node has a displacement and a rotation, in
this order: 2 (N + 1) degrees of freedom, the displacements of the ends are
numbers 1 and 2 N + 1.  Bernoulli's beam, cubic elements, consistent mass.

The beam
========
Steel, E = 2.1e11 Pa, 7850 kg/m3, 4 m long, 0.1 m wide, 0.036 m thick:

    EI = 81648 N m2 exactly,  28.26 kg/m,  113.04 kg in all

EI and N/length are integers, so every entry of K is an integer far below 2^53,
and the two rigid motions are in the null space of the written K exactly.  The
entries of M are rounded; that moves no zero.

Largest natural frequency (rad/s): 8.0e4, 1.3e6, 8.0e6 for N = 20, 80, 200.
First bending: 75.3 rad/s.  On springs of 89.25 N/m the beam bounces at 0.2 Hz
and pitches at 0.35 Hz.

Stability in closed form
========================
beam-N: the damping matrix is (c - g) times a diagonal that is one at both ends
and zero elsewhere, and no mode has both ends at rest.  So all modes are stable
where c > g and all flutter where c < g.  c and g have the same distribution: 50 %.

beam-N-free: with K x = mu M x, each mode has lambda^2 + (b - g) mu lambda +
e mu = 0.  mu = 0 twice, that is four eigenvalues of zero at every point.  All
others are stable where b > g and flutter where b < g (they would need
|b - g| > 2 sqrt(e / mu_max) = 2.4e-7 s to stop oscillating, and have 0.8e-7 s
at most): 50 %.

How to run it
=============
    python3 make_beams.py        Python 3.10, nothing else
"""

from fractions import Fraction
from pathlib import Path

HERE = Path(__file__).resolve().parent
ELEMENTS = (20, 80, 200)

LENGTH = 4  # m
STIFFNESS = 81648  # N m2: 2.1e11 * 0.1 * 0.036^3 / 12
DENSITY = Fraction(2826, 100)  # kg/m: 7850 * 0.1 * 0.036


def assemble(element, elements):
    """The lower triangle of a chain of equal 4 x 4 elements: {(row, column): value}, from 1."""
    matrix = {}
    for e in range(elements):
        for i in range(4):
            for j in range(i + 1):
                key = (2 * e + i + 1, 2 * e + j + 1)
                matrix[key] = matrix.get(key, 0) + element[i][j]
    return {key: value for key, value in matrix.items() if value != 0}


def stiffness(elements):
    per = Fraction(elements, LENGTH)  # 1 / length of an element
    a, b, c = 12 * STIFFNESS * per**3, 6 * STIFFNESS * per**2, 2 * STIFFNESS * per
    element = [[a, b, -a, b], [b, 2 * c, -b, c], [-a, -b, a, -b], [b, c, -b, 2 * c]]
    return assemble(element, elements)


def mass(elements):
    h = Fraction(LENGTH, elements)
    f = DENSITY * h / 420
    element = [
        [156 * f, 22 * h * f, 54 * f, -13 * h * f],
        [22 * h * f, 4 * h**2 * f, 13 * h * f, -3 * h**2 * f],
        [54 * f, 13 * h * f, 156 * f, -22 * h * f],
        [-13 * h * f, -3 * h**2 * f, -22 * h * f, 4 * h**2 * f],
    ]
    return assemble(element, elements)


def write_matrix(path, size, matrix, remark):
    """Matrix Market, the lower triangle by columns, 17 digits."""
    lines = ["%%MatrixMarket matrix coordinate real symmetric", f"% {remark}", f"{size} {size} {len(matrix)}"]
    for row, column in sorted(matrix, key=lambda key: (key[1], key[0])):
        lines.append(f"{row} {column} {float(matrix[row, column]):.16e}")
    path.write_text("\n".join(lines) + "\n")


def write_study(path, text):
    path.write_text(text.strip("\n") + "\n")


def main():
    for n in ELEMENTS:
        size = 2 * (n + 1)
        folder = HERE / f"beam-{n}"
        folder.mkdir(exist_ok=True)
        K = stiffness(n)
        assert all(value == int(value) and abs(value) < 2**53 for value in K.values())
        of = f"of a free-free beam of {n} elements, 4 m of steel, 0.1 m x 0.036 m; by make_beams.py"
        write_matrix(folder / "K.mtx", size, K, f"stiffness (N/m, N, N m) {of}")
        write_matrix(folder / "M.mtx", size, mass(n), f"mass (kg, kg m, kg m2) {of}")
        write_study(
            HERE / f"beam-{n}.toml",
            f"""
# A free-free beam of {n} elements ({size} degrees of freedom) on soft springs at its ends: bounce at 0.2 Hz, pitch at 0.35 Hz.
# Damping is (c - g) at both ends and nowhere else: all modes are stable where c > g, exactly half of the box, and flutter elsewhere.
format = 1
name = "beam-{n}"

[model]
kind = "matrices"
M = {{ file = "beam-{n}/M.mtx" }}                                        # kg, kg m, kg m^2
C = {{ size = {size}, factor = "c - g", entries = [[1, 1, 1], [{size - 1}, {size - 1}, 1]] }}
K = [
    {{ file = "beam-{n}/K.mtx" }},                                       # N/m, N, N m
    {{ size = {size}, factor = "k", entries = [[1, 1, 1], [{size - 1}, {size - 1}, 1]] }},
]

[inputs]
c = {{ distribution = "uniform", lower = 0.8, upper = 1.2 }}           # N s/m, dashpot at each end
g = {{ distribution = "uniform", lower = 0.8, upper = 1.2 }}           # N s/m, negative damping at each end
k = {{ distribution = "uniform", nominal = 89.25, spread = 0.05 }}      # N/m, spring at each end

[spectrum]
modes = [1, 2, 3, 4]
""",
        )
        write_study(
            HERE / f"beam-{n}-free.toml",
            f"""
# A beam of {n} elements ({size} degrees of freedom), free in space: four eigenvalues are zero at every point.
# Damping is (b - g) times stiffness: all bending modes are stable where b > g, exactly half of the box, and flutter elsewhere.
format = 1
name = "beam-{n}-free"

[model]
kind = "matrices"
M = {{ file = "beam-{n}/M.mtx" }}                                        # kg, kg m, kg m^2
C = {{ file = "beam-{n}/K.mtx", factor = "b - g" }}
K = {{ file = "beam-{n}/K.mtx", factor = "e" }}                          # N/m, N, N m

[inputs]
b = {{ distribution = "uniform", lower = 1.6e-7, upper = 2.4e-7 }}     # s, damping over stiffness
g = {{ distribution = "uniform", lower = 1.6e-7, upper = 2.4e-7 }}     # s, negative damping over stiffness
e = {{ distribution = "uniform", nominal = 1.0, spread = 0.05 }}       # modulus over that of steel

[spectrum]
modes = [1, 2, 3, 4]
""",
        )


if __name__ == "__main__":
    main()
