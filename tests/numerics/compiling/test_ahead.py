"""What other processes compile is found in the cache, and is what machines call."""

from importlib import import_module
from pathlib import Path

import pytest

from engine import Machine, Scene
from engine.compiling import ahead
from engine.compiling.decorators import driver
from engine.cycle.block_measures import MEASURES
from engine.cycle.cycle_machine import compile_driver
from engine.cycle.driver import evaluate_blocks
from engine.cycle.plan import Kept, Plan
from engine.stepping.closed_cycle import find_cycles
from engine.stepping.system import compile_walks
from engine.stepping.walk import attempt, lay_steps, repeat_steps, walk


@driver
def never_compiled(begin, end):
    pass


@pytest.fixture
def two_cores(monkeypatch):
    monkeypatch.setattr(ahead, "threads", lambda: 2)
    monkeypatch.setattr(ahead, "_running", {})


def test_function__runs_in_another_process_that_is_waited_for(two_cores, tmp_path, monkeypatch):
    # Only the parent's search path leads to its module; the working folder has another one of that name.
    modules, here = tmp_path / "modules", tmp_path / "here"
    modules.mkdir()
    here.mkdir()
    (modules / "only_there.py").write_text("def write(path):\n    path.write_text('by another process')\n")
    (here / "only_there.py").write_text("raise ImportError")
    monkeypatch.syspath_prepend(modules)
    monkeypatch.chdir(here)
    ahead.compile_ahead(never_compiled, import_module("only_there").write, tmp_path / "written")
    ahead.wait_until_compiled(never_compiled)
    assert (tmp_path / "written").read_text() == "by another process"


def test_failure_of_the_other_process__stops_nothing(two_cores, tmp_path):
    ahead.compile_ahead(never_compiled, Path.unlink, tmp_path / "missing")
    ahead.wait_until_compiled(never_compiled)
    assert ahead._running[never_compiled].returncode == 1
    assert never_compiled.signatures == []


def test_one_core__starts_no_process(two_cores, monkeypatch, tmp_path):
    monkeypatch.setattr(ahead, "threads", lambda: 1)
    ahead.compile_ahead(never_compiled, Path.write_text, tmp_path / "written", "by another process")
    assert not ahead._running


CRANK = {
    "points": {"O": {"x": 0, "y": 0}},
    "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.1, "speed": 10.0},
    "bodies": {"drum": {"link": "crank", "mass": 1.0, "inertia": 2.0}},
    "moments": {
        "motor": {"type": "dc_motor", "on": "crank", "no_load_speed": 20.0, "stall_moment": 20.0},
        "rub": {"type": "against_motion", "on": "crank", "moment": 1.0, "role": "useful"},
    },
    "regimes": {"start": {"type": "run", "speed": 10.0, "from_speed": 1.0}, "on": {"type": "steady"}},
}


def test_what_is_compiled_ahead__is_what_machines_call():
    plan = Plan((0, 1), 1)
    plan.find_extremes(Kept((0,)))
    compile_driver(plan)
    compile_walks()
    shared = evaluate_blocks, MEASURES["extremes"], walk, find_cycles, attempt, lay_steps, repeat_steps
    before = [len(function.signatures) for function in shared]
    assert min(before) >= 1
    names = ["input_moment.max", "start.time", "on.mean_speed"]
    found = Machine(Scene.model_validate(CRANK), names).evaluate({})
    assert found.status[0] == 0
    assert [len(function.signatures) for function in shared] == before
