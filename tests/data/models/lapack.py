"""Eigenvalues of the example systems by LAPACK, through SciPy.

    python3 tests/data/models/lapack.py

Builds the matrices from the physics, without the studies, and writes
eigenvalues_<name>.csv beside this file: 20 random points of the inputs each,
then Re and Im of the modes (of the block's first 12) by frequency.
"""
import csv
import sys
from pathlib import Path

import numpy as np
import scipy.linalg

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parents[2] / "surrogates" / "block"))

import generate  # noqa: E402


def stack(rows):
    """(points, n, n) array from rows of numbers or arrays over the points."""
    shape = np.broadcast_shapes(*(np.shape(e) for row in rows for e in row))
    return np.stack([np.stack([np.broadcast_to(np.asarray(e, float), shape)
                               for e in row], -1) for row in rows], -2)


# The systems: u = displacements, forces taken to the left-hand side.

def mode_coupling(mu, k_1, k_2, k_n, c):
    """K from the directions of the springs; friction mu*k_n*y on the belt."""
    stiffness = 0
    for k, degrees in ((k_1, 150), (k_2, 30)):
        direction = np.array([np.cos(np.radians(degrees)),
                              np.sin(np.radians(degrees))])
        stiffness = stiffness + (k[:, None, None]
                                 * np.outer(direction, direction))
    stiffness[:, 1, 1] += k_n
    stiffness[:, 0, 1] -= mu * k_n
    return np.eye(2), stack([[c, 0], [0, c + 4]]), stiffness


def three_modes(mu, k_n, k_x, k_z, c):
    phi = np.radians(40)
    suspension = stack([[k_x, 4e4, 0], [4e4, 6e5, 4e4], [0, 4e4, k_z]])
    suspension[:, 1, 1] += k_n
    suspension[:, 0, 1] -= mu * k_n * np.cos(phi)
    suspension[:, 2, 1] -= mu * k_n * np.sin(phi)
    return np.eye(3), stack([[c, 0, 0], [0, c + 4, 0], [0, 0, c]]), suspension


def flutter(airspeed, k_theta, s, rho, c_h):
    """Lift L = pi rho U 2b (U theta + h' + d theta') upwards at the quarter
    chord, and the moment -pi rho U b^3/2 theta' of a rotating flat plate."""
    m, i_cg, b, a, k_h, c_theta = 5.0, 0.025, 0.15, -0.2, 1800.0, 0.02
    quarter, three_quarter = b * (0.5 + a), b * (0.5 - a)
    q, n = 0.5 * rho * airspeed ** 2, len(s)
    slope = 2 * np.pi                               # of the lift coefficient
    lift_k = q * 2 * b * slope * np.array([[0], [1]])
    lift_c = q * 2 * b * slope / airspeed * np.array([[1], [three_quarter]])
    mass = stack([[m + 0 * s, m * s], [m * s, i_cg + m * s * s]])
    stiffness, damping = np.zeros((2, n, 2, 2))
    stiffness[:, 0, 0], stiffness[:, 1, 1] = k_h, k_theta
    damping[:, 0, 0], damping[:, 1, 1] = c_h, c_theta
    damping[:, 1, 1] += np.pi / 2 * rho * airspeed * b ** 3
    for j in range(2):
        stiffness[:, 0, j] += lift_k[j]             # h is counted downwards
        stiffness[:, 1, j] -= quarter * lift_k[j]
        damping[:, 0, j] += lift_c[j]
        damping[:, 1, j] -= quarter * lift_c[j]
    return mass, damping, stiffness


def rotor(omega, c_internal, c_external, k, anisotropy):
    """The internal damper sees the velocity u' - omega x u."""
    k_x, k_y = k * (1 + anisotropy), k * (1 - anisotropy)
    zero = 0 * k
    whirl = c_internal * omega
    return (10 * np.eye(2),
            stack([[c_internal + c_external, zero],
                   [zero, c_internal + c_external]]),
            stack([[k_x, whirl], [-whirl, k_y]]))


BLOCK = generate.assemble()


def block(E, k_n, mu, beta):
    m, elastic, contact, friction = BLOCK
    e, k, f, b = (x[:, None, None] for x in (E, k_n, mu, beta))
    return (m, 50 * m + b * e * elastic,
            e * elastic + k * contact + f * k * friction)


SYSTEMS = {
    "mode-coupling": (mode_coupling, {
        "mu": (0.2, 0.6), "k_1": (5.7e5, 6.3e5), "k_2": (1.71e6, 1.89e6),
        "k_n": (1.08e6, 1.32e6), "c": (5, 20)}),
    "three-modes": (three_modes, {
        "mu": (0.1, 0.5), "k_n": (3.4e5, 4.6e5), "k_x": (8.924e5, 9.476e5),
        "k_z": (1.0476e6, 1.1124e6), "c": (5, 20)}),
    "flutter": (flutter, {
        "airspeed": (8, 13), "k_theta": (38, 42), "s": (0.022, 0.038),
        "rho": (1.1, 1.3), "c_h": (1, 4)}),
    "rotor": (rotor, {
        "omega": (300, 700), "c_internal": (80, 140), "c_external": (40, 80),
        "k": (0.95e6, 1.05e6), "anisotropy": (0.01, 0.05)}),
    "block": (block, {
        "E": (4.5e9, 5.5e9), "k_n": (3e7, 7e7), "mu": (0.05, 0.4),
        "beta": (1e-7, 3e-7)}),
}


def draw(inputs, points, seed):
    bounds = np.array(list(inputs.values()), float)
    unit = np.random.default_rng(seed).random((points, len(bounds)))
    return bounds[:, 0] + unit * (bounds[:, 1] - bounds[:, 0])


def state_matrices(build, x):
    m, c, k = build(*x.T)
    n = m.shape[-1]
    inverse = np.linalg.inv(m)
    a = np.zeros((len(x), 2 * n, 2 * n))
    a[:, :n, n:] = np.eye(n)
    a[:, n:, :n] = -inverse @ k
    a[:, n:, n:] = -inverse @ c
    return a


def in_order(values):
    """Im > 0, by Im; where Im is the same to 1e-9, by Re."""
    values = values[values.imag > 1e-6 * abs(values).max()]
    values = values[np.argsort(values.imag)]
    group = np.cumsum(np.diff(values.imag, prepend=values.imag[0])
                      > 1e-9 * abs(values))
    return values[np.lexsort((values.real, group))]


def main():
    for name, (build, inputs) in SYSTEMS.items():
        points = draw(inputs, 20, seed=20)
        rows = []
        for point, a in zip(points, state_matrices(build, points)):
            values = in_order(scipy.linalg.eig(a, right=False))[:12]
            parts = [p for v in values for p in (v.real, v.imag)]
            rows.append([repr(float(p)) for p in [*point, *parts]])
        modes = range(1, (len(rows[0]) - len(inputs)) // 2 + 1)
        header = [f"{part}_{k}" for k in modes for part in ("re", "im")]
        path = FOLDER / f"eigenvalues_{name}.csv"
        with open(path, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([*inputs, *header])
            writer.writerows(rows)


if __name__ == "__main__":
    main()
