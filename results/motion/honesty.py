"""Honesty of the error estimates of motion: random machines with induction motors against 80 bits.

    python results/motion/honesty.py --machines 1000 --seed 1

writes honesty.md next to this file. Measurements are kept in a file; the same command resumes where it stopped.
Estimates that were improved with some machines in view must be judged by others, of another seed.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np
from settled_path import Path80, UnderMotor

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))
from random_machines import SEED, Kind, Varied, kinds, machines

from engine import Machine, Scene, Verdict
from engine.compiling.threads import set_threads
from engine.scene.scene import scene_numbers

HERE = Path(__file__).parent
KINDS = ("slider-crank", "crank-rocker", "compressor", "turning moment", "press", "Scotch yoke")
# Number of machines drawn of each kind; the first of them are measured.
DRAWN = 167
# Only the motor depends on the speed: the closed formulas of other loads hold at constant speed.
AT_SPEED = ("springs.s.damping", "forces.drag.coefficient", "moments.drag.coefficient")
CYCLES, FROM = 2, 0.9
GO = ("final_speed", "time")
EVEN = ("speed_fluctuation", "speed_min", "speed_max", "mean_speed", "multiplier", "motor_moment_rms")
ASKED = tuple([f"go.{name}" for name in GO] + [f"even.{name}" for name in EVEN])
# Uncertainty of the reference.
REFERENCE = 1e-16
# Relative errors above this aren't rounding.
ROUNDED = 1e-13
# Median ratio of close estimates to their errors; the table gives the share that they would cover.
CLOSE = 10.0
# A relative estimate above this is useless.
LOST = 0.5


def with_motor(kind: Kind) -> Scene:
    """The machine with an induction motor on its crank, a flywheel, a run and a steady regime."""
    scene = kind.scene.model_dump()
    motor = {"type": "induction_motor", "on": kind.scene.input.link, "synchronous_speed": 10.0}
    motor |= {"breakdown_moment": 10.0, "breakdown_slip": 0.1}
    go = {"type": "run", "from_speed": 1.0, "cycles": CYCLES}
    parts = {"flywheel": {"inertia": 1.0}, "regimes": {"even": {"type": "steady"}, "go": go}}
    return Scene.model_validate(scene | parts | {"moments": scene["moments"] | {"motor": motor}})


def driven(kind: Kind, seed: int) -> Varied:
    """Machines with breakdown slips of 0.5 to 20 %, and flywheels for a δ from 0.003 to 3, or none."""
    random, varied = np.random.default_rng([seed, *kind.name.encode()]), machines(kind, DRAWN, seed)
    varied = {path: values for path, values in varied.items() if not path.startswith("flywheel")}
    varied |= {path: np.zeros(DRAWN) for path in AT_SPEED if path in scene_numbers(kind.scene)}
    asked = ["excess_work", "reduced_moment.min", "reduced_moment.max", "reduced_inertia.max"]
    work, low, high, most = Machine(kind.scene, asked, (), list(varied)).evaluate(varied).summaries.values()
    speed = abs(varied["input.speed"])
    wheel = work / speed**2 / (0.003 * 1000 ** random.random(DRAWN))
    wheel = np.where(random.random(DRAWN) < 0.1, 1e-3 * most, wheel)
    greatest = np.maximum(abs(low), abs(high)) * random.uniform(0.8, 2.5, DRAWN)
    motor = {"breakdown_moment": greatest, "breakdown_slip": 0.005 * 40 ** random.random(DRAWN)}
    varied |= {f"moments.motor.{key}": values for key, values in motor.items()}
    varied |= {"moments.motor.synchronous_speed": speed, "flywheel.inertia": wheel}
    return varied | {"regimes.go.from_speed": FROM * speed}


def measure(count: int, seed: int, kept: Path) -> list[dict]:
    """Values, estimates and truths of `count` machines; each is added to a file, and those in it are reused."""
    known = [json.loads(line) for line in kept.read_text("utf8").splitlines()] if kept.exists() else []
    done = {(row["kind"], row["machine"]) for row in known}
    every = {kind.name: kind for kind in kinds()}
    found = {}
    for i in range(count):
        name, k = KINDS[i % len(KINDS)], i // len(KINDS)
        if (name, k) in done:
            continue
        if name not in found:
            varied, scene = driven(every[name], seed), with_motor(every[name])
            along = Machine(scene, (), ["even.speed"], list(varied), positions=16).evaluate(varied)
            outcome = Machine(scene, ASKED, (), list(varied)).evaluate(varied)
            found[name] = scene, varied, outcome, along.fields["even.speed"][:, 0]
        row = {"kind": name, "machine": k, **against(*found[name], k)}
        with kept.open("a", encoding="utf8") as file:
            file.write(json.dumps(row) + "\n")
        known.append(row)
    return known


def against(scene: Scene, varied: Varied, outcome: object, begins: np.ndarray, k: int) -> dict:
    """One machine: its status, and by name true value, error and estimate.

    Error and estimate are relative to the value, those of the multiplier absolute. A machine may have two steady
    motions: the reference is the one that starts at the speed of `begins`.
    """
    status = Verdict(outcome.status[k])
    if status != Verdict.OK:
        return {"status": status.name}
    own = {path: float(values[k]) for path, values in varied.items()}
    motor = (own[f"moments.motor.{key}"] for key in ("breakdown_moment", "breakdown_slip", "synchronous_speed"))
    machine = UnderMotor(Path80(scene, own), own["flywheel.inertia"], *motor)
    try:
        true = {f"go.{key}": value for key, value in machine.run(own["regimes.go.from_speed"], CYCLES).items()}
        true |= {f"even.{key}": value for key, value in machine.steady(begins[k]).items()}
    except ArithmeticError:
        return {"status": "no reference"}
    if true["even.multiplier"] > 1:
        # Newton's method found an unstable motion.
        return {"status": "no reference"}
    rows = {}
    for name in ASKED:
        value, figure = outcome.summaries[name][k], outcome.errors[name][k]
        # The multiplier may vanish: a disturbance may decay completely within a cycle.
        size = 1.0 if name == "even.multiplier" else float(abs(true[name]))
        rows[name] = [float(true[name]), float(abs(value - true[name])) / size, float(figure) / size]
    return {"status": "OK", "values": rows, "slip": own["moments.motor.breakdown_slip"]}


def table(rows: list[dict]) -> list[str]:
    """Lines of the table, for each answer: share of estimates that cover, their ratio to errors, their size."""
    sound = [row["values"] for row in rows if row["status"] == "OK"]
    lines = [
        "| answer | estimates that cover, % | estimate / error, median | would cover at a median of 10, % "
        "| estimate, median | maximum | error / estimate, maximum |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in ASKED:
        error, figure = np.array([values[name][1:] for values in sound]).T
        covered, told = error <= figure + REFERENCE, error > ROUNDED
        ratio, beyond = np.median(figure[told] / error[told]), (error / (figure + REFERENCE)).max()
        closer = (error <= figure * min(CLOSE / ratio, 1.0) + REFERENCE).mean()
        parts = f"{100 * covered.mean():.2f}", f"{ratio:.1f}", f"{100 * closer:.1f}", f"{np.median(figure):.0e}"
        parts += (f"{figure.max():.0e}",)
        lines.append(f"| {name} | {' | '.join(parts)} | {beyond:.1f} × |")
    return lines


def by_kind(rows: list[dict]) -> list[str]:
    """Lines of the table: share of estimates of all answers that cover, by kind of machine."""
    lines = ["| kind | machines | estimates that cover, % | estimates above half the value |", "|---|---|---|---|"]
    for kind in KINDS:
        sound = [row["values"] for row in rows if row["kind"] == kind and row["status"] == "OK"]
        _, error, figure = np.array([[values[name] for name in ASKED] for values in sound]).reshape(-1, 3).T
        covered, lost = (error <= figure + REFERENCE).mean(), (figure > LOST).sum()
        lines.append(f"| {kind} | {len(sound)} | {100 * covered:.2f} | {lost} |")
    return lines


TEXT = """# Honesty of the error estimates of motion

