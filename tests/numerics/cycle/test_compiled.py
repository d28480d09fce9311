import pytest
from cycle_machines import force_numbers, forces, press, press_numbers, smooth, smooth_numbers

from engine.cycle.block_measures import MEASURES
from engine.cycle.driver import evaluate_blocks
from engine.cycle.plan import Running, VectorAngle

ANGLE = VectorAngle((0, 1))
ONE_FORCE = force_numbers([1.0], [0.3])


def versions():
    """Number of compiled versions of the driver and of each measure."""
    return {function.__name__: len(function.signatures) for function in (evaluate_blocks, *MEASURES.values())}


def test_all_machines_share_one_driver_and_one_version_of_each_measure():
    press(integrals=(1,), extremes=[Running((1,), about_mean=True)]).evaluate(press_numbers(1))
    smooth(extremes=(0,), roots=(1,)).evaluate(smooth_numbers(0.1, 0.0)[:, None])
    forces(extremes=[ANGLE], averages=[ANGLE], spaced=[ANGLE], positions=3).evaluate(ONE_FORCE)
    assert versions()["evaluate_blocks"] == 1
    assert set(versions().values()) <= {0, 1}


@pytest.mark.parametrize(
    ("asked", "measure"),
    [({"arcs": [(0, 1, 2)]}, "measure_arcs"), ({"roots": (2,)}, "measure_roots")],
    ids=["arcs", "roots"],
)
def test_another_measure__adds_its_own_machine_code_alone(asked, measure):
    forces(extremes=(0,)).evaluate(ONE_FORCE)
    before = versions()
    forces(extremes=(0,), **asked).evaluate(ONE_FORCE)
    assert {name for name, count in versions().items() if count > before[name]} <= {measure}
    assert versions()[measure] == 1
