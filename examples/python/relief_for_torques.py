"""Tip relief for a range of torques, by Optuna: one amount and one start for both wheels.

usage: python relief_for_torques.py [CASE.yaml] [TRIALS]
needs: pip install optuna

Each trial is a quasi-static analysis of the pair at the torques of the range, in this process. The
search minimises the largest peak-to-peak transmission error over the range.
"""

from __future__ import annotations

import sys
from pathlib import Path

import optuna

import evolvent

BAND = (50, 150, 3)  # torques of the pinion [N m]: from, to, steps
TIPS = {"pinion": 65.4, "gear": 108.6}  # tip diameters [mm]


def relief(amount: float, depth: float) -> dict[str, str]:
    """Settings of a relief [um] that starts below the tips by this depth [mm in diameter]."""
    return {
        f"wheels.{wheel}.tip_relief": f"{{amount: {amount} um, diameter: {tip - depth} mm}}"
        for wheel, tip in TIPS.items()
    }


def worst(case: Path, settings: dict[str, str]) -> float:
    """Largest peak-to-peak transmission error over the range of torques [um]."""
    analysis = evolvent.static(case, settings, torque=BAND, points=60)
    return 1e6 * float(analysis.peak_to_peak_transmission_error.max())


def main() -> None:
    """Search, and print the result."""
    examples = Path(__file__).resolve().parents[1]
    case = Path(sys.argv[1]) if len(sys.argv) > 1 else examples / "compliant-pair.yaml"
    trials = int(sys.argv[2]) if len(sys.argv) > 2 else 40

    def of_trial(trial: optuna.Trial) -> float:
        amount = trial.suggest_float("amount", 0, 30)
        return worst(case, relief(amount, trial.suggest_float("depth", 1, 5)))

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
    study.enqueue_trial({"amount": 0, "depth": 1})  # what there is without relief
    study.optimize(of_trial, n_trials=trials)
    found = study.best_params
    print(f"without relief {study.trials[0].value:.3f} um")
    print(f"with {found['amount']:.2f} um from {found['depth']:.2f} mm {study.best_value:.3f} um")


if __name__ == "__main__":
    main()
