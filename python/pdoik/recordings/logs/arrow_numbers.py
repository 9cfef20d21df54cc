"""Numbers of Arrow's batches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from pdoik.errors import LoadError

from ..recording import FloatArray


def numbers(batch: Any, columns: Sequence[str], name: str = "") -> FloatArray:
    """A batch's columns, (R, c), NaN for null.

    Raises:
        LoadError: a column holds no numbers.
    """
    out = np.empty((batch.num_rows, len(columns)))
    for k, column in enumerate(columns):
        out[:, k] = number_column(batch.column(column), column, name)
    return out


def number_column(values: Any, column: str, name: str) -> FloatArray:
    """One of Arrow's arrays as numbers, (R,); time stamps and times of the day in s."""
    if pa.types.is_timestamp(values.type) or pa.types.is_time(values.type):
        day = pa.types.is_time(values.type)
        stamps = values.cast(pa.time64("ns") if day else pa.timestamp("ns")).cast(pa.int64())
        return np.asarray(stamps.to_numpy(zero_copy_only=False) * 1e-9, dtype=np.float64)
    try:
        cells = values.cast(pa.float64()).to_numpy(zero_copy_only=False)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise LoadError(
            f"{name}: column {column!r} holds {values.type}, expected numbers"
        ) from error
    return np.asarray(cells, dtype=np.float64)
