#!/usr/bin/env python3
"""Derivatives by the inputs, of a state matrix and of cluster invariants: reference
data.

Writes ``clutch_matrix_derivatives.csv``, ``clutch_invariant_derivatives.csv`` and
``three_mode_derivatives.csv`` into the folder of this file; reads
``three_modes.csv`` there.  Needs mpmath and sympy (and numpy, by way of
``coupled_oscillators``).  With the argument ``check`` it writes nothing and
verifies the numbers instead (see the end).


The systems
===========
The clutch: six degrees of freedom (theta_x, theta_y, Z_A, Z_B, Z_C, Z_D),

    M u'' + C u' + K u = 0,
    M = diag(plate_inertia_x, plate_inertia_y, m, m, m, m),   m = plate_mass / 4,
    K = S(gamma_1 k_p / 4, k_p / (4 gamma_1),
          gamma_2 k_p / 4, k_p / (4 gamma_2), k_f),
    C = S(c_A, c_B, c_C, c_D, c_f),

    S(a, b, c, d, f), with r = (r_1 + r_2) / 2, is

    r^2 (a+b+4f)    +mu l r (c+d)   r (a+2f)   -r (b+2f)   mu l c     -mu l d
    -mu l r (a+b)   r^2 (c+d+4f)    -mu l a    mu l b      r (c+2f)   -r (d+2f)
    r (a+2f)        0               a+2f       0           -f         -f
    -r (b+2f)       0               0          b+2f        -f         -f
    0               r (c+2f)        -f         -f          c+2f       0
    0               -r (d+2f)       -f         -f          0          d+2f

with 16 parameters, in this order and with these nominal values (SI units):

    mu 0.25         gamma_2 0.8     plate_mass 40           c_B 4
    k_p 16e6        r_1 0.075       plate_inertia_x 0.03    c_C 4
    k_f 7e6         r_2 0.12        plate_inertia_y 0.03    c_D 4
    gamma_1 0.9     l 0.0125        c_A 4                   c_f 0.1

The first eight are its uncertain inputs: mu in [0, 0.5], the others within 5 % of
nominal (this is "the box" below).  All parameters, the decimal ones too, are
meant as double-precision numbers.  The state matrix is

    A = [0, I; -M^-1 K, -M^-1 C]      (12 x 12).

It has a fourfold eigenvalue zero (rigid rotations) and four oscillating modes,
numbered by ascending Im; modes 3 and 4 are the pair that coalesces.

The three modes: the system k = 3 of ``coupled_oscillators``, its modes 1, 2 and 3,
its inputs and their standardized form, its decimal constants.

Why these functions.  Where eigenvalues coalesce, their own derivatives are
unbounded.  Symmetric functions of the cluster are analytic there:

    pair           s = (lambda_1 + lambda_2) / 2,   d = ((lambda_1 - lambda_2) / 2)^2
    three modes    s = (lambda_1 + lambda_2 + lambda_3) / 3,
                   prod_i (z - (lambda_i - s)) = z^3 + c1 z + c0


The files
=========
clutch_matrix_derivatives.csv

    by,mu,...,c_f,a_7_1,a_7_2,...,a_12_12

    Derivative of A by the parameter named in `by`, at the 16 parameter values that
    follow; a_i_j is the derivative of entry (i, j), counted from one.  Only rows 7
    to 12 are there, the upper half of A being constant.  Three points, 16 rows
    each: nominal, then two random points with every parameter changed by up to
    30 % (mu in [0, 0.5]).  The derivatives are symbolic and evaluated with 60
    digits.

clutch_invariant_derivatives.csv

    set,mu,k_p,k_f,gamma_1,gamma_2,r_1,r_2,l,re_s,im_s,re_d,im_d,
    re_s_mu,im_s_mu,re_d_mu,im_d_mu,...,re_s_l,im_s_l,re_d_l,im_d_l,
    c_A,c_B,c_C,c_D

    s and d of modes 3 and 4, then their derivatives by each input in physical
    units (k_p: per N/m, and so on).  The last four columns are the dampers; the
    other parameters are nominal.

    set = generic       six random points of the box, nominal dampers
    set = exceptional   six points of the box at or next to coalescences:

        |d| = 0.019     nominal dampers
        |d| = 0.0096    nominal dampers
        |d| = 1e-3      beside the fifth, mu moved
        |d| = 1e-5      beside the sixth, gamma_2 moved
        the pair coalesces, c_C = 4.2 (mu and gamma_1 solved for)
        the pair coalesces, dampers 4.1, 3.8, 4.05, 4 (mu and gamma_2 solved for)

    Why the dampers change.  With four equal dampers there is no exceptional point
    in the box, nor near it.  Friction couples two rotations that are independent
    at mu = 0, so that d is about -a^2 + b mu^2, with a half their difference in
    frequency.  The dampers take part in the coupling and turn b in the complex
    plane, by 0.002 to 0.03, but hardly turn a: wherever Re d = 0, Im d is
    positive (so at each of 3000 random points with all inputs within a factor of
    two).  Then d vanishes only where both terms do, at mu = 0 with
    gamma_1 = gamma_2, just outside the box, and there the double eigenvalue keeps
    two eigenvectors.  In the box |d| is at least about 0.0025.  Dampers that
    differ by a few per cent turn a as well, and the pair does coalesce, with a
    single eigenvector, in the midst of the box.

three_mode_derivatives.csv

    set,follower,detuning_1,detuning_2,coupling,
    re_s,im_s,re_c1,im_c1,re_c0,im_c0,
    re_s_follower,im_s_follower,re_c1_follower,...,im_c0_coupling

    s, c1, c0 of modes 1, 2 and 3 and their derivatives by each standardized input.

    set = generic       the first four rows of the set `test` of three_modes.csv
    set = coalescence   the five rows of its set `coalescence`

"coalesces" means as nearly as double-precision inputs can say it (both rounded to
nearest): |d| is then about 1e-14, d changing by about 400 per unit of mu.

Inputs are written so that they read back as the very doubles used, everything else
with 17 digits.


Method and verification
=======================
The derivatives of invariants are central differences of eigenvalues computed with
60 digits, the step being 1e-15 of the input's nominal value (1e-15 if
standardized).  The single eigenvalues at a coalescence are then good to 25 digits
or so, but their symmetric functions to more than 50.

``check`` compares

  * A, through its eigenvalues, with ``clutch_eigenvalues.csv``;
  * the symbolic derivatives of A with central differences of A;
  * the derivatives of invariants with those by a step of 1e-18;
  * the same with perturbation theory, which uses no differences:
    d lambda = w dA v / (w v) with left and right eigenvectors at generic points, and
    at every point the spectral projector P of the cluster,

        ds = tr(P dA) / m,      m = 2, 3 modes
        dd = tr(P (A - s) dA)
        c1 = -p2 / 2,   dp2 = 2 tr(P (A - s) dA)
        c0 = -p3 / 3,   dp3 = 3 tr(P (A - s)^2 dA) - 3 p2 ds

    P being made of bases of the null spaces of the cluster's polynomial in A and of
    its adjoint, dA of the symbolic derivatives (three modes: A is linear in xi).

It prints relative differences, real and imaginary parts each by themselves, and
fails if any exceeds 1e-20 (1e-15 for the eigenvalues, which are stored with 17
digits).  Found: eigenvalues 3e-17; derivatives of A 1e-35; the two steps at most
2e-25 and perturbation theory at most 2e-28, at coalescences much as elsewhere.
"""

