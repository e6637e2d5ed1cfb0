#!/usr/bin/env python3
"""Polynomial chaos coefficients of the clutch by tensor Gauss-Legendre projection:
reference data.

    python3 tensor_quadrature.py          writes tensor_quadrature.csv beside this file
    python3 tensor_quadrature.py check    writes nothing, verifies the numbers

Needs numpy and mpmath (written with Python 3.11.7, numpy 2.4.6, mpmath 1.3.0); one
process.  Everything that reaches the file is computed with DIGITS decimal digits and
rounded to double once, at the end; numpy only provides starting values of the
eigenvalues.


The system
==========
Six degrees of freedom (theta_x, theta_y, Z_A, Z_B, Z_C, Z_D),

    M u'' + C u' + K u = 0,      M = diag(I, I, m, m, m, m),
    I = 0.03,  m = 40 / 4,
    K = S(gamma_1 k_p / 4, k_p / (4 gamma_1),
          gamma_2 k_p / 4, k_p / (4 gamma_2), k_f),
    C = S(4, 4, 4, 4, 0.1),

    S(a, b, c, d, f), with r = (r_1 + r_2) / 2, is

    r^2 (a+b+4f)    +mu l r (c+d)   r (a+2f)   -r (b+2f)   mu l c     -mu l d
    -mu l r (a+b)   r^2 (c+d+4f)    -mu l a    mu l b      r (c+2f)   -r (d+2f)
    r (a+2f)        0               a+2f       0           -f         -f
    -r (b+2f)       0               0          b+2f        -f         -f
    0               r (c+2f)        -f         -f          c+2f       0
    0               -r (d+2f)       -f         -f          0          d+2f

Inputs, in this order: mu uniform on [0, 0.5]; then k_p, k_f, gamma_1, gamma_2, r_1,
r_2, l uniform on [0.95, 1.05] times the nominal 16e6, 7e6, 0.9, 0.8, 0.075, 0.12,
0.0125 (SI units).  The first r vary, the others stay nominal: with xi in [-1, 1]^r

    mu = 0.25 (1 + xi_1),      x_j = nominal_j (1 + 0.05 xi_j)  for j > 1.

The constants are meant as the decimal numbers printed here, not as doubles.

Of the twelve eigenvalues of the state matrix four are zero and four have a positive
imaginary part.  The latter are numbered from 1 by ascending imaginary part.

Eigenvalues.  The rigid rotations

    n_1 = (1, 0, -r, r, 0, 0),      n_2 = (0, 1, 0, 0, -r, r)

are in the null spaces of both K and C.  Hence
(M s^2 + C s + K) [n_1, n_2, e_3, ..., e_6] has s^2 M n_1 and s^2 M n_2 as its first two
columns, and the determinant has the factor s^4.  The rows of

    L = [ q 0 1 0 0 0; -q 0 0 1 0 0; 0 q 0 0 1 0; 0 -q 0 0 0 1 ],      q = r m / I,

are orthogonal to M n_1 and M n_2, and L M [e_3, ..., e_6] = m 1.  So the eight other
eigenvalues are those of the 4 x 4 problem

    det(s^2 1 + s C' + K') = 0,      K' = L K [e_3, ..., e_6] / m,  C' likewise.

They start from numpy.linalg.eigvals and are refined, all eight together, by the
Ehrlich-Aberth iteration (Newton's method with the other roots divided out) on this
determinant written as a polynomial of degree 8 (Leibniz' formula, 24 products).


The coefficients
================
For r = 1, 2, 3, 4, tensor Gauss-Legendre with 7 nodes for each input (7, 49, 343, 2401
nodes),

    c_alpha = sum_i w_i y(xi_i) psi_alpha(xi_i),      |alpha|_1 <= 6,

the weights with sum 1, psi_alpha(xi) = prod_j phi_{alpha_j}(xi_j),
phi_k = sqrt(2 k + 1) P_k (orthonormal for the uniform density), for

    y = Re, Im of lambda_3, lambda_4,
        s = (lambda_3 + lambda_4) / 2,      c0 = -((lambda_3 - lambda_4) / 2)^2.


tensor_quadrature.csv
=====================
    r,alpha,re_3,im_3,re_4,im_4,re_s,im_s,re_c0,im_c0

alpha: r degrees joined by spaces ("0 2 1 0"), in the order of the inputs.  Rows by r,
then total degree, then alpha in descending lexicographic order.  7, 28, 84 and 210
rows.  Numbers are the doubles nearest to the results, by repr.

How to compare.  Double precision gives lambda to about 1e-11 absolute at a node, the
coefficients to about 3e-12 (lambda, s) and 3e-11 (c0).  Many coefficients are far
smaller than that: Re s hardly varies about its mean of -1.54 (with these four inputs),
so its coefficients but the mean are at most 4e-5 and as small as 5e-17.  The
tolerance should therefore be absolute, or relative to the size of the values, not to
each coefficient.  The smallest |lambda_3 - lambda_4| at any
node is 1.52 (r = 4; 6.02, 5.74, 5.61 for r = 1, 2, 3), the smallest difference of the
imaginary parts 0.053: there is no near-coalescence, nor doubt about the numbering.
"""

