"""Names for references and objects: what was said, what is seen, and that nothing fits."""

from __future__ import annotations

from agent.goal import Reference
from agent.language import lexicon
from agent.language.single_out import leftness
from kb.percept import PerceivedObject
from kb.vocabulary import UNKNOWN_CATEGORY

_INDEFINITE = ("a", "an", "any", "my")
_DETERMINERS = frozenset(
    "this that these those all every each both everything anything something your its his her our their some "
    "two three four five six seven eight nine ten".split()
)
"""Words that stand where the article would."""


def spoken(reference: Reference) -> str:
    """The reference as one would say it back."""
    if reference.pronoun:
        return "them" if reference.words in (*lexicon.ALL_OF, *lexicon.BOTH_OF, "them", "these", "those") else "it"
    words = reference.words or reference.noun or "that"
    first, _, rest = words.partition(" ")
    if first in _INDEFINITE and rest:
        return f"the {rest}"
    if reference.noun and first not in ("the", *_INDEFINITE, *_DETERMINERS) and not first.isdigit():
        return f"the {words}"
    return words


def describe(obj: PerceivedObject, among: tuple[PerceivedObject, ...] = ()) -> str:
    """A name that tells the object from the others: "the red cup", "the red cup on the left"."""
    name = "object I don't recognise" if obj.category == UNKNOWN_CATEGORY else obj.category.replace("_", " ")
    alike = [o for o in among if o.category == obj.category and o.id != obj.id]
    coloured = f"{obj.colour_name} {name}"
    same = [o for o in alike if o.colour_name == obj.colour_name]
    if not same:
        return f"the {coloured}"
    order = sorted([obj, *same], key=leftness, reverse=True)
    place = order.index(obj)
    if len(order) == 2:
        return f"the {coloured} on the {'left' if place == 0 else 'right'}"
    names = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth")
    return f"the {names[min(place, 8)]} {coloured} from the left"


def listing(objects: tuple[PerceivedObject, ...]) -> str:
    """As in "a red cup, a vase and an object I don't recognise"."""
    names = [describe(o).removeprefix("the ") for o in sorted(objects, key=leftness, reverse=True)]
    named = [("an " if n[0] in "aeiou" else "a ") + n for n in names]
    if not named:
        return "nothing"
    return named[0] if len(named) == 1 else ", ".join(named[:-1]) + " and " + named[-1]


def absent(reference: Reference, objects: tuple[PerceivedObject, ...]) -> str:
    """Says that nothing fits, and what there is."""
    unknown = [o for o in objects if o.category == UNKNOWN_CATEGORY]
    name = spoken(reference).removeprefix("the ")
    hint = (
        " I don't recognise several objects, so I can't tell which one it is."
        if len(unknown) > 1 and reference.noun
        else ""
    )
    return f"I see no {name}.{hint} I see {listing(objects)}."
