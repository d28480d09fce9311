"""Assembly modes as they are listed: of groups that hang on others, without points, with what can't be drawn."""

from pathlib import Path

import pytest
from free_link_scenes import triad_data

from engine import Machine, Scene, SceneError, assembly_modes
from sweeps.pictures.drawing.mode_pictures import mode_pictures
from sweeps.report.mode_table import mode_table


def triad_with_a_ram(rod: float, **near: dict) -> Scene:
    """A plate on three bars, and a ram that hangs on it by a rod; C lies at (0.306, 0.100) or (0.156, 0.038)."""
    data = triad_data()
    data["bodies"], data["near"] = {}, near
    data["guides"] = {"way": {"y": 0.3}}
    data["links"] |= {"ram": {"joints": ["R"], "guide": "way"}, "tie": {"joints": ["C", "R"], "length": rod}}
    return Scene.model_validate(data)


def test_modes_of_a_group_on_one_whose_mode_is_open__are_open_and_the_first_ones_are_listed():
    scene = triad_with_a_ram(0.25)
    modes = assembly_modes(scene)
    assert len(modes["group_of_plate"]) == 2
    assert modes["group_of_ram"] is None
    assert "group_of_ram: depends on a group without a mode" in mode_table(modes)


def test_place_of_another_group__is_not_taken_for_one_that_tells():
    scene = triad_with_a_ram(0.25, C={"x": 0.3, "y": 0.1})
    with pytest.raises(SceneError, match=r"the mode is ambiguous: give near\.R"):
        Machine(scene, ["loop_closure_residual"]).evaluate({})


def test_mode_in_which_the_rest_does_not_reach__is_told_and_the_others_are_drawn(tmp_path):
    # From the higher C the way is 0.2 away, from the lower one 0.262.
    scene = triad_with_a_ram(0.205, C={"x": 0.3, "y": 0.1}, R={"x": 0.4, "y": 0.3})
    made = mode_pictures(scene, {"group_of_plate": assembly_modes(scene)["group_of_plate"]}, tmp_path / "modes.svg")
    assert sorted(path.exists() for path in made) == [False, True]
    assert ["don't reach" in str(refusal) for path, refusal in made.items() if not path.exists()] == [True]


def test_group_without_points__has_its_modes_listed():
    data = triad_data()
    data["bodies"], data["near"] = {}, {}
    data["points"] = {"O": {"x": 0, "y": 0}, "P": {"x": 0.2, "y": 0}}
    data["guides"] = {"slot": {"link": "lever", "x": 0.01, "y": 0.02, "angle": 0.3}}
    data["links"] = {"lever": {"joints": ["P"]}, "block": {"joints": ["A"], "guide": "slot"}}
    scene = Scene.model_validate(data)
    told = mode_table(assembly_modes(scene))
    assert "group_of_lever: 2 real assembly modes" in told
    assert "with a point of one of the group's links" in told


CAMPAIGN = Path(__file__).parents[3] / "results" / "groups"


@pytest.fixture(autouse=True)
def campaigns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(CAMPAIGN))


def test_modes_of_random_triads__end_as_with_50_digits():
    from mode_campaign import campaign

    found = list(campaign(2, seed=3))
    assert {mode.ends for mode in found} >= {"closed", "lost"}
    assert sum(mode.ends == "no room" for mode in found) <= 1
    for mode in found:
        assert mode.ends in (mode.exact_ends, "no room")
        # Rounding, 1e-16, magnified by the reciprocal of the quality of transmission: 1e-8 where modes meet.
        assert mode.apart < 1e-6
        # There the path ends where steps are halved below 1e-8 of a seed's, or one of fifty digits' below 1e-9 of its.
        assert not mode.place_apart > 1e-6


def test_triads_near_dead_centres__errors_are_within_their_estimates():
    from triad_estimates import compared

    found = compared(1, 10, 2, None)
    for name, (error, estimate, *_) in found.items():
        assert (error <= estimate).all(), name
