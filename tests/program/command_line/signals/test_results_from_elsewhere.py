"""Result files edited by hand, damaged, or of other programs: sentences, never a traceback."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import refused, said

# Tests of pictures look at what is drawn.
pytestmark = pytest.mark.usefixtures("blank_pictures")

EXPORTS = ("export --to o.csv", "export --variant 0 --to o.toml")
COMMANDS = ("show", "show --where ram.stroke>'1mm'", "plot", "plot --variant 0", *EXPORTS)
COMMANDS = [command.split() for command in COMMANDS]


def reworked(path: str, change: Callable[[dict], None]) -> None:
    """Change the record of the study in a file, with its checksum, as a program of someone else's might."""
    with h5py.File(path, "r+") as file:
        record = json.loads(file.attrs["study_json"])
        change(record)
        file.attrs["study_json"] = json.dumps(record)
        del file["progress"].attrs["text_checksums"]


def with_value(key: str, value: object) -> Callable[[dict], None]:
    return lambda record: record.update({key: value})


CHANGES = {
    "no best": lambda record: record.pop("best"),
    "no scene": lambda record: record.pop("scene"),
    "no axes": lambda record: record.pop("vary"),
    "best of nothing": with_value("best", {"minimise": "beauty", "maximise": None, "where": []}),
    "an unreadable condition": with_value("best", {"minimise": "excess_work", "maximise": None, "where": "a >"}),
    "axes of another size": with_value("vary", [{"names": ["input.length"], "size": 3}]),
    "a search without a task": with_value("search", {}),
}


@pytest.mark.parametrize("name", CHANGES)
def test_edited_record__is_told_by_every_command(name, press_result):
    reworked(press_result, CHANGES[name])
    for command, *options in COMMANDS:
        message = refused(command, press_result, *options)
        assert press_result in message
        assert "attribute study_json" in message
        assert message.count("\n") == 1


def test_edited_scene__is_told_by_what_needs_it(press_result):
    reworked(press_result, lambda record: record["scene"].update(input={"type": "wheel"}))
    message = refused("export", press_result, "--variant", "0", "--to", "o.toml")
    assert "has an invalid scene" in message


@pytest.mark.parametrize("text", [None, "", "{", "[]", "7", "null", "[" * 60_000])
def test_record_that_is_none__is_told(text, press_result):
    with h5py.File(press_result, "r+") as file:
        del file.attrs["study_json"]
        if text is not None:
            file.attrs["study_json"] = text
            del file["progress"].attrs["text_checksums"]
    words = "its attribute study_json is missing" if text is None else "attribute study_json"
    assert words in refused("show", press_result)


def test_missing_attributes__are_told_or_not_needed(press_result):
    with h5py.File(press_result, "r+") as file:
        del file.attrs["outcome"]
    assert said("verify", press_result).exit_code == 0
    for name in ("question", "title", "study", "scene", "versions"):
        with h5py.File(press_result, "r+") as file:
            del file.attrs[name]
    assert said("verify", press_result).exit_code == 1
    for command, *options in COMMANDS:
        assert said(command, press_result, *options).exit_code == 0, command
    with h5py.File(press_result, "r+") as file:
        del file.attrs["study_json"]
    for command, *options in COMMANDS:
        assert said(command, press_result, *options).exit_code == 2, command


@pytest.mark.parametrize("name", ["status", "ram.stroke", "ram.stroke_error", "input.length", "progress/block_done"])
def test_missing_dataset__is_told(name, press_result):
    with h5py.File(press_result, "r+") as file:
        del file[name]
    for command, *options in COMMANDS:
        assert press_result in refused(command, press_result, *options)


def test_verify__tells_sound_damaged_and_unfinished_files_apart(press_result):
    answer = said("verify", press_result)
    assert (answer.exit_code, answer.stdout) == (0, f"{press_result}: 8 variants intact\n")
    shutil.copy(press_result, "copy.h5")
    with h5py.File("copy.h5", "r+") as file:
        file["ram.stroke"][1] += 1e-3
    answer = said("verify", "copy.h5")
    assert answer.exit_code == 1
    assert "copy.h5: variants 0 … 7 are damaged" in answer.stderr
    assert "copy.h5 is damaged (variants 0 … 7)" in refused("show", "copy.h5")
    shutil.copy(press_result, "text.h5")
    with h5py.File("text.h5", "r+") as file:
        file.attrs["question"] = "What?"
    answer = said("verify", "text.h5")
    assert answer.exit_code == 1
    assert "question was modified" in answer.stderr
    Path("notes.h5").write_text("my notes")
    assert "not an HDF5 file" in refused("verify", "notes.h5")


def test_flipped_bytes_anywhere__never_a_traceback(press_result):
    """Also in HDF5's own tables, which have no checksums: whatever a command makes of them, it ends in words."""
    whole, rng = Path(press_result).read_bytes(), np.random.default_rng(7)
    # Tables fill the beginning and lie between the data.
    for at in (*range(0, 96, 12), *rng.integers(96, len(whole), 15)):
        content = bytearray(whole)
        content[at] ^= int(rng.integers(1, 256))
        Path("spoilt.h5").write_bytes(content)
        for command in ("show", "verify"):
            answer = said(command, "spoilt.h5")
            assert answer.exit_code in (0, 1, 2)
