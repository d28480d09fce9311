"""Code, paths and control characters in place of an expression, a name, a path or a title."""

import re
from pathlib import Path

from bench import Bench
from hostile import TEXTS

from sweeps.text.templates import template_text

_SCENE = template_text("slider_crank")
# Where a text is inserted, as a TOML basic string: into the scene or the study.
_PLACES = {
    "derived parameter": 'scene = "s.toml"\n[derive]\n"input.length" = {0}\n',
    "name of a parameter": 'scene = "s.toml"\n[vary]\n{0} = {{ values = [1.0, 2.0] }}\n',
    "condition required": 'scene = "s.toml"\nrequire = [{0}]\n[vary]\n"input.length" = {{ values = ["40 mm"] }}\n',
    "what is best": 'scene = "s.toml"\n[vary]\n"input.length" = {{ values = ["40 mm"] }}\n[best]\nminimise = {0}\n',
    "where": 'scene = "s.toml"\n[vary]\n"input.length" = {{ values = ["40 mm"] }}\n'
    '[best]\nminimise = "required_power"\nwhere = {0}\n',
    "summary": 'scene = "s.toml"\n[outputs]\nsummaries = [{0}]\n',
    "value": 'scene = "s.toml"\n[vary]\n"input.length" = {{ values = [{0}] }}\n',
    "scene": "scene = {0}\n",
    "table of variants": 'scene = "s.toml"\nvariants = {0}\n',
    "title": 'title = {0}\nquestion = {0}\nscene = "s.toml"\n[vary]\n"input.length" = {{ values = ["40 mm"] }}\n',
}
_IN_SCENE = {
    "formula of a force": '[forces.f]\ntype = "formula"\non = "B"\nangle = "0 deg"\nforce = {0}\n',
    "table of a force": '[forces.f]\ntype = "table"\non = "B"\nangle = "0 deg"\nslider = "piston"\nfile = {0}\n',
    "name of a force": '[forces.{0}]\ntype = "constant"\non = "B"\nangle = "0 deg"\nforce = "1 N"\n',
    "name of a body": '[bodies.{0}]\nlink = "piston"\nmass = "1 kg"\n',
    "number": '[bodies.more]\nlink = "piston"\nmass = {0}\n',
}
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\x80-\x9f\u202e]")


def basic(text: str) -> str:
    """A text as TOML's basic string."""
    safe = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c >= " " and c.isprintable() else f"\\u{ord(c):04x}" for c in safe) + '"'


ATTEMPTS = [(place, text) for place in (*_PLACES, *_IN_SCENE, "option") for text in TEXTS]


def inject(bench: Bench) -> None:
    """One attempt: the text is checked, its functions printed, run, drawn and reported, as long as it is accepted."""
    place, text = bench.dice.choice(ATTEMPTS)
    scene, study = _SCENE, _PLACES["title"].format('"t"')
    options: tuple[str, ...] = ()
    if place in _PLACES:
        study = _PLACES[place].format(basic(text))
    elif place in _IN_SCENE:
        scene += "\n" + _IN_SCENE[place].format(basic(text))
    else:
        clean = text.replace("\x00", "")
        options = bench.dice.choice((("--set", clean), ("--set", f"input.length={clean}"), ("--accuracy", clean)))
    (bench.work / "s.toml").write_text(scene, encoding="utf8")
    (bench.work / "i.toml").write_text(f"{study}", encoding="utf8")
    before, ends = _files(bench.folder), []
    ends.append(bench.command("check", "i.toml", "--source", *options))
    if ends[-1].code == 0:
        ends.append(bench.command("run", "i.toml", "--quiet", "--out", "i.h5", *options))
        if (bench.work / "i.h5").exists():
            ends += [bench.command(*line) for line in _LOOKS]
    wrong = [end.fault for end in ends if end.fault]
    if (bench.work / "carried_out").exists():
        wrong.append("code carried out")
    said = "".join(end.out + end.err for end in ends)
    wrong += ["control characters said"] if _CONTROL.search(said) else []
    wrong += ["contents of a foreign file quoted"] if re.search(r"root:x:|XDG_CACHE_HOME=", said) else []
    for page in ("i.html", "i.svg"):
        held = (bench.work / page).read_text() if (bench.work / page).exists() else ""
        if "<script>alert" in held or "<img src=x" in held or _CONTROL.search(held):
            wrong.append(f"{page} holds the text as code")
    table = (bench.work / "i.csv").read_text() if (bench.work / "i.csv").exists() else ""
    wrong += ["i.csv begins a cell with a formula"] if re.search(r'(?m)(^|,)"?=', table) else []
    strangers = [path for path in _files(bench.folder) - before if not _is_own(path)]
    wrong += [f"files made elsewhere: {strangers[:3]}"] if strangers else []
    for path in bench.work.glob("i[._]*"):
        path.unlink()
    (bench.work / "carried_out").unlink(missing_ok=True)
    way = "refused" if ends[0].code else f"harmless text, {'run' if len(ends) > 2 else 'not run'}"
    bench.note("injections", way, wrong and f"{place} = {text!r}: {'; '.join(wrong)}")


_LOOKS = (
    ("show", "i.h5"),
    ("report", "i.h5", "--out", "i.html"),
    ("export", "i.h5", "--to", "i.csv"),
    ("export", "s.toml", "--to", "i.svg"),
)


def _files(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if path.is_file()}


def _is_own(path: Path) -> bool:
    return path.name.startswith(("i.", "i_")) or path.name == "written" or {"cache", "said"} & {*path.parts}