import csv
import random
import sys
from pathlib import Path

import mpmath as mp
import sympy

sys.dont_write_bytecode = True  # no __pycache__ among the data

from coupled_oscillators import INPUTS as THREE_INPUTS  # noqa: E402
from coupled_oscillators import THREE, depressed  # noqa: E402

mp.mp.dps = 60

FOLDER = Path(__file__).resolve().parent
SEED = 20245
NOMINAL = {
    "mu": 0.25,
    "k_p": 16e6,
    "k_f": 7e6,
    "gamma_1": 0.9,
    "gamma_2": 0.8,
    "r_1": 0.075,
    "r_2": 0.12,
    "l": 0.0125,
    "plate_mass": 40.0,
    "plate_inertia_x": 0.03,
    "plate_inertia_y": 0.03,
    "c_A": 4.0,
    "c_B": 4.0,
    "c_C": 4.0,
    "c_D": 4.0,
    "c_f": 0.1,
}
PARAMETERS = tuple(NOMINAL)
INPUTS = PARAMETERS[:8]
DAMPERS = PARAMETERS[11:15]
STEP = mp.mpf("1e-15")
STEP_CHECK = mp.mpf("1e-18")


# --- the clutch --------------------------------------------------------------


def assemble(mu, r, l, springs, f):
    """S(a, b, c, d, f), of numbers or of symbols."""
    a, b, c, d = springs
    return [
        [
            r * r * (a + b + 4 * f),
            mu * l * r * (c + d),
            r * (a + 2 * f),
            -r * (b + 2 * f),
            mu * l * c,
            -mu * l * d,
        ],
        [
            -mu * l * r * (a + b),
            r * r * (c + d + 4 * f),
            -mu * l * a,
            mu * l * b,
            r * (c + 2 * f),
            -r * (d + 2 * f),
        ],
        [r * (a + 2 * f), 0, a + 2 * f, 0, -f, -f],
        [-r * (b + 2 * f), 0, 0, b + 2 * f, -f, -f],
        [0, r * (c + 2 * f), -f, -f, c + 2 * f, 0],
        [0, -r * (d + 2 * f), -f, -f, 0, d + 2 * f],
    ]


