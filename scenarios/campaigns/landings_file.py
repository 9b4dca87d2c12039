"""A campaign's rows as Parquet: columns in a fixed order and type, rows by cell and seed.

Beside the schema stand `decklander.units`, the unit of each column that has one, and `decklander.versions`, both JSON.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import polars as pl

from link.errors import UserError
from scenarios.campaigns.landing_task import Row
from scenarios.recordings.result import units_of

_FIRST = ("cell", "firmware", "seed", "error")
_TYPES: dict[str, pl.DataType] = {
    "cell": pl.String(),
    "firmware": pl.String(),
    "seed": pl.Int64(),
    "error": pl.String(),
    "tier": pl.String(),
    "reason": pl.String(),
    "ended": pl.String(),
    "ended_reason_code": pl.String(),
    "ended_reason": pl.String(),
    "first_abort": pl.String(),
    "last_abort": pl.String(),
    "aborts_by_reason": pl.String(),
    "begun_anew_by_reason": pl.String(),
    "forecast_waiting_came": pl.String(),
    "forecast_commit_came": pl.String(),
    "on_pad": pl.Boolean(),
    "s2_quality": pl.Boolean(),
    "aborts": pl.Int64(),
    "retries": pl.Int64(),
    "approaches": pl.Int64(),
    "nees_count": pl.Int64(),
    "nis_dof": pl.Int64(),
}
"""Columns that are no decimal numbers, so that one without any value has its type too."""


def write_rows(path: Path, rows: Sequence[Row], versions: Mapping[str, str]) -> None:
    """Write rows into a Parquet file, at once or not at all; the same rows in any order make the same file.

    Args:
        path: of the file.
        rows: any number of them.
        versions: of what decided them, by name.

    Raises:
        UserError: the disk is full, or takes nothing else either; or the rows do not fit each other.
    """
    frame = _frame(rows, path)
    unfinished = path.with_suffix(".unfinished")
    about = {"decklander.units": units_of(frame.columns), "decklander.versions": versions}
    metadata = {name: json.dumps(value) for name, value in about.items()}
    try:
        frame.write_parquet(unfinished, compression="zstd", statistics=False, metadata=metadata)
        unfinished.replace(path)
    except (OSError, pl.exceptions.PolarsError) as error:
        unfinished.unlink(missing_ok=True)
        why = str(error).splitlines()[0]
        raise UserError(f"{path}: cannot be written ({why}); make room, and go on with --resume") from None


def read_rows(path: Path) -> list[Row]:
    """Return the rows of a Parquet file.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    try:
        return pl.read_parquet(path, glob=False).to_dicts()
    except (OSError, pl.exceptions.PolarsError) as error:
        raise UserError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from None


def as_written(rows: Sequence[Row], source: Path) -> list[Row]:
    """Return rows as they would be read back from a file that they were written into.

    Raises:
        UserError: the rows, which are from `source`, do not fit each other.
    """
    return _frame(rows, source).to_dicts()


def _frame(rows: Sequence[Row], path: Path) -> pl.DataFrame:
    ordered = sorted(rows, key=lambda row: (row["cell"], row["seed"]))
    names = sorted({name for row in rows for name in row})
    columns = [*(name for name in _FIRST if name in names), *(name for name in names if name not in _FIRST)]
    try:
        return pl.DataFrame({name: _column(name, ordered) for name in columns})
    except (TypeError, OverflowError, pl.exceptions.PolarsError) as error:
        why = str(error).splitlines()[0]
        raise UserError(f"{path}: landings that do not fit each other ({why}); start again in another folder") from None


def _column(name: str, rows: Sequence[Row]) -> pl.Series:
    values = [row.get(name) for row in rows]
    return pl.Series(name, values, dtype=_TYPES.get(name) or _type_of(values), strict=True)


def _type_of(values: Sequence[object]) -> pl.DataType:
    """Return the type of a column by its first value; a whole number may be followed by others."""
    first = next((value for value in values if value is not None), 0.0)
    if isinstance(first, bool):
        return pl.Boolean()
    return pl.String() if isinstance(first, str) else pl.Float64()
