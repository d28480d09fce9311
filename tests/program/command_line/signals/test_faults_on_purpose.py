"""Faults done on purpose: a part of `results/reliability/campaign.py`, whose slices add up."""

import json
import os
import subprocess
import sys

from commands import ROOT

CAMPAIGN = ROOT / "results" / "reliability" / "campaign.py"


def test_injected_texts__get_through_nowhere_and_slices_add_up(tmp_path):
    counts = tmp_path / "counts.json"
    for seed in (5, 6):
        line = [sys.executable, str(CAMPAIGN), "--minutes", "0.0001", "--only", "inject", "--counts", str(counts)]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run([*line, "--seed", str(seed)], env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    data = json.loads(counts.read_text())
    assert data["wrong"] == []
    assert sum(data["faults"]["injections"]["ways"].values()) == 4
    assert len(data["slices"]) == 2
    assert "| injections | 4 |" in (tmp_path / "reliability.md").read_text()