import csv
import itertools
import sys
from pathlib import Path

import mpmath
import numpy as np
from mpmath import mp

FOLDER = Path(__file__).resolve().parent
DIGITS = 50
DEGREE = 6
NODES = DEGREE + 1
INPUTS_MAX = 4
QUANTITIES = ("re_3", "im_3", "re_4", "im_4", "re_s", "im_s", "re_c0", "im_c0")

# Decimal strings: each arithmetic (mpf or float) reads them by itself.
NOMINAL = ("0.25", "16e6", "7e6", "0.9", "0.8", "0.075", "0.12", "0.0125")
PLATE_MASS, INERTIA = "40", "0.03"
DAMPERS, DAMPER_F = ("4", "4", "4", "4"), "0.1"

mp.dps = DIGITS


# --- the system; `number` is mp.mpf or float ---------------------------------


def physical(xi, number):
    """The eight inputs for standardized ones, the missing ones nominal."""
    nominal = [number(v) for v in NOMINAL]
    half = [nominal[0]] + [number("0.05") * v for v in nominal[1:]]
    full = list(xi) + [number(0)] * (len(nominal) - len(xi))
    return [v + h * x for v, h, x in zip(nominal, half, full, strict=True)]


def contact(mu, r, l, a, b, c, d, f):
    """S(a, b, c, d, f)."""
    ml, z = mu * l, 0 * f
    return [
        [r * r * (a + b + 4 * f), ml * r * (c + d), r * (a + 2 * f), -r * (b + 2 * f),
         ml * c, -ml * d],
        [-ml * r * (a + b), r * r * (c + d + 4 * f), -ml * a, ml * b,
         r * (c + 2 * f), -r * (d + 2 * f)],
        [r * (a + 2 * f), z, a + 2 * f, z, -f, -f],
        [-r * (b + 2 * f), z, z, b + 2 * f, -f, -f],
        [z, r * (c + 2 * f), -f, -f, c + 2 * f, z],
        [z, -r * (d + 2 * f), -f, -f, z, d + 2 * f],
    ]  # fmt: skip


def matrices(xi, number):
    """r, the diagonal of M, C and K."""
    mu, k_p, k_f, gamma_1, gamma_2, r_1, r_2, l = physical(xi, number)
    r = (r_1 + r_2) / 2
    stiff = contact(
        mu, r, l,
        gamma_1 * k_p / 4, k_p / (4 * gamma_1),
        gamma_2 * k_p / 4, k_p / (4 * gamma_2), k_f,
    )  # fmt: skip
    damp = contact(mu, r, l, *[number(c) for c in DAMPERS], number(DAMPER_F))
    mass = [number(INERTIA)] * 2 + [number(PLATE_MASS) / 4] * 4
    return r, mass, damp, stiff


def state_matrix(xi, number):
    """The 12 x 12 state matrix [0, 1; -M^-1 K, -M^-1 C], rows as lists."""
    _, mass, damp, stiff = matrices(xi, number)
    rows = [[number(int(j == i + 6)) for j in range(12)] for i in range(6)]
    for m, k_row, c_row in zip(mass, stiff, damp, strict=True):
        rows.append([-k / m for k in k_row] + [-c / m for c in c_row])
    return rows


