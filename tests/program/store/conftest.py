"""Names of a result and of its part file."""

from pathlib import Path

import pytest


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "out.h5"


@pytest.fixture
def part(tmp_path: Path) -> Path:
    return tmp_path / "out.part.h5"
