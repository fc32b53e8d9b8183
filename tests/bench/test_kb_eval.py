"""The retrieval evaluation: measures, rankings, executed relevance, and the report."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from bench.kb_eval import ranking
from bench.kb_eval.evaluate import Setting, evaluate, judge, make_sight
from bench.kb_eval.measure_ranking import means, ndcg, precision, reciprocal_rank
from bench.kb_eval.query import Query
from bench.kb_eval.relevance import FunctionalRelevance, affordance_relevant, key_of, successes
from bench.kb_eval.report import as_json, html, markdown
from bench.kb_eval.study import NOT_RUN, Part, Study, weight_grid
from kb.errors import EnvironmentFaultError
from kb.experience_table import make_table
from kb.priors import prior
from kb.reference_views import load_views, view_key, views_path
from kb.shape_colour import ShapeColourEmbedder
from kb.store import ExperienceStore
from kb.taxonomy import taxonomy
from tests.experience_fixtures import DIM, make_entries, make_store
from tools.context import ToolContext
from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag


def test_measures_of_a_ranking_worked_by_hand() -> None:
    """First relevant entry in place 2 of 4: P@1 0, P@3 1/3, MRR 1/2; nDCG of gains (0, 1, 0, 0) is 1 / log2(3)."""
    order, relevant = np.arange(4), np.array([False, True, False, False])
    assert precision(order, relevant, 1) == 0.0
    assert precision(order, relevant, 3) == pytest.approx(1 / 3)
    assert reciprocal_rank(order, relevant) == 0.5
    assert reciprocal_rank(order, np.zeros(4, bool)) == 0.0
    assert ndcg(order, relevant.astype(float)) == pytest.approx(1 / np.log2(3))


def test_intervals_over_objects_are_wider_than_over_queries_when_views_agree() -> None:
    """Five equal views of each of 12 objects are 12 observations: the interval over objects is about twice as wide."""
    objects = [f"o{i // 5}" for i in range(60)]
    values = {"p": [float(i // 5 < 6) for i in range(60)]}
    mean = means(values, objects, np.random.default_rng(0))["p"]
    assert mean.value == 0.5
    assert mean.high_by_object - mean.low_by_object > 1.8 * (mean.high - mean.low)


def test_haa_of_the_evaluation_is_the_haa_of_the_agent() -> None:
    """The first three of the evaluated ranking are what `retrieve_haarag` returns, for made-up queries of any kind."""
    store = make_store(make_entries())
    table, rng = store.table(), np.random.default_rng(3)
    for category in ("cup", "bowl", "thermos", "unknown", "key", "screwdriver"):
        for donor in ("cup", "vase", "smartphone", "apple"):
            vector = tuple(rng.random(DIM).tolist())
            args = RetrieveArgs(category=category, affordance=prior(donor).affordance, embedding=vector)
            found = retrieve_haarag(args, ToolContext(store=store)).top
            visual = table.cosines(np.array(vector), np.arange(len(table)))
            scores = ranking.make_scores(table, taxonomy(), category, args.affordance, visual, rng)
            order = ranking.haa(scores)[: len(found)]
            expected = [item.experience.id for item in found]
            if all(not item.experience.success for item in found[:-1]):
                continue  # the agent then takes a success into the last place (ledger G14f)
            assert [table.entries[row].id for row in order.tolist()] == expected


def test_every_system_ranks_every_entry_once() -> None:
    """Each ranking is a permutation, whatever the thresholds and weights."""
    table, rng = make_store(make_entries()).table(), np.random.default_rng(0)
    scores = ranking.make_scores(table, taxonomy(), "cup", prior("cup").affordance, rng.random(len(table)), rng)
    orders = [ranking.haa(scores, fusion) for fusion in weight_grid()]
    orders += [ranking.haa(scores, ranking.Fusion(tau=tau)) for tau in (0.0, 0.5, 1.1)]
    orders += [f(scores) for f in (ranking.category_only, ranking.affordance_only, ranking.visual_only)]
    orders += [ranking.visual_without_category(scores), ranking.random_in_category(scores, rng)]
    orders.append(ranking.Bm25(table.entries).rank("cup", prior("cup").affordance, scores))
    for order in orders:
        assert sorted(order.tolist()) == list(range(len(table)))


def test_the_baselines_do_what_their_names_say() -> None:
    """Visual only stays within related categories; without category the best cosine wins; affordance only ignores both."""
    table, rng = make_store(make_entries()).table(), np.random.default_rng(1)
    visual = rng.random(len(table))
    scores = ranking.make_scores(table, taxonomy(), "cup", prior("bowl").affordance, visual, rng)
    names = [table.entries[row].category for row in ranking.visual_only(scores)[:16].tolist()]
    assert set(names) == {"cup", "mug"}
    assert ranking.visual_without_category(scores)[0] == int((visual * scores.factor).argmax())
    best = table.entries[int(ranking.affordance_only(scores)[0])]
    assert (best.category, best.success) == ("bowl", True)
    bm25 = ranking.Bm25(table.entries).rank("bowl", prior("bowl").affordance, scores)
    assert table.entries[int(bm25[0])].category == "bowl"


def test_labels_want_type_region_fragility_and_success() -> None:
    """R-aff of a cup: its own successes with the same region; no failure, no bowl, no distant fragility."""
    entries = make_entries()
    relevant = affordance_relevant(prior("cup").affordance, entries)
    chosen = {entry.category for entry, good in zip(entries, relevant, strict=True) if good}
    assert chosen <= {"cup", "mug"}
    assert all(entry.success for entry, good in zip(entries, relevant, strict=True) if good)


def test_a_strategy_is_executed_on_another_object(tmp_path: Path) -> None:
    """A cube's strategy lifts a toy block in at least seven of ten trials; a stem grasp finds no stem on a cube: none."""
    store = ExperienceStore.open()
    cube = next(entry for entry in store.all() if entry.category == "cube" and entry.success)
    stem = next(entry for entry in store.all() if entry.strategy.region == "stem")
    assert successes("toy_block", cube.strategy) >= 7
    assert successes("wood_cube", stem.strategy) == 0
    path = tmp_path / "executed.json"
    executed = FunctionalRelevance(path)
    pairs = executed.missing([("wood_cube", stem), ("wood_cube", stem)])
    assert len(pairs) == 1
    executed.fill(pairs)
    again = FunctionalRelevance(path)
    assert (again.rate("wood_cube", stem), again.missing([("wood_cube", stem)])) == (0.0, [])
    stronger = stem.strategy.model_copy(update={"force": stem.strategy.force + 5})
    assert key_of("wood_cube", stronger) != key_of("wood_cube", stem.strategy)
    path.write_text("{")
    with pytest.raises(EnvironmentFaultError, match=r"delete .*executed\.json"):
        FunctionalRelevance(path)


