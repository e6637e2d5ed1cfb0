#!/usr/bin/env python3
"""Clusters of three and of four coalescing vibration modes: reference data.

Writes ``three_modes.csv`` (k = 3) and ``four_modes.csv`` (k = 4) into the folder
of this file.  Needs numpy and mpmath.


The systems
===========
k nearly equal oscillators form a chain; one more oscillator, three times as
fast, hangs weakly on the end of it.  With n = k + 1,

    u'' + C u' + K u = 0,        M = I,    C = diag(2 sigma_1, ..., 2 sigma_n).

K is not symmetric.  With w0 = 100 rad/s, wx = 300 rad/s,

    K[i,i]     = w0^2 (1 + e_i)                       i = 1..k
    K[i,i+1]   = -kappa_i + phi_i p                   i = 1..k-1
    K[i+1,i]   = -kappa_i - phi_i p                   i = 1..k-1
    K[n,n]     = wx^2 (1 + 0.4 delta_1 - 0.2 delta_2)
    K[k,n]     = K[n,k] = -kappa_x,   kappa_x = 500 s^-2

kappa_i are coupling springs (symmetric; their diagonal share is counted in
w0^2), p is the coefficient of the follower forces (antisymmetric, that is
circulatory: it feeds energy into the modes).

              k = 3                         k = 4
    e         delta_1, 0, delta_2           delta_1, 0, 0, delta_2
    kappa_i   300 eta, 300                  300, 300 eta, 300            [s^-2]
    phi_i     1, 1                          1, 0.9, 1
    sigma_i   0.95, 0.75, 0.5;  1.5         0.95, 0.8, 0.65, 0.5;  1.5   [1/s]

The last sigma is that of the fast oscillator.

Inputs (independent, uniform), in standardized form xi in [-1, 1]:

    follower     p       = 350 (1 + xi)   s^-2     0 ... 700
    detuning_1   delta_1 = 0.05 xi                 -5 % ... +5 % (of stiffness)
    detuning_2   delta_2 = 0.05 xi                 -5 % ... +5 %
    coupling     eta     = 1 + 0.2 xi              0.8 ... 1.2

Why the modes coalesce.  To leading order the cluster is the matrix
i K_c / (2 w0) - diag(sigma), tridiagonal, and K_c enters its characteristic
polynomial only through the diagonal and through the products
q_i = kappa_i^2 - (phi_i p)^2.  With q_i > 0 neighbours repel each other in
frequency (veering), with q_i < 0 they attract and repel each other in real part
(flutter); where q_i is near 0 and the diagonals agree, everything meets.  Since
the sigma_i differ, two eigenvalues coalesce on surfaces of codimension two, three
at isolated points of the four-dimensional box.  At these the single eigenvalue
behaves like a square or cube root of the inputs.  The mean s of the k cluster
eigenvalues and the coefficients of prod_i (z - (lambda_i - s)) remain analytic
over the whole box.


The files
=========
    set,follower,detuning_1,detuning_2,coupling,re_1,im_1,...,re_n,im_n

    set = design        80 points of a Latin hypercube
    set = test          400 independent uniform points
    set = coalescence   five points at or next to coalescences, in this order:

        k = 3   modes 1 and 2 coalesce
                modes 2 and 3 coalesce
                modes 2 and 3 nearly so: 1e-6 |lambda| apart
                modes 1, 2 and 3 coalesce
                modes 1, 2 and 3 nearly so: the closest two 1e-5 |lambda| apart
        k = 4   modes 1 and 2 coalesce
                modes 2 and 3 nearly so: 1e-6 |lambda| apart
                modes 3 and 4 coalesce
                modes 1, 2 and 3 coalesce, mode 4 0.05 rad/s away
                all four nearly so (within about 0.05 rad/s; for them to coalesce
                would take six inputs)

    "coalesce" means as nearly as double-precision inputs can say it: two
    eigenvalues then lie about 1e-10 |lambda| apart, three about 5e-8 |lambda|.

The inputs are standardized (xi).  The eigenvalues are those with Im > 0 of the
2n x 2n state matrix, by ascending Im, so that the fast oscillator comes last.
They belong to exactly the double-precision inputs written and to the decimal
constants above, are computed with 40 digits and written with 17.
"""

import csv
import itertools
from pathlib import Path

import mpmath as mp
import numpy as np

mp.mp.dps = 40

INPUTS = ("follower", "detuning_1", "detuning_2", "coupling")
N_DESIGN = 80
N_TEST = 400
LENGTH = mp.mpf("0.1")  # rad/s, see newton()
AXIS_FINE = np.linspace(-1, 1, 81)
AXIS_COARSE = np.linspace(-1, 1, 17)


