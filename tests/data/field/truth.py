#!/usr/bin/env python3
"""How often the systems of this folder are stable: reference shares.

What it does
============
For every study (`*.toml`) of this folder it draws random points of the inputs (uniform),
computes all eigenvalues at each point and counts.  It writes `truth.csv` into
the folder of this file:

    name        the study
    points      how many points were drawn
    stable      share of points where no eigenvalue has a real part above zero
    flutter     share of points that are unstable, and the eigenvalue of the
                largest real part is one of a complex pair
    divergence  share of points that are unstable, and that eigenvalue is real
    least_real  smallest number of real eigenvalues at any of the points
    most_real   largest number of real eigenvalues at any of the points

The script does not read the studies.  Its matrices are written a second time,
by hand, so that both can be compared.  If you change a study, change it here.

How to run it
=============
    python3 truth.py                 all systems; two to three minutes on two cores
    python3 truth.py cap bike        these alone; prints, and writes nothing
    python3 truth.py --points 20000  a quick look; prints, and writes nothing

What it needs
=============
Python 3.10 and NumPy (2.4 was used).  Nothing else.

How good it is
==============
Each share has a standard error of at most 0.5 / sqrt(points): 0.00035 for two
million points.  The random numbers are seeded, so the
same NumPy on the same machine gives the same table.  The numbers of real
eigenvalues are those seen: a corner of the box that no point hit may have
others.  For this reason the script also looks at all corners of the box.

The rigid body
==============
`driveline` can turn freely, so its matrices M, C, K have one eigenvalue of zero
at every point.  It says nothing about stability and is left out here.  The
script does so exactly: its state has the twists of the shafts in the place of
the angles, 7 states for 8 eigenvalues.  To drop the smallest of 8 computed
eigenvalues is not good enough: where the partner of the zero is small as well,
rounding makes a complex pair of the two.

Known in closed form
====================
cap 0.5.  overdamped: stable while P < 995, so 995 / 1040 = 0.956731.  rayleigh
0.625.  count: 0.5 for mode 1 alone, and the same for both modes, since mode 2 is
always stable; mode 1 alone has no real eigenvalue.  bike: stable from 4.29238253634 to 6.02426201539 m/s,
so 0.346376 of 3 to 8 m/s; for 0.3 to 8 m/s divide by 7.7 instead of 5: 0.224919.
"""

import itertools
import os
import sys
import time

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")  # the matrices are small; one process per core instead

from concurrent.futures import ProcessPoolExecutor

import numpy as np

CHUNK = 20_000


# ---------------------------------------------------------------- matrices


def rows(entries):
    """A stack of matrices from rows of numbers and of arrays over the points."""
    entries = [[np.asarray(entry, dtype=float) for entry in row] for row in entries]
    points = np.broadcast_shapes(*(entry.shape for row in entries for entry in row))
    answer = np.zeros(points + (len(entries), len(entries[0])))
    for i, row in enumerate(entries):
        for j, entry in enumerate(row):
            answer[..., i, j] = entry
    return answer


def diagonal(entries):
    n = len(entries)
    return rows([[entries[i] if i == j else 0.0 for j in range(n)] for i in range(n)])


def times(factor, matrix):
    return np.asarray(factor, dtype=float)[..., None, None] * matrix


def second_order(M, C, K):
    """The state matrix of M u'' + C u' + K u = 0, with the state (u, u')."""
    points = np.broadcast_shapes(M.shape[:-2], C.shape[:-2], K.shape[:-2])
    n = M.shape[-1]
    A = np.zeros(points + (2 * n, 2 * n))
    A[..., :n, n:] = np.eye(n)
    A[..., n:, :n] = -np.linalg.solve(M, np.broadcast_to(K, points + (n, n)))
    A[..., n:, n:] = -np.linalg.solve(M, np.broadcast_to(C, points + (n, n)))
    return A


# ---------------------------------------------------------------- the systems


def cap(p):
    return second_order(diagonal([1, 1]), diagonal([0.2, 30]), diagonal([100, 50 - p]))


def overdamped(P, c):
    return second_order(diagonal([1, 1]), diagonal([c, 1]), rows([[1000 - P, -100], [-100, 2000]]))


