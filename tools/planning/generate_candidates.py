"""All candidates of an object: every part that was seen, in every way it can be held."""

from __future__ import annotations

from kb.percept import PerceivedObject
from kb.vocabulary import Region
from tools.planning.bar_candidates import loop_candidates, neck_candidates, stem_candidates, tool_candidates
from tools.planning.body_candidates import body_candidates
from tools.planning.candidate import WIDEST_GRIP, Candidate
from tools.planning.rim_candidates import rim_candidates

LYING = 0.5
"""A handle whose axis rises less than this (sine) lies on the table: the handle of a tool, not a loop."""


KEPT = 32
"""Objects whose candidates are kept: the configurations of a trial plan on the very same percepts."""
_known: dict[int, tuple[PerceivedObject, tuple[Candidate, ...]]] = {}
"""Identity of a perceived object -> the object itself, which keeps its identity its own, and its candidates."""


def generate_candidates(subject: PerceivedObject) -> list[Candidate]:
    """Candidates on the perceived geometry alone; neither neighbours nor the arm's reach are considered here.

    Returns:
        Candidates with unique names, in a fixed order.
    """
    known = _known.get(id(subject))
    if known is None or known[0] is not subject:
        known = subject, tuple(_generate(subject))
        while len(_known) >= KEPT:
            _known.pop(next(iter(_known)), None)
        _known[id(subject)] = known
    return list(known[1])


def _generate(subject: PerceivedObject) -> list[Candidate]:
    found: list[Candidate] = []
    rim, handle = subject.part("rim"), subject.part("handle")
    stem, neck = subject.part("stem"), subject.part("neck")
    if rim is not None:
        found += rim_candidates(subject, rim, "rim")
    if handle is not None and handle.outward is not None and abs(handle.axis[2]) > LYING:
        found += loop_candidates(subject, handle)
    elif handle is not None:
        found += tool_candidates(subject, handle)
    if stem is not None:
        found += stem_candidates(subject, stem)
    if neck is not None:
        found += neck_candidates(subject, neck)
    found += body_candidates(subject, _body_region(subject))
    seen: set[str] = set()
    unique: list[Candidate] = []
    for candidate in found:
        if candidate.name not in seen:
            seen.add(candidate.name)
            unique.append(candidate)
    return unique


def has_narrower(candidates: list[Candidate]) -> bool:
    """Whether some part is narrow enough that wide places need not be gripped."""
    return any(candidate.width <= WIDEST_GRIP for candidate in candidates)


def _body_region(subject: PerceivedObject) -> Region:
    """Flat things are held by their edges; that is the same grasp under the name the affordance gives it."""
    edged = subject.affordance.region == "edge" and subject.part("rim") is None
    return "edge" if edged else "body"
