"""Charts of parts: endings of sub-goals, the flow up the ladder, failed attempts by type, where the time goes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import fmean

from bench.report import svg
from bench.report.diagnosis import failures
from bench.report.recovery import ENDS, endings
from bench.report.results import Results
from bench.report.times import PARTS

LABEL, ROW, WIDTH = 225, 26, 700

ENDING_COLOURS = ("var(--s-1)", "var(--s-2)", "var(--s-3)", "var(--s-4)", "var(--c-red)", "var(--c-grey)")
"""Blues from the first try to the last retry, red for what stayed unsolved: also told apart by lightness alone."""
TYPE_COLOURS = ("var(--c-blue)", "var(--c-orange)", "var(--c-green)", "var(--c-purple)", "var(--c-sky)", "var(--c-red)")
PART_COLOURS = ("var(--c-blue)", "var(--c-sky)", "var(--c-green)", "var(--c-orange)", "var(--c-purple)")

STAGES = ("first try", "1: tune", "2: switch", "3: replan")
"""What each attempt of the ladder does."""

Bar = tuple[str, Sequence[float], Sequence[str]]
"""Name, values, tips."""


def stacked(bars: Sequence[Bar], words: Sequence[str], colours: Sequence[str], unit: str, *, label: str) -> str:
    """Horizontal stacked bars to one scale, with a legend above.

    Args:
        bars: Rows from top to bottom.
        words: Names of the parts.
        colours: Fill of each part.
        unit: What the axis counts.
        label: What a screen reader says.
    """
    most = max((sum(values) for _, values, _ in bars), default=0.0)
    if most <= 0.0:
        return ""
    top, bottom = 34, 34 + ROW * len(bars)
    items: list[svg.Item] = [svg.legend(LABEL, 12, zip(colours, words, strict=True))]
    for tick in ticks(most):
        at = LABEL + WIDTH * tick / most
        items += [
            svg.line(at, top - 4, at, bottom),
            svg.text(at, bottom + 11, f"{tick:g}", anchor="middle", style="small"),
        ]
    items.append(svg.text(LABEL + WIDTH, bottom + 28, unit, anchor="end", style="small"))
    for row, (name, values, tips) in enumerate(bars):
        x, y = float(LABEL), top + ROW * row + 4
        style = "strong" if name == "full" else ""
        items.append(svg.text(LABEL - 12, y + (ROW - 8) / 2, name, anchor="end", style=style))
        for value, tip, colour in zip(values, tips, colours, strict=True):
            wide = WIDTH * value / most
            if wide > 0:
                items.append(svg.rect(x, y, wide, ROW - 8, colour, tip=tip, style="part"))
            x += wide
    return svg.figure(LABEL + WIDTH + 30, bottom + 38, items, label)


def ticks(most: float) -> list[float]:
    """Round numbers from zero, about five of them."""
    step = 10.0 ** (len(str(int(most))) - 1) if most >= 1 else 0.1
    step = next((step * factor for factor in (0.2, 0.25, 0.5, 1, 2) if most / (step * factor) <= 6), step * 5)
    return [round(step * number, 6) for number in range(int(most / step) + 1)]


def ladder_chart(results: Results) -> str:
    """With which attempt sub-goals were solved, as shares of all sub-goals."""
    bars: list[Bar] = []
    for name in results.configurations:
        found = endings(results.of(name))
        total = sum(found.values())
        if total:
            tips = [f"{name}: {found[end]} of {total} {end}" for end in ENDS]
            bars.append((name, [100 * found[end] / total for end in ENDS], tips))
    return stacked(bars, ENDS, ENDING_COLOURS, "% of sub-goals", label="With which attempt sub-goals were solved")


def flow_chart(results: Results, configuration: str = "full") -> str:
    """The sub-goals of a configuration on their way up the ladder: solved by an attempt, or passed on to the next."""
    found = endings(results.of(configuration))
    total = sum(found[end] for end in ENDS[:5])
    if not total or found[ENDS[0]] == total:
        return ""
    left, step, top, height = 150.0, 165.0, 30.0, 220.0
    unit = height / total
    right = left + 4 * step + 40
    items: list[svg.Item] = []
    alive, y_alive = total, top
    solved_y, low = top, top + height + 34
    for rung, end in enumerate(ENDS[:4]):
        x = left + rung * step
        stage = f"{end}: {alive} tried, {found[end]} solved"
        items.append(svg.rect(x, y_alive, 12, max(unit * alive, 1), "var(--ink-2)", tip=stage))
        items.append(svg.text(x + 6, y_alive - 10, f"{alive}", anchor="middle", style="small strong"))
        items.append(svg.text(x + 6, low + 40, STAGES[rung], anchor="middle"))
        solved = found[end]
        if solved:
            tip = f"{solved} of {alive} solved by the {end}"
            thick = unit * solved
            items.append(svg.band(x + 12, y_alive, right, solved_y, thick, ENDING_COLOURS[rung], tip=tip))
        alive_next = sum(found[other] for other in ENDS[rung + 1 : 4]) + _given_up_after(results, configuration, rung)
        given_up = alive - solved - alive_next
        y_fail = y_alive + unit * solved
        if alive_next:
            tip = f"{alive_next} passed on"
            y_next = low - unit * alive_next - 10 * (3 - rung) / 3
            items.append(svg.band(x + 12, y_fail, x + step, y_next, unit * alive_next, "var(--c-orange)", tip=tip))
        else:
            y_next = low
        if given_up:
            y_lost = low + 6
            tip = f"{given_up} not solved after the {end}"
            items.append(
                svg.band(x + 12, y_fail + unit * alive_next, right, y_lost, unit * given_up, "var(--c-red)", tip=tip)
            )
        solved_y += unit * solved
        alive, y_alive = alive_next, y_next
        if not alive:
            break
    done = sum(found[end] for end in ENDS[:4])
    items.append(svg.text(left - 14, top + height / 2, f"{total} sub-goals", anchor="end", style="strong"))
    items.append(svg.text(right + 10, (top + solved_y) / 2, f"{done} solved", style="strong"))
    items.append(svg.text(right + 10, low + 8, f"{total - done} not solved", style="strong"))
    return svg.figure(right + 130, low + 56, items, f"Sub-goals of {configuration} on the recovery ladder")


def _given_up_after(results: Results, configuration: str, rung: int) -> int:
    """Sub-goals that were never solved and tried again after attempt number `rung`."""
    return sum(
        not goal.success and len(goal.attempts) > rung + 1 for t in results.of(configuration) for goal in t.subgoals
    )


def failure_chart(results: Results) -> str:
    """Failed attempts per 100 trials by the observer's type; the rare types are added up."""
    counts = {name: failures(results.of(name)) for name in results.configurations}
    whole = sum(counts.values(), Counter[str]())
    if not whole:
        return ""
    common = [kind for kind, _ in sorted(whole.items(), key=lambda item: (-item[1], item[0]))][: len(TYPE_COLOURS)]
    words = [*(kind.replace("_", " ").lower() for kind in common), "other types"]
    bars: list[Bar] = []
    for name, found in counts.items():
        n = len(results.of(name))
        if n:
            numbers = [*(found[kind] for kind in common), sum(found.values()) - sum(found[kind] for kind in common)]
            tips = [f"{name}: {k} failed attempts, {word}" for k, word in zip(numbers, words, strict=True)]
            bars.append((name, [100 * k / n for k in numbers], tips))
    return stacked(
        bars, words, (*TYPE_COLOURS[: len(common)], "var(--c-grey)"), "failed attempts per 100 trials",
        label="Failed attempts by type",
    )  # fmt: skip


def time_chart(results: Results) -> str:
    """Mean wall seconds of a trial by part."""
    bars: list[Bar] = []
    for name in results.configurations:
        own = [t for t in results.of(name) if t.harness_error is None]
        if own:
            means = [fmean(t.times_s.get(part, 0.0) for t in own) for part in PARTS]
            bars.append((name, means, [f"{name}: {part} {m:.2f} s" for part, m in zip(PARTS, means, strict=True)]))
    return stacked(bars, PARTS, PART_COLOURS, "seconds per trial", label="Wall time of a trial by part")
