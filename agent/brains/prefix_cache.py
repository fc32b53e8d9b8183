"""The key-value cache of what stands at the beginning of every prompt of a role: computed once, continued from each time.

A prompt of ours is a system message (who you are, the schema of the reply, the role) and then the facts. The first part
is the same text at every question of a role, and often the longer one. Every reply goes through the stored part, the
first one too, so that a reply does not depend on what was asked before it.
"""

from __future__ import annotations

import copy
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

MAX_KEPT = 8
"""Beginnings that are kept: five roles, and some for other callers. The one that was used longest ago goes first."""
SHORTEST = 16
"""Tokens below which keeping a beginning is not worth its memory."""
OTHERWISE = ("a", "Z9")
"""Two ways to go on after the beginning: what their prompts share belongs to the beginning."""


class PrefixCache:
    """Beginnings of prompts, as token ids with their key-value caches."""

    def __init__(self, model: Any, tokenise: Callable[[str, str], Any], new_cache: Callable[[], Any]) -> None:
        """An empty store.

        Args:
            model: what `AutoModelForImageTextToText` gives.
            tokenise: token ids of a prompt of a system and a user text, shape (1, tokens).
            new_cache: makes an empty key-value cache.
        """
        self._model, self._tokenise, self._new_cache = model, tokenise, new_cache
        self._kept: OrderedDict[str, tuple[Any, Any]] = OrderedDict()

    def start(self, system: str, input_ids: Any) -> tuple[Any, int, int]:
        """A key-value cache that holds the beginning of a prompt.

        Args:
            system: the system message.
            input_ids: token ids of the whole prompt, shape (1, tokens).

        Returns:
            The cache, for one reply alone; how many tokens it holds; how many of them had to be computed now. None and
            zeros where the prompt does not begin like that.
        """
        computed = 0
        if system not in self._kept:
            ids = self._beginning(system).to(input_ids.device)
            cache = self._filled(ids) if ids.shape[1] >= SHORTEST else None
            computed = int(ids.shape[1]) if cache is not None else 0
            self._kept[system] = (ids, cache)
            while len(self._kept) > MAX_KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(system)
        ids, cache = self._kept[system]
        held = int(ids.shape[1])
        begins = input_ids.shape[1] > held and bool((input_ids[:, :held] == ids).all())
        return (copy.deepcopy(cache), held, computed) if cache is not None and begins else (None, 0, 0)

    def _beginning(self, system: str) -> Any:
        """What two prompts with this system message have in common, shape (1, tokens)."""
        one, other = (self._tokenise(system, text) for text in OTHERWISE)
        shorter = min(one.shape[1], other.shape[1])
        differ = (one[0, :shorter] != other[0, :shorter]).nonzero()
        return one[:, : int(differ[0]) if len(differ) else shorter]

    def _filled(self, ids: Any) -> Any:
        """The key-value cache after these tokens."""
        forget_pictures(self._model)
        cache = self._new_cache()
        self._model(input_ids=ids, past_key_values=cache, use_cache=True, logits_to_keep=1)
        return cache


def forget_pictures(model: Any) -> None:
    """Lets go of how far the pictures of the last prompt shifted the positions, which Qwen-VL keeps between prompts and
    would apply to the next one that begins with a stored part."""
    inner = getattr(model, "model", None)
    if getattr(inner, "rope_deltas", None) is not None:
        inner.rope_deltas = None  # pyright: ignore[reportOptionalMemberAccess]
