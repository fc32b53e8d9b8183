"""Cuts a noun phrase: what is meant from what is not, and the thing from what it relates to."""

from __future__ import annotations

from agent.goal import RelationWord
from agent.language import lexicon

ARTICLES = (
    "the",
    "that",
    "this",
    "these",
    "those",
    "my",
    "your",
    "our",
    "its",
    "his",
    "her",
    "of",
    "same",
    "very",
    "up",
)
EXCEPT = (
    "except for", "except", "apart from", "other than", "but not", "but", "without", "excluding", "not including", "save",
    "besides", "rather than", "instead of", "and not", "not",
)  # fmt: skip
TABLE = ("table", "desk", "tabletop", "surface", "scene", "workspace", "floor", "counter",
         "clutter", "mess", "pile", "heap", "crowd", "muddle", "jumble")  # fmt: skip


def split_exceptions(tokens: list[str]) -> tuple[list[str], list[list[str]]]:
    """Cuts at "except", "but not", ", not the mug": (what is meant, what is not)."""
    for start in range(len(tokens)):
        for phrase in EXCEPT:
            parts = phrase.split()
            if tokens[start : start + len(parts)] == parts and start + len(parts) < len(tokens):
                kept, rest = tokens[:start], tokens[start + len(parts) :]
                if phrase == "not" and not kept:
                    # "not the mug , the cup": the correction follows after a comma or "but".
                    for cut in (",", "but"):
                        if cut in rest:
                            at = rest.index(cut)
                            return rest[at + 1 :], [rest[:at]]
                if phrase == "not" and kept and kept[-1] in ("is", "are"):
                    kept = [t for t in kept[:-1] if t not in ("that", "which")]
                while kept and kept[-1] == ",":
                    kept = kept[:-1]
                if kept:
                    return kept, split_list(rest)
    return tokens, []


def split_list(tokens: list[str]) -> list[list[str]]:
    parts: list[list[str]] = [[]]
    for token in tokens:
        if token in (",", "and", "or", "nor"):
            parts.append([])
        else:
            parts[-1].append(token)
    return [part for part in parts if part]


def split_relation(tokens: list[str]) -> tuple[list[str], RelationWord | None, list[str]]:
    """Cuts at the first relation that has a reference behind it: (head, relation, what it relates to)."""
    for start in range(len(tokens)):
        for phrase, relation in lexicon.RELATIONS:
            parts = phrase.split()
            rest = tokens[start + len(parts) :]
            if tokens[start : start + len(parts)] != parts or not rest:
                continue
            superlative = phrase in ("nearest", "closest") and tokens[start - 1] in ARTICLES
            if superlative or (start == 0 and phrase in ("nearest", "closest", "next", "above", "before", "at")):
                continue  # "the nearest block" singles a block out; "the cup nearest the block" relates
            if phrase in ("next", "at", "before") and rest[0] in ("one", "to"):
                continue
            bare = [t for t in rest if t not in (*ARTICLES, "to")]
            if bare and bare[0] in TABLE:  # "on the table" tells nothing
                return split_relation(tokens[:start] + rest[rest.index(bare[0]) + 1 :])
            if bare and (bare[0] in lexicon.SIDES or bare[0] in lexicon.EXTREMES) and relation in ("on", "in", "near"):
                continue  # "on the left", "at the front": a side, read with the head
            if (
                phrase in ("nearest", "closest", "nearest to", "closest to")
                and bare
                and bare[0] in ("me", "you", "robot")
            ):
                continue
            return tokens[:start], relation, rest
    return tokens, None, []
