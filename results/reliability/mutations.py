"""Scenes, studies, tables and command lines garbled at random; writes `mutations.md` next to this file.

    python results/reliability/mutations.py --texts 20000 --numbers 4000 --evaluated 100 --lines 2000 --seed 2

Counts are added to those in `mutations.json`, from which the table is made: slices with other seeds add up. `--anew`
discards the counts of an earlier state of the program.

The stock is all bundled studies, their scenes, the templates and their tables. A seed decides the changes of a text:
numbers become extreme, wrong or missing, names are exchanged, keys are renamed, omitted or taken from another text with
their contents, lines and bytes are lost or doubled. Each text is read, and its machine's functions are printed; some
are run to their end. A command may refuse with a message or give results; wrong are a traceback, a crash, more
processor time or memory than stated with the table, and executed code from a text.

A machine of another structure takes seconds to compile and milliseconds to run. So only few texts with arbitrary
changes are run; in most runs only numbers, units, formulas, goals and names of a study are changed, which need no
compilation. These have a few variants each, and are otherwise as bundled.
"""

import argparse
import contextlib
import copy
import importlib
import io
import multiprocessing
import os
import pkgutil
import random
import resource
import shutil
import signal
import tempfile
import time
import tomllib
import traceback
from collections.abc import Callable, Iterator
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import tomlkit
from hostile import TEXTS
from tally import Tally

import sweeps

HERE = Path(__file__).parent
STOCK = Path(sweeps.__file__).parent
# Maximum processor time [s] to read a text and print its functions, and to run a small study to its end.
READ_WITHIN, RUN_WITHIN = 10.0, 120.0
MOST_MEMORY = 1_000_000_000
# A garbled study with more variants than this is only read.
FEW = 5000
# Cases per process, which frees its compiled code at its end; more if only numbers of one study change.
BATCH, NUMBERS_BATCH = 60, 300
# Processor time [s] after which a process changes no further number: some studies always take seconds.
BATCH_SECONDS = 15.0
# Maximum values of a number in a study of which only numbers change, and its variants if they are sampled.
VALUES, SAMPLED = 2, 8
# Parts of a slice, after each of which its counts are written.
TURNS = 20

NUMBERS = ("0", "-1", "1", "1e-300", "1e12", "1e150", "1e300", "1e400", "nan", "inf", "-inf", "1/0", "٣")  # fmt: skip
UNITS = ("", "mm", "m", "deg", "rpm", "kg", "N", "N m", "s", "1/s", "kg m2", "m/s**999", "furlong", "degC")  # fmt: skip
HOSTILE = (*TEXTS, "9**9**9**9", "(" * 3000 + ")" * 3000, "a" * 100_000)

# Units of one dimension.
SAME = (
    ("mm", "cm", "m", "in", "ft"),
    ("deg", "rad", "rev"),
    ("rpm", "rad/s", "1/s", "deg/s"),
    ("kg", "g", "t", "lb"),
    ("N", "kN", "MN", "lbf"),
    ("N m", "kN m", "J", "lbf ft"),
)


class Slow(BaseException):
    """A text takes more processor time than allowed."""


@cache
def stock() -> dict[str, str]:
    """All bundled texts, by their paths within the package."""
    paths = (
        p for folder in ("studies", "templates") for p in (STOCK / folder).rglob("*") if p.suffix in (".toml", ".csv")
    )
    return {str(path.relative_to(STOCK)): path.read_text(encoding="utf8") for path in sorted(paths)}


@cache
def documents() -> list[dict]:
    """All bundled TOML texts as they are read."""
    return [tomllib.loads(text) for path, text in stock().items() if path.endswith(".toml")]


@cache
def runnable() -> list[str]:
    """All bundled texts that can be run, by their paths: studies, and scenes with nothing varied."""
    return [path for path in stock() if path.endswith(".toml") and "/scenes/" not in path]


Place = tuple[Any, Any]