class System:
    """One chain of k oscillators with the fast oscillator at its end."""

    def __init__(self, k, seed, eta_on, phi, sigma):
        self.k = k
        self.n = k + 1
        self.seed = seed
        self.eta_on = eta_on  # index of the spring scaled by eta
        self.phi = phi
        self.sigma = sigma

    def stiffness_damping(self, xi, num):
        """K and the diagonal of C as lists; `num` makes numbers of decimals."""
        k, n = self.k, self.n
        x_p, x_1, x_2, x_eta = xi
        p = 350 * (1 + x_p)
        delta_1 = num("0.05") * x_1
        delta_2 = num("0.05") * x_2
        eta = 1 + num("0.2") * x_eta

        e = [delta_1] + [num("0")] * (k - 2) + [delta_2]
        stiff = [[num("0")] * n for _ in range(n)]
        for i in range(k):
            stiff[i][i] = 10000 * (1 + e[i])
        for i in range(k - 1):
            kappa = 300 * eta if i == self.eta_on else num("300")
            push = num(self.phi[i]) * p
            stiff[i][i + 1] = -kappa + push
            stiff[i + 1][i] = -kappa - push
        stiff[k][k] = 90000 * (1 + num("0.4") * delta_1 - num("0.2") * delta_2)
        stiff[k - 1][k] = stiff[k][k - 1] = num("-500")
        damp = [2 * num(s) for s in self.sigma]
        return stiff, damp

    def eigenvalues(self, xi):
        """Eigenvalues with Im > 0, by ascending Im, with mpmath's precision."""
        n = self.n
        stiff, damp = self.stiffness_damping([mp.mpf(x) for x in xi], mp.mpf)
        state = mp.zeros(2 * n)
        for i in range(n):
            state[i, n + i] = 1
            state[n + i, n + i] = -damp[i]
            for j in range(n):
                state[n + i, j] = -stiff[i][j]
        values = mp.eig(state, left=False, right=False)
        upper = sorted((v for v in values if v.imag > 0), key=lambda v: v.imag)
        if len(upper) != n:
            raise ValueError("a mode does not oscillate")
        return upper

    def eigenvalues_fast(self, points):
        """The same in double precision for many points (rows): only for the
        coarse searches below."""
        points = np.asarray(points, dtype=float)
        n = self.n
        stiff, damp = self.stiffness_damping(points.T, float)
        state = np.zeros((len(points), 2 * n, 2 * n))
        state[:, :n, n:] = np.eye(n)
        for i in range(n):
            state[:, n + i, n + i] = -damp[i]
            for j in range(n):
                state[:, n + i, j] = -stiff[i][j]
        values = np.linalg.eigvals(state)
        order = np.argsort(-values.imag, axis=1)[:, :n][:, ::-1]
        return np.take_along_axis(values, order, axis=1)


THREE = System(
    k=3,
    seed=20243,
    eta_on=0,
    phi=("1", "1"),
    sigma=("0.95", "0.75", "0.5", "1.5"),
)
FOUR = System(
    k=4,
    seed=20244,
    eta_on=1,
    phi=("1", "0.9", "1"),
    sigma=("0.95", "0.8", "0.65", "0.5", "1.5"),
)


# --- sample points -----------------------------------------------------------


def latin_hypercube(rng, count, dim):
    """One point in each of `count` equal layers of every input, at a random
    place in its layer, the layers paired at random."""
    columns = [
        (rng.permutation(count) + rng.random(count)) / count for _ in range(dim)
    ]
    return 2 * np.array(columns).T - 1


# --- coalescences ------------------------------------------------------------


def depressed(values):
    """Coefficients c_2, ..., c_m of prod (z - (lambda_i - mean)): all zero
    exactly where all m given eigenvalues coincide, and smooth there."""
    mean = mp.fsum(values) / len(values)
    poly = [mp.mpc(1)]
    for v in values:
        root = v - mean
        poly = [a - root * b for a, b in zip(poly + [0], [0] + poly)]
    return poly[2:]


def tightest(values, m):
    """The m of the given eigenvalues that are closest together."""

    def spread(group):
        return max(abs(a - b) for a, b in itertools.combinations(group, 2))

    return min(itertools.combinations(values, m), key=spread)


def newton(system, start, free, m):
    """Let the inputs `free` move so that m cluster eigenvalues coalesce: Newton's
    method with difference quotients on Re/Im of their depressed coefficients,
    2 (m - 1) real equations.  With fewer inputs than equations they are met in
    the sense of least squares (Gauss-Newton), c_j being weighed by LENGTH^-j.
    None if it leaves the box or does not converge."""

    def residual(xi):
        values = tightest(system.eigenvalues(xi)[: system.k], m)
        scaled = [c / LENGTH**j for j, c in enumerate(depressed(values), start=2)]
        return mp.matrix([f(c) for c in scaled for f in (mp.re, mp.im)])

    xi = [mp.mpf(float(x)) for x in start]
    step = mp.mpf(10) ** -12
    for _ in range(60):
        at = residual(xi)
        jacobian = mp.zeros(len(at), len(free))
        for col, j in enumerate(free):
            moved = list(xi)
            moved[j] += step
            jacobian[:, col] = (residual(moved) - at) / step
        try:
            change = mp.lu_solve(jacobian, -at)
        except ZeroDivisionError:
            return None
        size = mp.norm(change, mp.inf)
        damping = min(mp.mpf(1), mp.mpf("0.1") / size) if size else mp.mpf(1)
        for col, j in enumerate(free):
            xi[j] += damping * change[col]
        if any(abs(x) > 1 for x in xi):
            return None
        if size < mp.mpf(10) ** -18:
            return xi
    return None


