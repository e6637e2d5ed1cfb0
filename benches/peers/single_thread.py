"""Holds NumPy and OpenTURNS to one thread. They read these variables once, so import this module before them."""

import os

for _variable in (
    "MKL_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "OPENTURNS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
):
    os.environ[_variable] = "1"