def places(value: Any) -> Iterator[Place]:
    """Every entry of a document: the table or list that contains it, and its key there."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in list(pairs):
        yield value, key
        yield from places(inner)


def other_value(dice: random.Random, old: Any, words: list[str]) -> Any:
    """A replacement for a value."""
    if isinstance(old, str) and old[:1].isdigit() and dice.random() < 0.7:
        number, _, unit = old.partition(" ")
        return dice.choice((f"{dice.choice(NUMBERS)} {unit}", f"-{old}", f"{number} {dice.choice(UNITS)}", number))
    return dice.choice(
        (
            dice.choice(words),
            dice.choice(words),
            f"{dice.choice(NUMBERS)} {dice.choice(UNITS)}".strip(),
            dice.choice(HOSTILE),
            dice.choice((0, -1, 1e308, float("nan"), True, [], {}, "", ["1 mm"], [[1.0]], {"x": 1}, 10**400)),
        )
    )


def garbled_document(dice: random.Random, text: str, others: list[dict]) -> str:
    """A TOML text with one to four entries changed, renamed, omitted, or taken from another text."""
    document = tomllib.loads(text)
    words = [value for table, key in places(document) if isinstance(value := table[key], str)] or ["a"]
    for _ in range(dice.choice((1, 1, 1, 2, 4))):
        found = list(places(document))
        if not found:
            break
        leaves = [(table, key) for table, key in found if not isinstance(table[key], (dict, list))]
        table, key = dice.choice(leaves if leaves and dice.random() < 0.7 else found)
        way = dice.random()
        if way < 0.3 and isinstance(table[key], str) and table[key][:1].isdigit():
            number, _, unit = table[key].partition(" ")
            with contextlib.suppress(ValueError):
                table[key] = f"{float(number) * 10 ** dice.uniform(-4, 4):.6g} {unit}".strip()
        elif way < 0.5:
            table[key] = other_value(dice, table[key], words)
        elif way < 0.65:
            del table[key]
        elif way < 0.75 and isinstance(table, dict):
            table[dice.choice([k for _, k in found if isinstance(k, str)])] = table.pop(key)
        elif isinstance(table, dict):
            donor = dice.choice([other for other in others if ("scene" in other) == ("scene" in document)])
            kind = dice.choice([k for k, v in donor.items() if isinstance(v, dict)] or [key])
            given = donor.get(kind, {})
            mine = document.setdefault(kind, {})
            if isinstance(mine, dict) and isinstance(given, dict) and given:
                chosen = dice.choice(list(given))
                mine[chosen if dice.random() < 0.7 else dice.choice(list(mine) or [chosen])] = copy.deepcopy(
                    given[chosen]
                )
    return tomlkit.dumps(document)


def garbled_text(dice: random.Random, text: str) -> str:
    """A text with lines or characters lost, doubled, exchanged or inserted."""
    lines = text.splitlines(keepends=True)
    for _ in range(dice.choice((1, 2, 5))):
        i = dice.randrange(len(lines))
        way = dice.randrange(7)
        if way == 0 and len(lines) > 1:
            del lines[i]
        elif way == 1:
            lines.insert(i, dice.choice(lines))
        elif way == 2:
            lines[i] = lines[i].replace(dice.choice('"=[]{},.'), dice.choice(('"', "'", "", "=", "\x00", "ä", ";")), 1)
        elif way == 3:
            cut = dice.randrange(len(lines[i]) + 1)
            lines[i] = lines[i][:cut] + lines[i][cut + 1 :]
        elif way == 4:
            lines[i] = "\ufeff" + lines[i].replace("\n", "\r\n")
        elif way == 5:
            lines[i] = dice.choice(HOSTILE)[:5000] + lines[i]
        else:
            lines = lines[: i + 1]
    return "".join(lines)


def changed_number(dice: random.Random, text: str) -> str:
    """A changed number, perhaps with its unit, or the number in another unit of its dimension."""
    number, _, unit = text.partition(" ")
    try:
        value = float(number)
    except ValueError:
        return text
    scaled = value * 10 ** dice.choice((dice.gauss(0, 0.15), dice.uniform(-4, 4)))
    nearby = value * (1 + dice.choice((-1, 1)) * 10.0 ** -dice.randrange(6, 16))
    number = dice.choice(
        (f"{scaled:.6g}", f"{scaled:.6g}", repr(nearby), f"{-value:.6g}", dice.choice(NUMBERS), number)
    )
    if dice.random() < 0.15:
        unit = dice.choice(next((family for family in SAME if unit in family), (unit,)))
    return f"{number} {unit}".strip()


def few_variants(study: dict) -> dict:
    """A study with only a few values of each variable."""
    for varied in study.get("vary", {}).values():
        if isinstance(varied, dict) and isinstance(varied.get("count"), int):
            varied["count"] = min(varied["count"], VALUES)
        if isinstance(varied, dict) and isinstance(varied.get("values"), list):
            varied["values"] = varied["values"][:VALUES]
    sampling = study.get("sampling")
    if isinstance(sampling, dict) and isinstance(sampling.get("count"), int):
        sampling["count"] = min(sampling["count"], SAMPLED)
    return study


def with_other_numbers(dice: random.Random, document: dict) -> str:
    """A scene or study with one to three numbers, units or goals changed, which need no compilation."""
    for _ in range(dice.choice((1, 1, 2, 3))):
        leaves = [(t, k) for t, k in places(document) if isinstance(t[k], (str, int, float)) and k != "scene"]
        numeric = [(t, k) for t, k in leaves if str(t[k])[:1] in "-.0123456789"]
        table, key = dice.choice(numeric if numeric and dice.random() < 0.9 else leaves)
        old = table[key]
        if isinstance(old, bool):
            table[key] = not old if dice.random() < 0.2 else old
        elif isinstance(old, int):
            table[key] = dice.randint(1, 4) if key == "count" else dice.choice((old - 1, old + 1, 2 * old))
        elif isinstance(old, float):
            table[key] = old * 10 ** dice.gauss(0, 0.3)
        elif key in ("minimise", "maximise"):
            table[{"minimise": "maximise", "maximise": "minimise"}[key]] = table.pop(key)
        else:
            table[key] = changed_number(dice, old)
    return tomlkit.dumps(document)


def numbers(dice: random.Random, name: str, folder: Path, report: Callable[[str, str, float], None]) -> None:
    """A study or template with changed numbers, its own or its scene's, run to its end."""
    bundled = stock()
    study = few_variants(tomllib.loads(bundled[name]))
    scene = str(Path(name).parent / study["scene"]) if "scene" in study else ""
    garbled = {name: tomlkit.dumps(study)}
    if scene in bundled and dice.random() < 0.7:
        garbled[scene] = with_other_numbers(dice, tomllib.loads(bundled[scene]))
    else:
        garbled[name] = with_other_numbers(dice, study)
    for path, text in garbled.items():
        (folder / path).write_text(text, encoding="utf8")
    try:
        run(name, folder, "\n".join(garbled.values()), report)
    finally:
        for path in garbled:
            (folder / path).write_text(bundled[path], encoding="utf8")


