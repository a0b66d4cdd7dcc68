"""Results of the program `evolvent` for a case: wheels and meshes, natural modes."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.errors import BAD_INPUT, USAGE, EvolventError

if TYPE_CHECKING:
    import numpy as np

    from evolvent.signals.campbell import Excitation

KEYS = ("natural_frequency", "damping_ratio")


Row = list[tuple[float, float]] | None  # natural frequency and damping ratio of each mode


@dataclass(frozen=True)
class SpeedSetting:
    """Load that prescribes the speed of a wheel."""

    wheel: str
    number: int  # index of the load
    against: str
    factor: float  # ratio of its speed to that of the axis, counterclockwise positive

    def text(self, speed: float) -> str:
        """Return the setting for a constant speed of the axis [rad/s]; it also replaces a table."""
        load = f"{{kind: speed, against: {self.against}, value: {self.factor * speed!r}}}"
        return f"wheels.{self.wheel}.loads.{self.number}={load}"


@dataclass(frozen=True)
class Modes:
    """Modes over speeds."""

    values: dict[str, np.ndarray]  # natural_frequency [Hz], damping_ratio: dims (speed, mode)
    computed: np.ndarray  # whether there is a steady state, dims (speed)
    remark: str  # how the modes were computed


@dataclass(frozen=True)
class Gearbox:
    """A case as printed by `evolvent show`."""

    path: Path
    settings: tuple[str, ...]
    description: dict[str, Any]

    @classmethod
    def ask(cls, path: Path, settings: Sequence[str]) -> Gearbox:
        """Read a case with the program.

        Raises
        ------
        EvolventError
            The program rejects the case (message and exit code of the program), or it has no mesh.
        """
        description = json.loads(_run("show", path, settings))
        if not description["meshes"]:
            raise EvolventError(f"{path}: has no mesh, so there are no mesh orders")
        return cls(path, tuple(settings), description)

    @property
    def text(self) -> str:
        """The case with all defaults, as JSON, which is valid YAML."""
        return json.dumps(self.description["case"])

    @property
    def first_driving(self) -> str:
        """Wheel that drives the first mesh."""
        return str(self.description["case"]["meshes"][0]["driving"])

    def check_wheel(self, name: str) -> None:
        """Reject the name of a wheel that does not exist."""
        if name not in self.description["wheels"]:
            raise EvolventError(
                f"{self.path}: has no wheel `{name}`; there is "
                f"{', '.join(self.description['wheels'])}",
                USAGE,
            )

    def excitations(self, axis: str, mesh_orders: int, wheel_orders: int) -> list[Excitation]:
        """Orders of all meshes and wheels per revolution of the wheel `axis`; no duplicates."""
        from evolvent.signals.campbell import Excitation

        teeth = {
            wheel["name"]: wheel.get("teeth", 0) for wheel in self.description["case"]["wheels"]
        }
        rates = [
            ("mesh", mesh["name"], self._ratio(mesh["driving"], axis) * teeth[mesh["driving"]])
            for mesh in self.description["case"]["meshes"]
        ]
        rates += [("wheel", name, self._ratio(name, axis)) for name in teeth]
        found: list[Excitation] = []
        for kind, name, rate in rates:
            for order in range(1, 1 + (mesh_orders if kind == "mesh" else wheel_orders)):
                if not any(math.isclose(order * rate, e.order * e.per_turn) for e in found):
                    found.append(Excitation(kind, name, order, rate))
        return found

    def modes(self, axis: str, speed: np.ndarray) -> Modes:
        """Compute natural frequencies and damping ratios over speeds.

        If a load prescribes a speed, the modes are computed at each speed; otherwise once. Speeds
        without a steady state get linearly interpolated values, outside the range the nearest ones.

        Parameters
        ----------
        axis : wheel to which the speeds refer.
        speed : [rad/s].

        Raises
        ------
        EvolventError
            There is no steady state at any speed, or no mode vibrates.
        """
        import numpy as np

        setting = self._speed_setting(axis)
        if setting is None:
            rows: list[Row] = [self._modes_with()] * speed.size
            remark = "modes at the mean stiffness in the steady state of the case, for all speeds"
        else:
            rows, refusal = self._modes_over(setting, speed)
            remark = (
                f"modes at the mean stiffness, at {speed.size} speeds; {setting.wheel} has a "
                "prescribed speed and does not vibrate, as with infinite inertia"
            )
            if refusal is not None:
                missing = rows.count(None)
                remark += f"; at {missing} of the speeds the nearest modes are used ({refusal})"
        computed = np.array([row is not None for row in rows])
        most = max(len(row) for row in rows if row is not None)
        if most == 0:
            raise EvolventError(f"{self.path}: has no natural frequency")
        table = np.full((len(KEYS), speed.size, most), np.nan)
        for i, row in enumerate(rows):
            for j, mode in enumerate(sorted(row or [])):
                table[:, i, j] = mode
        for k, j in np.ndindex(len(KEYS), most):
            known = computed & np.isfinite(table[k, :, j])
            table[k, ~computed, j] = np.interp(speed[~computed], speed[known], table[k, known, j])
        return Modes(dict(zip(KEYS, table, strict=True)), computed, remark)

    def _modes_over(
        self, setting: SpeedSetting, speed: np.ndarray
    ) -> tuple[list[Row], EvolventError | None]:
        """Compute modes at each speed (None without a steady state), and the first error."""
        rows: list[Row] = []
        refusal = None
        for value in speed.tolist():
            try:
                rows.append(self._modes_with(setting.text(value)))
            except EvolventError as error:
                if error.code != BAD_INPUT:
                    raise
                rows.append(None)
                refusal = refusal or error
        if refusal is not None and not any(rows):
            raise refusal
        return rows, refusal

    def _ratio(self, wheel: str, axis: str) -> float:
        """Revolutions of a wheel per revolution of the axis."""
        wheels = self.description["wheels"]
        return abs(float(wheels[wheel]["speed_ratio"]) / float(wheels[axis]["speed_ratio"]))

    def _speed_setting(self, axis: str) -> SpeedSetting | None:
        """Return the load that prescribes a speed, or None."""
        first = self.description["case"]["meshes"][0]
        wheels = self.description["wheels"]
        sense = -self.description["meshes"][first["name"]]["flank"]
        for wheel in self.description["case"]["wheels"]:
            name = wheel["name"]
            to_driving = wheels[name]["speed_ratio"] / wheels[first["driving"]]["speed_ratio"]
            factor = math.copysign(self._ratio(name, axis), sense * to_driving)
            for i, load in enumerate(wheel["loads"]):
                if load["kind"] == "speed":
                    return SpeedSetting(name, i, load["against"], factor)
        return None

    def _modes_with(self, *more: str) -> list[tuple[float, float]]:
        """Natural frequency [Hz] and damping ratio of the oscillatory modes."""
        description = json.loads(_run("modes", self.path, (*self.settings, *more), "--mean"))
        modes = [(mode[KEYS[0]], mode[KEYS[1]]) for mode in description["modes"]]
        return [(frequency, damping) for frequency, damping in modes if frequency is not None]


def _run(command: str, path: Path, settings: Sequence[str], *options: str) -> str:
    """Run the program and return its JSON output."""
    from evolvent.sweep.program import call, find_program, last_message

    words = [word for setting in settings for word in ("--set", setting)]
    done = call(find_program(), command, path, *options, *words, "--json")
    if done.returncode != 0:
        raise EvolventError(last_message(done.stderr), done.returncode)
    return done.stdout