def lower_rows(values):
    """Rows 7 to 12 of the state matrix, of 16 numbers or symbols."""
    mu, k_p, k_f, gamma_1, gamma_2, r_1, r_2, l = values[:8]
    mass, inertia_x, inertia_y, *dampers, c_f = values[8:]
    springs = [
        gamma_1 * k_p / 4,
        k_p / (4 * gamma_1),
        gamma_2 * k_p / 4,
        k_p / (4 * gamma_2),
    ]
    r = (r_1 + r_2) / 2
    stiffness = assemble(mu, r, l, springs, k_f)
    damping = assemble(mu, r, l, dampers, c_f)
    masses = [inertia_x, inertia_y] + [mass / 4] * 4
    return [
        [-entry / m for entry in stiff + damp]
        for stiff, damp, m in zip(stiffness, damping, masses)
    ]


def symbolic_derivatives():
    """For each parameter a function of the 16 values: rows 7 to 12 of dA."""
    symbols = sympy.symbols(PARAMETERS, positive=True)
    rows = sympy.Matrix(lower_rows(symbols))
    return {
        name: sympy.lambdify(symbols, rows.diff(symbol).tolist(), modules="mpmath")
        for name, symbol in zip(PARAMETERS, symbols)
    }


def square(rows, upper):
    """The 2n x 2n matrix with the given lower half; its upper half is [0, I] or,
    for a derivative, zero."""
    n = len(rows)
    full = mp.zeros(2 * n)
    for i, row in enumerate(rows):
        full[i, n + i] = upper
        for j, entry in enumerate(row):
            full[n + i, j] = entry
    return full


def clutch_state(values):
    return square(lower_rows([mp.mpf(v) for v in values]), 1)


def oscillating(values):
    """Those with Im > 0 by ascending Im, without the rigid-body zeros."""
    limit = mp.mpf("1e-6") * max(abs(v) for v in values)
    return sorted((v for v in values if v.imag > limit), key=lambda v: v.imag)


def clutch_modes(values):
    modes = oscillating(mp.eig(clutch_state(values), left=False, right=False))
    if len(modes) != 4:
        raise ValueError("not four oscillating modes")
    return modes


def pair_invariants(values):
    """s and d of modes 3 and 4."""
    _, _, one, two = clutch_modes(values)
    return [(one + two) / 2, ((one - two) / 2) ** 2]


def with_nominal(**changed):
    """The 16 values, nominal but for those given."""
    return [float(changed.get(name, NOMINAL[name])) for name in PARAMETERS]


# --- the three modes ---------------------------------------------------------


def three_state(xi):
    stiff, damp = THREE.stiffness_damping([mp.mpf(x) for x in xi], mp.mpf)
    n = THREE.n
    rows = [
        [-k for k in stiff[i]] + [-damp[i] if j == i else mp.mpf(0) for j in range(n)]
        for i in range(n)
    ]
    return square(rows, 1)


def three_invariants(xi):
    """s, c1 and c0 of modes 1, 2 and 3."""
    cluster = THREE.eigenvalues(xi)[:3]
    return [mp.fsum(cluster) / 3, *depressed(cluster)]


# --- differences -------------------------------------------------------------


def difference(function, at, j, step):
    """Central difference quotients of a list-valued function by argument j."""
    at = [mp.mpf(x) for x in at]
    ahead, behind = list(at), list(at)
    ahead[j] += step
    behind[j] -= step
    return [(a - b) / (2 * step) for a, b in zip(function(ahead), function(behind))]


