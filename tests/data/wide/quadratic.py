"""Eigenvalues of (lambda^2 M + lambda C + K) x = 0 to any number of digits.

For symmetric sparse M, C, K with M and K positive definite; C may be anything
symmetric.  Entries are exact: integers, fractions and doubles are taken as they
are.  All arithmetic is mpmath's, with `mpmath.mp.dps` digits.

    read(path)                 the lower triangle of a Matrix Market file, exactly
    combine((f, A), ...)       sum of f A, exactly
    negative(A)                how many eigenvalues a symmetric A has below zero
    squares(K, M, count)       the lowest eigenvalues of K x = mu M x, roughly, as brackets
    refine(M, C, K, start)     an eigenvalue near `start`, its vector, its last step
    inside(M, C, K, radius)    how many eigenvalues there are with |lambda| < radius

A matrix is a pair: its size and {(row, column): entry} with row >= column, from 0.
The elimination has no pivoting; it takes the rows in turn, but those named in `LAST`
after all others.  With a hundred digits, pivots would have to be small by 1e-60 to
matter.
"""

from fractions import Fraction

import mpmath
from mpmath import mp, mpf

LAST = ()  # rows that couple what is far apart


def read(path):
    with open(path) as file:
        kind = file.readline().split()
        assert kind[1:] == ["matrix", "coordinate", "real", "symmetric"], kind
        lines = [line.split() for line in file if not line.startswith("%")]
    size = int(lines[0][0])
    entries = {(int(row) - 1, int(column) - 1): Fraction(float(value)) for row, column, value in lines[1:]}
    assert len(entries) == int(lines[0][2]) and all(row >= column for row, column in entries)
    return size, entries


def combine(*terms):
    """The sum of factor times matrix; factors and entries are exact (Fraction)."""
    size = terms[0][1][0]
    entries = {}
    for factor, (other, matrix) in terms:
        assert other == size
        for key, value in matrix.items():
            entries[key] = entries.get(key, 0) + Fraction(factor) * value
    return size, {key: value for key, value in entries.items() if value}


def number(exact):
    return mpf(exact.numerator) / exact.denominator


def floating(matrix):
    size, entries = matrix
    return size, {key: number(value) for key, value in entries.items()}


def times(matrix, x):
    size, entries = matrix
    y = [mpf(0)] * size
    for (i, j), value in entries.items():
        y[i] += value * x[j]
        if i != j:
            y[j] += value * x[i]
    return y


def dot(x, y):
    """Without conjugation."""
    return mpmath.fsum(a * b for a, b in zip(x, y))


def factor(matrix):
    """Pivots and rows of the elimination L D L^T, in the order in which it was done."""
    size, entries = matrix
    order = [i for i in range(size) if i not in LAST] + list(LAST)
    place = {row: at for at, row in enumerate(order)}
    rows = [{} for _ in range(size)]
    for (i, j), value in entries.items():
        a, b = sorted((place[i], place[j]))
        rows[a][b] = value
    pivots = []
    for i in range(size):
        row = rows[i]
        pivot = row.pop(i)
        if pivot == 0:  # an eigenvalue to the last digit: the vector is then right as well
            pivot = mpf(10) ** -mp.dps * abs(entries[order[i], order[i]])
        pivots.append(pivot)
        columns = sorted(row)
        for at, j in enumerate(columns):
            f = row[j] / pivot
            target = rows[j]
            for k in columns[at:]:
                target[k] = target.get(k, 0) - f * row[k]
    return order, pivots, rows


def solve(factored, b):
    order, pivots, rows = factored
    x = [b[row] for row in order]
    for i, row in enumerate(rows):
        f = x[i] / pivots[i]
        for j, value in row.items():
            x[j] -= value * f
    for i in range(len(rows) - 1, -1, -1):
        x[i] = (x[i] - mpmath.fsum(value * x[j] for j, value in rows[i].items())) / pivots[i]
    answer = [None] * len(x)
    for at, row in enumerate(order):
        answer[row] = x[at]
    return answer


