"""What the tests share: shipped surrogates and studies, and studies of functions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import systems

import pcc

SHIPPED = Path(__file__).resolve().parents[2] / "surrogates"

OSCILLATOR = {"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}


@pytest.fixture(scope="session")
def shipped() -> Path:
    return SHIPPED


@pytest.fixture(scope="session")
def clutch() -> pcc.Surrogate:
    return pcc.load(SHIPPED / "clutch-r2.pcc")


@pytest.fixture(scope="session")
def points() -> np.ndarray:
    random = np.random.default_rng(1)
    return np.column_stack([random.uniform(0.0, 0.5, 1000), random.uniform(15.2e6, 16.8e6, 1000)])


@pytest.fixture
def oscillator() -> pcc.Study:
    return pcc.Study(OSCILLATOR, systems.oscillator)


@pytest.fixture(scope="session")
def built() -> pcc.Surrogate:
    return pcc.build(pcc.Study(OSCILLATOR, systems.oscillator))
