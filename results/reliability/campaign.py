"""Faults done on purpose to runs, result files and the cache of machine code; writes `reliability.md` beside this file.

    python results/reliability/campaign.py --minutes 60 --seed 2
    python results/reliability/campaign.py --minutes 0 --variants 100000000

Each fault falls at a random moment or place, of a seed. A command counts as well when what it leaves behind, and what
the same command makes of it afterwards, is bit for bit what an undisturbed run gives; whatever a command says, it has
to be words and no traceback. Disks are small tmpfs mounts where these are allowed; else file sizes are limited.

The kinds of faults take turns until the time is over. Counts are added to those in `counts.json`, from which the table
is made: slices with other seeds add up. Counts of an earlier state of the program are thrown away with `--anew`.
"""

import argparse
import json
import os
import platform
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path

from bench import Bench
from injecting import inject
from killing import AT_ONCE, interrupt, kill
from many_variants import most_memory
from spoiling import damage, damage_search, spoil_cache
from surroundings import cache_refused, clock_set_back, empty_cache, full_disk, room_again, together

HERE = Path(__file__).parent
# How often each kind of fault is done in a turn.
TURN = {
    kill: 6,
    interrupt: 5,
    damage: 5,
    damage_search: 1,
    full_disk: 2,
    room_again: 0.5,
    clock_set_back: 0.5,
    together: 2,
    inject: 2,
    spoil_cache: 0.4,
    cache_refused: 0.3,
    empty_cache: 0.1,
}
# So many texts of what went wrong are kept.
TOLD = 60


class Tally:
    """Counts of all slices, in a file of JSON.

    Parameters
    ----------
    path : Path
    anew : bool
        Forget what it holds.
    """

    def __init__(self, path: Path, anew: bool) -> None:
        self.path = path
        empty = {"slices": [], "faults": {}, "wrong": [], "most": {}, "many": []}
        self.data = json.loads(path.read_text()) if path.exists() and not anew else empty

    def note(self, fault: str, way: str, wrong: str) -> None:
        """Count a fault done."""
        row = self.data["faults"].setdefault(fault, {"ways": {}, "wrong": 0})
        row["ways"][way] = row["ways"].get(way, 0) + 1
        if wrong:
            row["wrong"] += 1
            # Of a traceback its last line: others name places of files on this machine.
            said, marker, trace = wrong.partition("traceback:")
            wrong = f"{said}{marker} {trace.strip().splitlines()[-1]}" if trace.strip() else wrong
            self.data["wrong"] = [*self.data["wrong"], f"{fault}: {' '.join(wrong.split())}"[:600]][-TOLD:]
            print(self.data["wrong"][-1], flush=True)

    def note_memory(self, found: dict[str, float]) -> None:
        """Put down what a study of so many variants took."""
        others = [other for other in self.data.get("many", []) if other["variants"] != found["variants"]]
        self.data["many"] = [*others, found]

    def keep(self, line: str, minutes: float, most: Counter) -> None:
        """Write the counts, with those of the slice under way, and the table made of them."""
        for name, value in most.items():
            self.data["most"][name] = max(self.data["most"].get(name, 0.0), value)
        others = [found for found in self.data["slices"] if found["line"] != line]
        self.data["slices"] = [*others, {"line": line, "minutes": round(minutes, 1), "commit": _commit()}]
        self.path.write_text(json.dumps(self.data, indent=1, ensure_ascii=False) + "\n", encoding="utf8")
        self.path.with_name("reliability.md").write_text(table(self.data), encoding="utf8")


def _commit() -> str:
    line = ["git", "-C", str(HERE), "describe", "--always", "--dirty"]
    return subprocess.run(line, capture_output=True, text=True).stdout.strip()


def table(data: dict) -> str:
    """The counts as a text."""
    rows = []
    for fault, row in sorted(data["faults"].items()):
        ways = sorted(row["ways"].items(), key=lambda pair: -pair[1])
        told = ", ".join(f"{count} {way}" for way, count in ways)
        rows.append(f"| {fault} | {sum(row['ways'].values())} | {told} | {row['wrong']} |")
    slices = [f"- `campaign.py {s['line']}`, {s['minutes']:.0f} minutes, at {s['commit']}" for s in data["slices"]]
    most = [f"- {name}: {value:.2f}" for name, value in data["most"].items()]
    wrong = [f"- {text}" for text in data["wrong"]]
    many = [f"| {m['variants']:.3g} | {m['seconds']} | {m['megabytes']} |" for m in data.get("many", [])]
    title = "Memory of one summary, from the start of Python to the answer:"
    head = ["", title, "", "| variants | s | most memory, MB |", "|---|---|---|"]
    return "\n".join(
        [
            "# Faults done on purpose",
            "",
            f"On {os.cpu_count()} cores that others used too, {platform.system()} {platform.machine()},",
            f"Python {platform.python_version()}:",
            "",
            *slices,
            "",
            "A command counts as wrong when something flagged as done differs from an undisturbed run or is computed",
            "again, the same command doesn't mend it or refuse in words, numbers that changed are shown, a draft stays",
            f"after a signal, a signal isn't obeyed within {AT_ONCE:g} s (times the processes for each core where",
            "these are more), a text is carried out or shown as code, or anything but words is said.",
            "Commands are forks of a process that has everything loaded, but for those from Python's start on; blocks",
            "are a twelfth of a study.",
            "",
            "| fault | times | what came of it | wrong |",
            "|---|---|---|---|",
            *rows,
            *([*head, *many] if many else []),
            *(["", "Signals:", "", *most] if most else []),
            *(["", "What went wrong:", "", *wrong] if wrong else []),
            "",
        ]
    )


def main() -> None:
    """Do faults in turns until the time is over, and write counts and table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variants", type=int, help="Measure the memory of a study of so many first.")
    parser.add_argument("--only", help="One kind of fault alone, by the name of its function.")
    parser.add_argument("--anew", action="store_true", help="Forget the counts of earlier slices.")
    parser.add_argument("--counts", type=Path, default=HERE / "counts.json")
    asked = parser.parse_args()
    line = f"--minutes {asked.minutes:g} --seed {asked.seed}" + (f" --only {asked.only}" if asked.only else "")
    kinds = {kind: often for kind, often in TURN.items() if asked.only in (None, kind.__name__)}
    tally, begun = Tally(asked.counts, asked.anew), time.monotonic()
    if asked.variants:
        tally.note_memory(most_memory(asked.variants))
        line += f" --variants {asked.variants}"
        tally.keep(line, 0.0, Counter())
    if not asked.minutes:
        return
    with tempfile.TemporaryDirectory(prefix="reliability-") as folder:
        bench = Bench(Path(folder), asked.seed, tally.note)
        due: Counter = Counter()
        try:
            minutes = 0.0
            while minutes < asked.minutes:
                for kind, often in kinds.items():
                    due[kind] += often
                    while due[kind] >= 1:
                        due[kind] -= 1
                        kind(bench)
                minutes = (time.monotonic() - begun) / 60
                tally.keep(line, minutes, bench.most)
        finally:
            bench.close()


if __name__ == "__main__":
    main()
