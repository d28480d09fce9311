"""Deliberate faults in runs, result files and the cache of machine code; writes `reliability.md` next to this file.

    python results/reliability/campaign.py --minutes 60 --seed 2
    python results/reliability/campaign.py --minutes 0 --variants 100000000

Each fault has a random moment or position, by a seed. The files that a command leaves, and the result of the same
command afterwards, must equal those of an undisturbed run bit for bit, and no output may be a traceback. Disks are
small tmpfs mounts if these are allowed; else file sizes are limited.

The kinds of faults alternate until the time is over. Counts are added to those in `counts.json`, from which the table
is made: slices with other seeds add up. `--anew` discards the counts of an earlier state of the program.
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
# Frequency of each kind of fault per turn.
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
    """Count a fault; of a traceback only its last line, as others contain paths of this machine."""
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
        rows += ["", "Peak memory of a study with one summary, from the start of Python to the answer:", ""]
        rows += ["| variants | s | peak memory, MB |", "|---|---|---|"]
        rows += [f"| {m['variants']:.3g} | {m['seconds']} | {m['megabytes']} |" for m in many]
    if most := tally.data.get("most"):
        rows += ["", "Signals:", "", *(f"- {name}: {value:.2f}" for name, value in most.items())]
    words = f"""A command counts as wrong if a block flagged as done differs from an undisturbed run or is computed
again, the same command neither repairs the damage nor refuses with a message, changed numbers are shown, a
draft stays after a signal, a signal isn't obeyed within {AT_ONCE:g} s (times the number of processes per core, if more
than 1), a text is executed or shown as code, or the output has a traceback.
Commands are forks of a process that has everything loaded, except those from Python's start on; blocks
are a twelfth of a study.

| fault | cases | outcome | wrong |
|---|---|---|---|"""
    return tally.text("Deliberate faults", "campaign.py", words, rows)


def main() -> None:
    """Alternate faults until the time is over, and write counts and table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variants", type=int, help="First measure the memory of a study of this many variants.")
    parser.add_argument("--only", help="Only one kind of fault, by the name of its function.")
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
