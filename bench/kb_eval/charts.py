"""Pictures of the retrieval evaluation as SVG that follows the page's colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bench.kb_eval.measure_ranking import Mean
from bench.report import svg

LEFT, WIDTH, ROW, TOP = 280.0, 430.0, 24.0, 34.0
BLUE, RED, GREEN = "var(--c-blue)", "var(--c-red)", "var(--c-green)"


def dots(systems: Mapping[str, Mapping[str, Mean]], measures: Sequence[tuple[str, str, str]], label: str) -> str:
    """Every system's measures as dots with intervals on one axis from 0 to 100.

    Args:
        systems: Name -> measure -> mean.
        measures: Key, word and colour of what is shown.
        label: What a screen reader says.
    """
    bottom = TOP + ROW * len(systems)
    items = [svg.legend(LEFT, 12.0, [(colour, word) for _, word, colour in measures])]
    items.append(svg.share_axis(LEFT, WIDTH, TOP - 6.0, bottom))
    for row, (name, means) in enumerate(systems.items()):
        middle = TOP + ROW * (row + 0.5)
        items.append(svg.text(LEFT - 10.0, middle, name.replace("_", " "), anchor="end"))
        for lane, (key, word, colour) in enumerate(measures):
            mean = means[key]
            if mean.value != mean.value:
                continue
            y = middle + 6.0 * (lane - (len(measures) - 1) / 2)
            if mean.low == mean.low:
                items.append(
                    svg.line(
                        LEFT + WIDTH * mean.low_by_object,
                        y,
                        LEFT + WIDTH * mean.high_by_object,
                        y,
                        stroke=colour,
                        width=1.5,
                    )
                )
            items.append(
                svg.dot(LEFT + WIDTH * mean.value, y, 3.5, colour, tip=f"{name}, {word}: {100 * mean.value:.1f}")
            )
    return svg.figure(LEFT + WIDTH + 30.0, bottom + 24.0, items, label)


def tau_chart(rows: Sequence[Mapping[str, float]]) -> str:
    """P@1 by label and by execution against the threshold of level 2."""
    left, width, top, height = 60.0, 480.0, 30.0, 180.0
    items = [svg.legend(left, 10.0, [(BLUE, "R-aff P@1"), (RED, "R-func P@1")])]
    for tick in (0, 25, 50, 75, 100):
        y = top + height * (1 - tick / 100)
        items += [svg.line(left, y, left + width, y), svg.text(left - 8, y, str(tick), anchor="end", style="small")]
    for key, colour in (("p_at_1", BLUE), ("r_func_p_at_1", RED)):
        points = [(left + width * row["tau"], top + height * (1 - row[key])) for row in rows if row[key] == row[key]]
        if points:
            path = "M" + " L".join(f"{svg.num(x)},{svg.num(y)}" for x, y in points)
            items.append(svg.path(path, stroke=colour, width=2))
            items += [svg.dot(x, y, 3, colour) for x, y in points]
    for row in rows:
        x = left + width * row["tau"]
        items.append(svg.text(x, top + height + 12, f"{row['tau']:g}", anchor="middle", style="small"))
    return svg.figure(left + width + 20, top + height + 30, items, "HAA-RAG against the threshold of level 2")


def weight_chart(rows: Sequence[Mapping[str, float]], key: str, word: str) -> str:
    """A triangle of fusion weights: right is more category, up more looks, the rest affordance."""
    left, top, step = 60.0, 30.0, 26.0
    side = 11 * step
    values = [row[key] for row in rows if row[key] == row[key]]
    if not values:
        return ""
    low, high = min(values), max(values)
    items = [svg.text(left, 10.0, f"{word}: {100 * low:.0f} % (pale) to {100 * high:.0f} % (full)", style="small")]
    for row in rows:
        x = left + step * round(10 * row["category"])
        y = top + side - step * (round(10 * row["visual"]) + 1)
        share = 1.0 if high == low else (row[key] - low) / (high - low)
        tip = f"category {row['category']:.1f}, affordance {row['affordance']:.1f}, looks {row['visual']:.1f}: "
        items.append(
            svg.rect(x, y, step - 2, step - 2, f"color-mix(in srgb, {BLUE} {15 + 85 * share:.0f}%, transparent)",
                     tip=f"{tip}{100 * row[key]:.1f}")
        )  # fmt: skip
    items.append(svg.text(left, top + side + 10, "category weight 0 to 1, to the right", style="small"))
    items.append(svg.text(left, top + side + 24, "looks weight 0 to 1, upwards; the rest is affordance", style="small"))
    paper = left + 2 * step, top + side - 5 * step
    items.append(svg.dot(paper[0] + step / 2 - 1, paper[1] + step / 2 - 1, 4, RED, tip="the paper's weights"))
    return svg.figure(left + side + 40, top + side + 36, items, f"{word} over the fusion weights")
