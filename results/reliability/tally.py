"""Counts of outcomes of faults and garbled texts: slices with other seeds add up in a JSON file."""

import json
import os
import platform
from pathlib import Path

# Maximum number of recorded failures.
TOLD = 60


class Tally:
    """Counts of all slices by kind.

    Parameters
    ----------
    path : Path
    anew : bool
        Forget what it holds.
    """

    def __init__(self, path: Path, anew: bool) -> None:
        self.path = path
        self.data = json.loads(path.read_text()) if path.exists() and not anew else {}
        for key, empty in (("slices", []), ("kinds", {}), ("wrong", [])):
            self.data.setdefault(key, empty)

    def note(self, kind: str, way: str, wrong: str) -> dict:
        """Count a case with its failure, "" for none; returns the row of its kind."""
        row = self.data["kinds"].setdefault(kind, {"ways": {}, "wrong": 0})
        row["ways"][way] = row["ways"].get(way, 0) + 1
        if wrong:
            row["wrong"] += 1
            self.data["wrong"] = [*self.data["wrong"], " ".join(wrong.split())[:600]][-TOLD:]
            print(self.data["wrong"][-1], flush=True)
        return row

    def ways(self, kind: str) -> str:
        """Outcomes of a kind with their counts, the most frequent first."""
        ways = sorted(self.data["kinds"][kind]["ways"].items(), key=lambda pair: -pair[1])
        return ", ".join(f"{count} {way}" for way, count in ways)

    def keep(self, line: str, minutes: float, done: str) -> None:
        """Write the counts, with those of the slice under way."""
        others = [found for found in self.data["slices"] if found["line"] != line]
        self.data["slices"] = [*others, {"line": line, "minutes": round(minutes, 1), "done": done}]
        self.path.write_text(json.dumps(self.data, indent=1, ensure_ascii=False) + "\n", encoding="utf8")

    def text(self, title: str, script: str, words: str, rows: list[str]) -> str:
        """A page of the counts, with a table of these rows."""
        slices = [f"- `{script} {s['line']}`, {s['minutes']:.0f} minutes, {s['done']}" for s in self.data["slices"]]
        wrong = [f"- {text}" for text in self.data["wrong"]]
        system = f"{platform.system()} {platform.machine()},\nPython {platform.python_version()}"
        head = [f"# {title}", "", f"On {os.cpu_count()} cores shared with others, {system}:", "", *slices, ""]
        return "\n".join([*head, words, *rows, *(["", "Failures:", "", *wrong] if wrong else []), ""])
