"""Writes the fixtures of the Matrix Market reader with scipy.io.mmwrite; run in this folder."""
import numpy as np
import scipy.io
import scipy.sparse as sparse

general = np.array([[0.1 + 0.2, 0.0, -1e-300], [1 / 3, 2.5e17, 0.0], [0.0, -7.0, 1e22], [np.pi, 0.0, 5e-324]])
lower = np.tril(np.array([[4.0, 0.0, 0.0], [-1 / 3, 0.0, 0.0], [0.0, 1e-9, 6.0]]))
symmetric = lower + lower.T - np.diag(np.diag(lower))
skew = np.array([[0.0, 0.7, 0.0], [-0.7, 0.0, -1 / 3], [0.0, 1 / 3, 0.0]])
integer = np.array([[1, 0, -3], [0, 2**53, 0]])
for name, matrix, symmetry in [
    ("general", general, "general"),
    ("symmetric", symmetric, "symmetric"),
    ("skew", skew, "skew-symmetric"),
    ("integer", integer, "general"),
]:
    scipy.io.mmwrite(f"{name}_array.mtx", matrix, symmetry=symmetry, precision=17)
    scipy.io.mmwrite(f"{name}_coordinate.mtx", sparse.coo_array(matrix), symmetry=symmetry, comment="by SciPy")
    assert (scipy.io.mmread(f"{name}_array.mtx") == matrix).all()
    assert (scipy.io.mmread(f"{name}_coordinate.mtx").toarray() == matrix).all()
