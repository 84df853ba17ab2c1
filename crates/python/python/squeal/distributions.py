"""Distributions of parameters, as case files have them; docs/case-files.md says what each is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar

from ._arrays import number, real, text
from ._errors import refused


@dataclass(frozen=True)
class Distribution:
    """What a parameter is drawn from; `unit` is for information only."""

    #: Name in case files.
    kind: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for field in fields(self):
            given = getattr(self, field.name)
            if field.type == "str":
                text(field.name, given)
            elif "Sequence" in str(field.type):
                if real(field.name, given).ndim != 1:
                    raise refused(field.name, repr(given), "a list of numbers")
            elif given is not None or "None" not in str(field.type):
                number(field.name, given)

    def table(self) -> dict[str, Any]:
        """The table of a case file."""
        given = {field.name.rstrip("_"): getattr(self, field.name) for field in fields(self)}
        plain = {name: list(value) if isinstance(value, Iterable) and not isinstance(value, str) else value for name, value in given.items() if value is not None}
        return {"distribution": self.kind, **plain}


@dataclass(frozen=True)
class Constant(Distribution):
    """Always the same value."""

    kind: ClassVar[str] = "constant"
    value: float
    unit: str = ""


@dataclass(frozen=True)
class Uniform(Distribution):
    """Uniform between two values."""

    kind: ClassVar[str] = "uniform"
    from_: float
    to: float
    unit: str = ""


@dataclass(frozen=True)
class Normal(Distribution):
    """Normal, under the condition that the value lies between the bounds; none is below 0 unless `at_least` says so."""

    kind: ClassVar[str] = "normal"
    mean: float
    deviation: float
    at_least: float = 0.0
    at_most: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class LogNormal(Distribution):
    """median e^(sigma z) with z standard normal, under the condition that the value lies between the bounds."""

    kind: ClassVar[str] = "log-normal"
    median: float
    sigma: float
    at_least: float | None = None
    at_most: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class LogUniform(Distribution):
    """The logarithm of the value is uniform."""

    kind: ClassVar[str] = "log-uniform"
    from_: float
    to: float
    unit: str = ""


@dataclass(frozen=True)
class Triangular(Distribution):
    """A density that rises from the smallest value to the mode and falls to the largest."""

    kind: ClassVar[str] = "triangular"
    from_: float
    mode: float
    to: float
    unit: str = ""


@dataclass(frozen=True)
class Weibull(Distribution):
    """from + scale (-ln(1 - u))^(1 / shape), u uniform."""

    kind: ClassVar[str] = "weibull"
    shape: float
    scale: float
    from_: float = 0.0
    unit: str = ""


@dataclass(frozen=True)
class Quantiles(Distribution):
    """A table of quantiles, linear between two neighbours."""

    kind: ClassVar[str] = "quantiles"
    probabilities: Sequence[float]
    values: Sequence[float]
    unit: str = ""


@dataclass(frozen=True)
class Discrete(Distribution):
    """One of a few ascending values, each with a probability in proportion to its weight; equal ones without."""

    kind: ClassVar[str] = "discrete"
    values: Sequence[float]
    weights: Sequence[float] = ()
    unit: str = ""


@dataclass(frozen=True)
class Empirical(Distribution):
    """Measured values, in any order: the quantile function is linear between them."""

    kind: ClassVar[str] = "empirical"
    values: Sequence[float]
    unit: str = ""

    def table(self) -> dict[str, Any]:
        return {**super().table(), "values": sorted(real("values", self.values).tolist())}