def run(target: str, folder: Path, garbled: str, report: Callable[[str, str, float], None]) -> None:
    """Run a text to its end."""
    result = folder / "result.h5"
    line = ["run", target, "--no-plots", "--quiet", "--out", str(result), "--replace", "--jobs", "1"]
    code, said, took = command(line, RUN_WITHIN)
    report(f"run: {judged(code, said, folder)}", garbled, took)
    for left in folder.glob("result*"):
        left.unlink()


def garbled_lines(dice: random.Random, scenes: list[str], made: str) -> list[str]:
    """A command line of known commands, options and values in some order."""
    files = (dice.choice(scenes), made, "none.toml", "", "/dev/null", ".", "crank_press", "result.h5")
    options = (
        ("--set", f"input.length={dice.choice(NUMBERS)} {dice.choice(UNITS)}"),
        ("--set", dice.choice(HOSTILE)),
        ("--at", f"{dice.choice(NUMBERS)} {dice.choice(UNITS)}"),
        ("--accuracy", dice.choice(NUMBERS)),
        ("--positions", dice.choice(NUMBERS)),
        ("--variant", dice.choice(NUMBERS)),
        ("--where", dice.choice((*HOSTILE, "a < 1", "required_power > 1 W"))),
        ("--sort", dice.choice(HOSTILE)),
        ("-x", "input.length"),
        ("-y", dice.choice(("piston.slide", "nothing", *HOSTILE))),
        ("--to", dice.choice(("out.csv", "out.svg", "out.dxf", "out.toml", "out.nothing", "/dev/full", "."))),
        ("--json",),
        ("--history",),
        ("--help",),
        (dice.choice(HOSTILE)[:1000],),
    )
    commands = ("list", "help", "guide", "new", "modes", "quantities", "check", "show", "plot", "report", "export")
    line = [dice.choice((*commands, "compare", "verify", "flywheel", "balance", "orders", "nothing"))]
    line += [dice.choice(files).replace("\x00", "") for _ in range(dice.choice((0, 1, 1, 2)))]
    for _ in range(dice.choice((0, 1, 1, 2, 3))):
        line += dice.choice(options)
    return [word.replace("\x00", "") for word in line]


