#!/usr/bin/env python3
"""Shares of the undamped and conservative systems: flutter, divergence, marginal.

What it does
============
For the eight studies that `make_conservative.py` writes it draws random points of the
inputs (uniform), tells at each point what the system does, and counts.  It writes
`shares.csv` into the folder of this file:

    name                    the study
    flutter, divergence     per cent of points where the eigenvalue of the largest real
                            part (above zero) is one of a complex pair, or real
    marginal                per cent of points where all eigenvalues are imaginary
    stable                  per cent of points where all are left of the imaginary axis:
                            none, for systems like these
    doubtful                per cent of points that exact arithmetic could not decide
    points                  how many were drawn
    resolved                how many of them double precision could not decide and exact
                            arithmetic did
    checked                 how many further points were decided by exact arithmetic as
                            well, all alike

The script does not read the studies; its matrices are written a second time, by hand.

How a point is decided
======================
The eigenvalues lambda of such systems come as +-lambda: the characteristic polynomial
is one in mu = lambda^2, with real coefficients.  A point is marginal if all mu are
negative, it diverges by a positive mu, and flutters by complex ones.

* chains: M^(-1/2) K M^(-1/2) is symmetric, so all mu are real by construction, and the
  point is marginal if the smallest stiffness is above 1e-9 of the largest.
* friction: mu are the eigenvalues of -M^-1 K.  A complex pair counts as complex, and
  a real pair as real, if its distance exceeds 1e-6 of the largest |mu|: rounding splits
  or joins a pair at about 1e-8.  friction-2 and spin-2 have no eigenvalues computed:
  mu solves a quadratic, and signs of its discriminant and coefficients are looked at;
  they are doubtful within 1e-12 of zero.
* spinning: lambda from the state matrix.  Marginal if the largest real part is below
  1e-9 of the largest |lambda|, unstable above 1e-6 of it, doubtful between.
* The larger real part says flutter or divergence; the point is doubtful if a real and a
  complex one are within 1e-9 of each other.

Doubtful points go to exact arithmetic: the polynomial in mu from the inputs as
rational numbers (determinants at integers, interpolation), a Sturm chain, numbers of
negative, positive and complex roots without any rounding.  If there are positive and
complex ones, mpmath finds them with 60 digits.  What would stay doubtful: a double root,
or a root of zero.

How to run it
=============
    python3 shares.py                    all; 15 minutes on one core
    python3 shares.py spin-2 chain-5     these alone; prints, and writes nothing
    python3 shares.py --points 20000     a quick look; prints, and writes nothing

It needs NumPy and mpmath.  The standard error of a share is at most 0.05 per cent.
"""

import os
import sys
import time
from fractions import Fraction
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import mpmath
import numpy as np

HERE = Path(__file__).resolve().parent
POINTS = 1_000_000
CHUNK = 20_000
MARGINAL, FLUTTER, DIVERGENCE, DOUBTFUL = range(4)


# ---------------------------------------------------------------- matrices
# Each answers M (a diagonal), S of C = W S, or None, and K, as lists: of arrays over points, or of Fractions.


def zeros(n):
    return [[0] * n for _ in range(n)]


def chain_2(m, k):
    return [1, m], None, [[k + 8000, -8000], [-8000, 8000]]


def chain_5(k, m, s):
    springs = [k, 10 * s, 10_000, 100_000, 1_000_000]
    K = zeros(5)
    for i, spring in enumerate(springs):
        K[i][i] += spring
        if i:
            K[i - 1][i - 1] += spring
            K[i - 1][i] -= spring
            K[i][i - 1] -= spring
    return [m, 1, 1, 1, 1], None, K


def chain_16(k, k_c, d):
    K = zeros(16)
    for i in range(16):
        K[i][i] = k + 2 * k_c
        if i:
            K[i][i - 1] = K[i - 1][i] = -k_c
    return [1] * 7 + [1 + d] + [1] * 8, None, K


def spin_2(W, a, p):
    square = W * W
    K = [[10_000 * (1 + a) - p - square, 0], [0, 10_000 * (1 - a) - p - square]]
    return [1, 1], [[0, -2], [2, 0]], K


def spin(mass, W, a, k):
    n = len(mass)
    K, S = zeros(2 * n), zeros(2 * n)
    for plane, first in ((1, 0), (-1, n)):
        for span in range(n + 1):
            stiffness = k * (1 + plane * a) if span == 0 else k
            left, right = first + span - 1, first + span
            if span > 0:
                K[left][left] = K[left][left] + stiffness
            if span < n:
                K[right][right] = K[right][right] + stiffness
            if 0 < span < n:
                K[left][right] = K[right][left] = -stiffness
        for i in range(n):
            K[first + i][first + i] = K[first + i][first + i] - mass[i] * W * W
    for i in range(n):
        S[i][n + i], S[n + i][i] = -2 * mass[i], 2 * mass[i]
    return mass * 2, S, K


