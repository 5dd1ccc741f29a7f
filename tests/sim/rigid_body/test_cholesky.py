"""Small linear systems against numpy."""

import numpy as np

from sim.rigid_body.cholesky import factor, solve


def test_it_solves_what_numpy_solves() -> None:
    rng = np.random.default_rng(3)
    for m in range(1, 7):
        square = rng.normal(size=(m, m))
        a = np.full((6, 6), np.nan)
        a[:m, :m] = square @ square.T + 0.1 * np.eye(m)
        whole, b = a[:m, :m].copy(), rng.normal(size=6)
        x = b.copy()
        factor(a, m)
        solve(a, x, m)
        np.testing.assert_allclose(x[:m], np.linalg.solve(whole, b[:m]), rtol=1e-9)
        np.testing.assert_array_equal(x[m:], b[m:])
