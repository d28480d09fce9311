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
import subprocess
import tempfile
import time
from collections import Counter
from functools import partial
from pathlib import Path

from bench import Bench
from injecting import inject
from killing import AT_ONCE, interrupt, kill
from many_variants import most_memory
from spoiling import damage, damage_search, spoil_cache
from surroundings import cache_refused, clock_set_back, empty_cache, full_disk, room_again, together
from tally import Tally

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


def note(tally: Tally, fault: str, way: str, wrong: str) -> None:
    """Count a fault done; of a traceback its last line: others name places of files on this machine."""
    if wrong:
        said, marker, trace = wrong.partition("traceback:")
        wrong = f"{fault}: {said}{marker} {' '.join(trace.strip().splitlines()[-1:])}"
    tally.note(fault, way, wrong)


def keep(tally: Tally, line: str, minutes: float, most: Counter) -> None:
    """Write the counts, with those of the slice under way, and the table made of them."""
    longest = tally.data.setdefault("most", {})
    for name, value in most.items():
        longest[name] = max(longest.get(name, 0.0), value)
    git = ["git", "-C", str(HERE), "describe", "--always", "--dirty"]
    commit = subprocess.run(git, capture_output=True, text=True).stdout.strip()
    tally.keep(line, minutes, f"at {commit}")
    tally.path.with_name("reliability.md").write_text(table(tally), encoding="utf8")


def table(tally: Tally) -> str:
    """The counts as a text."""
    rows = []
    for fault, row in sorted(tally.data["kinds"].items()):
        rows.append(f"| {fault} | {sum(row['ways'].values())} | {tally.ways(fault)} | {row['wrong']} |")
    if many := tally.data.get("many"):
        rows += ["", "Memory of one summary, from the start of Python to the answer:", ""]
        rows += ["| variants | s | most memory, MB |", "|---|---|---|"]
        rows += [f"| {m['variants']:.3g} | {m['seconds']} | {m['megabytes']} |" for m in many]
    if most := tally.data.get("most"):
        rows += ["", "Signals:", "", *(f"- {name}: {value:.2f}" for name, value in most.items())]
    words = f"""A command counts as wrong when something flagged as done differs from an undisturbed run or is computed
again, the same command doesn't mend it or refuse in words, numbers that changed are shown, a draft stays
after a signal, a signal isn't obeyed within {AT_ONCE:g} s (times the processes for each core where
these are more), a text is carried out or shown as code, or anything but words is said.
Commands are forks of a process that has everything loaded, but for those from Python's start on; blocks
are a twelfth of a study.

| fault | times | what came of it | wrong |
|---|---|---|---|"""
    return tally.text("Faults done on purpose", "campaign.py", words, rows)


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
        found = most_memory(asked.variants)
        others = [other for other in tally.data.get("many", []) if other["variants"] != found["variants"]]
        tally.data["many"] = [*others, found]
        line += f" --variants {asked.variants}"
        keep(tally, line, 0.0, Counter())
    if not asked.minutes:
        return
    with tempfile.TemporaryDirectory(prefix="reliability-") as folder:
        bench = Bench(Path(folder), asked.seed, partial(note, tally))
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
                keep(tally, line, minutes, bench.most)
        finally:
            bench.close()


if __name__ == "__main__":
    main()
