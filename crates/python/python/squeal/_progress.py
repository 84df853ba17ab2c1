"""Progress: a function of (stage, done, total), or a bar where somebody looks."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Literal

from ._errors import refused

#: `None` is a bar where standard error is a terminal, `False` nobody, a function is told of each stage now and then.
Progress = Callable[[str, int, int], object] | Literal[False] | None


class _Bar:
    """Lines of a terminal, one for each stage."""

    def __init__(self) -> None:
        self.stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        beginning = "\n" if self.stage not in ("", stage) else ""
        self.stage = stage
        end = "\n" if done >= total else ""
        print(f"{beginning}\r{done} of {total} {stage}", end=end, file=sys.stderr, flush=True)
        if end:
            self.stage = ""


def receiver(progress: Progress) -> Callable[[str, int, int], object] | None:
    """The function that is told."""
    if progress is None:
        return _Bar() if sys.stderr is not None and sys.stderr.isatty() else None
    if progress is False:
        return None
    if not callable(progress):
        raise refused("progress", repr(progress), "None, False or a function of (stage, done, total)")
    return progress
