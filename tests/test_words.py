"""Plain words: comments, docstrings, messages and the guide avoid phrases that no engineer says."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# Patterns of what nobody says at a drawing board, and what to say.
PLAIN = {
    r"\bas of\b": "as in, as for, as at",
    r"isn't a number|no number\b": "NaN, undefined",
    r"[Ww]hat isn't|what is (told|looked)": "name the thing",
    r"that is told|is told\b|are told\b": "is reported, is given",
    r"answers for\b": "covers",
    r"by this alone": "by this only",
    r"[Nn]or .{1,30} once more": "without repeated",
    r"[Ww]hatever is made of it": "later calculations",
    r"\bbesides\b": "also, without",
    r"repeats itself": "steady, periodic",
    r"keeps the speed uniform": "drive torque for constant speed",
    r"(moment|torque) that closes the cycle": "mean drive torque",
    r"greatest magnitude": "peak",
    r"(least|greatest) value of": "minimum of, maximum of",
    r"root of the mean square": "rms",
    r"comes to no end": "never ends",
}
BANNED = PLAIN | {
    r"keeps? the speed even": "limits the speed fluctuation",
    r"quality of (force )?transmission": "transmission angle",
    r"may be off\b|\b[Dd]oubts?\b|[Ee]rror figures?": "error estimate",
    r"\b[Hh]and(s|ed)? (on|out|over)\b": "pass, supply, return",
    r"must be given|(may|can) be left out|unless given": "required, optional, default",
    r"isn't finite": "infinite, NaN",
    r"\b([Oo]f|by) what\b": "name the thing",
    r"\b[Tt]ells?\b(?! :)|\b[Tt]old\b": "give, report, show",
    r"\b[Aa]nswers? for\b": "give",
    r"\bgo(es)? on\b": "continue, resume",
    r"\bcomes? to\b(?! rest)|\b(is|are) to be\b": "reach; an active verb",
    r"\b[Ss]o many\b": "a number",
    r"\bin its own\b": "only, separate",
    r"(?<![Tt]here )\b(is|are) no \w+": "is not a",
    r"\bonce more\b|\banew\b": "again",
    r"(?<!-)\b[Bb]esides?\b(?! :)|\b[Aa]side\b": "next to, also",
    r"\b(a|either|which|the whole|a long|all the) way\b|\b[Tt]he way (of|to)\b": "distance, direction, how",
    r"(?<![\w.])[Gg]reatest?(?!\w)": "maximum, peak",
    r"\b[Mm]otors?'?s? moments?\b|\b[Mm]oments? of (the |a )?motors?\b": "motor torque",
    r"\b[Uu]niform speed\b": "constant speed",
    r"\blink \w+ from link\b": "crankpin force (joint A): crank on rod",
    r"\b([Tt]he|its|their|each) begin\b": "start",
    r"\b[Ll]east (value|radius|magnitude|speed|torque)\b": "minimum",
}
# Folders and files that are read, whether only what a user sees counts (no comments, no docstrings), and the patterns.
SCOPE = (
    ("sweeps", False, BANNED),
    ("README.md", False, BANNED),
    ("engine", True, BANNED),
    ("engine/compiling", False, PLAIN),
    ("engine/cycle", False, PLAIN),
    ("engine/elements", False, BANNED),
    ("engine/graph", False, PLAIN),
    ("engine/laws", False, PLAIN),
    ("engine/motion", False, BANNED),
    ("engine/stepping", False, BANNED),
    ("engine/quantities", False, PLAIN),
    ("engine/machine", False, PLAIN),
    ("engine/mechanism", False, PLAIN),
    ("engine/parts", False, PLAIN),
    ("engine/scene", False, PLAIN),
    ("engine/units", False, PLAIN),
    ("engine/warnings", False, BANNED),
    ("engine/words/verdicts.py", False, PLAIN),
)
ENDINGS = {".py", ".pyi", ".md", ".toml", ".txt", ".html", ".js"}
# Right texts with a banned phrase: file, text, reason.
EXCEPTIONS = {
    ("engine/elements/elastic_drives/two_masses.py", "greatest, greatest_at :"): "names of attributes",
    ("engine/elements/oscillators/one_mass.py", "greatest, time :"): "name of an attribute",
    ("sweeps/synthesis/paths.py", "rms, greatest : float"): "name of an attribute",
    ("engine/quantities/chapters/dynamics.py", "motor moment"): "name of a node that nobody sees",
}


_JS = re.compile(r"//.*|\"[^\"]*\"|`[^`]*`?|^\s*\*.*")


def files(place: str) -> list[Path]:
    path = ROOT / place
    return sorted(f for f in path.rglob("*") if f.suffix in ENDINGS) if path.is_dir() else [path]


def docstrings(tree: ast.Module) -> set[int]:
    """Identities of the docstrings' nodes."""
    owners = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    bodies = (node.body for node in ast.walk(tree) if isinstance(node, owners))
    return {id(body[0].value) for body in bodies if body and isinstance(body[0], ast.Expr)}


@cache
def texts(file: Path, seen_only: bool) -> list[tuple[int, str]]:
    return list(found_texts(file, seen_only))


def found_texts(file: Path, seen_only: bool) -> Iterator[tuple[int, str]]:
    source = file.read_text(encoding="utf8")
    if file.suffix == ".js":
        # Comments and texts, without the code in these.
        source = "\n".join(" ".join(_JS.findall(re.sub(r"\$\{[^}]*\}", "", line))) for line in source.splitlines())
    if file.suffix not in {".py", ".pyi"}:
        yield from enumerate(source.splitlines(), 1)
        return
    tree = ast.parse(source)
    hidden = docstrings(tree) if seen_only else set()
    for node in ast.walk(tree):
        # One word alone is a key.
        if (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in hidden
            and " " in node.value
        ):
            yield from enumerate(node.value.splitlines(), node.lineno)
    if not seen_only:
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.string


def excepted(place: str, text: str) -> bool:
    return any(place.startswith(where) and what in text for where, what in EXCEPTIONS)


def hits(place: str, seen_only: bool, banned: dict[str, str]) -> Iterator[str]:
    for file in files(place):
        name, read = file.relative_to(ROOT).as_posix(), texts(file, seen_only)
        whole = "\n".join(text for _, text in read)
        for pattern, instead in banned.items():
            # Most patterns are nowhere in a file.
            for line, text in read if re.search(pattern, whole) else ():
                found = re.search(pattern, text)
                if found and not excepted(name, text):
                    yield f"{name}:{line}: {found[0]!r}: say {instead}: {text.strip()}"


@pytest.mark.parametrize(("place", "seen_only", "banned"), SCOPE)
def test_words__are_plain_english(place, seen_only, banned):
    found = list(hits(place, seen_only, banned))
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize(("where", "what"), EXCEPTIONS)
def test_exceptions__are_needed(where, what):
    assert any(excepted(where, text) and what in text for _, text in texts(ROOT / where, False))
