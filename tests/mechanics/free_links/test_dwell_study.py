"""The dwell of the bundled triad, by its summary and by the output's angle from position to position."""

import numpy as np
import pytest

from engine import Machine, Verdict
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study


def test_path_in_the_dwell__is_that_of_the_output_from_position_to_position():
    scene = read_study(bundled_studies()["triad_dwell"]).scene
    positions = 3600
    machine = Machine(scene, ["output.swing", "still.moment.mean"], ["output.angle"], positions=positions)
    outcome = machine.evaluate({})
    assert outcome.status[0] == Verdict.OK
    numbers = scene.moments["still"].numbers
    begin, arc = (numbers[key].value for key in ("begin", "arc"))
    # The arc's ends are positions: between them the path bends at its turning points alone.
    angle, step = np.unwrap(outcome.fields["output.angle"][0]), 2.0 * np.pi / positions
    within = angle[round(begin / step) : round((begin + arc) / step) + 1]
    path = np.degrees(np.abs(np.diff(within)).sum())
    # A turning point between two positions: less than the path of a step, some 1e-4 deg there.
    assert -outcome.summaries["still.moment.mean"][0] == pytest.approx(path, abs=1e-3)
    assert np.degrees(np.ptp(within)) < 0.4
    assert np.degrees(outcome.summaries["output.swing"][0]) > 30.0
