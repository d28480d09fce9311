"""What variants take, found with a clock of the test's own: on it hangs how many fall into a block."""

from types import SimpleNamespace

import pytest
from press_sweeps import DISTINCT, study_of

from sweeps.run import cost
from sweeps.run.blocks import block_size

COMPILING, EACH = 20.0, 1e-4
# Cranks from 20 mm on: the first of them, and with the longer ones all of the first variants tried.
DROPS = ("input.length > '20 mm'", "input.length > '59 mm'")


class Clock:
    """Seconds that evaluations are said to take: compiling once, where anything is computed, and so many each."""

    def __init__(self, each: float) -> None:
        self.now, self.each, self.compiled = 0.0, each, False

    def evaluate(self, study, machine, values, drop) -> None:
        kept = drop.size - int(drop.sum())
        self.now += self.each * kept + (COMPILING if kept and not self.compiled else 0.0)
        self.compiled = self.compiled or kept > 0


@pytest.fixture
def clock(request, monkeypatch):
    found = Clock(request.param)
    monkeypatch.setattr(cost, "time", SimpleNamespace(perf_counter=lambda: found.now))
    monkeypatch.setattr(cost, "evaluate_variants", found.evaluate)
    return found


@pytest.mark.parametrize("clock", [EACH], indirect=True)
@pytest.mark.parametrize("drop", DROPS)
def test_variant__takes_what_it_takes_once_compiled_where_the_first_is_dropped(clock, drop, tmp_path):
    text = DISTINCT.replace("positions = 48", f'positions = 48\nrequire = ["{drop}"]')
    study = study_of(tmp_path, text.replace("count = 200", "count = 20000"))
    machine = study.machine()
    found = cost.seconds_of_variant(study, machine)
    assert clock.compiled
    # No more than each; less by as many as are dropped.
    assert 0 < found <= EACH
    assert block_size(study, machine, lambda: found) >= 1 / EACH


@pytest.mark.parametrize("clock", [2.0], indirect=True)
def test_trial__takes_a_tenth_of_a_study_at_most_besides_the_first_look(clock, tmp_path):
    study = study_of(tmp_path, DISTINCT)
    assert cost.seconds_of_variant(study, study.machine()) == pytest.approx(clock.each)
    assert clock.now - COMPILING <= clock.each * study.design.size * (1 / cost.WORTH_TWO + 0.1)