def command(line: list[str], within: float) -> tuple[int | str, str, float]:
    """A command in this process: exit code or what went wrong, what it said, processor time [s]."""
    from sweeps.cli import main

    said, begun = io.StringIO(), time.process_time()
    signal.signal(signal.SIGPROF, _slow)
    signal.setitimer(signal.ITIMER_PROF, within)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            main(line, prog_name="sweeps")
        code: int | str = 0
    except SystemExit as ending:
        code = ending.code or 0
    except Slow:
        code = f"more than {within:g} s"
    except BaseException:
        code = "traceback: " + " ".join(traceback.format_exc().splitlines()[-3:])
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return code, said.getvalue(), time.process_time() - begun


def texts(dice: random.Random, folder: Path, evaluated: bool, report: Callable[[str, str, float], None]) -> None:
    """One garbled text among unchanged ones: read, printed, and perhaps run."""
    bundled = stock()
    name = dice.choice(list(bundled))
    garbled = bundled[name]
    structured = name.endswith(".toml") and dice.random() < 0.8
    garbled = garbled_document(dice, garbled, documents()) if structured else garbled_text(dice, garbled)
    (folder / name).write_text(garbled, encoding="utf8", errors="surrogatepass")
    try:
        target = name
        if not name.endswith(".toml") or "/scenes/" in name:
            users = [p for p, text in bundled.items() if p.endswith(".toml") and Path(name).name in text]
            target = dice.choice(users) if users else name
        code, said, took = command(["check", "--source", target], READ_WITHIN)
        report(judged(code, said, folder), garbled, took)
        if evaluated and code == 0:
            from sweeps.study.study_reader import read_study

            if read_study(target).design.size > FEW:
                return
            run(target, folder, garbled, report)
    finally:
        (folder / name).write_text(bundled[name], encoding="utf8")


def judged(code: int | str, said: str, folder: Path) -> str:
    """Outcome of a command in a word; anything but "results" and "refused" is wrong."""
    if (folder / "carried_out").exists():
        (folder / "carried_out").unlink()
        return "code carried out"
    if isinstance(code, str):
        return code
    if "Traceback" in said:
        return "traceback: " + said[-300:]
    if "\x1b" in said or "\x07" in said:
        return "control characters said"
    if code and not said.strip():
        return "refused without a word"
    if len(said) > 3000 and code:
        return f"message of {len(said)} characters"
    return "results" if code == 0 else "refused"


def batch(kind: str, seed: int, count: int, folder: Path, pipe: Connection) -> None:
    """A number of cases in a separate process, each reported at its end."""
    os.chdir(folder)
    # All cases of one study share its machine code.
    study = random.Random(f"{kind} {seed}").choice(runnable())
    begun = time.process_time()
    for i in range(count):
        if kind == "numbers" and time.process_time() - begun > BATCH_SECONDS:
            break
        dice = random.Random(f"{kind} {seed} {i}")
        pipe.send(f"{kind} {seed} {i}")

        def report(how: str, content: str, took: float, case: str = f"{kind} {seed} {i}") -> None:
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            pipe.send((case, how, content, took, memory))

        if kind == "lines":
            templates = [p for p in stock() if p.startswith("templates")]
            line = garbled_lines(dice, templates, "studies/flywheels/scenes/press.toml")
            code, said, took = command(line, READ_WITHIN * 6)
            how = judged(code, said, folder)
            report("results" if how.startswith("message of") and "--help" in line else how, " ".join(line), took)
        elif kind == "numbers":
            numbers(dice, study, folder, report)
        else:
            texts(dice, folder, kind == "evaluated", report)


def _slow(*_: object) -> None:
    raise Slow