def pair_derivatives(values, relative):
    """Derivatives of s and d by each of the eight inputs."""
    return [
        difference(pair_invariants, values, j, relative * mp.mpf(NOMINAL[name]))
        for j, name in enumerate(INPUTS)
    ]


def three_derivatives(xi, step):
    return [difference(three_invariants, xi, j, step) for j in range(len(xi))]


# --- points ------------------------------------------------------------------


def short(value, digits):
    return float(f"{value:.{digits}g}")


def matrix_points():
    rng = random.Random(SEED)
    points = [with_nominal()]
    for _ in range(2):
        changed = {
            name: short(nominal * rng.uniform(0.7, 1.3), 4)
            for name, nominal in NOMINAL.items()
        }
        changed["mu"] = short(rng.uniform(0, 0.5), 4)
        points.append(with_nominal(**changed))
    return points


def generic_points():
    rng = random.Random(SEED + 1)
    points = []
    for _ in range(6):
        changed = {
            name: short(NOMINAL[name] * rng.uniform(0.95, 1.05), 6)
            for name in INPUTS[1:]
        }
        points.append(with_nominal(mu=short(rng.uniform(0, 0.5), 6), **changed))
    return points


def coalescence(start, names):
    """Newton's method for d = 0 on two of the inputs, Re and Im being two real
    equations; unrounded."""
    values = [mp.mpf(v) for v in start]
    free = [PARAMETERS.index(name) for name in names]
    for _ in range(40):
        at = pair_invariants(values)[1]
        jacobian = mp.zeros(2)
        for col, j in enumerate(free):
            slope = difference(pair_invariants, values, j, STEP * NOMINAL[names[col]])
            jacobian[0, col], jacobian[1, col] = slope[1].real, slope[1].imag
        change = mp.lu_solve(jacobian, mp.matrix([-at.real, -at.imag]))
        size = max(abs(change[c]) / NOMINAL[n] for c, n in enumerate(names))
        damping = min(mp.mpf(1), mp.mpf("0.1") / size)
        for col, j in enumerate(free):
            values[j] += damping * change[col]
        if size < mp.mpf(10) ** -30:
            return values
    raise ValueError("no coalescence")


def beside(values, name, target):
    """Move one input off a coalescence until |d| is about `target`."""
    j = PARAMETERS.index(name)
    slope = difference(pair_invariants, values, j, STEP * NOMINAL[name])[1]
    moved = list(values)
    moved[j] += target / abs(slope)
    return moved


def exceptional_points():
    first = coalescence(with_nominal(mu=0.0926, c_C=4.2), ("mu", "gamma_1"))
    second = coalescence(
        with_nominal(
            mu=0.09,
            k_p=16.4e6,
            k_f=6.8e6,
            gamma_1=0.89,
            gamma_2=0.805,
            r_1=0.0765,
            r_2=0.1175,
            l=0.0128,
            c_A=4.1,
            c_B=3.8,
            c_C=4.05,
        ),
        ("mu", "gamma_2"),
    )
    points = [
        with_nominal(mu=0.03288, gamma_1=0.865, gamma_2=0.83),
        with_nominal(mu=0.02383, k_f=7.2e6, gamma_1=0.86, gamma_2=0.835, l=0.0123),
        beside(first, "mu", mp.mpf("1e-3")),
        beside(second, "gamma_2", mp.mpf("1e-5")),
        first,
        second,
    ]
    return [[float(v) for v in point] for point in points]


def pair_points():
    yield from (("generic", values) for values in generic_points())
    yield from (("exceptional", values) for values in exceptional_points())


def three_points():
    with open(FOLDER / "three_modes.csv", newline="") as handle:
        rows = list(csv.DictReader(handle))
    for source, name, count in (("test", "generic", 4), ("coalescence",) * 2 + (5,)):
        chosen = [row for row in rows if row["set"] == source][:count]
        yield from ((name, [float(row[i]) for i in THREE_INPUTS]) for row in chosen)


# --- files -------------------------------------------------------------------


def digits(x):
    return mp.nstr(x, 17, strip_zeros=False) if x else "0.0"


def parts(numbers):
    return [digits(f) for z in numbers for f in (z.real, z.imag)]


def headings(quantities, suffix=""):
    return [f"{part}_{q}{suffix}" for q in quantities for part in ("re", "im")]


