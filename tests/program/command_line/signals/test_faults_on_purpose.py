"""Faults done on purpose: a part of `results/reliability/campaign.py`, whose slices add up."""

import json

from commands import ROOT, ran

RELIABILITY = ROOT / "results" / "reliability"
# Both slices in one process, whose imports take most of the time.
SLICES = """
import sys
import campaign
for seed in ("5", "6"):
    sys.argv[1:] = ["--minutes", "0.0001", "--only", "inject", "--counts", "counts.json", "--seed", seed]
    campaign.main()
"""


def test_injected_texts__get_through_nowhere_and_slices_add_up(tmp_path):
    ended = ran("-c", f"import sys\nsys.path.insert(0, {str(RELIABILITY)!r})\n{SLICES}", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    data = json.loads((tmp_path / "counts.json").read_text())
    assert data["wrong"] == []
    assert sum(data["faults"]["injections"]["ways"].values()) == 4
    assert len(data["slices"]) == 2
    assert "| injections | 4 |" in (tmp_path / "reliability.md").read_text()
