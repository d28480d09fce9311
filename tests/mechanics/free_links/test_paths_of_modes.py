"""Modes of random triads over a turn: tables of seeds against paths followed with 50 digits."""

from pathlib import Path

import pytest

CAMPAIGN = Path(__file__).parents[3] / "results" / "groups"


def test_modes_of_random_triads__end_as_with_50_digits(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(CAMPAIGN))
    from mode_campaign import campaign

    found = list(campaign(4, seed=3))
    assert {mode.ends for mode in found} >= {"closed", "lost"}
    assert sum(mode.ends == "no room" for mode in found) <= 1
    for mode in found:
        assert mode.ends in (mode.exact_ends, "no room")
        # Rounding, 1e-16, magnified by the reciprocal of the quality of transmission: 1e-8 where modes meet.
        assert mode.apart < 1e-6
        # There the path ends where steps are halved below 1e-8 of a seed's, or one of fifty digits' below 1e-9 of its.
        assert not mode.place_apart > 1e-6
