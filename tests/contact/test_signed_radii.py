"""One closed form for external and internal wheels: radii of an internal wheel are negative.

The flanks are constructed as involutes of their base circles, and their distance as that of two
curves, with 30 digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import Kernel, _at

PSI_A, PSI_B, U_A, U_B = 1, 2, slice(3, 5), slice(5, 7)
OMEGA, PSI_DOT_A, PSI_DOT_B, V_A, V_B = 7, 8, 9, slice(10, 12), slice(12, 14)
N_MOTION, N_LOCAL = 14, 21
NAMES = ("h", "h_dot", "rho_a", "rho_b", "v_t")
SHARES = (0.25, 0.75)  # position of the force between the flanks, as in closed_form_calls


@dataclass(frozen=True)
class Wheels:
    """Two wheels in the nominal basis (t_0, e_0), with the driving axis at its origin."""

    r_ba: float
    r_bb: float
    rho_a0: float
    sigma: int = 1
    alpha: float = 0.35

    @property
    def rho_0(self) -> float:
        """Length of the line of action, negative with an internal wheel."""
        return (self.r_ba + self.r_bb) * float(mp.tan(self.alpha))

    @property
    def ratios(self) -> tuple[float, float]:
        """Nominal speeds over that of the driving wheel."""
        return 1.0, -self.r_ba / self.r_bb

    def constants(self) -> np.ndarray:
        """Constants of the kernel."""
        return np.array(
            [self.sigma, self.r_ba, self.r_bb, self.rho_0, *self.ratios, self.rho_a0], float
        )

    def flanks(self, q: list) -> tuple:
        """Return the flanks as curves over the direction of their normal, and rho of both."""

        def curve(axle, radius, rho, side):  # of the point K + rho e, K = axle + radius t
            def at(delta):
                t = mp.matrix([mp.cos(delta), mp.sin(delta)])
                e = mp.matrix([-mp.sin(delta), mp.cos(delta)])
                return axle + side * (radius * t + rho(delta) * e)

            return at

        r_ba, r_bb, rho_0 = mp.mpf(self.r_ba), mp.mpf(self.r_bb), mp.mpf(self.rho_0)
        rho_a0 = mp.mpf(self.rho_a0) - self.sigma * r_ba * q[0]  # wheel A has turned by theta
        axle_b = mp.matrix([r_ba + r_bb, rho_0]) + mp.matrix(q[U_B])

        def rho_a(delta):
            return rho_a0 - r_ba * (delta + self.sigma * q[PSI_A])

        def rho_b(delta):
            return rho_0 - rho_a0 - r_bb * (delta + self.sigma * q[PSI_B])

        return (
            curve(mp.matrix(q[U_A]), r_ba, rho_a, 1),
            curve(axle_b, r_bb, rho_b, -1),
            rho_a,
            rho_b,
        )

    def contact(self, q: list) -> list:
        """Return h, rho_A and rho_B at the stationary distance of the two curves."""
        on_a, on_b, rho_a, rho_b = self.flanks(q)

        def stationary(one, other):
            apart = on_b(other) - on_a(one)
            # the curves have the tangent t at the direction of their normal
            return [apart[0] * mp.cos(delta) + apart[1] * mp.sin(delta) for delta in (one, other)]

        one, other = mp.findroot(stationary, (mp.mpf(0), mp.mpf(1e-4)), tol=1e-50)
        apart = on_b(other) - on_a(one)
        gap = -apart[0] * mp.sin(one) + apart[1] * mp.cos(one)
        return [-gap, rho_a(one), rho_b(other), one]

    def values(self, q: list) -> list:
        """Return the values in `NAMES`: the rate by differentiation, sliding from velocities."""

        def moved(time):
            rates = [q[OMEGA], q[PSI_DOT_A], q[PSI_DOT_B], *q[V_A], *q[V_B]]
            positions = [q[0], q[PSI_A], q[PSI_B], *q[U_A], *q[U_B]]
            return [x + time * v for x, v in zip(positions, rates, strict=True)] + list(q[OMEGA:])

        h, rho_a, rho_b, delta = self.contact(q)
        h_dot = mp.diff(lambda time: self.contact(moved(time))[0], 0)
        omega_a = self.ratios[0] * q[OMEGA] + q[PSI_DOT_A]
        omega_b = self.ratios[1] * q[OMEGA] + q[PSI_DOT_B]
        t = mp.matrix([mp.cos(delta), mp.sin(delta)])
        axles = mp.matrix(q[V_A]) - mp.matrix(q[V_B])
        # counterclockwise is from t_0 to e_0 if sigma is -1
        arms = (rho_a - SHARES[0] * h) * omega_a + (rho_b - SHARES[1] * h) * omega_b
        return [h, h_dot, rho_a, rho_b, self.sigma * arms + (axles.T * t)[0]]


WHEELS = {
    "external": Wheels(0.2, 0.3, 0.08),
    "internal": Wheels(0.2, -0.5, 0.08),
    "internal, other flank": Wheels(0.2, -0.5, 0.08, sigma=-1),
    "internal, nearly alike": Wheels(0.2, -0.26, 0.05),
    "internal wheel drives": Wheels(-0.5, 0.2, -0.19),
}


def motion(random: np.random.Generator) -> np.ndarray:
    """Return local variables: positions within 20 um, speeds within 1."""
    q = np.zeros(N_LOCAL)
    q[:OMEGA] = random.uniform(-2e-5, 2e-5, OMEGA)
    q[OMEGA:N_MOTION] = random.uniform(-1, 1, N_MOTION - OMEGA)
    q[0] = 0.0  # rho_A0 is that at theta
    return q


@pytest.mark.parametrize("wheels", WHEELS.values(), ids=WHEELS.keys())
def test_closed_form_is_the_distance_of_the_flanks_drawn_as_involutes(
    kernel: Kernel, wheels: Wheels
):
    q = motion(np.random.default_rng(3))
    values, gradients = np.empty(5), np.empty((5, N_LOCAL))
    constants = wheels.constants()
    kernel.library.closed_form_contact(*map(_at, (constants, q, values, gradients)))
    with mp.workdps(30):
        exact = [mp.mpf(x) for x in q]
        expected = wheels.values(exact)
        slopes = [
            mp.diff(lambda x, j=j: wheels.contact([*exact[:j], x, *exact[j + 1 :]])[0], exact[j])
            for j in range(1, OMEGA)
        ]
    # rounding of the positions [m] for h, and of lengths and speeds of order 1 for the others
    tolerance = {"h": 1e-19, "h_dot": 1e-15, "rho_a": 1e-16, "rho_b": 1e-16, "v_t": 1e-15}
    for name, value, right in zip(NAMES, values, expected, strict=True):
        assert abs(value - float(right)) <= tolerance[name], name
    np.testing.assert_allclose(gradients[0, 1:OMEGA], [float(x) for x in slopes], atol=1e-14)
