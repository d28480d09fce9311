"""Bundled texts garbled at random are read or refused in words: a part of `results/reliability/mutations.py`."""

import random
import shutil

from commands import ROOT

TIMES = 100


def test_garbled_texts__are_read_or_refused_in_words(folder, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "results" / "reliability"))
    from mutations import STOCK, texts

    for part in ("studies", "templates"):
        shutil.copytree(STOCK / part, folder / part)
    ways = {}
    for i in range(TIMES):
        dice = random.Random(f"quick {i}")
        texts(dice, folder, False, lambda how, text, took: ways.setdefault(how, []).append(text))
    assert set(ways) == {"results", "refused"}, {how: found[0] for how, found in ways.items()}
    assert sum(map(len, ways.values())) == TIMES
    assert any("carried_out" in text for found in ways.values() for text in found)
