#!/usr/bin/env python3
"""Groups of eigenvalues closed under conjugation that meet on the real axis: reference data.

Writes ``closed_groups.csv`` into the folder of this file. Needs mpmath.

The systems
===========
x' = A x with six states. A group of n = 2, 3 or 4 eigenvalues near -1 has the polynomial

    n = 2   q(p)                      q(p) = z^2 + p,   z = lambda + 1
    n = 3   q(p) (z - r)
    n = 4   q(p) (z^2 + r)

so that for p > 0 there is a pair, for p < 0 two reals, and at p = 0 they meet; with r = 0 all n meet. The others of the
six eigenvalues are -5 +- 30i and, for n = 2 and 3, reals from -40 on. B is block diagonal with companion matrices, and
A = S B S^-1, S = L U with unit triangular L and U of small integers, so that A is not normal.

The file
========
    size,case,a_1_1,...,a_6_6,da_1_1,...,da_6_6,e_1,...,e_4,de_1,...,de_4,re_1,im_1,...,re_4,im_4

A is rounded to doubles first; everything else belongs to exactly these. dA is the derivative of A by p, exact in doubles.
e_m are the elementary symmetric functions of the group, de_m their derivatives by p (from symmetric differences with a
step of 1e-20), re and im its eigenvalues; zeros fill up. Computed with 200 digits, of which 50 are left where four
eigenvalues meet, and written with 17. The case says
where p and r lie: `pair`, `reals`, `near` (1e-4 and 1e-8 on both sides of the meeting), `meeting`, `all` (all n meet).
"""

import csv
from pathlib import Path

import mpmath as mp

mp.mp.dps = 200

STATES = 6
MOST = 4
STEP = mp.mpf("1e-20")

LOWER = [[1 if i == j else (i * j + i) % 3 - 1 if i > j else 0 for j in range(STATES)] for i in range(STATES)]
UPPER = [[1 if i == j else (i + 2 * j) % 3 - 1 if i < j else 0 for j in range(STATES)] for i in range(STATES)]

CASES = [
    ("pair", "0.5", "0.25"),
    ("reals", "-0.375", "0.3125"),
    ("near", "1e-4", "0.25"),
    ("near", "-1e-4", "0.25"),
    ("near", "1e-8", "0.25"),
    ("near", "-1e-8", "0.25"),
    ("meeting", "0", "0.25"),
    ("all", "0", "0"),
]


def times(one, other):
    """The product of two polynomials, highest power first."""
    product = [mp.mpf(0)] * (len(one) + len(other) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            product[i + j] += a * b
    return product


def moved(polynomial):
    """A polynomial in z as one in lambda, where z = lambda + 1."""
    whole = [mp.mpf(0)]
    for coefficient in polynomial:
        whole = times(whole, [mp.mpf(1), mp.mpf(1)])
        whole[-1] += coefficient
    return whole[-len(polynomial):]


def of_group(size, p, r):
    last = {2: [1], 3: [1, -r], 4: [1, 0, r]}[size]
    return moved(times([1, 0, p], [mp.mpf(c) for c in last]))


def companion(polynomial):
    n = len(polynomial) - 1
    block = mp.zeros(n)
    for i in range(n - 1):
        block[i, i + 1] = 1
    for j in range(n):
        block[n - 1, j] = -polynomial[n - j]
    return block


def system(size, p, r):
    """A."""
    blocks = [companion(of_group(size, p, r)), mp.matrix([[-5, 30], [-30, -5]])]
    blocks += [mp.matrix([[-40 - 10 * k]]) for k in range(STATES - 2 - size)]
    b, at = mp.zeros(STATES), 0
    for block in blocks:
        for i in range(block.rows):
            for j in range(block.rows):
                b[at + i, at + j] = block[i, j]
        at += block.rows
    s = mp.matrix(LOWER) * mp.matrix(UPPER)
    return s * b * s**-1


def eigenvalues_of_group(matrix, size):
    values = mp.eig(matrix, left=False, right=False)
    return sorted(values, key=lambda value: abs(value + 1))[:size]


def symmetric(values):
    """e_1, ..., e_n."""
    polynomial = [mp.mpf(1)]
    for value in values:
        polynomial = times(polynomial, [1, -value])
    return [mp.re(c) * (-1) ** m for m, c in enumerate(polynomial)][1:]


def row(size, case, p, r):
    p, r = mp.mpf(p), mp.mpf(r)
    exact = system(size, p, r)
    a = exact.apply(lambda entry: mp.mpf(float(entry)))
    slope = system(size, p + 1, r) - exact
    values = eigenvalues_of_group(a, size)
    shifted = [symmetric(eigenvalues_of_group(a + sign * STEP * slope, size)) for sign in (1, -1)]
    slopes = [(up - down) / (2 * STEP) for up, down in zip(*shifted)]
    values.sort(key=lambda value: (mp.re(value), mp.im(value)))
    parts = [part for value in values for part in (mp.re(value), mp.im(value))]

    def filled(numbers, count):
        # What is zero but for rounding is zero.
        texts = [mp.nstr(number, 17) if abs(number) > 1e-30 else "0" for number in numbers]
        return texts + ["0"] * (count - len(numbers))

    entries = [repr(float(entry)) for entry in a] + [repr(float(entry)) for entry in slope]
    return [size, case, *entries, *filled(symmetric(values), MOST), *filled(slopes, MOST), *filled(parts, 2 * MOST)]


def main():
    places = [f"{i}_{j}" for i in range(1, STATES + 1) for j in range(1, STATES + 1)]
    group = range(1, MOST + 1)
    header = ["size", "case", *(f"a_{at}" for at in places), *(f"da_{at}" for at in places)]
    header += [f"e_{m}" for m in group] + [f"de_{m}" for m in group]
    header += [f"{part}_{k}" for k in group for part in ("re", "im")]
    with open(Path(__file__).parent / "closed_groups.csv", "w", newline="") as handle:
        out = csv.writer(handle, lineterminator="\n")
        out.writerow(header)
        out.writerows(row(size, *case) for size in (2, 3, 4) for case in CASES)


if __name__ == "__main__":
    main()