def write(name, header, rows):
    with open(FOLDER / name, "w", newline="") as handle:
        out = csv.writer(handle, lineterminator="\n")
        out.writerow(header)
        out.writerows(rows)


def write_matrix():
    entries = [f"a_{i}_{j}" for i in range(7, 13) for j in range(1, 13)]
    rows = []
    for values in matrix_points():
        for name, function in symbolic_derivatives().items():
            derivative = function(*[mp.mpf(v) for v in values])
            numbers = [digits(mp.mpf(e)) for row in derivative for e in row]
            rows.append([name, *map(repr, values), *numbers])
    write("clutch_matrix_derivatives.csv", ["by", *PARAMETERS, *entries], rows)


def write_pair():
    header = ["set", *INPUTS, *headings("sd")]
    for name in INPUTS:
        header += headings("sd", f"_{name}")
    rows = []
    for name, values in pair_points():
        row = [name, *map(repr, values[:8]), *parts(pair_invariants(values))]
        for derivative in pair_derivatives(values, STEP):
            row += parts(derivative)
        rows.append(row + [repr(v) for v in values[11:15]])
    write("clutch_invariant_derivatives.csv", header + list(DAMPERS), rows)


def write_three():
    quantities = ("s", "c1", "c0")
    header = ["set", *THREE_INPUTS, *headings(quantities)]
    for name in THREE_INPUTS:
        header += headings(quantities, f"_{name}")
    rows = []
    for name, xi in three_points():
        row = [name, *map(repr, xi), *parts(three_invariants(xi))]
        for derivative in three_derivatives(xi, STEP):
            row += parts(derivative)
        rows.append(row)
    write("three_mode_derivatives.csv", header, rows)


# --- verification ------------------------------------------------------------


def relative(value, reference):
    """The larger of the relative differences of real and imaginary parts."""
    pairs = [(mp.re(value), mp.re(reference)), (mp.im(value), mp.im(reference))]
    return max(abs(a - b) / abs(b) if b else abs(a) for a, b in pairs)


def worst(lists, references):
    return max(
        relative(a, b)
        for one, other in zip(lists, references, strict=True)
        for a, b in zip(one, other, strict=True)
    )


def trace(matrix):
    return mp.fsum(matrix[i, i] for i in range(matrix.rows))


def null_basis(matrix, dim):
    """Basis of the null space of a matrix that is singular to rounding, by two
    steps of inverse iteration from a fixed start."""
    rng = random.Random(SEED + 2)
    n = matrix.rows
    block = mp.matrix(n, dim)
    for i in range(n):
        for j in range(dim):
            block[i, j] = mp.mpf(rng.uniform(-1, 1))
    for _ in range(2):
        columns = [mp.lu_solve(matrix, block[:, j]) for j in range(dim)]
        for j, column in enumerate(columns):
            block[:, j] = column / mp.norm(column)
        block, _ = mp.qr(block, mode="skinny")
    return block


def scaled(matrix, frequency):
    """Velocity rows in units of displacement times frequency: a similarity."""
    n = matrix.rows // 2
    out = matrix.copy()
    for i in range(n):
        for j in range(n):
            out[i, n + j] *= frequency
            out[n + i, j] /= frequency
    return out


def by_projector(state, changes, invariants):
    """The derivatives of s, d or of s, c1, c0 by perturbation theory."""
    s, *rest = invariants
    frequency = abs(s)
    state = scaled(state, frequency)
    changes = [scaled(change, frequency) for change in changes]
    one = mp.eye(state.rows)
    shifted = state - s * one
    m = len(rest) + 1
    if m == 2:
        polynomial = shifted**2 - rest[0] * one
    else:
        polynomial = shifted**3 + rest[0] * shifted + rest[1] * one
    right = null_basis(polynomial, m)
    left = null_basis(polynomial.H, m)
    projector = right * mp.inverse(left.H * right) * left.H
    out = []
    for change in changes:
        ds = trace(projector * change) / m
        dp2 = 2 * trace(projector * shifted * change)
        if m == 2:
            out.append([ds, dp2 / 2])
        else:
            p2 = -2 * rest[0]
            dp3 = 3 * trace(projector * shifted**2 * change) - 3 * p2 * ds
            out.append([ds, -dp2 / 2, -dp3 / 3])
    return out


