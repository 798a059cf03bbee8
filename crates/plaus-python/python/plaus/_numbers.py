"""Numbers as arguments."""

from __future__ import annotations

from typing import Any


def _whole(name: str, value: Any, least: int) -> int | None:
    """A whole number as an argument, or a clear refusal."""
    if value is None:
        return None
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{name}: a whole number is expected, not {value!r}")
    number = int(value.__index__())
    if number < least:
        raise ValueError(f"{name} is {number}, but must be at least {least}")
    return number
