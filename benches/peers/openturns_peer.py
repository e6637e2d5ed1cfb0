"""A surrogate in OpenTURNS, in the two ways that suggest themselves."""

from __future__ import annotations

import numpy as np
import openturns as ot

from surrogate import Surrogate

# Points whose basis matrix is made at once; the time per point hardly depends on it.
BLOCK = 1000

ot.TBB.SetThreadsNumber(1)


class OpenTurnsExpansion:
    """The surrogate as a basis of product polynomials, the chosen functions of it, and their coefficients."""

    def __init__(self, surrogate: Surrogate) -> None:
        dimension = len(surrogate.inputs)
        marginals = [ot.Uniform(*bounds) for bounds in zip(surrogate.lower, surrogate.upper, strict=True)]
        enumeration = ot.LinearEnumerateFunction(dimension)
        self.distribution = ot.JointDistribution(marginals)
        self.basis = ot.OrthogonalProductPolynomialFactory([ot.LegendreFactory()] * dimension, enumeration)
        self.transformation = ot.DistributionTransformation(self.distribution, self.basis.getMeasure())
        self.positions = ot.Indices([enumeration.inverse(index) for index in surrogate.indices])
        self.functions = ot.FunctionCollection([self.basis.build(position) for position in self.positions])
        self.coefficients = surrogate.physical_coefficients()

    def metamodel(self) -> ot.Function:
        """The metamodel of a `FunctionalChaosResult`: what OpenTURNS gives to those who built a chaos with it."""
        # The training data serve its residuals only, which nobody asks for here.
        inputs, outputs = self.distribution.getSample(2), ot.Sample(2, self.coefficients.shape[1])
        result = ot.FunctionalChaosResult(
            inputs,
            outputs,
            self.distribution,
            self.transformation,
            self.transformation.inverse(),
            self.basis,
            self.positions,
            ot.Sample(self.coefficients),
            self.functions,
        )
        return result.getMetaModel()

    def by_basis_matrix(self, blocks: list[ot.Sample]) -> np.ndarray:
        """Values at blocks of points by `DesignProxy`, made for fits: all functions at all points, a matrix.

        Multiplied by the coefficients with NumPy. The fastest way to evaluate many outputs that was found in OpenTURNS.
        """
        chosen = ot.Indices(len(self.functions))
        chosen.fill()
        return np.concatenate([self._basis_matrix(block, chosen) @ self.coefficients for block in blocks])

    def _basis_matrix(self, block: ot.Sample, chosen: ot.Indices) -> np.ndarray:
        return np.asarray(ot.DesignProxy(self.transformation(block), self.functions).computeDesign(chosen))


def in_blocks(points: np.ndarray) -> list[ot.Sample]:
    """Points as samples of `BLOCK` points each."""
    return [ot.Sample(points[start : start + BLOCK]) for start in range(0, len(points), BLOCK)]
