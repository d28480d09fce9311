"""Cost of regimes: a steady press, a machine under a torque over time, machines at two speeds; writes regimes.md.

python results/motion/regimes.py
"""

import sys
import tomllib
from pathlib import Path

import numpy as np
from cases import CASES

sys.path.append(str(Path(__file__).parents[1]))
from measuring import least_time, sample

from engine import Machine, Scene, scene_numbers
from engine.compiling.threads import set_threads
from engine.parts.actions import TableMoment
from engine.parts.regimes import RunRegime, SteadyRegime
from sweeps.text.templates import template_text

HERE = Path(__file__).parent
VARIANTS, CYCLES = 2000, 20.0
ACCURACIES = (1e-4, 1e-6, 1e-9)
ASKED = ("work.speed_fluctuation", "work.mean_speed", "work.multiplier", "work.motor_moment_rms")


def settled_press() -> list[str]:
    """Lines of a table: accuracy, time per variant, median and maximum estimates."""
    case = CASES["crank_press"]
    scene = case.scene.model_copy(update={"regimes": {"work": SteadyRegime(type="steady")}})
    varied = sample(case, VARIANTS)
    lines = [
        f"| accuracy | µs per variant | {' | '.join(f'{name} (estimate: median, maximum)' for name in ASKED)} |",
        "|---" * (2 + len(ASKED)) + "|",
    ]
    for accuracy in ACCURACIES:
        machine = Machine(scene, ASKED, varied=tuple(varied), accuracy=accuracy)
        seconds = least_time(lambda machine=machine: machine.evaluate(varied)) / VARIANTS
        outcome = machine.evaluate(varied)
        figures = [outcome.errors[name] / np.abs(outcome.summaries[name]) for name in ASKED]
        told = " | ".join(f"{np.median(figure):.1e}, {figure.max():.1e}" for figure in figures)
        lines.append(f"| {accuracy:.0e} | {seconds * 1e6:.1f} | {told} |")
    return lines


def machine_over_time() -> str:
    """A sentence: time of one machine whose torque depends on time, and its estimated error."""
    case = CASES["slider_crank"]
    push = TableMoment(
        type="table", on="crank", over_time=[0.0, 1.0, 3.0], moment=[0.0, 2.0, 0.0], interpolation="linear"
    )
    run = RunRegime(type="run", from_speed=case.speed, cycles=CYCLES)
    moments = {**case.scene.moments, "push": push}
    scene = case.scene.model_copy(update={"moments": moments, "regimes": {"go": run}})
    machine = Machine(Scene.model_validate(scene.model_dump(exclude_none=True)), ["go.time", "go.final_speed"])
    seconds = least_time(lambda: machine.evaluate({}))
    outcome = machine.evaluate({})
    figure = float(outcome.errors["go.final_speed"][0] / outcome.summaries["go.final_speed"][0])
    turns = f"{CYCLES:g} turns of the slider-crank"
    return f"{seconds * 1e3:.0f} ms for {turns}; estimated error of its final speed {figure:.0e}."


CLUTCH = {"type": "friction_clutch", "shaft": "motor_shaft", "capacity": "20 N m", "engagement": "0.1 s"}
FLUID = {
    "type": "fluid_coupling",
    "shaft": "motor_shaft",
    "diameter": "200 mm",
    "density": "860 kg/m3",
    "slip": [0, 0.03, 0.1, 1],
    "coefficient": [0, 0.002, 0.005, 0.008],
    "interpolation": "linear",
}
START = {"type": "run", "from_speed": "0 rad/s", "from_shaft_speed": "240 rad/s", "time": "2 s"}


def coupled_feeder(coupling: dict[str, object], regime: dict[str, object]) -> Scene:
    """The slider-crank behind a coupling, its motor on a shaft that turns four times as fast."""
    given = CASES["slider_crank"].scene.model_dump(exclude_none=True, mode="json")
    motor = given["moments"]["motor"] | {"on": "motor_shaft", "stall_moment": 5.0, "no_load_speed": 240.0}
    given["shafts"] = {"motor_shaft": {"geared_to": "crank", "ratio": 4.0, "inertia": 0.02}}
    given["moments"] |= {"motor": motor}
    return Scene.model_validate(given | {"couplings": {"coupling": coupling}, "regimes": {"go": regime}})


def elastic_pump(backlash: bool) -> Scene:
    """The template of a pump on an elastic shaft, started from rest."""
    given = tomllib.loads(template_text("driven_machine"))
    run = given["elements"]["coupling"]["run"]
    if not backlash:
        del run["backlash"]
    return Scene.model_validate(given)


def two_speeds() -> list[str]:
    """Lines of a table: machine, variants, time per variant."""
    path, asked = "moments.motor.stall_moment", ("go.time", "go.coupling_heat", "go.final_speed")
    cases = (
        ("start through a clutch, 2 s", coupled_feeder(CLUTCH, START), asked, 512),
        ("start through a fluid coupling, 2 s", coupled_feeder(FLUID, START), asked, 512),
        ("steady motion behind a fluid coupling", coupled_feeder(FLUID, {"type": "steady"}), ("go.mean_speed",), 64),
        ("start on an elastic shaft, 0.3 s", elastic_pump(backlash=False), ("coupling.run_greatest_moment",), 128),
        ("the same through a backlash of 1°", elastic_pump(backlash=True), ("coupling.run_greatest_moment",), 128),
    )
    lines = ["| machine | variants | µs per variant |", "|---|---|---|"]
    for title, scene, names, count in cases:
        varied = {path: scene_numbers(scene)[path].value * np.linspace(0.7, 1.4, count)}
        machine = Machine(scene, names, varied=(path,))
        seconds = least_time(lambda machine=machine, varied=varied: machine.evaluate(varied)) / count
        lines.append(f"| {title} | {count} | {seconds * 1e6:.0f} |")
    return lines


def main() -> None:
    set_threads(1)
    lines = [
        "# Cost of regimes",
        "",
        "CPU time on one thread, the minimum of some rounds, with cuts and error estimates. Remade by",
        "`python results/motion/regimes.py`.",
        "",
        f"## Steady state of the crank press with an induction motor, {VARIANTS} variants",
        "",
        *settled_press(),
        "",
        "## One machine under a torque over time",
        "",
        machine_over_time(),
        "",
        "## Two speeds",
        "",
        *two_speeds(),
        "",
    ]
    (HERE / "regimes.md").write_text("\n".join(lines), encoding="utf8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
