"""What an accuracy costs on the bundled studies, against the equally spaced positions that reach it.

    python results/accuracy/asked.py ../version-0.1

writes asked.md beside this file. The argument is a checkout of version 0.1 (commit 2d17cc5), which evaluated every
variant at as many equally spaced positions as it was told: `git worktree add --detach ../version-0.1 2d17cc5`. Each
version runs in processes of its own, on one thread; what is measured is processor time.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
STUDIES = (
    "crank_press",
    "compressor",
    "four_stroke_engine",
    "jaw_crusher",
    "engine_bearings",
    "four_bar_counterweights",
)
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-9)
TRUTH = 1e-12
POSITIONS = (24, 48, 96, 192, 384, 768, 1536, 3072, 6144, 12_288)
# Variants whose errors are looked at; most of a run whose time is taken, and positions of all of these together.
VARIANTS, TIMED, PLACES_TIMED, RUNS = 256, 8192, 4_000_000, 5
# Share of the variants that must be within an accuracy.
NEARLY_ALL = 99.0
# Compare two numbers with one of them, and are zero where they agree.
RELATIVE_ALREADY = ("_difference", "_residual", "_disagreement")


def child(name: str, way: str, setting: str, file: str) -> None:
    """Evaluate a study by either version: its summaries into a file, µs of a variant to standard output."""
    import sweeps
    from engine import Machine
    from sweeps import read_study

    # Versions differ in the folders they keep their studies in.
    files = (Path(sweeps.__file__).parent / "studies").rglob(f"{name}.toml")
    study = read_study(next(path for path in files if path.parent.name != "scenes"))
    given = {way: int(setting)} if way == "positions" else ({"accuracy": float(setting)} if setting else {})
    machine = Machine(study.scene, study.summaries, (), study.paths, **given)

    def variants(most: int) -> dict[str, np.ndarray]:
        values, dropped = study.values(0, min(most, study.design.size))
        return {path: np.asarray(values[path])[~dropped] for path in study.paths}

    outcome = machine.evaluate(variants(VARIANTS))
    np.savez(file, status=outcome.status, **outcome.summaries)
    most = TIMED if way == "accuracy" else max(VARIANTS, min(TIMED, PLACES_TIMED // int(setting)))
    timed, times = variants(most), []
    machine.evaluate(timed)
    for _ in range(RUNS):
        begin = time.process_time()
        machine.evaluate(timed)
        times.append(time.process_time() - begin)
    print(json.dumps(float(np.median(times)) / next(iter(timed.values())).size * 1e6))


def evaluated(sources: Path, *words: str) -> tuple[dict[str, np.ndarray], float]:
    """Summaries, and µs of a variant."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "summaries.npz"
        environment = {**os.environ, "PYTHONPATH": str(sources.resolve())}
        command = [sys.executable, str(Path(__file__).resolve()), "--child", *words, str(file)]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=folder, check=False)
        if done.returncode:
            raise SystemExit(f"{' '.join(words)}: {done.stderr}")
        return dict(np.load(file)), json.loads(done.stdout.splitlines()[-1])


def true_error(found: dict[str, np.ndarray], truth: dict[str, np.ndarray]) -> float:
    """What nearly all variants are off by at most, of the summary that is worst; places of extremes left out."""
    worst, good = 0.0, (found["status"] == 0) & (truth["status"] == 0)
    for name in found.keys() & truth.keys() - {"status"}:
        if name.endswith("_at"):
            continue
        exact, value = truth[name][good], found[name][good]
        # Statistics of a field are measured by the greatest that is asked of it: its mean may be zero.
        field = name.rpartition(".")[0]
        asked = [truth[other][good] for other in truth if field and other.rpartition(".")[0] == field]
        asked = [exact] if not field else [a for a in asked if a.dtype.kind == "f"]
        size = 1.0 if name.endswith(RELATIVE_ALREADY) else np.max(np.abs(asked), axis=0)
        with np.errstate(all="ignore"):
            share = np.where(value == exact, 0.0, np.abs(value - exact) / size)
        known = share[np.isfinite(share)]
        worst = max(worst, float(np.percentile(known, NEARLY_ALL)) if known.size else 0.0)
    return worst


def rows_of(name: str, before: Path) -> list[str]:
    """Rows of a study."""
    here = HERE.parents[1]
    truth, _ = evaluated(here, name, "accuracy", f"{TRUTH}")
    found, default = evaluated(here, name, "accuracy", "")
    words = name.replace("_", " ")
    lines = [f"| {words} | as it is | {default:.1f} | {true_error(found, truth):.0e} | | | |"]
    ladder: list[tuple[int, float, float]] = []
    for accuracy in ACCURACIES:
        found, cost = evaluated(here, name, "accuracy", f"{accuracy}")
        own = f"| {words} | {accuracy:g} | {cost:.1f} | {true_error(found, truth):.0e} |"
        while not (ladder and ladder[-1][2] <= accuracy) and len(ladder) < len(POSITIONS):
            positions = POSITIONS[len(ladder)]
            found, there = evaluated(before, name, "positions", f"{positions}")
            ladder.append((positions, there, true_error(found, truth)))
        positions, there, error = next((rung for rung in ladder if rung[2] <= accuracy), ladder[-1])
        beyond = "> " if error > accuracy else ""
        lines.append(f"{own} {beyond}{positions} | {there:.1f} | {beyond}{there / cost:.1f} |")
        print(lines[-1], flush=True)
    return lines


TEXT = """# What an accuracy costs

Each study is asked one accuracy, and evaluated by version 0.1 at equally spaced positions: at as many, of
{positions}, as truly reach that accuracy (`> `: the most don't). µs of processor time per variant on one thread.
True errors are against accuracy {truth:g}; of the summary that is worst, what {nearly:g} % of {variants} variants are
within; places of extremes are left out. `as it is`: no accuracy is asked.

Made by `python results/accuracy/asked.py CHECKOUT` on a machine shared with others.

| study | accuracy | now [µs] | true error | positions | version 0.1 [µs] | times cheaper |
|---|---|---|---|---|---|---|
"""


def main() -> None:
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    if sys.argv[1] == "--child":
        child(*sys.argv[2:])
        return
    rungs = f"{POSITIONS[0]}, {POSITIONS[1]} … {POSITIONS[-1]}"
    words = TEXT.format(positions=rungs, truth=TRUTH, nearly=NEARLY_ALL, variants=VARIANTS)
    lines = [line for name in STUDIES for line in rows_of(name, Path(sys.argv[1]))]
    (HERE / "asked.md").write_text(words + "\n".join(lines) + "\n", encoding="utf8")


if __name__ == "__main__":
    main()
