import platform

import pytest
from cycle_machines import press, press_numbers, smooth, smooth_numbers

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
