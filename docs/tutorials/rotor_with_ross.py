"""A rotor that ROSS assembles, with uncertain bearings and an uncertain seal, at 30 speeds.

pip install ./python ross-rotordynamics==2.3.0 "plotly<7"     # Python 3.11
python docs/tutorials/rotor_with_ross.py                      # writes rotor.pcc and two figures
python docs/tutorials/rotor_with_ross.py 2000                 # beside as many rotors that ROSS solves itself
"""

import sys
import time
from pathlib import Path

import numpy as np
import ross

import pcc

STEEL = ross.Material("steel", rho=7810, E=211e9, G_s=81.2e9)
SHAFT = [ross.ShaftElement(L=0.2, idl=0.0, odl=0.06, material=STEEL, beta=2e-6) for _ in range(6)]
DISKS = [ross.DiskElement.from_geometry(n=n, material=STEEL, width=0.04, i_d=0.06, o_d=0.36) for n in (2, 6)]
SPEEDS = np.linspace(250.0, 7500.0, 30)  # rpm
RATED = 4000.0  # rpm


def supports(k, c, q):
    """Two bearings of stiffness k (vertically 0.7 k) and damping c, and a seal whose swirl grows with the speed."""
    bearings = [ross.BearingElement(n=n, kxx=k, kyy=0.7 * k, cxx=c, cyy=c) for n in (0, 5)]
    swirl, none = q * SPEEDS / RATED, np.zeros_like(SPEEDS)
    seal = ross.SealElement(n=2, kxx=none, cxx=none, kxy=swirl, kyx=-swirl, frequency=np.pi / 30 * SPEEDS)
    return [*bearings, seal]


ROTOR = ross.Rotor(SHAFT, DISKS, supports(1e7, 3e3, 1e5))
# Bending, which torsion and axial motion do not touch.
BENDING = np.ix_(*[[i for i in range(ROTOR.ndof) if i % ROTOR.number_dof in (0, 1, 3, 4)]] * 2)


def matrices(k, c, q, speed):
    """M, C and K of shaft and disks, which ROSS has assembled once, on these supports."""
    omega = np.pi / 30 * speed  # rad/s
    damping, stiffness = ROTOR.C0 + omega * ROTOR.G0, ROTOR.K0.copy()
    at = {nominal.n: nominal for nominal in ROTOR.bearing_elements}
    for support in supports(k, c, q):
        where = np.ix_(*[list(at[support.n].dof_global_index.values())] * 2)
        damping[where] += support.C(omega)
        stiffness[where] += support.K(omega)
    return ROTOR.M0[BENDING], damping[BENDING], stiffness[BENDING]


def build():
    inputs = {
        "k": pcc.normal(1e7, cv=0.1, unit="N/m", label="bearing stiffness"),
        "c": pcc.lognormal(3e3, cv=0.2, unit="N·s/m", label="bearing damping"),
        "q": pcc.uniform(5e4, 2.5e5, unit="N/m", label="cross-coupled stiffness of the seal at 4000 rpm"),
        "speed": pcc.uniform(SPEEDS[0], SPEEDS[-1], unit="rpm"),
    }
    return pcc.build(pcc.Study(inputs, matrices, name="rotor", spectrum={"modes": [1, 2, 3, 4]}))


def check(surrogate, number):
    """Shares of unstable rotors by ROSS, and by the surrogate at the same points."""
    random = np.random.default_rng(1)
    sigma = np.sqrt(np.log(1 + 0.2**2))
    k, q = random.normal(1e7, 1e6, number), random.uniform(5e4, 2.5e5, number)
    c = random.lognormal(np.log(3e3) - sigma**2 / 2, sigma, number)
    rotors = (ross.Rotor(SHAFT, DISKS, supports(*point)) for point in zip(k, c, q))
    by_ross = np.empty((len(SPEEDS), number), dtype=bool)
    for i, rotor in enumerate(rotors):
        for j, speed in enumerate(SPEEDS):
            found = np.linalg.eigvals(rotor.A(np.pi / 30 * speed))
            # Free motion of the whole rotor is none of ROSS's modes, and torsion is undamped.
            by_ross[j, i] = found[np.abs(found) > 0.1].real.max() > 1e-6
    for speed, of_ross in zip(SPEEDS, by_ross):
        ours = surrogate.max_re({"k": k, "c": c, "q": q, "speed": speed}) > 0.0
        shares = f"{100 * of_ross.mean():6.2f} % by ROSS, {100 * ours.mean():6.2f} % here"
        print(f"{speed:6.0f} rpm: {shares}, {(ours != of_ross).sum()} differ")
    start = time.process_time()
    for point in zip(k[:10], c, q):
        rotor = ross.Rotor(SHAFT, DISKS, supports(*point))
        [rotor.run_modal(np.pi / 30 * speed) for speed in SPEEDS]
    print(f"a rotor at {len(SPEEDS)} speeds by ROSS: {(time.process_time() - start) / 10:.2f} s of processor time")


start = time.process_time()
surrogate = build()
built = time.process_time()
sweep, campbell = surrogate.sweep(speed=SPEEDS), surrogate.campbell(speed=SPEEDS)
print(sweep, f"processor time: build {built - start:.1f} s, answers {time.process_time() - built:.1f} s", sep="\n\n")
surrogate.save("rotor.pcc")
Path("rotor-stability.svg").write_text(sweep.svg, encoding="utf-8")
Path("rotor-campbell.svg").write_text(campbell.svg, encoding="utf-8")
if len(sys.argv) > 1:
    check(surrogate, int(sys.argv[1]))
