"""Bundled texts garbled at random are read or refused in words: a part of `results/reliability/mutations.py`."""

import importlib.util
import random
import shutil
from pathlib import Path

import pytest

CAMPAIGN = Path(__file__).parents[3] / "results" / "reliability" / "mutations.py"
TIMES = 100


@pytest.fixture(scope="module")
def campaign():
    spec = importlib.util.spec_from_file_location("mutations", CAMPAIGN)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_garbled_texts__are_read_or_refused_in_words(campaign, tmp_path, monkeypatch):
    for part in ("studies", "templates"):
        shutil.copytree(campaign.STOCK / part, tmp_path / part)
    monkeypatch.chdir(tmp_path)
    ways = {}
    for i in range(TIMES):
        campaign.texts(
            random.Random(f"quick {i}"), tmp_path, False, lambda how, text, took: ways.setdefault(how, []).append(text)
        )
    assert set(ways) == {"results", "refused"}, {how: texts[0] for how, texts in ways.items()}
    assert sum(map(len, ways.values())) == TIMES
    assert any("carried_out" in text for texts in ways.values() for text in texts)