def bike(v):
    """M q'' + v C1 q' + (g K0 + v^2 K2) q = 0; q = (lean, steer)."""
    g = 9.81
    M = rows([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
    C1 = rows([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
    K0 = rows([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
    K2 = rows([[0, 76.59734589573222], [0, 2.65431523794604]])
    return second_order(M, times(v, C1), g * K0 + times(v**2, K2))


def count(beta, g):
    return second_order(diagonal([1, 1]), diagonal([100 * beta - g, 1e6 * beta]), diagonal([100, 1e6]))


def rayleigh(beta, g, kappa):
    squares = [100.0 * i**4 for i in range(1, 9)]  # 100, 1600, ..., 409600
    C = diagonal([beta * square - (g if i == 0 else 0) for i, square in enumerate(squares)])
    return second_order(diagonal([1] * 8), C, diagonal([kappa * square for square in squares]))


def axi(omega, k, c, c_i):
    h, r = 0.001 * k, c_i * omega
    gyro = 0.08 * omega
    C = rows([[c, 0, 0, 0], [0, c, 0, 0], [0, 0, 1, gyro], [0, 0, -gyro, 1]])
    K = rows([[k, r, 0, -h], [-r, k, h, 0], [0, h, 1.2e4, 0], [-h, 0, 0, 1.2e4]])
    return second_order(diagonal([10, 10, 0.05, 0.05]), C, K)


def beam(beta, g, kappa):
    """Ten equal masses on a simply supported beam: the square of the string's matrix."""
    string = 2 * np.eye(10) - np.eye(10, k=1) - np.eye(10, k=-1)
    K = times(kappa, string @ string)
    C = times(beta, K)
    C[..., 3, 3] -= g
    return second_order(np.eye(10), C, K)


def wing(airspeed, sigma, x):
    """A typical section with Jones's two lags; time in units of 1 / omega_alpha.

    State: plunge / half chord (down), pitch (nose up), their rates, the two lags.
    """
    mass, r2, a = 20.0, 0.25, -0.2  # mass ratio, radius of gyration squared, elastic axis
    lags = [(0.165, 0.0455), (0.335, 0.3)]  # Wagner: 1 - 0.165 exp(-0.0455 s) - 0.335 exp(-0.3 s)
    V = airspeed / (0.5 * 40.0)  # half chord 0.5 m, pitch frequency 40 rad/s
    arm = 0.5 - a
    zero = np.zeros_like(V)
    M = rows([[1 + 1 / mass, x - a / mass], [x - a / mass, r2 + (a**2 + 0.125) / mass]])
    # downwash at three quarters of the chord, over the state
    downwash = [zero, V, zero + 1, zero + arm, zero, zero]
    # effective downwash: half at once, the rest by way of the lags
    effective = [0.5 * w for w in downwash]
    effective[4] = lags[0][0] * lags[0][1] * V
    effective[5] = lags[1][0] * lags[1][1] * V
    plunge = [-2 * V / mass * w for w in effective]
    pitch = [2 * V / mass * (0.5 + a) * w for w in effective]
    plunge[0] = plunge[0] - sigma**2
    plunge[3] = plunge[3] - V / mass
    pitch[1] = pitch[1] - r2
    pitch[3] = pitch[3] - V * arm / mass
    A = np.zeros(V.shape + (6, 6))
    A[..., 0, 2] = 1
    A[..., 1, 3] = 1
    A[..., 2:4, :] = np.linalg.solve(M, rows([plunge, pitch]))
    for row, (_, rate) in zip((4, 5), lags):
        A[..., row, :] = np.stack(downwash, axis=-1)
        A[..., row, row] -= rate * V
    return A


def driveline(g, d, k):
    """Four inertias on three shafts; drag at the first, friction falling with speed at the last.

    State: the twists of the three shafts, the speeds of the four inertias.
    """
    inertia = np.array([1.5, 0.1, 0.2, 0.4])
    twist = np.array([[-1.0, 1, 0, 0], [0, -1, 1, 0], [0, 0, -1, 1]])  # twists from angles
    A = np.zeros(k.shape + (7, 7))
    A[..., :3, 3:] = twist
    A[..., 3:, :3] = times(-k, twist.T) / inertia[:, None]
    A[..., 3:, 3:] = -0.4 * (twist.T @ twist) / inertia[:, None]
    A[..., 3, 3] -= d / inertia[0]
    A[..., 6, 6] += g / inertia[3]
    return A


def blades(d_1, d_2, d_3, a, c):
    """Three blades in a ring; the air makes each feel the one before and the one behind."""
    stiffness = [1e4 * (1 + d_1), 1e4 * (1 + d_2), 1e4 * (1 + d_3)]
    disc = 15.0 * rows([[2, -1, -1], [-1, 2, -1], [-1, -1, 2]])
    air = rows([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])
    late = 0.003  # s; the force of a neighbour comes so much later: a (u - late u')
    C = times(c, np.eye(3)) - times(a * late, air)
    return second_order(np.eye(3), C, diagonal(stiffness) + disc + times(a, air))


def bearings(m, c, k, k_c):
    """A rigid rotor on film bearings, its middle in x and y."""
    return second_order(diagonal([m, m]), diagonal([c, c]), rows([[k, k_c], [-k_c, 1.4 * k]]))


SYSTEMS = {  # name: state matrices, inputs in their order, points
    "cap": (cap, [(40, 60)], 2_000_000),
    "overdamped": (overdamped, [(0, 1040), (150, 250)], 2_000_000),
    "bike": (bike, [(3, 8)], 2_000_000),
    "bike-from-standstill": (bike, [(0.3, 8)], 2_000_000),
    "count": (count, [(0.001, 0.003), (0, 0.4)], 2_000_000),
    "rayleigh": (rayleigh, [(0.001, 0.004), (0, 0.4), (0.95, 1.05)], 2_000_000),
    "axi": (axi, [(0, 800), (0.95e6, 1.05e6), (60, 120), (20, 60)], 2_000_000),
    "beam": (beam, [(0.0055, 0.0085), (0.0, 6.0), (0.95e4, 1.05e4)], 2_000_000),
    "wing": (wing, [(10, 70), (0.3, 0.7), (-0.1, 0.2)], 2_000_000),
    "driveline": (driveline, [(0.0, 0.5), (0.1, 0.4), (900, 1100)], 2_000_000),
    "blades": (blades, [(-0.01, 0.01)] * 3 + [(10, 100), (0.2, 1.2)], 2_000_000),
    "bearings": (bearings, [(8, 12), (500, 5000), (2e4, 2e5), (2e4, 2e5)], 2_000_000),
}


# ---------------------------------------------------------------- counting


def spectrum(name, points):
    """All eigenvalues at the points, but for the zero of a rigid body."""
    return np.linalg.eigvals(SYSTEMS[name][0](*points.T)).astype(complex)


def tally(name, points):
    """Counts of stable, fluttering and diverging points; least and most real eigenvalues."""
    values = spectrum(name, points)
    real = (values.imag == 0).sum(axis=-1)
    leading = values[np.arange(len(values)), values.real.argmax(axis=-1)]
    unstable = leading.real >= 0
    alone = leading.imag == 0
    counts = np.array([(~unstable).sum(), (unstable & ~alone).sum(), (unstable & alone).sum()])
    return counts, real.min(), real.max()


def sample(name, seed, number):
    low, high = np.array(SYSTEMS[name][1], dtype=float).T
    return low + (high - low) * np.random.default_rng(seed).random((number, len(low)))


def chunk(task):
    name, part, number = task
    seed = [int.from_bytes(name.encode(), "little"), part]
    return tally(name, sample(name, seed, number))


def corners(name):
    return np.array(list(itertools.product(*SYSTEMS[name][1])), dtype=float)


def main():
    arguments = sys.argv[1:]
    limit = None
    if "--points" in arguments:
        at = arguments.index("--points")
        limit = int(arguments[at + 1])
        del arguments[at : at + 2]
    names = arguments or list(SYSTEMS)
    lines = ["name,points,stable,flutter,divergence,least_real,most_real"]
    print(lines[0])
    with ProcessPoolExecutor() as pool:
        for name in names:
            start = time.time()
            total = limit or SYSTEMS[name][2]
            sizes = [min(CHUNK, total - done) for done in range(0, total, CHUNK)]
            results = list(pool.map(chunk, [(name, part, size) for part, size in enumerate(sizes)]))
            stable, flutter, divergence = sum(counts for counts, _, _ in results) / total
            _, least, most = tally(name, corners(name))
            least = min([least] + [low for _, low, _ in results])
            most = max([most] + [high for _, _, high in results])
            lines.append(f"{name},{total},{stable:.6f},{flutter:.6f},{divergence:.6f},{least},{most}")
            print(lines[-1], f"   # {time.time() - start:.0f} s", flush=True)
    if limit is None and not arguments:
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "truth.csv"), "w") as file:
            file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