def by_eigenvectors(state, changes, ranks):
    """The same from left and right eigenvectors, for distinct eigenvalues."""
    values, left, right = mp.eig(state, left=True, right=True)
    modes = oscillating(values)
    chosen = [values.index(modes[rank]) for rank in ranks]
    found = [values[i] for i in chosen]
    m = len(found)
    s = mp.fsum(found) / m
    out = []
    for change in changes:
        slopes = []
        for i in chosen:
            w, v = left[i, :], right[:, i]
            slopes.append((w * change * v)[0] / (w * v)[0])
        ds = mp.fsum(slopes) / m
        roots = [(v - s, dv - ds) for v, dv in zip(found, slopes)]
        if m == 2:
            (one, done), (two, dtwo) = roots
            out.append([ds, (one - two) * (done - dtwo) / 2])
        else:
            (a, da), (b, db), (c, dc) = roots
            dc1 = da * (b + c) + db * (a + c) + dc * (a + b)
            dc0 = -(da * b * c + a * db * c + a * b * dc)
            out.append([ds, dc1, dc0])
    return out


def check():
    limit = mp.mpf("1e-20")
    failed = []

    def report(text, value, bound=limit):
        print(f"  {text:58} {mp.nstr(value, 2)}")
        if value > bound:
            failed.append(text)

    print("clutch, state matrix")
    difference_of_modes = mp.mpf(0)
    with open(FOLDER / "clutch_eigenvalues.csv", newline="") as handle:
        for row in csv.DictReader(handle):
            modes = clutch_modes(with_nominal(**{n: float(row[n]) for n in INPUTS}))
            stored = [mp.mpc(row[f"re_{i}"], row[f"im_{i}"]) for i in range(1, 5)]
            for a, b in zip(modes, stored):
                difference_of_modes = max(difference_of_modes, abs(a - b) / abs(b))
    report("eigenvalues against those stored", difference_of_modes, mp.mpf("1e-15"))

    symbolic = symbolic_derivatives()
    difference_of_entries = mp.mpf(0)
    for values in matrix_points():
        for j, name in enumerate(PARAMETERS):
            exact = symbolic[name](*[mp.mpf(v) for v in values])
            step = mp.mpf("1e-18") * NOMINAL[name]

            def entries(at):
                return [entry for row in lower_rows(at) for entry in row]

            flat = [entry for row in exact for entry in row]
            quotients = difference(entries, values, j, step)
            difference_of_entries = max(
                difference_of_entries, worst([quotients], [flat])
            )
    report("symbolic derivatives against differences", difference_of_entries)

    print("clutch, modes 3 and 4")
    for name, values in pair_points():
        invariants = pair_invariants(values)
        derivatives = pair_derivatives(values, STEP)
        print(f" {name}, |d| = {mp.nstr(abs(invariants[1]), 3)}")
        other = pair_derivatives(values, STEP_CHECK)
        report("step 1e-15 against 1e-18", worst(derivatives, other))
        state = clutch_state(values)
        numbers = [mp.mpf(v) for v in values]
        changes = [square(symbolic[i](*numbers), 0) for i in INPUTS]
        other = by_projector(state, changes, invariants)
        report("differences against projector", worst(derivatives, other))
        if name == "generic":
            other = by_eigenvectors(state, changes, (2, 3))
            report("differences against eigenvectors", worst(derivatives, other))

    print("three modes")
    for name, xi in three_points():
        invariants = three_invariants(xi)
        derivatives = three_derivatives(xi, STEP)
        sizes = ", ".join(mp.nstr(abs(c), 3) for c in invariants[1:])
        print(f" {name}, |c1|, |c0| = {sizes}")
        other = three_derivatives(xi, STEP_CHECK)
        report("step 1e-15 against 1e-18", worst(derivatives, other))
        state = three_state(xi)
        numbers = [mp.mpf(x) for x in xi]
        changes = []
        for j in range(len(xi)):
            moved = list(numbers)
            moved[j] += 1
            changes.append(three_state(moved) - state)
        other = by_projector(state, changes, invariants)
        report("differences against projector", worst(derivatives, other))
        if name == "generic":
            other = by_eigenvectors(state, changes, (0, 1, 2))
            report("differences against eigenvectors", worst(derivatives, other))

    if failed:
        raise SystemExit("differ: " + "; ".join(failed))


def main():
    if sys.argv[1:] == ["check"]:
        check()
        return
    write_matrix()
    write_pair()
    write_three()


if __name__ == "__main__":
    main()
