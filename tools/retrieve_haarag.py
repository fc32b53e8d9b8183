"""HAA-RAG: three-level retrieval of experiences by category, affordance and looks (Sec. III-A; ledger A2, G14-G14g)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kb.affordance import AffordanceDescriptor
from kb.base import Finite, Noun
from kb.errors import EnvironmentFaultError
from kb.experience import Experience, Funnel, Retrieval, RetrievedExperience
from kb.experience_table import ExperienceTable
from kb.learned import posterior_mean
from kb.taxonomy import Taxonomy, taxonomy

if TYPE_CHECKING:
    from kb.store import ExperienceStore
    from tools.context import ToolContext

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

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

FEW, ROUGH = 500, 1e-5
"""More rows than the first are sieved by rough scores, whose error is below the second."""


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
    admitted, s_cat, fallback = level_1(
        args, store, taxonomy(context.switches.taxonomy), strict=context.switches.strict_l1
    )
    if context.switches.retrieval == "random_in_category":
        return _random(scored(args, store, admitted, s_cat), args.k, len(store), fallback, context.rng)
    fitting = admitted[affordance_scores(args.affordance, store.table(), admitted) >= TAU_AFFORDANCE - TAU_GUARD]
    learn = context.switches.learn
    likely = fitting if learn else promising(args, store, fitting, s_cat)
    ranked = rank(scored(args, store, likely, s_cat, learn=learn), args.affordance)
    top = choose(ranked, args.k)
    funnel = Funnel(total=len(store), level1=len(admitted), level2=len(fitting), level3=len(top), fallback=fallback)
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


def posterior_factor(entry: Experience) -> float:
    """While learning: between the penalty and 1, by the mean of the Beta posterior over the entry's success rate."""
    return PENALTY + (1.0 - PENALTY) * posterior_mean(entry)


def level_1(
    args: RetrieveArgs, store: ExperienceStore, categories: Taxonomy, *, strict: bool
) -> tuple[Rows, Array, bool]:
    """Rows admitted by category with their s_cat, at most K1 of them; and whether the fallback was needed.

    Among equal category scores those with the highest s_aff stay, then s_vis, then the smaller id (ledger G14c).
    """
    table = store.table()
    s_cat = np.array([categories.s_cat(args.category, name) for name in table.categories])[table.category]
    related = np.flatnonzero(s_cat > 0.0)
    if len(related) < FEWEST and not strict:
        return np.arange(len(table)), s_cat, True
    related = _sieved(args, store, related, s_cat)
    s_aff, s_vis = affordance_scores(args.affordance, table, related), visual_scores(args, store, related)
    order = np.lexsort((table.id_rank[related], -s_vis, -s_aff, -s_cat[related]))[:K1]
    return related[order], s_cat, False


def _sieved(args: RetrieveArgs, store: ExperienceStore, related: Rows, s_cat: Array) -> Rows:
    """Of very many rows those that can be among the K1 best of level 1."""
    if len(related) <= FEW:
        return related
    table = store.table()
    # s_aff is at most 1 and the steps of s_cat count 2 here: category first.
    key = 4.0 * s_cat[related] + affordance_scores(args.affordance, table, related)
    last = np.partition(key, -K1)[-K1]
    sure, tied = np.flatnonzero(key > last + TAU_GUARD), np.flatnonzero(np.abs(key - last) <= TAU_GUARD)
    needed = K1 - len(sure)
    if args.embedding and 0 < needed < len(tied):
        rough = np.maximum(0.0, table.rough_cosines(store.check_query(args.embedding))[related[tied]])
        tied = tied[rough >= np.partition(rough, -needed)[-needed] - ROUGH]
    return related[np.concatenate([sure, tied])]


def affordance_scores(affordance: AffordanceDescriptor, table: ExperienceTable, rows: Rows) -> Array:
    """s_aff of Eq. (1) of these rows, in [0, 1]."""
    type_, material, region, fragility = table.matches(affordance, rows)
    return W_TYPE * type_ + W_MATERIAL * material + W_FRAGILITY * fragility + W_REGION * region


def visual_scores(args: RetrieveArgs, store: ExperienceStore, rows: Rows) -> Array:
    """s_vis of these rows, in [0, 1]; 0 without a picture."""
    if not args.embedding:
        return np.zeros(len(rows))
    return np.maximum(0.0, store.table().cosines(store.check_query(args.embedding), rows))


def scored(
    args: RetrieveArgs, store: ExperienceStore, rows: Rows, s_cat: Array, *, learn: bool = False
) -> list[RetrievedExperience]:
    """These rows with the exact scores of all levels; while learning, with the posterior instead of the penalty."""
    table = store.table()
    s_aff, s_vis = affordance_scores(args.affordance, table, rows), visual_scores(args, store, rows)
    found: list[RetrievedExperience] = []
    places: list[int] = rows.tolist()
    for place, aff, vis in zip(places, s_aff.tolist(), s_vis.tolist(), strict=True):
        entry, cat = table.entries[place], float(s_cat[place])
        score = fused_score(cat, aff, vis, success=entry.success or learn) * (posterior_factor(entry) if learn else 1.0)
        found.append(RetrievedExperience(experience=entry, s_cat=cat, s_aff=aff, s_vis=vis, score=score))
    return found


def promising(args: RetrieveArgs, store: ExperienceStore, rows: Rows, s_cat: Array) -> Rows:
    """Of many rows those that can be among the k best, the best success of the type, or the k best failures.

    One rough matrix product scores all of them; whatever is within its error of the k-th best stays, so that the exact
    scores of the rest give the same answer as those of all.
    """
    if len(rows) <= FEW:
        return rows
    table = store.table()
    rough = np.zeros(len(rows))
    if args.embedding:
        rough = np.maximum(0.0, table.rough_cosines(store.check_query(args.embedding))[rows])
    s_aff, success = affordance_scores(args.affordance, table, rows), table.success[rows]
    score = (W_CATEGORY * s_cat[rows] + W_AFFORDANCE * s_aff + W_VISUAL * rough) * np.where(success, 1.0, PENALTY)
    same = table.type[rows] == table.code(args.affordance.type)
    kept = np.zeros(len(rows), np.bool_)
    for group in (np.ones(len(rows), np.bool_), success, success & same, ~success & same):
        inside = np.flatnonzero(group)
        if len(inside) > args.k:
            inside = inside[score[inside] >= np.partition(score[inside], -args.k)[-args.k] - ROUGH]
        kept[inside] = True
    return rows[kept]


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


def _final_order(item: RetrievedExperience) -> tuple[float, float, float, str]:
    return (-item.score, -item.s_aff, -item.s_vis, item.experience.id)
