"""Prompt texts as files, rendered strictly: a missing or a superfluous placeholder is an error."""

from __future__ import annotations

import string
from functools import cache
from importlib import resources


class PromptError(Exception):
    """A prompt is missing, or its placeholders do not fit what was given."""


@cache
def load_prompt(name: str) -> str:
    """The text of `prompts/<name>.txt`, without the final newline.

    Args:
        name: path inside the folder without suffix, for example "thought/first_attempt".

    Raises:
        PromptError: there is no such prompt.
    """
    parts = name.split("/")
    if not parts or any(not part or part.startswith(".") for part in parts):
        raise PromptError(f"{name!r} is no name of a prompt")
    try:
        text = resources.files("prompts").joinpath(*parts[:-1], f"{parts[-1]}.txt").read_text(encoding="utf-8")
    except OSError as error:
        raise PromptError(f"there is no prompt {name!r}") from error
    return text.rstrip("\n")


def placeholders(text: str) -> frozenset[str]:
    """The names in braces; only plain names are allowed, so that a value can reach nothing but its own text.

    Raises:
        PromptError: a placeholder has an attribute, an index, a conversion or a format.
    """
    names: set[str] = set()
    for _, field, spec, conversion in string.Formatter().parse(text):
        if field is None:
            continue
        if not field.isidentifier() or spec or conversion:
            raise PromptError(f"placeholder {field!r} is not a plain name")
        names.add(field)
    return frozenset(names)


def render(name: str, **values: str) -> str:
    """The prompt with its placeholders filled.

    Raises:
        PromptError: there is no such prompt, or `values` has other names than its placeholders.
    """
    text = load_prompt(name)
    wanted = placeholders(text)
    missing, extra = sorted(wanted - values.keys()), sorted(values.keys() - wanted)
    if missing or extra:
        raise PromptError(f"prompt {name!r}: missing {missing}, superfluous {extra}")
    return text.format(**values)
