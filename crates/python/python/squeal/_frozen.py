"""Results, which are not written to: a copy is made of what is to be changed."""

from __future__ import annotations

from typing import Any

import numpy as np


def _refuse(*_: object, **__: object) -> Any:
    raise TypeError("results are not written to; allowed: a copy, as dict(...) or list(...) makes it")


class FrozenDict(dict[Any, Any]):
    """A dict of results."""

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> Any:
        return FrozenDict, (dict(self),)


class FrozenList(list[Any]):
    """A list of results."""

    __setitem__ = __delitem__ = __iadd__ = __imul__ = append = clear = extend = insert = pop = remove = reverse = sort = _refuse

    def __reduce__(self) -> Any:
        return FrozenList, (list(self),)


def frozen(of: Any) -> Any:
    """What cannot be written to any more: arrays, and dicts and lists with all that is in them."""
    if isinstance(of, np.ndarray):
        of.flags.writeable = False
    elif isinstance(of, dict):
        return FrozenDict({key: frozen(item) for key, item in of.items()})
    elif isinstance(of, list):
        return FrozenList(map(frozen, of))
    elif type(of) is tuple:
        return tuple(map(frozen, of))
    return of


class Frozen:
    """Results of named parts, of which none is written to; neither after they went to another process."""

    def __post_init__(self) -> None:
        self.__setstate__(self.__dict__)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update({name: frozen(part) for name, part in state.items()})
