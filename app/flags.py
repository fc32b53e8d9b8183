"""The option declarations that commands share, so that a name means the same everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Optional

import typer

from app import completion

WORLD = "What happens"
OUTPUT = "Output"

# `Optional` and not `| None`: typer reads these aliases at run time in all its supported versions.
Scene = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--scene",
        autocompletion=completion.scenes,
        metavar="NAME|FILE",
        help="Built-in scene or YAML file (default: single_cup).",
        rich_help_panel=WORLD,
    ),
]
Seed = Annotated[
    Optional[int],  # noqa: UP045
    typer.Option("--seed", metavar="N", help="Everything random follows from it (default: 0).", rich_help_panel=WORLD),
]
Brain = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--brain",
        metavar="BRAIN",
        help="rules, openai:MODEL, hf:MODEL_OR_FOLDER or replay:FILE (default: rules).",
        rich_help_panel=WORLD,
    ),
]
BaseUrl = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--base-url", metavar="URL", help="Server of an openai: brain.", rich_help_panel=WORLD),
]
RecordBrain = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--record-brain",
        metavar="FILE",
        help="Keep the exchanges with a language model there; what it holds is not asked again.",
        rich_help_panel=OUTPUT,
    ),
]
BrainPictures = Annotated[
    Optional[bool],  # noqa: UP045
    typer.Option(
        "--brain-pictures/--no-brain-pictures",
        help="Send pictures to the language model.",
        show_default=False,
        rich_help_panel=WORLD,
    ),
]
Perception = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--perception",
        autocompletion=completion.perceptions,
        metavar="KIND",
        help="rgbd (from pixels), vlm, or oracle (the truth) (default: rgbd).",
        rich_help_panel=WORLD,
    ),
]
Evaluator = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--evaluator",
        autocompletion=completion.evaluators,
        metavar="KIND",
        help="mujoco (physics) or analytic (default: mujoco).",
        rich_help_panel=WORLD,
    ),
]
Configuration = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--configuration",
        autocompletion=completion.configurations,
        metavar="NAME",
        help="full, or an ablation by name (default: full).",
        rich_help_panel=WORLD,
    ),
]
Embedder = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--embedder",
        metavar="NAME",
        help="shape_colour, efficientnet, clip:TAG or clip:FILE (default: shape_colour).",
        rich_help_panel=WORLD,
    ),
]
Kb = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--kb",
        metavar="FILE|DIR",
        help="Knowledge base: a file, or the folder of a learning one (default: the one shipped).",
        rich_help_panel=WORLD,
    ),
]
KbUrl = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--kb-url", metavar="URL", help="Chroma server with the knowledge base.", rich_help_panel=WORLD),
]
Learn = Annotated[
    Optional[bool],  # noqa: UP045
    typer.Option(
        "--learn/--no-learn",
        help="Learn from what happens: outcomes enter the knowledge base of --kb (default: your own).",
        show_default=False,
        rich_help_panel=WORLD,
    ),
]
Approve = Annotated[
    Optional[bool],  # noqa: UP045
    typer.Option("--approve/--no-approve", help="Ask before every motion.", show_default=False, rich_help_panel=WORLD),
]
DryRun = Annotated[
    Optional[bool],  # noqa: UP045
    typer.Option(
        "--dry-run/--no-dry-run",
        help="Understand, look and plan; move nothing.",
        show_default=False,
        rich_help_panel=WORLD,
    ),
]
Thread = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--thread", metavar="ID", help="Name of a conversation that persists and can be resumed.", rich_help_panel=WORLD
    ),
]
Json = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--json", metavar="FILE", help="Write the result there; - is standard output.", rich_help_panel=OUTPUT
    ),
]
Record = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        "--record", metavar="DIR", help="Write the run: result, trace, pictures, a video.", rich_help_panel=OUTPUT
    ),
]
Config = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--config",
        metavar="FILE",
        help="TOML file with these options; a flag wins over the file.",
        rich_help_panel=OUTPUT,
    ),
]

CONVERSATION: dict[str, Any] = {
    "scene": Scene,
    "seed": Seed,
    "brain": Brain,
    "base_url": BaseUrl,
    "brain_pictures": BrainPictures,
    "record_brain": RecordBrain,
    "perception": Perception,
    "evaluator": Evaluator,
    "configuration": Configuration,
    "embedder": Embedder,
    "kb": Kb,
    "kb_url": KbUrl,
    "learn": Learn,
    "approve": Approve,
    "dry_run": DryRun,
    "thread": Thread,
}
"""Field of `app.options.RunOptions` -> the option that sets it, for whatever talks with the robot."""
SINGLE_RUN: dict[str, Any] = {**CONVERSATION, "json": Json, "record": Record}
"""The same for a single run, which can be written to files."""