def spin_6(W, a, k):
    return spin([Fraction(1), Fraction(5, 4), Fraction(3, 4)], W, a, k)


def spin_16(W, a, k):
    return spin([Fraction(1)] * 8, W, a, k)


def friction_2(mu, k_n):
    return [1, 1], None, [[10_000, 1500 - mu * k_n], [1500, 4000 + k_n]]


def friction_4(mu, k_n, p):
    f = mu * k_n
    K = [
        [12_000, 2000 - f, 0, f],
        [2000, 5000 + k_n, 0, -k_n],
        [0, f, 15_000 - p, -3000 - f],
        [0, -k_n, -3000, 8000 + k_n],
    ]
    return [1, 1, 2, 2], None, K


# ---------------------------------------------------------------- double precision


def stack(entries, points):
    """A stack of matrices, or of diagonals, from nested lists of numbers and arrays."""
    if not isinstance(entries[0], list):
        return np.stack([np.broadcast_to(np.asarray(value, dtype=float), points) for value in entries], axis=-1)
    return np.stack([stack(row, points) for row in entries], axis=-2)


def floating(system, columns):
    if system in (spin_6, spin_16):
        mass = [1.0, 1.25, 0.75] if system is spin_6 else [1.0] * 8
        M, S, K = spin(mass, *columns)
    else:
        M, S, K = system(*columns)
    points = columns[0].shape
    return stack(M, points), None if S is None else stack(S, points), stack(K, points)


def chains(system, columns):
    M, _, K = floating(system, columns)
    root = np.sqrt(M)
    squares = np.linalg.eigvalsh(K / root[..., :, None] / root[..., None, :])
    return np.where(squares[:, 0] > 1e-9 * squares[:, -1], MARGINAL, DOUBTFUL)


def quadratics(system, columns):
    """mu^2 + b mu + c = 0."""
    M, S, K = floating(system, columns)
    speed = columns[0]
    assert (M == 1).all()
    diagonal = K[:, 0, 0] + K[:, 1, 1]
    products = K[:, 0, 0] * K[:, 1, 1], K[:, 0, 1] * K[:, 1, 0]
    b = diagonal + (0 if S is None else 4 * speed**2)
    c = products[0] - products[1]
    if S is None:  # (K_00 + K_11)^2 - 4 c, without cancellation
        discriminant = (K[:, 0, 0] - K[:, 1, 1]) ** 2 + 4 * products[1]
    else:
        discriminant = b**2 - 4 * c
    # above all terms of the sums
    scale = np.abs(K[:, 0, 0]) + np.abs(K[:, 1, 1]) + np.sqrt(np.abs(products[1])) + (0 if S is None else 4 * speed**2)
    kind = np.where(discriminant < 0, FLUTTER, np.where((c > 0) & (b > 0), MARGINAL, DIVERGENCE))
    doubt = np.minimum.reduce([np.abs(discriminant) / scale**2, np.abs(c) / scale**2])
    # the sign of b matters only where both roots are real and of the same sign
    doubt = np.where((discriminant > 0) & (c > 0), np.minimum(doubt, np.abs(b) / scale), doubt)
    return np.where(doubt < 1e-12, DOUBTFUL, kind)


def leading(real_growth, complex_growth, scale):
    """By the larger growth (-inf where there is none)."""
    kind = np.where(np.isinf(real_growth) & np.isinf(complex_growth), MARGINAL, DIVERGENCE)
    kind = np.where(complex_growth > real_growth, FLUTTER, kind)
    both = np.isfinite(real_growth) & np.isfinite(complex_growth)
    with np.errstate(invalid="ignore"):
        return np.where(both & (np.abs(real_growth - complex_growth) < 1e-9 * scale), DOUBTFUL, kind)


def frictions(system, columns):
    M, _, K = floating(system, columns)
    mu = np.linalg.eigvals(-K / M[..., None]).astype(complex)
    scale = np.abs(mu).max(axis=-1)
    growth = np.abs(np.sqrt(mu).real)
    kind = leading(
        np.where((mu.imag == 0) & (mu.real > 0), growth, -np.inf).max(axis=-1),
        np.where(mu.imag != 0, growth, -np.inf).max(axis=-1),
        np.sqrt(scale),
    )
    distance = np.abs(mu[..., :, None] - mu[..., None, :]) + np.diag([np.inf] * mu.shape[-1])
    close = (distance.min(axis=(-1, -2)) < 1e-6 * scale) | (np.abs(mu).min(axis=-1) < 1e-9 * scale)
    return np.where(close, DOUBTFUL, kind)