def campaign(kind: str, count: int, seed: int, folder: Path, keep: Path | None, tally: Tally) -> None:
    """Count garbled texts or lines of one kind: outcomes, longest time, memory, failures."""
    context = multiprocessing.get_context("fork")
    size = NUMBERS_BATCH if kind == "numbers" else BATCH

    def note(case: str, how: str, content: str, took: float, memory: int) -> None:
        fine = how.removeprefix("run: ") in ("results", "refused")
        if memory > MOST_MEMORY and kind in ("texts", "numbers"):
            fine, how = False, f"{memory / 1e6:.0f} MB; {how}"
        way = how if fine else "run: wrong" if how.startswith("run: ") else "wrong"
        row = tally.note(kind, way, "" if fine else f"{case}: {how}")
        row["longest"] = max(row.get("longest", 0.0), took)
        row["memory"] = max(row.get("memory", 0), memory)
        if keep and not fine:
            (keep / f"{case.replace(' ', '_')}.txt").write_text(content, encoding="utf8", errors="replace")

    for first in range(0, count, size):
        mine, its = context.Pipe(duplex=False)
        process = context.Process(
            target=batch, args=(kind, seed * 1_000_000 + first, min(size, count - first), folder, its)
        )
        process.start()
        its.close()
        case = ""
        with contextlib.suppress(EOFError):
            while True:
                # A case that begins, or its outcome.
                told = mine.recv()
                if isinstance(told, str):
                    case = told
                else:
                    note(*told)
        process.join()
        if process.exitcode:
            note(case, f"the process ended with {process.exitcode}", "", 0.0, 0)


def main() -> None:
    """Garble, read, run, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, usual in (("texts", 20_000), ("numbers", 4000), ("evaluated", 100), ("lines", 2000), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=usual)
    parser.add_argument("--anew", action="store_true", help="Forget the counts of earlier slices.")
    parser.add_argument("--keep", type=Path, help="Folder for the texts that failed.")
    asked = parser.parse_args()
    if asked.keep:
        asked.keep.mkdir(parents=True, exist_ok=True)
    begun, tally = time.monotonic(), Tally(HERE / "mutations.json", asked.anew)
    line = " ".join(f"--{name} {getattr(asked, name)}" for name in ("texts", "numbers", "evaluated", "lines", "seed"))
    load_program()
    documents()
    with tempfile.TemporaryDirectory(prefix="mutations-") as scratch:
        folder = Path(scratch) / "texts"
        for part in ("studies", "templates"):
            shutil.copytree(STOCK / part, folder / part, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
        os.environ["XDG_CACHE_HOME"] = str(Path(scratch) / "cache")
        # Alternating, so that a stopped slice has cases of each kind; finished ones are kept.
        for turn in range(TURNS):
            for kind in ("texts", "lines", "numbers", "evaluated"):
                share = getattr(asked, kind) * (turn + 1) // TURNS - getattr(asked, kind) * turn // TURNS
                campaign(kind, share, asked.seed * TURNS + turn, folder, asked.keep, tally)
            tally.keep(line, (time.monotonic() - begun) / 60, f"{turn + 1} of {TURNS} turns")
            (HERE / "mutations.md").write_text(table(tally), encoding="utf8")


def load_program() -> None:
    """Load the whole program, which forks then have."""
    for found in pkgutil.walk_packages(sweeps.__path__, "sweeps."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)


NAMES = {
    "texts": "texts read, functions printed",
    "lines": "command lines",
    "numbers": "numbers, units, formulas, names changed, and run",
    "evaluated": "texts read, and run where read",
}


def table(tally: Tally) -> str:
    """The counts as a text."""
    rows = []
    for kind, row in tally.data["kinds"].items():
        times = sum(count for way, count in row["ways"].items() if kind == "numbers" or not way.startswith("run: "))
        figures = f"{row['longest']:.1f} | {row['memory'] / 1e6:.0f} | {row['wrong']}"
        rows.append(f"| {NAMES[kind]} | {times} | {tally.ways(kind)} | {figures} |")
    words = f"""Wrong are: a traceback, a crash, more than {READ_WITHIN:g} s of processor time or
{MOST_MEMORY / 1e9:g} GB to read a text, more than {RUN_WITHIN:g} s to run one of at most {FEW} variants, a failure
without a message, a message of more than 3000 characters, and executed code from a text.

| kind | cases | outcome | longest, s of processor | memory, MB | wrong |
|---|---|---|---|---|---|"""
    return tally.text("Texts and command lines garbled at random", "mutations.py", words, rows)


if __name__ == "__main__":
    main()
