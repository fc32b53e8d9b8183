"""Charts of success: with intervals by configuration, differences against full, and against noise."""

from __future__ import annotations

from bench.paper_tables import TABLE_II, TRIALS
from bench.report import svg
from bench.report.contrasts import REGISTERED, contrasts
from bench.report.noise import curves
from bench.report.results import CATEGORIES, CATEGORY_WORDS, Results, solved
from bench.report.value import Count, Span, signed
from bench.statistics import wilson

LABEL = 225
"""Width of the column of names [px]."""
ROW = 24
"""Height of a row [px]."""
PANEL, GAP = 166, 40
DASHES = ("", "7 4", "2 4", "10 3 2 3", "", "7 4")
"""Lines differ in their dashes as well, and stand a little beside each other where they would coincide."""
DODGE = 5
"""Distance of neighbouring lines [px]."""
LINES = ("var(--c-blue)", "var(--c-orange)", "var(--c-green)", "var(--c-purple)", "var(--c-sky)", "var(--c-red)")


def success_chart(results: Results) -> str:
    """Dots with Wilson intervals, one panel for all trials and one per category; diamonds are the paper's values."""
    names = [name for name in results.configurations if results.of(name)]
    panels: list[tuple[str, str | None]] = [("All", None), *((CATEGORY_WORDS[c], c) for c in results.categories)]
    top, bottom = 34, 34 + ROW * len(names)
    items: list[svg.Item] = []
    for row, name in enumerate(names):
        style = "strong" if name == "full" else ""
        items.append(svg.text(LABEL - 12, top + ROW * (row + 0.5), name, anchor="end", style=style))
    for number, (title, category) in enumerate(panels):
        x = LABEL + number * (PANEL + GAP)
        items.append(svg.text(x, 14, title, style="strong"))
        items.append(svg.share_axis(x, PANEL, top - 6, bottom))
        for row, name in enumerate(names):
            items.append(_dot(results, name, category, x, top + ROW * (row + 0.5)))
    width = LABEL + len(panels) * (PANEL + GAP)
    items.append(svg.diamond(LABEL + 6, bottom + 32, 4.5, "var(--ink-2)"))
    items.append(svg.text(LABEL + 16, bottom + 32, "the paper's value (its own analytical simulation)", style="small"))
    return svg.figure(width, bottom + 44, items, "Success rate with 95 % Wilson intervals by configuration")


def _dot(results: Results, name: str, category: str | None, x: float, y: float) -> svg.Item:
    k, n = solved(results.of(name, CATEGORIES[category] if category else None))
    if not n:
        return ""
    interval = wilson(k, n)
    colour = "var(--c-blue)" if name == "full" else "var(--ink-2)"
    tip = f"{name}: {Count(k, n)}, 95 % {Span(interval.low, interval.high)}"
    items = [
        svg.line(x + PANEL * interval.low, y, x + PANEL * interval.high, y, stroke=colour, width=2.5),
        svg.dot(x + PANEL * k / n, y, 5, colour, tip=tip),
    ]
    for row in TABLE_II:
        if row.configuration == name:
            printed = row.counts[category] / TRIALS[category] if category else row.total / sum(TRIALS.values())
            items.append(svg.diamond(x + PANEL * printed, y, 4.5, "var(--ink-2)", tip=f"paper: {100 * printed:.1f} %"))
    return "".join(items)


def contrast_chart(results: Results) -> str:
    """Paired differences full minus other, with bootstrap intervals."""
    found = contrasts(results)
    if not found:
        return ""
    ends = [end for item in found for end in (item.difference.low, item.difference.high)]
    low, high = min(-0.1, *ends), max(0.1, *ends)
    left, width, top = LABEL + 40, 620, 30
    bottom = top + ROW * len(found)

    def place(share: float) -> float:
        return left + width * (share - low) / (high - low)

    items = [
        svg.line(place(0), top - 8, place(0), bottom, stroke="var(--ink-2)", width=1.5),
        svg.text(place(0), bottom + 11, "0", anchor="middle", style="small"),
    ]
    step = 0.1 if high - low <= 0.7 else 0.25
    for number in range(int(low / step) - 1, int(high / step) + 2):
        if low <= number * step <= high and number:
            at = place(number * step)
            items += [svg.line(at, top - 8, at, bottom)]
            items += [svg.text(at, bottom + 11, signed(number * step), anchor="middle", style="small")]
    items.append(svg.text(place(0) - 8, 10, "the other is better", anchor="end", style="small"))
    items.append(svg.text(place(0) + 8, 10, "full is better", style="small"))
    for row, item in enumerate(found):
        y = top + ROW * (row + 0.5)
        clear = item.difference.low > 0 or item.difference.high < 0
        colour = "var(--c-blue)" if clear else "var(--ink-2)"
        span = Span(item.difference.low, item.difference.high, signed=True)
        tip = f"{signed(item.difference.value)} pp, 95 % {span}, {item.count} pairs"
        style = "strong" if item.name in REGISTERED else ""
        items.append(svg.text(left - 12, y, item.name, anchor="end", style=style))
        items.append(svg.line(place(item.difference.low), y, place(item.difference.high), y, stroke=colour, width=2.5))
        items.append(svg.dot(place(item.difference.value), y, 5, colour, tip=tip))
    return svg.figure(left + width + 40, bottom + 24, items, "Paired differences of success, full minus other")


def noise_chart(results: Results) -> str:
    """Success against noise, with Wilson bands."""
    found = curves(results)
    if not found:
        return ""
    left, width, top, height = 50, 560, 14, 260
    least, most = min(results.noises), max(results.noises)

    def place(level: float, number: float = 0) -> float:
        return left + 20 + (width - 40) * (level - least) / (most - least) + DODGE * number

    items: list[svg.Item] = []
    for tick in (0, 25, 50, 75, 100):
        y = top + height * (1 - tick / 100)
        items += [svg.line(left, y, left + width, y), svg.text(left - 8, y, f"{tick}", anchor="end", style="small")]
    for level in results.noises:
        items.append(svg.text(place(level), top + height + 13, f"{level:g}", anchor="middle", style="small"))
    items.append(svg.text(left + width / 2, top + height + 32, "noise factor", anchor="middle", style="small"))
    for number, (name, points) in enumerate(found.items()):
        colour = LINES[number % len(LINES)]
        at = {level: place(level, number - (len(found) - 1) / 2) for level in points}
        upper = [(at[x], top + height * (1 - interval.high)) for x, (_, interval) in points.items()]
        lower = [(at[x], top + height * (1 - interval.low)) for x, (_, interval) in points.items()]
        middle = [(at[x], top + height * (1 - interval.value)) for x, (_, interval) in points.items()]
        items.append(svg.path(f"{_track([*upper, *reversed(lower)])} Z", fill=colour, style="band"))
        items.append(svg.path(_track(middle), stroke=colour, width=2.5, dash=DASHES[number % len(DASHES)]))
        for (x, y), (level, (count, _)) in zip(middle, points.items(), strict=True):
            items.append(svg.dot(x, y, 4, colour, tip=f"{name} at noise {level:g}: {count}"))
        y = top + 15 + 22 * number
        key = _track([(left + width + 14, y), (left + width + 40, y)])
        items.append(svg.path(key, stroke=colour, width=2.5, dash=DASHES[number % len(DASHES)]))
        items.append(svg.text(left + width + 48, y, name))
    return svg.figure(left + width + 260, top + height + 44, items, "Success against noise by configuration")


def _track(points: list[tuple[float, float]]) -> str:
    return "M" + " L".join(f"{svg.num(x)},{svg.num(y)}" for x, y in points)
