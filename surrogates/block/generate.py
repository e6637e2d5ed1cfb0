"""Write the matrices of the study block: an elastic block sliding in contact.

A block in plane strain, 44 mm wide, 40 mm high, 10 mm thick: 9 x 10 bilinear
quadrilaterals, its top edge clamped, so that 10 x 10 nodes are free.  Its
bottom edge is pressed on a rigid surface that slides in the direction of x.

The contact of the bottom nodes is a layer of springs of k_n in total.  A node
with the share w of the edge that moves by v in the direction of y (away from
the surface) changes the contact force on the block by -k_n w v, and with it
the friction by -mu k_n w v in the direction of x.  On the left-hand side,

    M u'' + C u' + (E K_elastic + k_n K_contact + mu k_n K_friction) u = 0,

K_contact therefore holds w at (v, v), and K_friction w at (row u, column v):
friction does not work both ways, and K is not symmetric.

Degrees of freedom: u_1, v_1, u_2, v_2, ... from left to right, then upwards;
the first 20 are those of the contact.
"""
from pathlib import Path

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array

WIDTH, HEIGHT, THICKNESS = 0.044, 0.040, 0.010   # m
COLUMNS, ROWS = 9, 10                            # elements
POISSON = 0.3
DENSITY = 2500.0                                 # kg/m^3


def element(width, height):
    """Stiffness (for E = 1 Pa) and mass of a quadrilateral."""
    elasticity = np.array([[1 - POISSON, POISSON, 0],
                           [POISSON, 1 - POISSON, 0],
                           [0, 0, 0.5 - POISSON]])
    elasticity /= (1 + POISSON) * (1 - 2 * POISSON)
    stiffness, mass = np.zeros((2, 8, 8))
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for x, y in corners / np.sqrt(3):            # Gauss points
        factor_x, factor_y = 1 + corners[:, 0] * x, 1 + corners[:, 1] * y
        shape = factor_x * factor_y / 4
        strain = np.zeros((3, 8))                # eps_x, eps_y, gamma_xy
        strain[0, 0::2] = strain[2, 1::2] = corners[:, 0] * factor_y / 4
        strain[1, 1::2] = strain[2, 0::2] = corners[:, 1] * factor_x / 4
        strain[0] *= 2 / width
        strain[1] *= 2 / height
        strain[2, 0::2] *= 2 / height
        strain[2, 1::2] *= 2 / width
        volume = THICKNESS * width * height / 4
        stiffness += volume * strain.T @ elasticity @ strain
        mass += DENSITY * volume * np.kron(np.outer(shape, shape), np.eye(2))
    return stiffness, mass


def assemble(clamped=True):
    """M, K_elastic, K_contact, K_friction as dense arrays."""
    per_row = COLUMNS + 1
    size = 2 * per_row * (ROWS + 1)
    mass, elastic, contact, friction = np.zeros((4, size, size))
    k_element, m_element = element(WIDTH / COLUMNS, HEIGHT / ROWS)
    for row in range(ROWS):
        for column in range(COLUMNS):
            first = row * per_row + column
            nodes = np.array([first, first + 1,
                              first + per_row + 1, first + per_row])
            dofs = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
            elastic[np.ix_(dofs, dofs)] += k_element
            mass[np.ix_(dofs, dofs)] += m_element
    for node in range(per_row):
        share = (0.5 if node in (0, COLUMNS) else 1.0) / COLUMNS
        u, v = 2 * node, 2 * node + 1
        contact[v, v] = share
        friction[u, v] = share
    free = 2 * per_row * ROWS if clamped else size
    return [clean(matrix[:free, :free])
            for matrix in (mass, elastic, contact, friction)]


def clean(matrix):
    """Set to zero what only rounding has kept from being zero."""
    return np.where(abs(matrix) > 1e-12 * abs(matrix).max(), matrix, 0.0)


def main():
    folder = Path(__file__).parent
    names = ("M", "K_elastic", "K_contact", "K_friction")
    units = ("kg", "N/m for a Young's modulus of 1 Pa",
             "N/m for k_n = 1 N/m", "N/m for mu k_n = 1 N/m")
    for name, unit, matrix in zip(names, units, assemble()):
        symmetric = name != "K_friction"
        if symmetric:
            matrix = (matrix + matrix.T) / 2
        mmwrite(folder / f"{name}.mtx", coo_array(matrix),
                comment=f" {name} of the study block, in {unit}",
                field="real",
                symmetry="symmetric" if symmetric else "general")


if __name__ == "__main__":
    main()
