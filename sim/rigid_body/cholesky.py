"""Linear systems of a few unknowns, compiled: a symmetric matrix is factored once and solved for any right-hand side."""

import math

from sim.compiled.kernel import kernel


@kernel
def factor(a, m) -> None:
    """Overwrite the lower triangle of the positive definite matrix a[:m, :m] with its Cholesky factor."""
    for i in range(m):
        for j in range(i + 1):
            rest = a[i, j]
            for k in range(j):
                rest -= a[i, k] * a[j, k]
            a[i, j] = math.sqrt(rest) if i == j else rest / a[j, j]


@kernel
def solve(a, b, m) -> None:
    """Overwrite b[:m] with the solution of the system that `factor` has factored into `a`."""
    for i in range(m):
        for k in range(i):
            b[i] -= a[i, k] * b[k]
        b[i] /= a[i, i]
    for i in range(m - 1, -1, -1):
        for k in range(i + 1, m):
            b[i] -= a[k, i] * b[k]
        b[i] /= a[i, i]
