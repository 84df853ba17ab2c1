"""The blocks of docs/python.md run, one after the other, and so does that of the package's own page."""

import os
import re

import matplotlib
import pytest

from conftest import ROOT

matplotlib.use("agg")


@pytest.mark.parametrize("page", ["docs/python.md", "crates/python/README.md"])
def test_the_blocks_of_a_page_run(page, monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    text = (ROOT / page).read_text()
    blocks = list(re.finditer(r"^```python\n(.*?)^```", text, re.M | re.S))
    names = {}
    for block in blocks:
        # Lines of the page in what a fault says.
        before = "\n" * (text[: block.start()].count("\n") + 1)
        exec(compile(before + block[1], os.fspath(ROOT / page), "exec"), names)
    assert blocks and "squeal" in text
    if "plt" in names:
        names["plt"].close("all")
