"""Files that commands write in folders that others may write to: nobody can predict a draft or redirect it."""

import ast
import os
import sys
from pathlib import Path

import pytest
from commands import ROOT, WRITES, done, said


def test_draft__is_created_by_its_writer_alone(press_folder, monkeypatch):
    """The system's call that creates it fails where there is anything, a link too. A page draws all pictures: 6 s."""
    opened, real = [], os.open

    def noted(path: object, flags: int, *rest: object, **options: object) -> int:
        if isinstance(path, Path) and flags & os.O_CREAT and path.parent == press_folder.resolve():
            opened.append((path.name, flags))
        return real(path, flags, *rest, **options)

    monkeypatch.setattr(os, "open", noted)
    # The mode that the finished file gets is the one that its user's files have.
    mask = os.umask(0o027)
    try:
        for arguments in [*WRITES, WRITES[0]]:
            Path(arguments[-1]).unlink(missing_ok=True)
            before = len(opened)
            done(*arguments)
            assert len(opened) > before, arguments
    finally:
        os.umask(mask)
    assert len({name for name, _ in opened}) == len(opened)
    assert all(flags & os.O_EXCL and flags & os.O_NOFOLLOW for _, flags in opened)
    made = [path for path in press_folder.glob("out*") if path.is_file()]
    assert len(made) >= len(WRITES)
    assert {path.stat().st_mode & 0o777 for path in made} == {0o640}


def test_planted_link__is_not_written_through(press_folder, monkeypatch):
    """Even where the name of a draft is known beforehand."""
    monkeypatch.setattr("sweeps.text.whole_files.secrets.token_hex", lambda count: "known")
    target = press_folder / "target"
    # All of them write by one function: see the last test.
    for arguments in WRITES[:1] + WRITES[-2:]:
        link = press_folder / f".known{Path(arguments[-1]).suffix}"
        link.symlink_to(target)
        answer = said(*arguments)
        assert answer.exit_code == 2, arguments
        assert answer.stderr.count("\n") == 1
        assert "File exists" in answer.stderr
        assert not target.exists()
        link.unlink()


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root makes links of other users")
@pytest.mark.parametrize("name", ["out.csv", "out.part.h5"])
def test_link_of_another_user__is_refused(name, press_folder):
    target = press_folder / "target"
    target.write_text("precious")
    os.symlink(target, name)
    os.lchown(name, 65534, 65534)
    command = ("export", "press.toml", "--to", name) if name == "out.csv" else ("run", "study.toml", "--out", "out.h5")
    answer = said(*command)
    assert answer.exit_code == 2
    assert "link owned by another user" in answer.stderr
    assert target.read_text() == "precious"
    # The owner of a folder may lead what is written in it elsewhere.
    os.chown(".", 65534, 65534)
    if name == "out.csv":
        done(*command)
        assert target.read_text() != "precious"


WRITING = {"write_text", "write_bytes", "savefig", "saveas", "save", "copyfile"}
# They are handed a draft, write into memory, or make result files, which HDF5 creates exclusively.
OTHERWISE = {"python/display.py", "store/creating.py"}


def test_every_writer__takes_its_draft_from_one_place():
    for path in (ROOT / "sweeps").rglob("*.py"):
        text, name = path.read_text(encoding="utf8"), path.relative_to(ROOT / "sweeps").as_posix()
        # Folders too, which a signal is to remove.
        assert "import tempfile" not in text or name == "text/whole_files.py", name
        for call in (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)):
            called = call.func.attr if isinstance(call.func, ast.Attribute) else ""
            modes = [a.value for a in call.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
            opens = called in {"open", "File"} and any({*mode} <= {*"wax+bt"} and mode != "b" for mode in modes)
            if (opens or called in WRITING) and name not in OTHERWISE:
                assert "whole_file" in text, f"{name}, line {call.lineno}: write to a draft of whole_file"


if sys.platform == "win32":
    pytestmark = pytest.mark.skip("needs links")
