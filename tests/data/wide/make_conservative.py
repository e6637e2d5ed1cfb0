#!/usr/bin/env python3
"""Systems without damping: chains, rotating systems, friction.

What it does
============
It writes eight studies into the folder of this file:

    chain-2, chain-5, chain-16     masses and springs: every point is marginal
    spin-2, spin-6, spin-16        in a frame that turns with speed W: C = 2 W J skew, K - W^2 M;
                                   marginal, flutter and divergence by W
    friction-2, friction-4         K is not symmetric: marginal, flutter, and for friction-4 divergence

No point of any of them is asymptotically stable: a point is marginal if all eigenvalues
are imaginary.  `shares.py` says how large the parts of the box are.

How to run it
=============
    python3 make_conservative.py     Python 3.10, nothing else
"""

from pathlib import Path

HERE = Path(__file__).resolve().parent


def uniform(lower, upper):
    return f'{{ distribution = "uniform", lower = {lower}, upper = {upper} }}'


def entries(items):
    return "[" + ", ".join(f"[{i}, {j}, {value}]" for i, j, value in items) + "]"


def write(name, remark, body):
    text = "\n".join(f"# {line}" for line in remark) + f'\nformat = 1\nname = "{name}"\n\n' + body.strip("\n") + "\n"
    (HERE / f"{name}.toml").write_text(text)


def string(masses, planes=1):
    """The lower triangle of a string of masses between two walls, all spans alike."""
    items = []
    for plane in range(planes):
        first = plane * masses + 1
        for i in range(first, first + masses):
            items.append((i, i, 2))
            if i > first:
                items.append((i, i - 1, -1))
    return items


def spin(name, remark, mass, inputs):
    """Masses on a string that turns; its first span is a tape, stiffer in x (first half) than in y."""
    n = len(mass)
    skew = entries([(n + i + 1, i + 1, mass[i]) for i in range(n)])
    doubled = ", ".join(str(value) for value in mass + mass)
    write(
        name,
        remark,
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [{doubled}] }}
C = {{ size = {2 * n}, form = "skew-symmetric", factor = "2*W", entries = {skew} }}
K = [
    {{ size = {2 * n}, form = "symmetric", factor = "k", entries = {entries(string(n, 2))} }},
    {{ size = {2 * n}, factor = "a*k", entries = [[1, 1, 1], [{n + 1}, {n + 1}, -1]] }},
    {{ factor = "-W^2", diagonal = [{doubled}] }},
]

[inputs]
{inputs}
""",
    )


def main():
    write(
        "chain-2",
        ["Two masses on two springs, without damping: marginal everywhere."],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [1, "m"] }}                            # kg
K = {{ form = "symmetric", rows = [["k + 8e3"], [-8e3, 8e3]] }}

[inputs]
m = {uniform(0.5, 2.0)}      # kg
k = {uniform(9e3, 1.1e4)}  # N/m
""",
    )
    write(
        "chain-5",
        ["Five masses on a spring that stiffens from 1 to 10000 times: marginal everywhere, frequencies over three decades."],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = ["m", 1, 1, 1, 1] }}                   # kg; the first is held by the softest spring
K = {{ form = "symmetric", rows = [["k + 10*s"], ["-10*s", "10*s + 1e4"], [0, -1e4, 1.1e5], [0, 0, -1e5, 1.1e6], [0, 0, 0, -1e6, 1e6]] }}

[inputs]
k = {uniform(50.0, 150.0)}   # N/m
m = {uniform(0.5, 2.0)}      # kg
s = {uniform(80.0, 120.0)}   # N/m, a tenth of the second spring
""",
    )
    write(
        "chain-16",
        ["Sixteen oscillators, nearly alike and hardly coupled: marginal everywhere, all frequencies within 1.5 per cent."],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [1, 1, 1, 1, 1, 1, 1, "1 + d", 1, 1, 1, 1, 1, 1, 1, 1] }}
K = [
    {{ diagonal = [{", ".join(['"k"'] * 16)}] }},
    {{ size = 16, form = "symmetric", factor = "k_c", entries = {entries(string(16))} }},
]

[inputs]
k = {uniform(9.5e3, 1.05e4)}   # 1/s^2, each to ground
k_c = {uniform(20.0, 60.0)}      # 1/s^2, from each to the next
d = {uniform(-0.002, 0.002)}   # error of the eighth mass
""",
    )
    write(
        "spin-2",
        [
            "A mass in a turning frame, on springs that differ in x and y and that a load p weakens. Without damping.",
            "Light load: it diverges while W^2 is between both stiffnesses. Heavy load: spin holds it (marginal) or it flutters.",
        ],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [1, 1] }}
C = [[0, "-2*W"], ["2*W", 0]]
K = {{ diagonal = ["k*(1 + a) - p - W^2", "k*(1 - a) - p - W^2"] }}

[model.constants]
k = 1e4                                                                # 1/s^2

[inputs]
W = {uniform(50.0, 150.0)}      # rad/s
a = {uniform(0.05, 0.3)}        # difference of the springs
p = {uniform(0.0, 1.6e4)}       # 1/s^2
""",
    )
    spin(
        "spin-6",
        [
            "Three masses on a string that turns with speed W; one span is a tape, stiffer in x than in y. Turning frame, without damping.",
            "Each critical speed is a band of divergence, and between two of them is a band of flutter; elsewhere it is marginal.",
        ],
        [1, 1.25, 0.75],
        f"W = {uniform(60.0, 140.0)}       # rad/s\na = {uniform(0.1, 0.5)}          # of the tape\n"
        f"k = {uniform(9.5e3, 1.05e4)}    # N/m",
    )
    spin(
        "spin-16",
        [
            "Eight masses on a string that turns with speed W; one span is a tape, stiffer in x than in y. Turning frame, without damping.",
            "Many bands of divergence (critical speeds) and of flutter (between them), some of which overlap; elsewhere it is marginal.",
        ],
        [1] * 8,
        f"W = {uniform(20.0, 75.0)}        # rad/s\na = {uniform(0.1, 0.5)}          # of the tape\n"
        f"k = {uniform(9.5e3, 1.05e4)}    # N/m",
    )
    write(
        "friction-2",
        ["A mass on a sliding belt, without damping: friction makes K unsymmetric, and two frequencies merge (flutter)."],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [1, 1] }}
K = [[1e4, "1500 - mu*k_n"], [1500, "4e3 + k_n"]]

[inputs]
mu = {uniform(0.0, 1.0)}
k_n = {uniform(4e3, 8e3)}      # N/m, contact
""",
    )
    write(
        "friction-4",
        [
            "Two bodies that slide on each other, without damping, x along and y across: friction makes them flutter, and a load p",
            "on the second makes it diverge near the upper end of its range.",
        ],
        f"""
[model]
kind = "matrices"
M = {{ diagonal = [1, 1, 2, 2] }}                       # kg: x and y of the first, x and y of the second
K = [
    {{ form = "symmetric", rows = [[1.2e4], [2e3, 5e3], [0, 0, "1.5e4 - p"], [0, 0, -3e3, 8e3]] }},
    {{ size = 4, form = "symmetric", factor = "k_n", entries = [[2, 2, 1], [4, 4, 1], [4, 2, -1]] }},
    {{ size = 4, factor = "mu*k_n", entries = [[1, 2, -1], [1, 4, 1], [3, 2, 1], [3, 4, -1]] }},
]

[inputs]
mu = {uniform(0.0, 0.8)}
k_n = {uniform(4e3, 1.2e4)}    # N/m, contact
p = {uniform(0.0, 1.6e4)}      # N/m
""",
    )


if __name__ == "__main__":
    main()
