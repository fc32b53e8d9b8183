"""What stands in a table's cell: a value that knows how people read it and how a machine does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

DASH = "–"
"""Stands where there is nothing to say."""
MINUS = "\N{MINUS SIGN}"


@runtime_checkable
class Value(Protocol):
    """A cell that is more than a word or a number."""

    @property
    def parts(self) -> tuple[str, ...]:
        """Suffixes of the CSV columns that this value fills."""
        ...

    def raw(self) -> tuple[float | int, ...]:
        """Numbers for the CSV, one per part."""
        ...

    def __str__(self) -> str: ...


@dataclass(frozen=True)
class Count:
    """k of n, counts first, then the share."""

    k: int
    n: int
    parts = ("k", "n")

    @property
    def share(self) -> float | None:
        """The share; None where nothing was counted."""
        return self.k / self.n if self.n else None

    def raw(self) -> tuple[float | int, ...]:
        """Both integers."""
        return self.k, self.n

    def __str__(self) -> str:
        return f"{self.k}/{self.n} ({100 * self.k / self.n:.1f} %)" if self.n else DASH


@dataclass(frozen=True)
class Share:
    """A share of 1, read as percent."""

    value: float
    parts = ("share",)

    def raw(self) -> tuple[float | int, ...]:
        """The share."""
        return (round(self.value, 6),)

    def __str__(self) -> str:
        return f"{100 * self.value:.1f} %"


@dataclass(frozen=True)
class Span:
    """An interval of shares, read as percent; `signed` for differences in percentage points."""

    low: float
    high: float
    signed: bool = False
    parts = ("low", "high")

    def raw(self) -> tuple[float | int, ...]:
        """Both ends."""
        return round(self.low, 6), round(self.high, 6)

    def __str__(self) -> str:
        if self.signed:
            return f"[{signed(self.low)}, {signed(self.high)}]"
        return f"[{100 * self.low:.1f}, {100 * self.high:.1f}]"


@dataclass(frozen=True)
class Points:
    """A difference of shares, read as percentage points."""

    value: float
    parts = ("difference",)

    def raw(self) -> tuple[float | int, ...]:
        """The difference as a share."""
        return (round(self.value, 6),)

    def __str__(self) -> str:
        return signed(self.value)


@dataclass(frozen=True)
class MeanSd:
    """Mean and standard deviation over repetitions, as percent."""

    mean: float
    sd: float | None
    parts = ("mean", "sd")

    def raw(self) -> tuple[float | int, ...]:
        """Mean and SD; the SD of a single repetition is not a number."""
        return round(self.mean, 6), float("nan") if self.sd is None else round(self.sd, 6)

    def __str__(self) -> str:
        return f"{100 * self.mean:.1f}" + (f" ± {100 * self.sd:.1f}" if self.sd is not None else "")


@dataclass(frozen=True)
class PValue:
    """A probability under the null hypothesis."""

    value: float
    parts = ("p",)

    def raw(self) -> tuple[float | int, ...]:
        """The probability."""
        return (self.value,)

    def __str__(self) -> str:
        return "< 0.001" if self.value < 0.001 else f"{self.value:.3f}"


@dataclass(frozen=True)
class Number:
    """A measured number with its digits."""

    value: float
    digits: int = 2
    parts = ("",)

    def raw(self) -> tuple[float | int, ...]:
        """The number itself."""
        return (round(self.value, 6),)

    def __str__(self) -> str:
        return f"{self.value:.{self.digits}f}".replace("-", MINUS)


def signed(share: float) -> str:
    """A difference in percentage points with its sign."""
    text = f"{abs(100 * share):.1f}"
    return text if float(text) == 0.0 else f"{'+' if share > 0 else MINUS}{text}"


Content = Value | str | int | None
"""What a cell may hold."""


def text(content: Content) -> str:
    """A cell for people."""
    return DASH if content is None else str(content)