def reference_queries() -> list[Query]:
    """The reference views of five entries as queries, perceived right except the last."""
    store = ExperienceStore.open()
    assert store.path is not None
    views = load_views(views_path(store.path))
    queries: list[Query] = []
    for number, name in enumerate(("cup", "apple", "bowl", "vase", "cube")):
        entry = next(entry for entry in store.all() if entry.category == name)
        seen = name if name != "cube" else "unknown"
        queries.append(
            Query(
                model=f"model_{name}", split="in", seed=number, true_category=name,
                true_affordance=prior(name).affordance, category=seen, affordance=prior(name).affordance,
                view=views[view_key(entry)],
            )
        )  # fmt: skip
    return queries


def test_the_evaluation_and_its_report(tmp_path: Path) -> None:
    """On five queries HAA-RAG and the oracle find a relevant first entry; what was not executed is null; CLIP says that
    it was not run; the JSON has the promised keys."""
    store, queries, executed = ExperienceStore.open(), reference_queries(), FunctionalRelevance(tmp_path / "none.json")
    sight = make_sight("shape_colour", "shape and colour", ShapeColourEmbedder(), store, queries)
    systems = evaluate(queries, [sight], executed, Setting(), np.random.default_rng(0), 50)
    assert systems["haa"]["p_at_1"].value == systems["oracle"]["p_at_1"].value == 1.0
    assert systems["visual_without_category_shape_colour"]["p_at_1"].value <= 1.0
    assert np.isnan(systems["haa"]["r_func_p_at_1"].value)
    left_out = judge(queries, [sight], executed, Setting(leave_out=True))
    assert all(len(item.rows) < len(store) for item in left_out)
    study = Study(
        knowledge_base={"entries": 116, "successes": 87, "content": "x"},
        embedders={"shape_colour": "shape and colour", "clip": f"{NOT_RUN}: no weights"},
        perceived={"in": (5, 5, 4)},
        executed=(10, 10),
        parts=(Part("in", Setting(), 5, 5, systems),),
        tau_sweep=[{"tau": 0.3, "p_at_1": 1.0, "mrr": 1.0, "r_func_p_at_1": float("nan")}],
        weight_sweep=[],
        machine="here",
    )
    told = json.loads(json.dumps(as_json(study)))
    assert told["queries"] == 5
    assert {"p_at_1", "p_at_3", "mrr", "affordance_match", "r_func_p_at_1"} <= set(told["systems"]["haa"])
    assert told["systems"]["haa"]["r_func_p_at_1"] is None
    assert "visual_clip" not in told["systems"]
    assert told["not_run"]["clip"].startswith(NOT_RUN)
    assert NOT_RUN in markdown(study)
    assert "<svg" in html(study)


def test_a_table_without_entries_is_searched_in_vain() -> None:
    """An empty table has no rows and no cosines."""
    table = make_table([], 4)
    assert len(table.cosines(np.ones(4), np.arange(0))) == 0
