#!/usr/bin/env python3
"""The lowest eigenvalues of the beams and of the machine, to 40 digits.

What it does
============
At one point of each study of this folder it computes the 16 eigenvalues of least
magnitude (8 modes) of (lambda^2 M + lambda C + K) x = 0, from the doubles that the
Matrix Market files hold, and writes

    eigenvalues_N.csv          beam-N            mode, re, im (1/s, rad/s)
    eigenvalues_free_N.csv     beam-N-free       the same; its first four are zero
    eigenvalues_machine.csv    machine           the same
    points.csv                 study, input, value

Conjugates are listed, too, that with im > 0 first.  Of the free beams there are four
zeros and six modes that oscillate.

The points are such that every sum and product in the assembled M, C and K is a
double: nothing is rounded when they are put together, so a program in double
precision starts from the very matrices that these eigenvalues belong to.  (`exact`
checks this.)

How it is done
==============
1. Sturm counts (signs of pivots) isolate the lowest eigenvalues of K x = mu M x.
2. From there inverse iteration on the quadratic problem with 120 digits.
3. The same with 160 digits from another start; both must agree to 45 digits.
4. The residual must be below 1e-40 with the eigenvalue as it is written (42 digits), and
   below 1e-100 before that.
5. The determinant of lambda^2 M + lambda C + K is followed around a circle between
   the 8th and the 9th mode: it must turn 16 times, so none is missed.
6. Free beams: K times either rigid motion is zero in exact integers, 2 mu of K x =
   mu M x are zero by Sturm counts at +-1e-30, and lambda^2 + (b - g) mu lambda + e mu = 0
   gives all others.  The residual of the quadratic problem is checked as well.
7. Machine: bounce and surge are compared with their closed form.

How to run it
=============
    python3 eigenvalues.py               all; one minute
    python3 eigenvalues.py beam-20       those alone; leaves points.csv as it is

It needs mpmath (1.4 was used; with gmpy2 it is faster).
"""

import sys
import time
from fractions import Fraction
from pathlib import Path

import mpmath
from mpmath import mp, mpf

import quadratic as q

HERE = Path(__file__).resolve().parent
DIGITS = 120
MORE = 160
WRITTEN = 42

POINTS = {
    **{f"beam-{n}": {"c": 1.125, "g": 0.9375, "k": 90.0} for n in (20, 80, 200)},
    **{f"beam-{n}-free": {"b": 7 * 2.0**-25, "g": 13 * 2.0**-26, "e": 1.03125} for n in (20, 80, 200)},
    "machine": {"c": 0.01953125, "tau": 0.0126953125, "kappa": 1.625},
}


def unit(size, *entries):
    return size, {(i, j): Fraction(value) for i, j, value in entries}


def matrices(study):
    """M, C, K at the point, exactly."""
    p = {name: Fraction(value) for name, value in POINTS[study].items()}
    q.LAST = ()
    if study == "machine":
        q.LAST = (1, 117)  # the ends of the bar
        read = {name: q.read(HERE / "machine" / f"{name}.mtx") for name in ("K", "M_x", "M_y")}
        bar = unit(120, (1, 1, 1), (117, 117, 1), (117, 1, -1))
        M = q.combine((1, read["M_x"]), (1, read["M_y"]))
        C = q.combine(
            (p["c"] - p["tau"] * p["kappa"], read["M_y"]),
            (Fraction(0.0234375), read["M_x"]),
            (Fraction(4.76837158203125e-7), read["K"]),
        )
        K = q.combine(
            (1, read["K"]), (p["kappa"], read["M_y"]), (Fraction(3.5625), read["M_x"]), (Fraction(7.625), bar)
        )
        return M, C, K
    folder = HERE / study.removesuffix("-free")
    M, beam = q.read(folder / "M.mtx"), q.read(folder / "K.mtx")
    if study.endswith("-free"):
        return M, q.combine((p["b"] - p["g"], beam)), q.combine((p["e"], beam))
    size = M[0]
    ends = unit(size, (0, 0, 1), (size - 2, size - 2, 1))
    return M, q.combine((p["c"] - p["g"], ends)), q.combine((1, beam), (p["k"], ends))


def exact(*parts):
    return all(Fraction(float(value)) == value for _, entries in parts for value in entries.values())


def text(value):
    return mpmath.nstr(value, WRITTEN, strip_zeros=False)


def modes_of(K, M, most):
    """Brackets of nine mu, and a radius between the 8th and the 9th frequency."""
    brackets = q.squares(K, M, 9, mpf("1e-3"), most)
    assert len(brackets) == 9 and q.below(K, M, mpf("1e-3")) == 0
    return brackets, mpmath.sqrt(mpmath.sqrt(brackets[7][1] * brackets[8][0]))


