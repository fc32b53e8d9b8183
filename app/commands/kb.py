"""`ragvlm kb`: the knowledge base of measured experiences: list, look up, query with scores, rebuild from physics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Optional

import typer

app = typer.Typer(help="The knowledge base of measured grasps: list, query with scores, rebuild from physics.")

Store = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--store",
        metavar="FILE",
        help="A knowledge base: file, or folder of a learning one (default: the shipped one).",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]


Affordance = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--affordance", metavar="TYPE", help="For example GRASPABLE_HANDLE (default: the category's)."),
]
Material = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--material", metavar="NAME", help="For example ceramic (default: the category's)."),
]
Fragility = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--fragility", metavar="0..1", help="0 durable, 1 breaks at a touch (default: the category's)."),
]
Workers = Annotated[int, typer.Option("--workers", min=1, max=64, metavar="N", help="Processes.")]
Folder = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--kb", metavar="DIR", help="A learning knowledge base (default: the user's own)."),
]


def _described(**given: object) -> dict[str, Any]:
    """What was said about an object."""
    return {key: value for key, value in given.items() if value is not None}


@app.command("show")
def show(
    entry: Annotated[
        Optional[str],  # noqa: UP045
        typer.Argument(metavar="[ID]", help="One experience; all of them if left out."),
    ] = None,
    category: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--category", metavar="NAME", help="Only this category."),
    ] = None,
    store: Store = None,
    json_output: AsJson = False,
) -> None:
    """List the experiences, or show one."""
    from app.knowledge import show_all, show_one
    from kb.learned import open_any

    opened = open_any(store)
    if entry is not None:
        show_one(opened, entry, json_output=json_output)
    else:
        show_all(opened, category, json_output=json_output)


@app.command("query")
def query(
    category: Annotated[str, typer.Argument(metavar="CATEGORY", help='For example "mug"; "unknown" is allowed.')],
    affordance: Affordance = None,
    material: Material = None,
    fragility: Fragility = None,
    region: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--region", metavar="NAME", help="For example rim (default: the category's)."),
    ] = None,
    k: Annotated[int, typer.Option("-k", min=1, max=50, metavar="N", help="How many.")] = 3,
    store: Store = None,
    json_output: AsJson = False,
) -> None:
    """Retrieve experiences for an object described in words, with the scores of all three levels."""
    from app.knowledge import query_store

    described = _described(type=affordance, material=material, fragility=fragility, region=region)
    query_store(store, category, described, k, json_output)


@app.command("build")
def build(
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Where to write the knowledge base.")],
    workers: Workers = 2,
    trials: Annotated[int, typer.Option("--trials", min=10, max=200, metavar="N", help="Trials per entry.")] = 10,
    categories: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--categories", metavar="A,B", help="Only these (default: all)."),
    ] = None,
) -> None:
    """Make the knowledge base again by physical trials; the same seeds give the same file."""
    from app.knowledge import build_store

    names = tuple(name.strip() for name in (categories or "").split(",") if name.strip())
    build_store(out, workers=workers, trials=trials, categories=names)


@app.command("views")
def views(store: Store = None) -> None:
    """Render the reference pictures of a knowledge base again, beside its file, so that any embedder can embed it."""
    from app.knowledge import render_reference_views

    render_reference_views(store)


@app.command("eval")
def evaluate(
    json_file: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--json", metavar="FILE", help="Write the numbers there; - is standard output."),
    ] = None,
    out: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--out", metavar="DIR", help="Write report.html, tables.md and summary.json there."),
    ] = None,
    embedder: Annotated[
        str, typer.Option("--embedder", metavar="A,B", help="shape_colour, efficientnet, clip:TAG or clip:FILE.")
    ] = "shape_colour",
    splits: Annotated[
        str, typer.Option("--splits", metavar="A,B", help="in (Table I), near, far (outside the knowledge base).")
    ] = "in,near,far",
    executed: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--executed", metavar="FILE", help="Executed outcomes (default: beside the knowledge base)."),
    ] = None,
    workers: Workers = 2,
    again: Annotated[bool, typer.Option("--again", help="Execute everything anew: the physics changed.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="One view per object, nothing executed that was not executed before.")
    ] = False,
    store: Store = None,
) -> None:
    """Measure retrieval: every system on every query, by label and by executing what was retrieved."""
    from app.evaluation import evaluate_retrieval

    evaluate_retrieval(
        store,
        embedders=embedder,
        splits=splits,
        quick=quick,
        json_file=json_file,
        out=out,
        executed=executed,
        workers=1 if quick else workers,
        again=again,
    )


@app.command("log")
def log(
    kb: Folder = None,
    everything: Annotated[bool, typer.Option("--all", help="Lessons, too.")] = False,
    json_output: AsJson = False,
) -> None:
    """List the versions of a learning knowledge base: what was promoted, refused, added, rolled back."""
    from app.learning import default_folder, print_log

    print_log(kb or default_folder(), everything=everything, json_output=json_output)


@app.command("diff")
def diff(
    old: Annotated[int, typer.Argument(metavar="OLD", help="Version.")],
    new: Annotated[
        Optional[int],  # noqa: UP045
        typer.Argument(metavar="[NEW]", help="Version (default: the newest)."),
    ] = None,
    kb: Folder = None,
) -> None:
    """Show what changed between two versions."""
    from app.learning import default_folder, print_diff

    print_diff(kb or default_folder(), old, new)


@app.command("rollback")
def rollback(version: Annotated[int, typer.Argument(metavar="VERSION", help="Version.")], kb: Folder = None) -> None:
    """Go back to a version; as a new version, so that this can be undone, too."""
    from app.learning import default_folder, roll_back

    roll_back(kb or default_folder(), version)


@app.command("add")
def add(
    name: Annotated[str, typer.Argument(metavar="NAME", help='What it is called, for example "knob".')],
    scene: Annotated[str, typer.Option("--scene", metavar="NAME|FILE", help="A scene with the object in it.")],
    thing: Annotated[str, typer.Option("--object", metavar="ID", help="Its id in the scene.")],
    affordance: Affordance = None,
    material: Material = None,
    fragility: Fragility = None,
    trials: Annotated[int, typer.Option("--trials", min=10, max=200, metavar="N", help="Physical trials.")] = 10,
    kb: Folder = None,
) -> None:
    """Teach it an object: grasp it in physics and keep how that went."""
    from app.learning import add_object, default_folder

    described = _described(type=affordance, material=material, fragility=fragility)
    add_object(kb or default_folder(), name, scene, thing, described, trials)


@app.command("push")
def push(
    kb_url: Annotated[str, typer.Option("--kb-url", metavar="URL", help="Chroma server, http://HOST:PORT.")],
    store: Store = None,
) -> None:
    """Put a knowledge base on a Chroma server, in place of the one that is there."""
    from kb.chroma_server import write_server
    from kb.learned import open_any

    print(f"{write_server(open_any(store), kb_url)} experiences on {kb_url}")