{count} random machines of {kinds} kinds with induction motors of breakdown slips from 0.5 to 20 %, flywheels from none
to heavy, and loads that start and jump anywhere: {cycles} cycles from {share} of the synchronous speed (`go`), and
steady running (`even`), against collocation in 80 bits (`settled_path.py`). {statuses}.
The last column is the largest ratio of error to estimate; below 1 all errors are within. Medians of the ratio are those
of errors above {rounded:.0e}, which rounding doesn't reach; the column behind gives the share that smaller estimates,
with a median of ten times the error, would cover. Made by
`python results/motion/honesty.py --machines {count} --seed {seed}`.

{table}

{kinds_table}
"""


def main() -> None:
    """Measure and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--kept", type=Path, help="default: motion_honesty_SEED.jsonl among temporary files")
    given = parser.parse_args()
    kept = given.kept or Path(tempfile.gettempdir()) / f"motion_honesty_{given.seed}.jsonl"
    set_threads(1)
    rows = measure(min(given.machines, DRAWN * len(KINDS)), given.seed, kept)
    statuses = {}
    for row in rows:
        statuses[row["status"]] = statuses.get(row["status"], 0) + 1
    text = TEXT.format(
        count=len(rows),
        seed=given.seed,
        kinds=len(KINDS),
        cycles=CYCLES,
        rounded=ROUNDED,
        share=FROM,
        statuses=", ".join(f"{status}: {n}" for status, n in sorted(statuses.items())),
        table="\n".join(table(rows)),
        kinds_table="\n".join(by_kind(rows)),
    )
    (HERE / "honesty.md").write_text(text, encoding="utf8")
    print(text)


if __name__ == "__main__":
    main()
