"""Pieces of inline SVG. Colours are the page's CSS variables, so that a chart follows light and dark."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

Item = str
"""Markup of one or more SVG elements."""

TEXT_HEIGHT = 4.2
"""From the middle of a line of 12-px text down to its base line [px]."""


def num(value: float) -> str:
    """A coordinate with at most two decimals: the same value gives the same bytes everywhere."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if value else "0"


def figure(width: float, height: float, items: Iterable[Item], label: str) -> Item:
    """A whole picture that scales with its column.

    Args:
        width: Width of the drawing [px].
        height: Height of the drawing [px].
        items: Its elements.
        label: What a screen reader says.
    """
    return (
        f'<svg viewBox="0 0 {num(width)} {num(height)}" role="img" aria-label="{escape(label)}" '
        f'style="max-width:{num(width)}px" xmlns="http://www.w3.org/2000/svg">{"".join(items)}</svg>'
    )


def text(x: float, y: float, words: str, *, anchor: str = "start", style: str = "") -> Item:
    """A line of text whose middle is at height y."""
    kind = f' class="{style}"' if style else ""
    return f'<text x="{num(x)}" y="{num(y + TEXT_HEIGHT)}" text-anchor="{anchor}"{kind}>{escape(words)}</text>'


def rect(x: float, y: float, width: float, height: float, fill: str, *, tip: str = "", style: str = "") -> Item:
    """A filled rectangle, with a tip on hovering."""
    kind = f' class="{style}"' if style else ""
    body = f"<title>{escape(tip)}</title>" if tip else ""
    return (
        f'<rect x="{num(x)}" y="{num(y)}" width="{num(max(width, 0))}" height="{num(height)}" '
        f'fill="{fill}"{kind}>{body}</rect>'
    )


def line(x1: float, y1: float, x2: float, y2: float, *, stroke: str = "var(--rule)", width: float = 1) -> Item:
    """A straight line."""
    return (
        f'<line x1="{num(x1)}" y1="{num(y1)}" x2="{num(x2)}" y2="{num(y2)}" stroke="{stroke}" '
        f'stroke-width="{num(width)}"/>'
    )


def dot(x: float, y: float, radius: float, fill: str, *, tip: str = "") -> Item:
    """A filled circle, with a tip on hovering."""
    body = f"<title>{escape(tip)}</title>" if tip else ""
    return f'<circle cx="{num(x)}" cy="{num(y)}" r="{num(radius)}" fill="{fill}">{body}</circle>'


def diamond(x: float, y: float, radius: float, stroke: str, *, tip: str = "") -> Item:
    """A hollow diamond: a printed value beside a measured one."""
    points = (
        f"{num(x - radius)},{num(y)} {num(x)},{num(y - radius)} {num(x + radius)},{num(y)} {num(x)},{num(y + radius)}"
    )
    body = f"<title>{escape(tip)}</title>" if tip else ""
    return f'<polygon points="{points}" fill="none" stroke="{stroke}" stroke-width="1.5">{body}</polygon>'


def path(
    d: str,
    *,
    fill: str = "none",
    stroke: str = "none",
    width: float = 1,
    tip: str = "",
    style: str = "",
    dash: str = "",
) -> Item:
    """A path; `dash` is a pattern of lengths [px]."""
    kind = f' class="{style}"' if style else ""
    kind += f' stroke-dasharray="{dash}"' if dash else ""
    body = f"<title>{escape(tip)}</title>" if tip else ""
    return f'<path d="{d}" fill="{fill}" stroke="{stroke}" stroke-width="{num(width)}"{kind}>{body}</path>'


def band(x1: float, top1: float, x2: float, top2: float, thickness: float, fill: str, *, tip: str = "") -> Item:
    """A flow of constant thickness from one vertical edge to another."""
    middle = (x1 + x2) / 2
    upper = f"M{num(x1)},{num(top1)} C{num(middle)},{num(top1)} {num(middle)},{num(top2)} {num(x2)},{num(top2)}"
    low1, low2 = top1 + thickness, top2 + thickness
    lower = f"L{num(x2)},{num(low2)} C{num(middle)},{num(low2)} {num(middle)},{num(low1)} {num(x1)},{num(low1)} Z"
    return path(f"{upper} {lower}", fill=fill, tip=tip, style="flow")


def legend(x: float, y: float, entries: Iterable[tuple[str, str]]) -> Item:
    """Coloured squares with words, in one row.

    Args:
        x: Left end [px].
        y: Middle of the row [px].
        entries: Fill and word of each.
    """
    items: list[Item] = []
    for fill, words in entries:
        items += [rect(x, y - 5, 10, 10, fill, style="key"), text(x + 15, y, words, style="small")]
        x += 15 + 6.4 * len(words) + 18
    return "".join(items)


def share_axis(x: float, width: float, top: float, bottom: float, ticks: Iterable[int] = (0, 25, 50, 75, 100)) -> Item:
    """Vertical rules at shares in percent, with their numbers below."""
    items: list[Item] = []
    for tick in ticks:
        at = x + width * tick / 100
        items += [line(at, top, at, bottom), text(at, bottom + 11, str(tick), anchor="middle", style="small")]
    return "".join(items)
