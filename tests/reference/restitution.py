"""The restitution that a force F_e (1 + chi h'/v0) really gives, and chi of the laws by name.

Between two free bodies v dv = -F_e (1 + chi v/v0) dh/m with v = h'. Dividing by 1 + chi v/v0 and
integrating over h, from v0 to 0 on approach and from 0 to -e' v0 on separation, both halves lose
and win the same elastic energy, so that

    chi (1 + e') = ln[(1 + chi)/(1 - chi e')]

whatever the elastic law. Prints the table of docs/reference/laws.md.
"""

from __future__ import annotations

import mpmath as mp

FACTORS = {
    "hunt_crossley": lambda e: 3 * (1 - e) / 2,
    "lankarani_nikravesh": lambda e: 3 * (1 - e**2) / 4,
    "flores": lambda e: 8 * (1 - e) / (5 * e),
    "gonthier": lambda e: (1 - e**2) / e,
    "lee_wang": lambda e: 3 * (1 - e) / 4,
}
DIVIDING = ("flores", "gonthier")  # chi divides by e: 0 is refused
NOMINAL = tuple(f"{tenth / 10:.1f}" for tenth in range(11))  # rows of the table


def factor(law: str, restitution: str | float) -> mp.mpf:
    """chi of a law for its nominal coefficient of restitution."""
    return FACTORS[law](mp.mpf(restitution))


def effective_restitution(chi: mp.mpf) -> mp.mpf:
    """Solve the equation for e' in (0, min(1, 1/chi)); e' = -1 is its other root."""
    if chi == 0:
        return mp.mpf(1)
    with mp.workdps(50):
        low, high = mp.mpf(0), min(mp.mpf(1), 1 / chi)
        for _ in range(120):  # halvings: 1e-36
            middle = (low + high) / 2
            lost = chi * (1 + middle) + mp.log(1 - chi * middle) - mp.log(1 + chi)
            low, high = (middle, high) if lost > 0 else (low, middle)
        return (low + high) / 2


def table() -> str:
    """Lay out the table of docs/reference/laws.md: nominal e, e' of every law, to four decimals."""
    lines = [
        f"| nominal $e$ | {' | '.join(f'`{law}`' for law in FACTORS)} |",
        "|---|" + "---|" * len(FACTORS),
    ]
    for nominal in NOMINAL:
        cells = [
            "refused"
            if law in DIVIDING and mp.mpf(nominal) == 0
            else f"{float(effective_restitution(factor(law, nominal))):.4f}"
            for law in FACTORS
        ]
        lines.append(f"| {nominal} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(), end="")
