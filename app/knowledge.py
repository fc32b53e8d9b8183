"""What `ragvlm kb` prints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from kb.errors import BadInputError

if TYPE_CHECKING:
    from kb.experience import Experience
    from kb.store import ExperienceStore


def show_all(store: ExperienceStore, category: str | None, *, json_output: bool) -> None:
    """One line an experience.

    Raises:
        BadInputError: no experience is of that category.
    """
    from app.console import make_console
    from app.table import print_table

    known = sorted({entry.category for entry in store.all()})
    if category is not None and category not in known:
        raise BadInputError(f'no experience with "{category}"', where="--category", choices=known)
    entries = [entry for entry in store.all() if category in (None, entry.category)]
    if json_output:
        print(json.dumps([_without_embedding(entry) for entry in entries], indent=2))
        return
    console = make_console()
    print_table(
        console,
        ("id", "category", "affordance", "region", "grasp", "approach", "force N", "trials", "verdict"),
        [_row(entry) for entry in entries],
    )
    good = sum(entry.success for entry in entries)
    trials = sum(entry.n_trials for entry in entries)
    if console.is_terminal:
        console.print(
            f"{len(entries)} experiences, {good} successes and {len(entries) - good} failures, {trials} physical "
            f"trials; embedded by {store.embedder_name}"
        )


def _row(entry: Experience) -> tuple[str, ...]:
    plan = entry.strategy
    return (
        entry.id,
        entry.category,
        entry.affordance.type,
        plan.region,
        plan.type,
        plan.approach,
        f"{plan.force:.0f}",
        f"{entry.n_success}/{entry.n_trials}",
        "success" if entry.success else "failure",
    )


def _without_embedding(entry: Experience) -> dict[str, Any]:
    row = entry.model_dump(mode="json")
    row["embedding"] = f"{len(entry.embedding)} numbers"
    return row


def show_one(store: ExperienceStore, entry_id: str, *, json_output: bool) -> None:
    """Everything about one experience.

    Raises:
        BadInputError: there is none of that id.
    """
    from app.console import make_console

    row = _without_embedding(store.get(entry_id))
    if json_output:
        print(json.dumps(row, indent=2))
        return
    console = make_console()
    for key, value in row.items():
        console.print(f"{key:<12}{json.dumps(value) if isinstance(value, dict | list) else value}", markup=False)


def query_store(path: Path | None, category: str, described: dict[str, Any], k: int, json_output: bool) -> None:
    """Retrieves for a described object and prints the scores of all levels.

    Raises:
        BadInputError: no category, or a descriptor's value is not one of its choices.
    """
    from app.console import make_console
    from app.table import print_table
    from kb.affordance import AffordanceDescriptor
    from kb.learned import open_any
    from kb.priors import prior
    from tools.context import ToolContext
    from tools.retrieve_haarag import RetrieveArgs, retrieve_haarag

    if not category.strip():
        raise BadInputError('it is empty; say "unknown" for an object of no known kind', where="CATEGORY")
    check_descriptor(described)
    affordance = AffordanceDescriptor.model_validate({**prior(category).affordance.model_dump(), **described})
    context = ToolContext(store=open_any(path))
    found = retrieve_haarag(RetrieveArgs(category=category, affordance=affordance, k=k), context)
    if json_output:
        rows = [
            {**item.model_dump(mode="json"), "experience": _without_embedding(item.experience)} for item in found.top
        ]
        print(json.dumps({"top": rows, "funnel": found.funnel.model_dump()}, indent=2))
        return
    console = make_console()
    print_table(
        console,
        ("id", "category", "score", "category", "affordance", "looks", "region", "approach", "force N", "trials"),
        [
            (
                item.experience.id,
                item.experience.category,
                f"{item.score:.3f}",
                f"{item.s_cat:.2f}",
                f"{item.s_aff:.2f}",
                f"{item.s_vis:.2f}",
                item.experience.strategy.region,
                item.experience.strategy.approach,
                f"{item.experience.strategy.force:.0f}",
                f"{item.experience.n_success}/{item.experience.n_trials}",
            )
            for item in found.top
        ],
    )
    if console.is_terminal:
        funnel = found.funnel
        console.print(
            f"funnel: {funnel.total} entries > {funnel.level1} by category"
            f"{' (too few fitted, all admitted)' if funnel.fallback else ''} > {funnel.level2} by affordance > "
            f"{funnel.level3}; looks score 0 because words have no picture"
        )


def check_descriptor(described: dict[str, Any]) -> None:
    """The words of the descriptor must be of the closed vocabularies."""
    from kb.vocabulary import AffordanceType, Material, Region

    choices = {"type": get_args(AffordanceType), "material": get_args(Material), "region": get_args(Region)}
    options = {"type": "--affordance", "material": "--material", "region": "--region"}
    for key, allowed in choices.items():
        if key in described and described[key] not in allowed:
            raise BadInputError(f'"{described[key]}" is not a choice', where=options[key], choices=allowed)
    if "fragility" in described and not 0.0 <= described["fragility"] <= 1.0:
        raise BadInputError(f"{described['fragility']} is not a choice", where="--fragility", choices=("0 to 1",))


def build_store(out: Path, *, workers: int, trials: int, categories: tuple[str, ...]) -> None:
    """Makes a knowledge base by physical trials and writes it, with progress on standard error.

    Raises:
        BadInputError: the file cannot be written there, or a category is unknown.
    """
    from app.console import make_console
    from app.files import refuse_unwritable_file
    from kb.shape_colour import ShapeColourEmbedder
    from kb.store import new_store
    from tools.experience.recipe import category_plans
    from tools.gather_experience import build_knowledge_base

    refuse_unwritable_file(out, where="--out")
    known = tuple(plan.category for plan in category_plans())
    for name in categories:
        if name not in known:
            raise BadInputError(f'there are no recipes for "{name}"', where="--categories", choices=known)
    console = make_console(stderr=True)

    def lines(done: int, total: int, what: str) -> None:
        console.print(f"{done}/{total} {what}", markup=False)

    if console.is_terminal:
        from rich.progress import Progress

        with Progress(console=console) as bar:
            task = bar.add_task("physical trials", total=None)
            entries = build_knowledge_base(
                lambda done, total, what: bar.update(task, completed=done, total=total, description=what),
                workers=workers, trials=trials, categories=categories,
            )  # fmt: skip
    else:
        entries = build_knowledge_base(lines, workers=workers, trials=trials, categories=categories)
    embedder = ShapeColourEmbedder()
    new_store(entries, embedder=embedder.name, dim=embedder.dim, path=out).save(out)
    good = sum(entry.success for entry in entries)
    console.print(f"{len(entries)} experiences, {good} successes and {len(entries) - good} failures, in {out}")
    render_reference_views(out)


def render_reference_views(path: Path | None) -> None:
    """Writes the reference views of a knowledge base beside its file, with progress on standard error.

    Raises:
        EnvironmentFaultError: an entry's view cannot be rendered again, or the file cannot be written.
    """
    from app.console import make_console
    from kb.reference_views import save_views, views_path
    from kb.store import ExperienceStore
    from tools.experience.reference_view import render_views

    store = ExperienceStore.open(path)
    console = make_console(stderr=True)

    def told(done: int, total: int) -> None:
        if done % 20 == 0 or done == total:
            console.print(f"{done}/{total} views", markup=False)

    pictures = render_views(store.all(), told)
    assert store.path is not None  # opened from a file
    save_views(views_path(store.path), pictures)
    console.print(f"{len(pictures)} reference views in {views_path(store.path)}")
