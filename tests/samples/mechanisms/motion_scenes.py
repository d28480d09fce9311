"""Small machines in motion, written short, what is asked of them, and the same machine by hand in mpmath.

One scene holds all masses and actions that the tests use; a regime lets `only` some of them act, and masses may be 0.
So the tests share a few compiled structures, and a machine whose inertia happens to be constant goes the same way
through the numerical methods as any other.
"""

import math
from typing import NamedTuple

import machines
import numpy as np
from closed_forms import slider_motion
from mpmath import mp

from engine import Machine, Scene, Verdict

RADIUS, ROD, RATIO = 0.05, 0.2, 7.5
CRANK_INERTIA, RAM_MASS, ECCENTRIC_MASS, ECCENTRICITY = 0.02, 3.0, 2.0, 0.03
GRAVITY = 9.81
INERTIA, SHAFT_INERTIA = 0.4, 0.004
# Of the pendulum: its mass, the distance of that from the pivot, and its inertia about its mass center; the greatest
# moment of its weight, and its inertia about the pivot.
SWUNG_MASS, ARM, OWN_INERTIA = 2.0, 0.25, 0.05
WEIGHT, SWUNG_INERTIA = SWUNG_MASS * GRAVITY * ARM, OWN_INERTIA + SWUNG_MASS * ARM**2

# Moments with a jump at 1 rad, and over time with bends.
BY_ANGLE = ([0.0, 1.0, 1.0, 4.0, 2 * math.pi], [5.0, 2.0, -1.0, 3.0, 5.0])
BY_TIME = ([0.0, 1.0, 3.0, 10.0], [5.0, 2.0, 4.0, 1.0])


def _moment(kind: str, on: str = "crank", **numbers: object) -> dict:
    return {"type": kind, "on": on, **numbers}


MOMENTS = {
    "brake": _moment("block_brake", force=20.0, friction=0.2, radius=0.1, blocks=2),
    "push": _moment("constant", moment=3.0, role="driving"),
    "load": _moment("constant", moment=-2.0),
    "rub": _moment("against_motion", moment=0.4),
    "oil": _moment("linear_drag", coefficient=0.05),
    "fan": _moment("quadratic_drag", coefficient=0.001),
    "by_angle": _moment("table", over_angle=BY_ANGLE[0], moment=BY_ANGLE[1], interpolation="linear"),
    "by_time": _moment("table", over_time=BY_TIME[0], moment=BY_TIME[1], interpolation="linear"),
    "nothing": _moment("table", over_time=[0.0, 1.0], moment=[0.0, 0.0], interpolation="linear"),
    "dc": _moment("dc_motor", no_load_speed=100.0, stall_moment=20.0),
    "induction": _moment(
        "induction_motor", "motor_shaft", synchronous_speed=150.0, breakdown_moment=2.5, breakdown_slip=0.2
    ),
}
# A cut from 20 mm to 10 mm before the high end of the stroke: it sets in with a jump, grows, and ends with a jump.
CUT = {
    "type": "table",
    "on": "B",
    "angle": math.pi,
    "slider": "ram",
    "measured_from": "high end",
    "over_stroke": [0.01, 0.02],
    "force": [900.0, 500.0],
    "interpolation": "linear",
    "outside": "zero",
    "acts": "against",
}
CLUTCH = {"type": "friction_clutch", "shaft": "motor_shaft", "capacity": 4.0}
FLUID = {
    "type": "fluid_coupling",
    "shaft": "motor_shaft",
    "diameter": 0.2,
    "density": 860.0,
    "slip": [0.0, 1.0],
    "coefficient": [0.0, 1e-3],
    "interpolation": "linear",
}


def slider_crank(regimes: dict, speed: float = 10.0, flywheel: float = 0.0, **changes: dict) -> dict:
    """A slider-crank with an unbalanced crank, a light rod, and a heavy ram that slides along x.

    Keyword arguments change numbers of the moments.
    """
    every = [*MOMENTS, "cut", "gravity"]
    return machines.slider_crank(RADIUS, ROD, speed, "drive") | {
        "gravity": GRAVITY,
        "bodies": {
            "eccentric": {"link": "crank", "mass": ECCENTRIC_MASS, "x": ECCENTRICITY, "inertia": CRANK_INERTIA},
            "ram_body": {"link": "ram", "mass": RAM_MASS},
        },
        "shafts": {"motor_shaft": {"geared_to": "crank", "ratio": RATIO}},
        "moments": {name: moment | changes.get(name, {}) for name, moment in MOMENTS.items()},
        "forces": {"cut": CUT},
        "flywheel": {"inertia": flywheel, "speed_fluctuation": 0.05},
        "regimes": {name: _regime(regime, every) for name, regime in regimes.items()},
    }


def rotor(regimes: dict, speed: float = 10.0, **changes: dict) -> dict:
    """The slider-crank with no mass but a rotor of `INERTIA`, which is constant, though not by its structure."""
    scene = slider_crank(regimes, speed, **changes)
    scene["bodies"]["ram_body"]["mass"] = 0.0
    scene["bodies"]["eccentric"] |= {"mass": 0.0, "inertia": INERTIA}
    return scene


def crank_alone(inertia: float, moments: dict, regimes: dict, speed: float, **parts: object) -> dict:
    """A crank of an inertia by its structure, in balance, and parts by their names."""
    return {
        "points": {"O": {"x": 0, "y": 0}},
        "input": machines.crank(length=0.1, speed=speed),
        "bodies": {"rotor": {"link": "crank", "mass": 1.0, "inertia": inertia}},
        "moments": moments,
        "regimes": regimes,
        **parts,
    }