def polynomial(M, C, K, z):
    """z^2 M + z C + K, of floating matrices."""
    size = M[0]
    entries = {}
    for f, (_, matrix) in ((z * z, M), (z, C), (mpf(1), K)):
        for key, value in matrix.items():
            entries[key] = entries.get(key, 0) + f * value
    return size, entries


def negative(matrix):
    return sum(1 for pivot in factor(matrix)[1] if pivot < 0)


def below(K, M, shift):
    """How many mu of K x = mu M x are below the shift (Sylvester)."""
    size = K[0]
    entries = dict(K[1])
    for key, value in M[1].items():
        entries[key] = entries.get(key, 0) - shift * value
    return negative((size, entries))


def squares(K, M, count, least, most):
    """Brackets of the lowest `count` eigenvalues mu between `least` and `most`, apart from one another.

    Halves in the logarithm until each bracket has one eigenvalue and is narrow.
    """
    found = []
    stack = [(mpf(least), below(K, M, mpf(least)), mpf(most), below(K, M, mpf(most)))]
    while stack and len(found) < count:
        low, n_low, high, n_high = stack.pop()
        if n_low == n_high or n_low >= count:
            continue
        if n_high - n_low == 1 and high / low < mpf("1.001"):
            found.append((low, high))
            continue
        assert high / low > 1 + mpf("1e-12"), "a double eigenvalue"
        middle = mpmath.sqrt(low * high)
        n_middle = below(K, M, middle)
        stack.append((middle, n_middle, high, n_high))
        stack.append((low, n_low, middle, n_middle))
    return found


def refine(M, C, K, start, steps=12, until=None):
    """Inverse iteration, three times with a fixed shift and then with a Rayleigh quotient: the eigenvalue near `start`."""
    size = M[0]
    until = until or mpf(10) ** (-(2 * mp.dps) // 3)
    x = [mpf(1) + mpf((i * 7) % 11) / 13 for i in range(size)]
    z = mpmath.mpc(start)
    fixed = factor(polynomial(M, C, K, z))
    for step in range(steps):
        y = solve(fixed if step < 3 else factor(polynomial(M, C, K, z)), times(M, x))
        largest = max(abs(value) for value in y)
        y = [value / largest for value in y]
        if step < 2:
            x = y
            continue
        a, b, c = (dot(y, times(A, y)) for A in (M, C, K))
        root = mpmath.sqrt(b * b - 4 * a * c)
        new = min(((-b + root) / (2 * a), (-b - root) / (2 * a)), key=lambda value: abs(value - z))
        step, z, x = abs(new - z), new, y
        if step < until * abs(z):
            break
    else:
        raise ArithmeticError(f"no convergence near {start}")
    return z, x, step / abs(z)


def residual(M, C, K, z, x):
    """|(z^2 M + z C + K) x| over |z^2 M x| + |z C x| + |K x|, largest entries."""
    parts = [[z * z * v for v in times(M, x)], [z * v for v in times(C, x)], times(K, x)]
    whole = max(abs(a + b + c) for a, b, c in zip(*parts))
    return whole / sum(max(abs(v) for v in part) for part in parts)


def inside(M, C, K, radius, points=512):
    """How often the determinant turns while z runs once around the circle: half of it, by symmetry.

    Also the largest turn from one point to the next, which must stay well below pi.
    """
    total, largest, last = mpf(0), mpf(0), None
    for i in range(points + 1):
        z = radius * mpmath.expjpi(mpf(i) / points)
        turn = mpmath.fsum(mpmath.arg(pivot) for pivot in factor(polynomial(M, C, K, z))[1])
        if last is not None:
            change = turn - last
            change -= 2 * mpmath.pi * mpmath.nint(change / (2 * mpmath.pi))
            total += change
            largest = max(largest, abs(change))
        last = turn
    return total / mpmath.pi, largest
