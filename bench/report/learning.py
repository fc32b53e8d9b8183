"""Success and attempts against trials seen: what `python -m bench.learn_study` measured, as a chapter of the report."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.report import svg
from bench.report.table import Table
from bench.report.value import Content, Count, Number, Points, Share, Span
from bench.statistics import wilson
from kb.errors import BadInputError

LEFT, WIDTH, TOP, HEIGHT, GAP = 70.0, 520.0, 40.0, 170.0, 50.0
"""Of the upper panel; the lower one is half as high."""
LEARNER, SHIPPED = "#2b6cb0", "#888888"
ARMS = (("learner", "begins with nothing", LEARNER), ("shipped", "shipped knowledge base", SHIPPED))

Summary = Mapping[str, Any]
"""Content of the study's summary.json."""


def read_learning(folder: Path) -> Summary:
    """The study's summary.

    Raises:
        BadInputError: the folder holds none.
    """
    path = folder / "summary.json"
    try:
        found: Summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInputError(f"no summary of a learning study: {error}", where=str(path)) from error
    missing = [key for key in ("asked", "learner", "shipped", "difference", "promotions") if key not in found]
    if missing:
        raise BadInputError(f"no summary of a learning study: {', '.join(missing)} missing", where=str(path))
    return found


def tables(summary: Summary) -> list[Table]:
    """Both arms with their difference, and the growth in blocks of trials."""
    asked, gap = summary["asked"], summary["difference"]
    arms: list[tuple[Content, ...]] = []
    for name, words, _ in ARMS:
        k, n = summary[name]["successes"], summary[name]["n"]
        band = wilson(k, n)
        arms.append((words, Count(k, n), Span(band.low, band.high), None, None))
    arms[0] = (*arms[0][:3], Points(gap["value"]), Span(gap["low"], gap["high"], signed=True))
    blocks = tuple(
        (int(mine["trials"]), Share(mine["success"]), Number(mine["attempts"]), int(mine["entries"]),
         Share(other["success"]), Number(other["attempts"]))
        for mine, other in zip(summary["learner"]["growth"], summary["shipped"]["growth"], strict=False)
    )  # fmt: skip
    promoted = len(summary["promotions"])
    note = (
        f"The same worlds for both; {asked['evaluator']}, {asked['perception']}, {100 * asked['false_claims']:g} % of failed "
        f"attempts and of failed confirmations turned into claims. {promoted} promotions, {summary['wrong_promotions']} wrong "
        f"(executed afterwards, under half succeed), {summary['refused']} refused."
    )
    return [
        Table(
            "learning", "Learning from nothing",
            ("arm", "success", "95 % Wilson", "difference, points", "95 % bootstrap"), tuple(arms), note,
        ),
        Table(
            "learning_growth", "Growth: by trials seen",
            ("trials", "success", "attempts", "entries", "success, shipped", "attempts, shipped"), blocks,
            "Each row is the block of trials that ends there.",
        ),
    ]  # fmt: skip


def growth_chart(summary: Summary) -> str:
    """Success of both arms against trials seen, and below it their attempts a trial, as SVG."""
    growth: dict[str, Sequence[Mapping[str, float]]] = {name: summary[name]["growth"] for name, _, _ in ARMS}
    most = max((point["trials"] for points in growth.values() for point in points), default=1)
    dearest = max(2.0, *(point["attempts"] for points in growth.values() for point in points), 2.0)
    lower, half = TOP + HEIGHT + GAP, HEIGHT / 2
    items = [svg.legend(LEFT, 10.0, [(colour, words) for _, words, colour in ARMS])]
    for tick in (0, 25, 50, 75, 100):
        items += _tick(TOP + HEIGHT * (1 - tick / 100), f"{tick} %")
    for value in (0.0, 1.0, dearest):
        items += _tick(lower + half * (1 - value / dearest), f"{value:g}")
    items.append(svg.text(LEFT, TOP - 12.0, "success", style="small"))
    items.append(svg.text(LEFT, lower - 12.0, "attempts a trial", style="small"))
    for name, words, colour in ARMS:
        for top, height, key, unit in ((TOP, HEIGHT, "success", 1.0), (lower, half, "attempts", dearest)):
            spots = [
                (LEFT + WIDTH * point["trials"] / most, top + height * (1 - point[key] / unit))
                for point in growth[name]
            ]
            if spots:
                path = "M" + " L".join(f"{svg.num(x)},{svg.num(y)}" for x, y in spots)
                items.append(svg.path(path, stroke=colour, width=2))
            items += [
                svg.dot(x, y, 3, colour, tip=f"{words}, {point['trials']:g} trials: {key} {point[key]:.2f}")
                for (x, y), point in zip(spots, growth[name], strict=True)
            ]
    for point in growth["learner"]:
        x = LEFT + WIDTH * point["trials"] / most
        items.append(svg.text(x, lower + half + 14, f"{point['trials']:.0f}", anchor="middle", style="small"))
    return svg.figure(LEFT + WIDTH + 20, lower + half + 30, items, "Success and attempts against trials seen")


def _tick(y: float, word: str) -> list[str]:
    return [
        svg.line(LEFT, y, LEFT + WIDTH, y, stroke="#dddddd"),
        svg.text(LEFT - 8, y, word, anchor="end", style="small"),
    ]