def spins(system, columns):
    M, S, K = floating(system, columns)
    n = M.shape[-1]
    A = np.zeros(columns[0].shape + (2 * n, 2 * n))
    A[..., :n, n:] = np.eye(n)
    A[..., n:, :n] = -K / M[..., None]
    A[..., n:, n:] = -columns[0][:, None, None] * S / M[..., None]
    values = np.linalg.eigvals(A).astype(complex)
    scale = np.abs(values).max(axis=-1)[:, None]
    grows = values.real > 1e-6 * scale
    doubt = ((values.real > 1e-9 * scale) & ~grows).any(axis=-1)
    # a pair that might be two real ones, or the reverse
    doubt |= (grows & (values.imag != 0) & (np.abs(values.imag) < 1e-6 * scale)).any(axis=-1)
    real = np.sort(np.where(grows & (values.imag == 0), values.real, -np.inf), axis=-1)
    with np.errstate(invalid="ignore"):
        doubt |= (np.diff(real, axis=-1) < 1e-6 * scale).any(axis=-1)
    kind = leading(real[:, -1], np.where(grows & (values.imag != 0), values.real, -np.inf).max(axis=-1), scale[:, 0])
    return np.where(doubt, DOUBTFUL, kind)


# ---------------------------------------------------------------- exact arithmetic


def determinant(A):
    """Of integers, without fractions (Bareiss)."""
    A = [row[:] for row in A]
    n, sign, last = len(A), 1, 1
    for k in range(n - 1):
        pivot = next((i for i in range(k, n) if A[i][k]), None)
        if pivot is None:
            return 0
        if pivot != k:
            A[k], A[pivot], sign = A[pivot], A[k], -sign
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                A[i][j] = (A[i][j] * A[k][k] - A[i][k] * A[k][j]) // last
        last = A[k][k]
    return sign * A[-1][-1]


def polynomial(M, C, K):
    """Coefficients of det(lambda^2 M + lambda C + K) in mu = lambda^2, from the constant on, up to a factor."""
    n = len(M)
    scale = 1
    for value in [*M, *(value for A in (C, K) for row in A for value in row)]:
        scale = max(scale, Fraction(value).denominator)  # all are powers of two
    nodes, values = [], []
    for x in range(n + 1):
        rows = [[scale * (x * C[i][j] + K[i][j] + (x * x * M[i] if i == j else 0)) for j in range(n)] for i in range(n)]
        assert all(Fraction(value).denominator == 1 for row in rows for value in row)
        nodes.append(Fraction(x * x))
        values.append(Fraction(determinant([[int(value) for value in row] for row in rows])))
    for step in range(1, n + 1):  # divided differences
        for i in range(n, step - 1, -1):
            values[i] = (values[i] - values[i - 1]) / (nodes[i] - nodes[i - step])
    answer = [Fraction(0)]
    for node, value in zip(reversed(nodes), reversed(values)):
        answer = [Fraction(0)] + answer
        for i in range(len(answer) - 1):
            answer[i] -= node * answer[i + 1]
        answer[0] += value
    return primitive(answer[: n + 1])