def reduced(xi, number):
    """C' and K' of the 4 x 4 problem without the rigid rotations."""
    r, mass, damp, stiff = matrices(xi, number)
    q = r * mass[2] / mass[0]

    def project(full):
        return [
            [(full[2 + i][2 + j] + sign * q * full[i // 2][2 + j]) / mass[2]
             for j in range(4)]
            for i, sign in enumerate((1, -1, 1, -1))
        ]  # fmt: skip

    return project(damp), project(stiff)


# --- eigenvalues in high precision -------------------------------------------


def times(one, other):
    out = [mp.mpf(0)] * (len(one) + len(other) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(other):
            out[i + j] += a * b
    return out


def characteristic(damp, stiff):
    """Coefficients of det(s^2 1 + s C' + K'), ascending: Leibniz' formula."""
    total = [mp.mpf(0)] * 9
    for order in itertools.permutations(range(4)):
        sign = 1
        for i in range(4):
            for j in range(i):
                if order[j] > order[i]:
                    sign = -sign
        product = [mp.mpf(sign)]
        for i, j in enumerate(order):
            entry = [stiff[i][j], damp[i][j]] + [mp.mpf(1)] * (i == j)
            product = times(product, entry)
        for k, value in enumerate(product):
            total[k] += value
    return total


def aberth(poly, roots):
    """All roots of a real polynomial (ascending coefficients) from approximations."""
    roots = [mp.mpc(complex(z)) for z in roots]
    for _ in range(60):
        largest = mp.mpf(0)
        for i, z in enumerate(roots):
            value, slope = mp.mpc(0), mp.mpc(0)
            for c in reversed(poly):
                slope = slope * z + value
                value = value * z + c
            if value == 0:
                continue
            others = mp.fsum(1 / (z - y) for j, y in enumerate(roots) if j != i)
            change = 1 / (slope / value - others)
            roots[i] = z - change
            largest = max(largest, abs(change) / abs(z))
        if largest < mp.mpf(10) ** (-mp.dps // 2 - 8):
            return roots  # cubic convergence: the last change is far below
    raise ValueError("no convergence")


def companion(damp, stiff):
    top = np.hstack([np.zeros((4, 4)), np.eye(4)])
    below = [[-float(x) for x in k + c] for k, c in zip(stiff, damp, strict=True)]
    return np.vstack([top, np.array(below)])


def oscillating(values):
    """Those with a positive imaginary part, by ascending imaginary part."""
    limit = max(abs(z) for z in values) * 1e-6
    modes = sorted((z for z in values if z.imag > limit), key=lambda z: z.imag)
    if len(modes) != 4:
        raise ValueError(f"{len(modes)} oscillating modes")
    return modes


def eigenvalues(xi):
    """The eight eigenvalues other than zero."""
    damp, stiff = reduced(xi, mp.mpf)
    start = np.linalg.eigvals(companion(damp, stiff))
    return aberth(characteristic(damp, stiff), start)


def quantities(l3, l4):
    s, c0 = (l3 + l4) / 2, -(((l3 - l4) / 2) ** 2)
    return [part for z in (l3, l4, s, c0) for part in (z.real, z.imag)]


# --- quadrature --------------------------------------------------------------


def legendre(degree, x):
    """P_0, ..., P_degree at x."""
    out = [mp.mpf(1), x]
    for k in range(1, degree):
        out.append(((2 * k + 1) * x * out[k] - k * out[k - 1]) / (k + 1))
    return out[: degree + 1]


def gauss():
    """Nodes, ascending, and weights, of sum 1."""
    nodes, weights = [], []
    for i in range(NODES):
        x = -mp.cos(mp.pi * (i + mp.mpf("0.75")) / (NODES + mp.mpf("0.5")))
        for _ in range(12):
            p = legendre(NODES, x)
            slope = NODES * (x * p[NODES] - p[NODES - 1]) / (x * x - 1)
            x -= p[NODES] / slope
        if 2 * i + 1 == NODES:
            x = mp.mpf(0)
        p = legendre(NODES, x)
        slope = NODES * (x * p[NODES] - p[NODES - 1]) / (x * x - 1)
        nodes.append(x)
        weights.append(1 / ((1 - x * x) * slope**2))
    return nodes, weights


def basis(x):
    """phi_0, ..., phi_DEGREE at x."""
    return [mp.sqrt(2 * k + 1) * p for k, p in enumerate(legendre(DEGREE, x))]


def multi_indices(r):
    """|alpha| <= DEGREE: by total degree, then descending lexicographic."""
    found = [
        a for a in itertools.product(range(NODES), repeat=r) if sum(a) <= DEGREE
    ]
    return sorted(found, key=lambda a: (sum(a), [-k for k in a]))


def sampled(r):
    """The quantities at all nodes, array [node of input 1, ..., of input r, quantity],
    and all lists of eigenvalues."""
    nodes, _ = gauss()
    out = np.empty((NODES,) * r + (len(QUANTITIES),), dtype=object)
    spectra = {}
    for place in itertools.product(range(NODES), repeat=r):
        spectra[place] = eigenvalues([nodes[i] for i in place])
        modes = oscillating(spectra[place])
        out[place] = quantities(modes[2], modes[3])
    return out, spectra


def project(values, r):
    """Coefficients of the full tensor basis, input after input: array
    [degree in input 1, ..., in input r, quantity]."""
    nodes, weights = gauss()
    table = [basis(x) for x in nodes]
    factor = np.array(
        [[weights[i] * table[i][k] for i in range(NODES)] for k in range(NODES)],
        dtype=object,
    )
    for _ in range(r):
        # Takes the first axis off and puts the degree before the quantity.
        values = np.tensordot(values, factor, axes=([0], [1]))
        values = np.moveaxis(values, -1, -2)
    return values


def double(x):
    """The nearest double."""
    return float(mp.nstr(x, DIGITS - 5))


def write():
    with open(FOLDER / "tensor_quadrature.csv", "w", newline="") as handle:
        out = csv.writer(handle, lineterminator="\n")
        out.writerow(["r", "alpha", *QUANTITIES])
        for r in range(1, INPUTS_MAX + 1):
            coefficients = project(sampled(r)[0], r)
            for alpha in multi_indices(r):
                numbers = [repr(double(c)) for c in coefficients[alpha]]
                out.writerow([r, " ".join(map(str, alpha)), *numbers])


# --- verification ------------------------------------------------------------


def in_doubles(r):
    """The coefficients with numpy only: eigenvalues of the 12 x 12 matrix, Gauss rule
    and polynomials of numpy, one sum over all nodes."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    points = np.array(list(itertools.product(x, repeat=r)))
    weight = np.prod(np.array(list(itertools.product(w / 2, repeat=r))), axis=1)
    values = []
    for xi in points:
        state = np.array(state_matrix([float(v) for v in xi], float))
        modes = oscillating(np.linalg.eigvals(state))
        values.append(quantities(modes[2], modes[3]))
    phi = np.polynomial.legendre.legvander(points, DEGREE)
    phi = phi * np.sqrt(2 * np.arange(NODES) + 1)
    psi = np.array(
        [np.prod([phi[:, j, k] for j, k in enumerate(a)], axis=0)
         for a in multi_indices(r)]
    )  # fmt: skip
    return np.array(values), (psi * weight) @ np.array(values)


def check():
    failed = []

    def report(text, value, bound):
        print(f"  {text:62} {mp.nstr(mp.mpf(value), 3)}")
        if not value <= bound:
            failed.append(text)

    tiny = mp.mpf(10) ** (10 - DIGITS)
    print("rule and basis")
    nodes, weights = gauss()
    x, w = np.polynomial.legendre.leggauss(NODES)
    report("nodes against numpy", max(abs(a - b) for a, b in zip(nodes, x)), 1e-15)
    away = max(abs(2 * a - b) for a, b in zip(weights, w))
    report("weights against numpy", away, 1e-15)
    moments = [
        abs(
            mp.fsum(w * x**k for x, w in zip(nodes, weights))
            - mp.mpf(int(k % 2 == 0)) / (k + 1)
        )
        for k in range(2 * NODES)
    ]
    report("moments to degree 13", max(moments), tiny)
    table = [basis(x) for x in nodes]
    gram = [
        abs(mp.fsum(w * t[j] * t[k] for w, t in zip(weights, table)) - int(j == k))
        for j in range(NODES)
        for k in range(NODES)
    ]
    report("discrete Gram matrix, one input", max(gram), tiny)
    gram = mp.mpf(0)
    for a in multi_indices(2):
        for b in multi_indices(2):
            inner = mp.fsum(
                weights[i] * weights[j] * table[i][a[0]] * table[j][a[1]]
                * table[i][b[0]] * table[j][b[1]]
                for i in range(NODES) for j in range(NODES)
            )  # fmt: skip
            gram = max(gram, abs(inner - int(a == b)))
    report("discrete Gram matrix, two inputs", gram, tiny)

    with open(FOLDER / "tensor_quadrature.csv", newline="") as handle:
        stored = list(csv.DictReader(handle))

    for r in range(1, INPUTS_MAX + 1):
        print(f"r = {r}")
        values, spectra = sampled(r)
        scale = [max(abs(v) for v in values[..., q].flat) for q in range(8)]

        # Of the spectra: traces of the 8 x 8 problem and its square, conjugates,
        # and the whole of the 12 x 12 matrix by another algorithm at a few nodes.
        worst = mp.mpf(0)
        for place, roots in spectra.items():
            damp, stiff = reduced([nodes[i] for i in place], mp.mpf)
            power_1 = -mp.fsum(damp[i][i] for i in range(4))
            power_2 = mp.fsum(
                damp[i][j] * damp[j][i] for i in range(4) for j in range(4)
            ) - 2 * mp.fsum(stiff[i][i] for i in range(4))
            size = mp.fsum(abs(z) ** 2 for z in roots)
            worst = max(worst, abs(mp.fsum(roots) - power_1) / mp.sqrt(size))
            worst = max(worst, abs(mp.fsum(z * z for z in roots) - power_2) / size)
        report("sum of the eigenvalues and of their squares, relative", worst, tiny)

        def gap(place):
            l3, l4 = oscillating(spectra[place])[2:]
            return abs(l3 - l4)

        by_gap = sorted(spectra, key=gap)
        place = by_gap[0]
        modes = [complex(z) for z in oscillating(spectra[place])]
        print(f"  smallest |lambda_3 - lambda_4| {float(gap(place)):.6g} at node"
              f" {place}, there {modes[2]:.8g}, {modes[3]:.8g}")
        apart = [
            [oscillating(z)[i + 1].imag - oscillating(z)[i].imag for i in range(3)]
            for z in spectra.values()
        ]
        print("  smallest differences of Im, modes 1-2, 2-3, 3-4: "
              + ", ".join(f"{float(min(a)):.6g}" for a in zip(*apart)))
        unstable = sum(max(z.real for z in spectra[p]) > 0 for p in spectra)
        print(f"  unstable nodes {unstable} of {len(spectra)}")

        worst = mp.mpf(0)
        for place in {by_gap[0], by_gap[len(by_gap) // 2], by_gap[-1]}:
            state = mp.matrix(state_matrix([nodes[i] for i in place], mp.mpf))
            mp.dps = 3 * DIGITS  # four eigenvalues zero, defective
            found = oscillating(mp.eig(state, left=False, right=False))
            mp.dps = DIGITS
            own = oscillating(spectra[place])
            worst = max(worst, *(abs(a - b) / abs(b) for a, b in zip(found, own)))
        report("eigenvalues of the 12 x 12 matrix by mpmath, 3 nodes, relative",
               worst, tiny)

        coefficients = project(values, r)
        weight = 1
        for _ in range(r):
            weight = np.multiply.outer(weight, np.array(weights, dtype=object))
        worst = mp.mpf(0)
        for q in range(8):
            squares = (weight * values[..., q] ** 2).sum()
            worst = max(worst, abs((coefficients[..., q] ** 2).sum() / squares - 1))
        report("Parseval over the full tensor basis, relative", worst, tiny)
        indices = multi_indices(r)
        worst = mp.mpf(0)
        for alpha in indices[:: max(1, len(indices) // 6)]:
            total = [mp.mpf(0)] * 8
            for place in spectra:
                factor = mp.mpf(1)
                for i, k in zip(place, alpha):
                    factor *= weights[i] * table[i][k]
                total = [t + factor * v for t, v in zip(total, values[place])]
            worst = max(worst, *(
                abs(a - b) / c for a, b, c in zip(total, coefficients[alpha], scale)
            ))  # fmt: skip
        report("some coefficients as one sum over the nodes", worst, tiny)

        rows = {row["alpha"]: row for row in stored if row["r"] == str(r)}
        if list(rows) != [" ".join(map(str, a)) for a in indices]:
            failed.append(f"rows of r = {r}")
        away = max(
            abs(float(rows[" ".join(map(str, a))][name]) - double(coefficients[a][q]))
            for a in indices
            for q, name in enumerate(QUANTITIES)
        )
        report("file against this computation (difference of doubles)", away, 0)

        plain_values, plain = in_doubles(r)
        exact_values = np.array(
            [[double(v) for v in values[place]] for place in spectra]
        )
        exact = np.array([[double(v) for v in coefficients[a]] for a in indices])
        print("  numpy only against the file: quantity, largest difference at a node;"
              "\n  of the coefficients: largest difference, the same relative to the"
              "\n  largest coefficient besides the mean; smallest |coefficient|")
        for q, name in enumerate(QUANTITIES):
            at_node = np.max(np.abs(plain_values - exact_values)[:, q])
            away = np.max(np.abs(plain - exact)[:, q])
            largest = np.max(np.abs(exact[1:, q]))
            print(f"    {name:6} {at_node:9.2e} {away:9.2e} {away / largest:9.2e}"
                  f"   (largest {largest:.6g}) {np.min(np.abs(exact[:, q])):9.2e}")
            # Absolute: Re s hardly varies, its coefficients are below 1e-4.
            if away > 1e-10:
                failed.append(f"numpy {name} r = {r}")

    if failed:
        raise SystemExit("differ: " + "; ".join(failed))
    print("all right")


def main():
    if sys.argv[1:] == ["check"]:
        print(f"Python {sys.version.split()[0]}, numpy {np.__version__}, "
              f"mpmath {mpmath.__version__}")
        check()
        return
    write()


if __name__ == "__main__":
    main()