def supported(study):
    exactly = matrices(study)
    assert exact(*exactly), "the assembled matrices are no doubles"
    mp.dps = 50
    M, C, K = (q.floating(A) for A in exactly)
    brackets, radius = modes_of(K, M, mpf("1e12"))
    turns, largest = q.inside(M, C, K, radius)
    print(f"  |lambda| < {mpmath.nstr(radius, 6)}: the determinant turns {mpmath.nstr(turns, 20)} times", end="")
    print(f" (steps of at most {mpmath.nstr(largest, 3)})")
    assert abs(turns - 16) < mpf("1e-20") and largest < 1
    answer = []
    worst = mpf(0)
    for low, high in brackets[:8]:
        values = []
        for digits, share in ((DIGITS, mpf("0.5")), (MORE, mpf("0.3"))):
            mp.dps = digits
            M, C, K = (q.floating(A) for A in exactly)
            start = mpmath.mpc(0, mpmath.sqrt(low + share * (high - low)))
            z, x, step = q.refine(M, C, K, start)
            values.append(z)
        assert abs(values[0] - values[1]) < mpf("1e-45") * min(abs(values[1].real), abs(values[1].imag)), values
        z = mpmath.mpc(text(values[1].real), text(values[1].imag))
        worst = max(worst, q.residual(M, C, K, z, x))
        assert q.residual(M, C, K, values[1], x) < mpf("1e-100")
        assert abs(z.imag**2 / high) < mpf("1.01") and abs(z.imag**2 / low) > mpf("0.99")
        answer.append(values[1])
    print(f"  largest residual of a written eigenvalue {mpmath.nstr(worst, 3)}")
    assert worst < mpf("1e-40") and len({text(z.imag) for z in answer}) == 8
    if study == "machine":
        p = {name: mpf(value) for name, value in POINTS[study].items()}
        for name, b, c in (("bounce", p["c"] - p["tau"] * p["kappa"], p["kappa"]), ("surge", mpf("0.0234375"), mpf("3.5625"))):
            closed = mpmath.mpc(-b / 2, mpmath.sqrt(c - b * b / 4))
            nearest = min(abs(z - closed) for z in answer)
            print(f"  {name} differs from its closed form by {mpmath.nstr(nearest, 3)}")
            assert nearest < mpf("1e-60")
    return answer


def free(study):
    exactly = matrices(study)
    assert exact(*exactly), "the assembled matrices are no doubles"
    p = {name: Fraction(value) for name, value in POINTS[study].items()}
    n = int(study.split("-")[1])
    folder = HERE / f"beam-{n}"
    beam, mass = q.read(folder / "K.mtx"), q.read(folder / "M.mtx")
    size = beam[0]
    # rigid motions, times the number of elements: shift, and turn by one
    shift = [Fraction((i + 1) % 2) for i in range(size)]
    turn = [Fraction(4 * (i // 2), n) if i % 2 == 0 else Fraction(1) for i in range(size)]
    for rigid in (shift, turn):
        for A in exactly[1:]:
            product = [Fraction(0)] * size
            for (i, j), value in A[1].items():
                product[i] += value * rigid[j]
                if i != j:
                    product[j] += value * rigid[i]
            assert not any(product), "a rigid motion meets a force"
    answer = []
    for digits in (DIGITS, MORE):
        mp.dps = digits
        K, M = q.floating(beam), q.floating(mass)
        # the next free modes begin above 1e3: one square apart from the two zeros
        assert q.below(K, M, mpf("-1e-30")) == 0 and q.below(K, M, mpf("1e-30")) == 2 == q.below(K, M, mpf(1000))
        if digits == DIGITS:
            brackets = q.squares(K, M, 8, mpf("1e3"), mpf("1e12"))
            assert len(brackets) == 6
        none = (size, {(0, 0): mpf(0)})
        values = []
        for low, high in brackets:
            z, x, _ = q.refine(M, none, K, mpmath.mpc(0, mpmath.sqrt((low + high) / 2)))
            mu = -(z * z).real
            assert low < mu < high and abs((z * z).imag) < mu * mpf("1e-60")
            b, c = q.number(p["b"] - p["g"]) * mu, q.number(p["e"]) * mu
            values.append(mpmath.mpc(-b / 2, mpmath.sqrt(c - b * b / 4)))
            whole = [q.floating(A) for A in exactly]
            assert q.residual(*whole, values[-1], [v.real if hasattr(v, "real") else v for v in x]) < mpf("1e-60")
        answer.append(values)
    assert all(abs(a - b) < mpf("1e-45") * abs(b.real) for a, b in zip(*answer))
    print(f"  two squares are zero, six of eight are between 1e3 and {mpmath.nstr(brackets[-1][1], 6)}")
    return [None, None] + answer[1]


def main():
    names = sys.argv[1:] or list(POINTS)
    for study in names:
        start = time.time()
        print(study, flush=True)
        modes = free(study) if study.endswith("-free") else supported(study)
        tail = study if study == "machine" else "_".join(reversed(study.split("-")[1:]))
        lines = ["mode,re,im"]
        for number, z in enumerate(modes, start=1):
            if z is None:
                lines += [f"{number},0,0"] * 2
            else:
                lines += [f"{number},{text(z.real)},{text(z.imag)}", f"{number},{text(z.real)},-{text(z.imag)}"]
        (HERE / f"eigenvalues_{tail}.csv").write_text("\n".join(lines) + "\n")
        for line in lines[1::2]:
            print("   ", line)
        print(f"  {time.time() - start:.0f} s", flush=True)
    if not sys.argv[1:]:
        lines = ["study,input,value"]
        lines += [f"{study},{name},{value:.17g}" for study, point in POINTS.items() for name, value in point.items()]
        (HERE / "points.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