def primitive(p):
    """Integers without a common factor, of the same signs."""
    while p and p[-1] == 0:
        p = p[:-1]
    if not p:
        return p
    bottom = np.lcm.reduce(np.array([Fraction(value).denominator for value in p], dtype=object))
    p = [int(value * bottom) for value in p]
    common = np.gcd.reduce(np.array(p, dtype=object))
    return [value // abs(common) for value in p]


def remainder(p, q):
    """A positive multiple of the remainder of p by q."""
    p, factor = list(p), abs(q[-1])
    while len(p) >= len(q):
        lead, shift = p[-1], len(p) - len(q)
        p = [value * factor for value in p]
        quotient = lead * (1 if q[-1] > 0 else -1)
        for i, value in enumerate(q):
            p[shift + i] -= quotient * value
        assert p[-1] == 0
        p.pop()
    return primitive(p)


def changes(signs):
    signs = [sign for sign in signs if sign]
    return sum(a != b for a, b in zip(signs, signs[1:]))


def exactly(system, point):
    """The kind of a point, from its inputs as rational numbers."""
    inputs = [Fraction(float(value)) for value in point]
    M, S, K = system(*inputs)
    n = len(M)
    C = zeros(n) if S is None else [[inputs[0] * value for value in row] for row in S]
    if S is None:  # det(mu M + K): the same nodes serve
        C = zeros(n)
    p = polynomial(M, C, K)
    assert len(p) == n + 1
    chain = [p, primitive([i * value for i, value in enumerate(p)][1:])]
    while True:
        rest = remainder(chain[-2], chain[-1])
        if not rest:
            break
        chain.append([-value for value in rest])
    if p[0] == 0 or len(chain[-1]) > 1:
        return DOUBTFUL  # a root of zero, or a double one

    def sign(value):
        return (value > 0) - (value < 0)

    minus = changes([sign(q[-1]) * (-1) ** (len(q) - 1) for q in chain])
    zero = changes([sign(q[0]) for q in chain])
    plus = changes([sign(q[-1]) for q in chain])
    negative, positive = minus - zero, zero - plus
    pairs = n - negative - positive
    if pairs == 0:
        return MARGINAL if positive == 0 else DIVERGENCE
    if positive == 0:
        return FLUTTER
    with mpmath.workdps(60):
        roots = mpmath.polyroots([mpmath.mpf(value) for value in reversed(p)], maxsteps=500, extraprec=400)
        grows = [(abs(mpmath.sqrt(root).real), abs(root.imag) > mpmath.mpf("1e-40") * abs(root)) for root in roots]
        real = max(growth for growth, pair in grows if not pair)
        pair = max(growth for growth, pair in grows if pair)
        if abs(real - pair) < mpmath.mpf("1e-30") * real:
            return DOUBTFUL
        return FLUTTER if pair > real else DIVERGENCE


# ---------------------------------------------------------------- counting

SYSTEMS = {  # name: system, how, inputs, further points for exact arithmetic
    "chain-2": (chain_2, chains, [(0.5, 2), (9e3, 1.1e4)], 2000),
    "chain-5": (chain_5, chains, [(50, 150), (0.5, 2), (80, 120)], 1000),
    "chain-16": (chain_16, chains, [(9.5e3, 1.05e4), (20, 60), (-0.002, 0.002)], 100),
    "spin-2": (spin_2, quadratics, [(50, 150), (0.05, 0.3), (0, 1.6e4)], 2000),
    "spin-6": (spin_6, spins, [(60, 140), (0.1, 0.5), (9.5e3, 1.05e4)], 1000),
    "spin-16": (spin_16, spins, [(20, 75), (0.1, 0.5), (9.5e3, 1.05e4)], 300),
    "friction-2": (friction_2, quadratics, [(0, 1), (4e3, 8e3)], 2000),
    "friction-4": (friction_4, frictions, [(0, 0.8), (4e3, 1.2e4), (0, 1.6e4)], 2000),
}


def sample(name, part, number):
    low, high = np.array(SYSTEMS[name][2], dtype=float).T
    generator = np.random.default_rng([int.from_bytes(name.encode(), "little"), part])
    return low + (high - low) * generator.random((number, len(low)))


def count(name, total):
    system, decide, _, further = SYSTEMS[name]
    counts, resolved, checked = np.zeros(4, dtype=int), 0, 0
    for part, done in enumerate(range(0, total, CHUNK)):
        points = sample(name, part, min(CHUNK, total - done))
        kinds = decide(system, list(points.T))
        again = list(np.flatnonzero(kinds == DOUBTFUL))
        resolved += len(again)
        for i in again:
            kinds[i] = exactly(system, points[i])
        if part == 0:
            for i in range(min(further, len(points))):
                assert exactly(system, points[i]) == kinds[i], (name, points[i], kinds[i])
                checked += 1
        counts += np.bincount(kinds, minlength=4)
    return counts, resolved, checked


def main():
    arguments = sys.argv[1:]
    total = POINTS
    if "--points" in arguments:
        at = arguments.index("--points")
        total = int(arguments[at + 1])
        del arguments[at : at + 2]
    lines = ["name,flutter,divergence,marginal,stable,doubtful,points,resolved,checked"]
    print(lines[0])
    for name in arguments or SYSTEMS:
        start = time.time()
        counts, resolved, checked = count(name, total)
        share = [f"{100 * counts[kind] / total:.4f}" for kind in (FLUTTER, DIVERGENCE, MARGINAL)]
        doubtful = f"{100 * counts[DOUBTFUL] / total:.4f}"
        lines.append(",".join([name, *share, "0.0000", doubtful, str(total), str(resolved), str(checked)]))
        print(lines[-1], f"   # {time.time() - start:.0f} s", flush=True)
    if total == POINTS and not arguments:
        (HERE / "shares.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
