"""Tables: the CSV files of a study as NumPy columns."""

from __future__ import annotations

import csv
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._frozen import frozen

if TYPE_CHECKING:
    import pandas

#: Columns that are text whatever stands in them.
_TEXT = frozenset(
    "constraints law speed arrangement mode label shape_file dof from_constraints from_mode to_constraints to_mode continuation family"
    " body comparison other_constraints other_law other_speed scene error kind parameter unit output input index places"
    " estimator change set more less other contact loudest_body".split()
)


#: Such columns of the tables whose other columns have the names of parameters, which may be any.
_BESIDE_PARAMETERS = {
    "samples": frozenset("constraints law speed arrangement unstable may_be".split()),
    **dict.fromkeys(
        ("branches", "onsets", "coalescences", "boundary", "regions"), frozenset("mode other_mode direction curve brake".split())
    ),
}


def _column(is_text: bool, cells: Sequence[str]) -> npt.NDArray[Any]:
    """Whole numbers, numbers with NaN where a cell is empty, or text."""
    if not is_text:
        try:
            return np.array([int(cell) for cell in cells], dtype=np.int64)
        except (ValueError, OverflowError):
            pass
        try:
            return np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
        except ValueError:
            pass
    return np.array(cells, dtype=str)


def _written(cell: str) -> str:
    """A cell as it was before it got the apostrophe that texts have in CSV files where a spreadsheet would take them for formulas."""
    text = cell.lstrip("'")
    return cell[1:] if text != cell and len(text) > 1 and text[0] in "=+-@\t\r" else cell


class Table(Mapping[str, npt.NDArray[Any]]):
    """A table: a mapping from the names of its columns to arrays, which cannot be written to.

    Of columns of one name, as where a parameter is called `growth`, the second is `growth.1`.
    """

    def __init__(self, name: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        #: Name: that of its file without `.csv`.
        self.name = name
        self._rows = len(rows)
        text = _BESIDE_PARAMETERS.get(name, _TEXT)
        before = [columns[:at].count(column) for at, column in enumerate(columns)]
        names = [f"{column}.{count}" if count else column for column, count in zip(columns, before, strict=True)]
        self._columns = {column: _column(column in text, [row[at] for row in rows]) for at, column in enumerate(names)}
        frozen(list(self._columns.values()))

    def __setstate__(self, state: dict[str, Any]) -> None:
        """After it went to another process its arrays are not written to either."""
        self.__dict__.update(state)
        frozen(list(self._columns.values()))

    # Arrays are not compared as a whole: a table is itself alone.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @classmethod
    def read(cls, path: pathlib.Path) -> Table:
        """The table of a CSV file; a `ValueError` says where it is damaged."""
        try:
            with path.open(encoding="utf-8", newline="") as file:
                columns, *rows = [[_written(cell) for cell in row] for row in csv.reader(file)] or [[]]
        except csv.Error as error:
            raise ValueError(f"{path.name} is no table ({error})") from None
        if not columns:
            raise ValueError(f"{path.name} is empty")
        for line, row in enumerate(rows, 2):
            if len(row) != len(columns):
                raise ValueError(f"{path.name} has {len(row)} values in row {line}, and {len(columns)} columns")
        return cls(path.stem, columns, rows)

    def __getitem__(self, column: str) -> npt.NDArray[Any]:
        return self._columns[column]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns; that of rows is `rows`."""
        return len(self._columns)

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self._rows

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a DataFrame."""
        import pandas

        return pandas.DataFrame({name: column.copy() for name, column in self._columns.items()})

    def __repr__(self) -> str:
        return f"Table({self.name!r}, {self._rows} rows: {', '.join(self._columns)})"


class Tables(Mapping[str, Table]):
    """Tables by their names."""

    __slots__ = ("_tables",)

    def __init__(self, tables: Sequence[Table]) -> None:
        self._tables = {table.name: table for table in tables}

    def __getitem__(self, name: str) -> Table:
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __repr__(self) -> str:
        return f"Tables({', '.join(self._tables)})"
