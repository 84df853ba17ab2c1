"""Tables as TOML, numbers in the digits that give them back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np


def value(of: Any) -> str:
    """A value in a line."""
    if isinstance(of, bool | np.bool_):
        return "true" if of else "false"
    if isinstance(of, str):
        return json.dumps(of, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(of, int | np.integer):
        # TOML has the whole numbers of 64 bits.
        return str(int(of)) if -(2**63) <= of < 2**63 else repr(_double(int(of)))
    if isinstance(of, float | np.floating):
        return repr(float(of))
    if isinstance(of, Mapping):
        return "{ " + ", ".join(f"{value(str(key))} = {value(item)}" for key, item in of.items()) + " }"
    if isinstance(of, np.ndarray):
        of = of.tolist()
    if isinstance(of, list | tuple):
        return "[" + ", ".join(map(value, of)) + "]"
    raise TypeError(f"{type(of).__name__} has no form in TOML")


def _double(of: int) -> float:
    try:
        return float(of)
    except OverflowError:
        raise TypeError("a whole number beyond all doubles has no form in TOML") from None


def document(tables: Mapping[str, Any]) -> str:
    """A case file of these tables."""
    lines = [f"{value(key)} = {value(of)}" for key, of in tables.items() if not _is_table(of)]
    for name, of in tables.items():
        if not _is_table(of):
            continue
        many = isinstance(of, list)
        for table in of if many else [of]:
            lines.append(f"\n[[{value(name)}]]" if many else f"\n[{value(name)}]")
            lines += [f"{value(str(key))} = {value(item)}" for key, item in table.items()]
    return "\n".join(lines).lstrip("\n") + "\n"


def _is_table(of: Any) -> bool:
    return isinstance(of, Mapping) or (isinstance(of, list) and bool(of) and all(isinstance(item, Mapping) for item in of))