def smallest_spread(system, m, axes, which=None):
    """Points of the grid with the given axes, by ascending spread (largest
    distance) of their tightest m cluster eigenvalues, or of those of ranks
    `which`."""
    grid = np.array(list(itertools.product(*axes)))
    values = system.eigenvalues_fast(grid)[:, : system.k]
    groups = [which] if which else list(itertools.combinations(range(system.k), m))
    spread = np.full(len(grid), np.inf)
    for group in groups:
        pairs = itertools.combinations(group, 2)
        widest = np.max([abs(values[:, a] - values[:, b]) for a, b in pairs], axis=0)
        spread = np.minimum(spread, widest)
    return grid[np.argsort(spread, kind="stable")]


def pair_coalescence(system, which, fixed):
    """Two eigenvalues, of ranks `which` by Im, coalescing: `fixed` holds two of
    the inputs, the other two are solved for."""
    free = [j for j in range(len(INPUTS)) if j not in fixed]
    axes = [[fixed[j]] if j in fixed else AXIS_FINE for j in range(len(INPUTS))]
    for start in smallest_spread(system, 2, axes, which)[:40]:
        xi = newton(system, start, free, 2)
        if xi is None:
            continue
        values = system.eigenvalues(xi)[: system.k]
        if tightest(values, 2) == tuple(values[i] for i in which):
            return [float(x) for x in xi]
    raise ValueError(f"no coalescence of {which} at {fixed}")


def multiple_coalescence(system, m, start=None):
    """m > 2 eigenvalues coalescing, or as nearly so as they can; all four inputs
    are solved for, from `start` or from the tightest grid points."""
    if start is None:
        starts = smallest_spread(system, m, [AXIS_COARSE] * len(INPUTS))[:200]
    else:
        starts = [start]
    for start in starts:
        xi = newton(system, start, range(len(INPUTS)), m)
        if xi is not None:
            return [float(x) for x in xi]
    raise ValueError(f"no coalescence of {m}")


def beside(system, xi, m, relative):
    """Move `follower` off a coalescence of m until the closest two eigenvalues
    are about `relative` * |lambda| apart (distances go as the m-th root)."""
    move = mp.mpf("1e-7")
    for _ in range(4):
        moved = [xi[0] + float(move)] + list(xi[1:])
        pair = tightest(system.eigenvalues(moved)[: system.k], 2)
        gap = abs(pair[0] - pair[1]) / abs(pair[0])
        move *= (relative / gap) ** m
    return [xi[0] + float(move)] + list(xi[1:])


def special_points(system):
    """The rows of the set `coalescence`, in the order given above."""
    if system.k == 3:
        low = pair_coalescence(system, (0, 1), {2: -0.4, 3: 0.5})
        high = pair_coalescence(system, (1, 2), {1: 0.3, 3: -0.5})
        triple = multiple_coalescence(system, 3)
        return [
            low,
            high,
            beside(system, high, 2, mp.mpf("1e-6")),
            triple,
            beside(system, triple, 3, mp.mpf("1e-5")),
        ]
    low = pair_coalescence(system, (0, 1), {2: -0.4, 3: 0.5})
    middle = pair_coalescence(system, (1, 2), {2: 0.25, 3: 0.0})
    high = pair_coalescence(system, (2, 3), {2: 0.5, 3: 0.5})
    # The fourth mode is only 0.05 rad/s away, so that Newton's method needs a
    # close start (from a search with many random ones).
    triple = multiple_coalescence(system, 3, [-0.14605, 0, 0.0064, -0.4892])
    return [
        low,
        beside(system, middle, 2, mp.mpf("1e-6")),
        high,
        triple,
        multiple_coalescence(system, 4),
    ]


# --- files -------------------------------------------------------------------


def write(system, path):
    rng = np.random.default_rng(system.seed)
    design = latin_hypercube(rng, N_DESIGN, len(INPUTS))
    test = rng.uniform(-1, 1, (N_TEST, len(INPUTS)))
    sets = {
        "design": design.tolist(),
        "test": test.tolist(),
        "coalescence": special_points(system),
    }
    parts = [f"{p}_{i + 1}" for i in range(system.n) for p in ("re", "im")]
    with open(path, "w", newline="") as handle:
        out = csv.writer(handle, lineterminator="\n")
        out.writerow(["set", *INPUTS, *parts])
        for name, points in sets.items():
            for xi in points:
                values = system.eigenvalues(xi)
                numbers = [f for v in values for f in (v.real, v.imag)]
                out.writerow(
                    [name]
                    + [f"{x:.17g}" for x in xi]
                    + [mp.nstr(f, 17, strip_zeros=False) for f in numbers]
                )


def main():
    folder = Path(__file__).resolve().parent
    write(THREE, folder / "three_modes.csv")
    write(FOUR, folder / "four_modes.csv")


if __name__ == "__main__":
    main()
