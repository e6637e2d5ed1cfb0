"""Systems as functions, at the top of a module so that they can be pickled."""

from __future__ import annotations

import math

import numpy as np


def oscillator(k, c):
    """Stable where c is positive: 3/4 of cases for c from -0.1 to 0.3."""
    return np.array([[0.0, 1.0], [-k, -c]])


def eigenvalues_of_oscillator(k, c):
    return np.linalg.eigvals(oscillator(k, c))


def clutch(mu=0.25, k_p=16e6, k_f=7e6, gamma_1=0.9, gamma_2=0.8, r_1=0.075, r_2=0.12, l=0.0125):  # noqa: E741
    """The clutch of surrogates/clutch-matrices.toml."""
    r = (r_1 + r_2) / 2
    springs = [gamma_1 * k_p / 4, k_p / (4 * gamma_1), gamma_2 * k_p / 4, k_p / (4 * gamma_2)]
    quarter = 40.0 / 4
    mass = np.diag([0.030, 0.030, quarter, quarter, quarter, quarter])
    return mass, _plate(mu, l, r, [4.0] * 4, 0.1), _plate(mu, l, r, springs, k_f)


def _plate(mu, l, r, contacts, f):  # noqa: E741
    a, b, c, d = contacts
    return np.array([
        [r**2 * (a + b + 4 * f), mu * l * r * (c + d), r * (a + 2 * f), -r * (b + 2 * f), mu * l * c, -mu * l * d],
        [-mu * l * r * (a + b), r**2 * (c + d + 4 * f), -mu * l * a, mu * l * b, r * (c + 2 * f), -r * (d + 2 * f)],
        [r * (a + 2 * f), 0, a + 2 * f, 0, -f, -f],
        [-r * (b + 2 * f), 0, 0, b + 2 * f, -f, -f],
        [0, r * (c + 2 * f), -f, -f, c + 2 * f, 0],
        [0, -r * (d + 2 * f), -f, -f, 0, d + 2 * f],
    ])  # fmt: skip


def rotor(omega, c_internal, c_external, k, anisotropy):
    """The rotor of surrogates/rotor.toml."""
    g = c_internal * omega
    stiffness = np.array([[k * (1 + anisotropy), g], [-g, k * (1 - anisotropy)]])
    return 10.0 * np.eye(2), (c_internal + c_external) * np.eye(2), stiffness


def flutter(airspeed, k_theta, s, rho, c_h):
    """The wing section of surrogates/flutter.toml."""
    m, inertia, b, e, k_h, c_theta = 5.0, 0.025, 0.15, 0.045, 1800.0, 0.02
    d, lift = b - e, 2 * math.pi * rho * b * airspeed
    mass = [[m, m * s], [m * s, inertia + m * s**2]]
    damping = [[c_h + lift, lift * d], [-lift * e, c_theta - lift * e * d + lift * b**2 / 4]]
    stiffness = [[k_h, lift * airspeed], [0.0, k_theta - lift * e * airspeed]]
    return np.array(mass), np.array(damping), np.array(stiffness)
