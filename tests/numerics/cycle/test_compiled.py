import platform

import numpy as np
import pytest
from cycle_machines import press, press_numbers, smooth, smooth_numbers

from engine.compiling.threads import set_threads
from engine.cycle.driver import evaluate_blocks


def test_all_machines_share_one_driver():
    press(integrals=(1,)).evaluate(press_numbers(1))
    smooth(extremes=(0,)).evaluate(smooth_numbers(0.1, 0.0)[:, None])
    # One more where something is asked that is asked rarely.
    assert len(evaluate_blocks.signatures) <= 2


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="counts this processor's instructions")
def test_machines_functions_run_over_lanes_side_by_side():
    text = next(iter(press(integrals=(1,)).curves.inspect_asm().values()))
    assert text.count("vsqrtpd") > 0
    # One root and one quotient a position: whatever is left over one lane at a time is no more than a remainder.
    assert text.count("vsqrtpd") >= text.count("vsqrtsd")


def test_results_do_not_depend_on_the_number_of_threads():
    rng = np.random.default_rng(1)
    machine, numbers = smooth(integrals=(0,), extremes=(0,)), smooth_numbers(rng.uniform(0.0, 0.9, 700), 1.0)
    try:
        set_threads(1)
        one = machine.evaluate(numbers)
        set_threads(3)
        three = machine.evaluate(numbers)
    finally:
        set_threads(0)
    assert np.array_equal(one.integrals.value, three.integrals.value)
    assert np.array_equal(one.extremes.greatest_at.value, three.extremes.greatest_at.value)
