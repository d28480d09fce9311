"""Faults done on purpose: a part of `results/reliability/campaign.py`, whose slices add up."""

import json

from commands import ROOT, ran

CAMPAIGN = ROOT / "results" / "reliability" / "campaign.py"


def test_injected_texts__get_through_nowhere_and_slices_add_up(tmp_path):
    counts = tmp_path / "counts.json"
    for seed in (5, 6):
        asked = ("--minutes", "0.0001", "--only", "inject", "--counts", str(counts), "--seed", str(seed))
        ended = ran(str(CAMPAIGN), *asked)
        assert ended.returncode == 0, ended.stderr
    data = json.loads(counts.read_text())
    assert data["wrong"] == []
    assert sum(data["faults"]["injections"]["ways"].values()) == 4
    assert len(data["slices"]) == 2
    assert "| injections | 4 |" in (tmp_path / "reliability.md").read_text()
