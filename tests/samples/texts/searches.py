"""A press to be searched, and what is asked of it, for the tests of searching."""

from pathlib import Path

from press_texts import PRESS_WITH_FLYWHEEL

from sweeps import Study, SweepResult, read_study
from sweeps.optimising.search_runner import optimise_study

SCENE = PRESS_WITH_FLYWHEEL.replace("100 kN", "10 kN")
CRANK, ROD = "input.length", "groups.slide.first.length"
RANGES = """
[vary]
"input.length" = {low = "30 mm", high = "80 mm"}
"groups.slide.first.length" = {low = "150 mm", high = "400 mm"}
"""
ASKED = '[outputs]\nsummaries = ["ram.stroke", "excess_work"]\n'
HEAD = 'title = "Which crank?"\nscene = "press.toml"\npositions = 72\n'


def study_of(folder: Path, optimise: str, vary: str = RANGES, head: str = HEAD, rest: str = "") -> Study:
    (folder / "press.toml").write_text(SCENE)
    (folder / "study.toml").write_text(f"{head}{vary}\n[optimise]\n{optimise}\n{ASKED}{rest}")
    return read_study(folder / "study.toml")


def searched(folder: Path, optimise: str, **rest: str) -> SweepResult:
    return SweepResult(optimise_study(study_of(folder, optimise, **rest), folder / "found.h5"))


def best_of(result: SweepResult) -> dict[str, float]:
    best = result.best()
    return {name: float(column[best]) for name, column in result.columns.items()}


# The distance from a point, squared.
NEAREST = "(ram.stroke / 2 - '48 mm')**2 + (groups.slide.first.length - '233 mm')**2"
ONE = f"""
minimise = "{NEAREST}"
where = "groups.slide.first.length >= 3 * ram.stroke"
population = 10
generations = 12
"""

TWO = """
minimise = ["(ram.stroke / 2 - '40 mm')**2 + (groups.slide.first.length - '200 mm')**2",
            "(ram.stroke / 2 - '60 mm')**2 + (groups.slide.first.length - '300 mm')**2"]
population = 40
generations = 40
"""