def crank_on_dc_motor(inertia: float, stall: float, light: float, load: dict) -> dict:
    """A crank alone, with a load, on a DC motor with a stall torque and a no-load speed, steady."""
    motor = {"type": "dc_motor", "on": "crank", "stall_moment": stall, "no_load_speed": light}
    return crank_alone(inertia, {"dc": motor, "load": {"on": "crank", **load}}, {"on": {"type": "steady"}}, light)


def pendulum(regimes: dict) -> dict:
    """A heavy crank that swings about φ = −π/2, and no ram."""
    scene = slider_crank(regimes)
    scene["bodies"]["ram_body"]["mass"] = 0.0
    scene["bodies"]["eccentric"] |= {"mass": SWUNG_MASS, "x": ARM, "inertia": OWN_INERTIA}
    return scene


def behind(scene: dict, inertia: float = SHAFT_INERTIA, open_in: str = "", **couplings: dict) -> dict:
    """A machine with its DC motor on a shaft of its own inertia, behind a coupling that is open in some regimes."""
    scene["shafts"]["motor_shaft"]["inertia"] = inertia
    scene["moments"]["dc"] = scene["moments"]["dc"] | {"on": "motor_shaft"}
    for name in open_in.split():
        scene["regimes"][name]["off"].extend(couplings)
    return scene | {"couplings": couplings}


def _regime(regime: dict, every: list[str]) -> dict:
    """A regime with `only`, the names of what acts, in place of `off`."""
    only = regime["only"].split()
    assert set(only) <= set(every), only
    rest = {key: value for key, value in regime.items() if key != "only"}
    return rest | {"off": [action for action in every if action not in only]}


def run(only: str, **regime: object) -> dict:
    """A run, to go into `regimes`."""
    return {"type": "run", "only": only, **regime}


def steady(only: str) -> dict:
    """A steady regime."""
    return {"type": "steady", "only": only}


def of(regime: str, names: str) -> str:
    """Results of a regime, to be asked for."""
    return " ".join(f"{regime}.{name}" for name in names.split())


class Found(NamedTuple):
    """Values and error estimates by name, of all variants; verdicts; fields."""

    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    status: list[Verdict]
    fields: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> float:
        """Of the only variant, which is sound."""
        assert self.status == [Verdict.OK], self.status
        return float(self.values[name][0])

    def figure(self, name: str) -> float:
        """Error figure of the only variant."""
        return float(self.errors[name][0])

    def covers(self, name: str, value: float, room: float = 0.0) -> None:
        """A number is what it should be, within its own error estimate and `room`."""
        assert abs(self[name] - value) <= self.figure(name) + room, (name, self[name], value)

    def agrees(self, other: "Found", *names: str) -> None:
        """Numbers, by default all, are those of another machine, within the error estimates of both."""
        for name in names or self.values:
            self.covers(name, other[name], other.figure(name))


def ask(
    scene: dict,
    names: str,
    positions: int = 120,
    fields: str = "",
    varied: dict | None = None,
    accuracy: float | None = None,
) -> Found:
    """What a machine answers; names are separated by spaces."""
    varied = varied or {}
    machine = Machine(
        Scene.model_validate(scene),
        summaries=names.split(),
        fields=fields.split(),
        varied=list(varied),
        positions=positions,
        accuracy=accuracy,
    )
    outcome = machine.evaluate({path: np.array(values, float) for path, values in varied.items()})
    status = [Verdict(code) for code in outcome.status]
    return Found(outcome.summaries, outcome.errors, status, outcome.fields)


# The same machine by hand


def reduced(phi: object, ram: float = RAM_MASS, flywheel: float = 0.0) -> tuple:
    """I, dI/dφ, the transfer function of the ram and the moment of gravity of `slider_crank` at φ, in mpmath."""
    eccentric = mp.mpf(ECCENTRIC_MASS) * mp.mpf(ECCENTRICITY)
    _, rate, curve = slider_motion(phi, mp.mpf(RADIUS), mp.mpf(ROD), by=mp)
    fixed = mp.mpf(CRANK_INERTIA) + eccentric * mp.mpf(ECCENTRICITY) + mp.mpf(flywheel)
    return (
        fixed + mp.mpf(ram) * rate**2,
        2 * mp.mpf(ram) * rate * curve,
        rate,
        -eccentric * mp.mpf(GRAVITY) * mp.cos(phi),
    )


def inertia_at(phi: float) -> tuple[float, float]:
    """I(φ) of `slider_crank` without a flywheel, and its derivative, in floats."""
    _, rate, curve = slider_motion(phi, RADIUS, ROD)
    fixed = CRANK_INERTIA + ECCENTRIC_MASS * ECCENTRICITY**2
    return fixed + RAM_MASS * rate**2, 2 * RAM_MASS * rate * curve


def dc_moment(omega: object) -> object:
    """Moment of the DC motor of `MOMENTS`."""
    motor = MOMENTS["dc"]
    return mp.mpf(motor["stall_moment"]) * (1 - omega / mp.mpf(motor["no_load_speed"]))


def kloss_moment(omega: object) -> object:
    """Moment of the induction motor of `MOMENTS` on the crank, by 2 M_b/(s/s_b + s_b/s)."""
    motor = MOMENTS["induction"]
    most, slip_b = mp.mpf(motor["breakdown_moment"]), mp.mpf(motor["breakdown_slip"])
    slip = 1 - mp.mpf(RATIO) * omega / mp.mpf(motor["synchronous_speed"])
    return mp.mpf(RATIO) * 2 * most / (slip / slip_b + slip_b / slip)
