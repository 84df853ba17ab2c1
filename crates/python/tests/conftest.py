import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture
def cases() -> pathlib.Path:
    return ROOT / "cases"


@pytest.fixture
def fixtures() -> pathlib.Path:
    return ROOT / "tests" / "fixtures" / "hard"
