"""Why a grasp was chosen, from what was recorded: each number with its source, the constraints, and what was rejected."""

from __future__ import annotations

import math
from typing import Any

from agent import phrases
from agent.answer import FIELD_WORDS
from agent.attempt import Attempt
from agent.chat.events import Explained, Fact
from agent.kept_force import raised_words
from kb.errors import BadInputError
from kb.experience import Experience
from kb.grasp import GraspField, Provenance

UNITS: dict[GraspField, tuple[str, float]] = {
    "yaw": (" deg", 180.0 / math.pi), "aperture": (" mm", 1000.0), "force": (" N", 1.0), "standoff": (" mm", 1000.0),
    "speed": ("", 1.0),
}  # fmt: skip
"""Field -> unit for people, and its factor."""


def explain(attempt: Attempt, store: Any) -> Explained:
    """Every number of the attempt's grasp with its sources.

    Args:
        attempt: The attempt.
        store: The knowledge base, for the outcomes of the experiences that were used (or None).
    """
    plan = attempt.plan
    facts = tuple(
        Fact(
            field=field,
            value=getattr(plan.grasp, field),
            sources=(
                *(source_words(field, item, attempt, store) for item in sources),
                *(raised_words(attempt) if field == "force" else ()),
            ),
        )
        for field, sources in plan.provenance.items()
    )
    constraints = tuple(phrases.sentence(item.reason) for item in attempt.constraints.active)
    others = tuple((name, score) for _, score, name in plan.alternatives)
    return Explained(
        text=_text(attempt, facts, constraints),
        attempt=attempt.number,
        facts=facts,
        constraints=constraints,
        rejected=plan.rejected,
        alternatives=others,
    )


def _text(attempt: Attempt, facts: tuple[Fact, ...], constraints: tuple[str, ...]) -> str:
    plan, name = attempt.plan, phrases.plain(attempt.target.category)
    lines = [attempt.thought] if attempt.thought else []
    lines.append(f"The numbers of attempt {attempt.number + 1}, the grasp of the {name}, and where they come from:")
    lines += [f"- {FIELD_WORDS[f.field]} {shown(f.field, f.value)}: {'; '.join(f.sources)}" for f in facts]  # type: ignore[index]
    if constraints:
        lines.append("Constraints: " + " ".join(constraints))
    if plan.rejected:
        counted = sorted(plan.rejected.items(), key=lambda item: (-item[1], item[0]))
        lines.append("Rejected candidates: " + ", ".join(f"{count} {reason}" for reason, count in counted) + ".")
    if plan.alternatives:
        others = ", ".join(f"{name} (score {score:.2f})" for _, score, name in plan.alternatives)
        lines.append(f"Also possible, with a lower score: {others}.")
    return "\n".join(lines)


def source_words(field: GraspField, item: Provenance, attempt: Attempt, store: Any) -> str:
    """One source in words, with its outcomes or its measured gap."""
    value = shown(field, item.value)
    if item.source == "experience":
        known = _experience(item.id, store)
        if known is None:
            return f"experience {item.id}: {value}"
        return (
            f"experience {item.id} ({known.category}, {known.n_success} of {known.n_trials} trials succeeded): {value}"
        )
    if item.source == "constraint" and item.id.startswith("person"):
        return f"you said {item.id.removeprefix('person: ')}: {value}"
    if item.source == "constraint":
        gaps = {f"{c.kind}:{c.target}": c.gap for c in attempt.constraints.active}
        measured = [f"{gaps[name] * 1000:.0f} mm away" for name in item.id.split(",") if gaps.get(name) is not None]  # type: ignore[operator]
        return f"constraint {item.id}{f' ({measured[0]})' if measured else ''}: {value}"
    if item.source == "correction" and item.id == "person":
        return f"you changed it: {value}"
    words = {
        "memory": "an earlier success", "geometry": "measured shape", "correction": "correction", "default": "default",
    }  # fmt: skip
    return f"{words[item.source]} {item.id}: {value}" if item.id else f"{words[item.source]}: {value}"


def _experience(name: str, store: Any) -> Experience | None:
    if store is None:
        return None
    try:
        return store.get(name)
    except BadInputError:
        return None


def shown(field: str, value: Any) -> str:
    """A value for a person, with its unit."""
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, int | float):
        unit, factor = UNITS.get(field, ("", 1.0))  # type: ignore[call-overload]
        return f"{value * factor:.3g}{unit}"
    if isinstance(value, tuple | list):
        return "(" + ", ".join(f"{float(v):.3f}" if isinstance(v, int | float) else str(v) for v in value) + ")"
    return str(value)
