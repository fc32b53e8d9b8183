"""HAA-RAG: three-level retrieval of experiences by category, affordance and looks (Sec. III-A; ledger A2, G14-G14g)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun
from kb.errors import EnvironmentFaultError
from kb.experience import Experience, Funnel, Retrieval, RetrievedExperience
from kb.taxonomy import Taxonomy, taxonomy

if TYPE_CHECKING:
    import numpy as np

    from kb.store import ExperienceStore
    from tools.context import ToolContext

K1 = 30
"""Entries that survive level 1 (Sec. III-A)."""
TAU_AFFORDANCE = 0.3
"""Entries below are discarded at level 2 (Sec. III-A)."""
TAU_GUARD = 1e-9
"""Scores equal to tau in exact arithmetic survive (ledger G14d)."""
FEWEST = 3
"""Fewer survivors of level 1 open it to every entry (ledger G14b)."""
W_TYPE, W_MATERIAL, W_FRAGILITY, W_REGION = 0.5, 0.2, 0.15, 0.15
"""Weights of Eq. (1)."""
W_CATEGORY, W_AFFORDANCE, W_VISUAL = 0.2, 0.4, 0.4
"""Weights of the fusion (Sec. III-A)."""
PENALTY = 0.7
"""Factor on failed entries: "scores reduced by 30 %" (Sec. III-A)."""


class RetrieveArgs(Noun):
    """Arguments of `retrieve_haarag`."""

    category: str
    """Category of the object to be grasped, or "unknown"."""
    affordance: AffordanceDescriptor
    """Descriptor as perceived."""
    embedding: tuple[Finite, ...] = ()
    """Visual embedding of the masked crop; empty if there is no picture (s_vis is 0 then)."""
    k: Annotated[int, Field(ge=1, le=50)] = 3
    """How many experiences to return."""


def retrieve_haarag(args: RetrieveArgs, context: ToolContext) -> Retrieval:
    """Finds the k experiences that best fit the object, with the scores of all levels and the funnel.

    The switches of the context choose the reading: `strict_l1` keeps unrelated categories out, `retrieval` "none"
    returns nothing, "random_in_category" draws k of the survivors of level 1.

    Args:
        args: Category, affordance descriptor and embedding of the object; k.
        context: Supplies the store, the embedder, the switches and the random generator.

    Raises:
        EnvironmentFaultError: if there is no store, or it was made with another embedder.
        BadInputError: if the embedding's length does not fit the store.
    """
    store = context.store
    if store is None:
        raise EnvironmentFaultError("the session has no knowledge base", mend="restore kb/data/experiences.jsonl")
    if context.switches.retrieval == "none":
        return Retrieval(top=(), funnel=Funnel(total=len(store), level1=0, level2=0, level3=0, fallback=False))
    if args.embedding and context.embedder is not None:
        store.require_embedder(context.embedder.name)
    admitted, fallback = level_1(args, store, taxonomy(), strict=context.switches.strict_l1)
    if context.switches.retrieval == "random_in_category":
        return _random(admitted, args.k, len(store), fallback, context.rng)
    scored = [item for item in admitted if item.s_aff >= TAU_AFFORDANCE - TAU_GUARD]
    ranked = rank(scored, args.affordance)
    top = choose(ranked, args.k)
    funnel = Funnel(total=len(store), level1=len(admitted), level2=len(scored), level3=len(top), fallback=fallback)
    return Retrieval(top=top, avoid=_avoid(ranked, args), funnel=funnel)


def affordance_similarity(query: AffordanceDescriptor, entry: AffordanceDescriptor) -> float:
    """s_aff of Eq. (1), in [0, 1]."""
    return (
        W_TYPE * (query.type == entry.type)
        + W_MATERIAL * (query.material == entry.material)
        + W_FRAGILITY * (1.0 - abs(query.fragility - entry.fragility))
        + W_REGION * (query.region == entry.region)
    )


def fused_score(s_cat: float, s_aff: float, s_vis: float, *, success: bool) -> float:
    """s_final, with the penalty on failures (Sec. III-A; ledger G14f)."""
    return (W_CATEGORY * s_cat + W_AFFORDANCE * s_aff + W_VISUAL * s_vis) * (1.0 if success else PENALTY)


def level_1(
    args: RetrieveArgs, store: ExperienceStore, categories: Taxonomy, *, strict: bool
) -> tuple[list[RetrievedExperience], bool]:
    """Entries admitted by category, at most K1, best first, with all their scores; and whether the fallback was needed.

    Among equal category scores those with the highest s_aff stay, then s_vis, then the smaller id (ledger G14c).
    """
    query = store.check_query(args.embedding) if args.embedding else None
    known = {entry.category for entry in store.all()}
    related = [name for name in sorted(known) if categories.s_cat(args.category, name) > 0.0]

    def scored(entry: Experience) -> RetrievedExperience:
        s_cat = categories.s_cat(args.category, entry.category)
        s_aff = affordance_similarity(args.affordance, entry.affordance)
        s_vis = 0.0 if query is None else max(0.0, store.cosine(query, entry.id))
        score = fused_score(s_cat, s_aff, s_vis, success=entry.success)
        return RetrievedExperience(experience=entry, s_cat=s_cat, s_aff=s_aff, s_vis=s_vis, score=score)

    survivors = sorted((scored(entry) for entry in store.by_category(*related)), key=_level_1_order)[:K1]
    if len(survivors) >= FEWEST or strict:
        return survivors, False
    return sorted((scored(entry) for entry in store.all()), key=_level_1_order), True


def rank(items: Sequence[RetrievedExperience], affordance: AffordanceDescriptor) -> list[RetrievedExperience]:
    """All items, best first; no success of another affordance type stands before the best success of the same type.

    Ties: s_aff, then s_vis, then the smaller id (ledger G14c, G14d).
    """
    ranked = sorted(items, key=_final_order)
    first = next((i for i, item in enumerate(ranked) if item.experience.success), None)
    match = next((i for i, item in enumerate(ranked) if item.experience.success and _same_type(item, affordance)), None)
    if first is not None and match is not None and first < match:
        ranked.insert(first, ranked.pop(match))
    return ranked


def choose(ranked: Sequence[RetrievedExperience], k: int) -> tuple[RetrievedExperience, ...]:
    """The first k; if all of them are failures, the best success takes the last place, so that there is an e_1."""
    top = list(ranked[:k])
    if top and not any(item.experience.success for item in top):
        best = next((item for item in ranked if item.experience.success), None)
        if best is not None:
            top[-1] = best
    return tuple(top)


def _avoid(ranked: Sequence[RetrievedExperience], args: RetrieveArgs) -> tuple[RetrievedExperience, ...]:
    """The best-scored failures of the same affordance type: negative examples for the reflection (ledger G14f)."""
    failures = [item for item in ranked if not item.experience.success and _same_type(item, args.affordance)]
    return tuple(failures[: args.k])


def _random(
    admitted: Sequence[RetrievedExperience], k: int, total: int, fallback: bool, rng: np.random.Generator
) -> Retrieval:
    """Draws k experiences at random among the exact category's, else among all that level 1 admitted."""
    pool = [item for item in admitted if item.s_cat == 1.0] or list(admitted)
    order: list[int] = rng.permutation(len(pool)).tolist()
    drawn = tuple(pool[i] for i in order[:k])
    funnel = Funnel(total=total, level1=len(admitted), level2=len(pool), level3=len(drawn), fallback=fallback)
    return Retrieval(top=drawn, funnel=funnel)


def _same_type(item: RetrievedExperience, affordance: AffordanceDescriptor) -> bool:
    return item.experience.affordance.type == affordance.type


def _level_1_order(item: RetrievedExperience) -> tuple[float, float, float, str]:
    return (-item.s_cat, -item.s_aff, -item.s_vis, item.experience.id)


def _final_order(item: RetrievedExperience) -> tuple[float, float, float, str]:
    return (-item.score, -item.s_aff, -item.s_vis, item.experience.id)
