"""The options that `run` and `chat` share, from the command line, a TOML file and the defaults (in this order).

Names are the same everywhere: the option `--dry-run` is the key `dry-run` of the file and the field `dry_run` here.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from kb.errors import BadInputError, EnvironmentFaultError

BRAINS = ("rules", "openai:MODEL", "hf:MODEL_OR_FOLDER", "replay:FILE")
PERCEPTIONS = ("rgbd", "vlm", "oracle")
EVALUATORS = ("mujoco", "analytic")
MAX_SEED = 2**63 - 1
"""Seeds must fit a signed 64-bit integer, so that every JSON reader keeps them exact or says so."""
MAX_CONFIG_BYTES = 1_000_000
"""A configuration file is a few lines; anything larger is a mistake (an image, a device)."""


@dataclass(frozen=True)
class RunOptions:
    """Everything that decides what a run does. The defaults are the product's."""

    scene: str | None = None
    """Built-in name or YAML file; None is the agent's default, or what the thread knows."""
    seed: int | None = None
    """None is 0, or what the thread knows."""
    brain: str = "rules"
    base_url: str | None = None
    """Address of the server of an `openai:` brain."""
    record_brain: str | None = None
    """File that keeps the exchanges with a language model; what stands in it is not asked again."""
    brain_pictures: bool = True
    """Whether a language model is sent pictures."""
    perception: str = "rgbd"
    evaluator: str = "mujoco"
    embedder: str = "shape_colour"
    """What turns a picture of an object into a vector: "shape_colour", "efficientnet", "clip:TAG" or "clip:FILE"."""
    kb: str | None = None
    """Knowledge base: a file, or the folder of a learning one; None is the shipped one (while learning: the user's)."""
    kb_url: str | None = None
    """Chroma server that holds the knowledge base instead."""
    learn: bool = False
    """Enter outcomes into the knowledge base, and score by them."""
    configuration: str = "full"
    json: str | None = None
    """File for the result, or "-" for standard output."""
    record: str | None = None
    """Folder for the record."""
    approve: bool = False
    dry_run: bool = False
    thread: str | None = None
    """Name of a conversation that persists."""


def option_name(field: str) -> str:
    """How a field is written on the command line (after `--`) and in the file."""
    return field.replace("_", "-")


def resolve_options(flags: Mapping[str, Any], config: Path | None, configurations: tuple[str, ...]) -> RunOptions:
    """Merges flags over the file over the defaults and checks every value.

    Args:
        flags: Field name -> value given on the command line; None where it was not given.
        config: TOML file, or None.
        configurations: Names that `--configuration` may have.

    Raises:
        BadInputError: An unknown key, a value of the wrong kind or out of its choices, a missing or malformed file.
        EnvironmentFaultError: `--perception vlm` without a brain that sees.
    """
    known = {field.name for field in fields(RunOptions)}
    merged: dict[str, Any] = {}
    if config is not None:
        for name, value in _read_config(config).items():
            _check_kind(name, value, where=f"{config}: {option_name(name)}")
            _check_value(name, value, f"{config}: {option_name(name)}", configurations)
            merged[name] = value
    for name, value in flags.items():
        if name in known and value is not None:
            _check_value(name, value, f"--{option_name(name)}", configurations)
            merged[name] = value
    options = RunOptions(**merged)
    _refuse_nonsense(options)
    return options


def _read_config(path: Path) -> dict[str, Any]:
    """Keys of the TOML file as field names."""
    if path.is_dir():
        raise BadInputError(f"{path} is a folder, a TOML file is wanted", where="--config")
    if not path.is_file():
        raise BadInputError(f"the file {path} does not exist", where="--config")
    if path.stat().st_size > MAX_CONFIG_BYTES:
        raise BadInputError(f"{path} is larger than 1 MB, which no configuration is", where="--config")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise BadInputError(f"malformed TOML: {error}", where=str(path)) from error
    except UnicodeDecodeError as error:
        raise BadInputError(f"not UTF-8 text (byte {error.start})", where=str(path)) from error
    names = {option_name(field.name): field.name for field in fields(RunOptions)}
    for key in table:
        if option_name(key) not in names:
            raise BadInputError(f'unknown key "{key}"', where=str(path), choices=names)
    return {names[option_name(key)]: value for key, value in table.items()}


def _check_kind(name: str, value: object, *, where: str) -> None:
    """A value from the file must have the type of the field: TOML has real integers and booleans."""
    kinds: dict[str, tuple[type, str]] = {
        "seed": (int, "a whole number"),
        "approve": (bool, "true or false"),
        "dry_run": (bool, "true or false"),
        "brain_pictures": (bool, "true or false"),
        "learn": (bool, "true or false"),
    }
    kind, wanted = kinds.get(name, (str, "a text in quotes"))
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise BadInputError(f"{value!r} is not {wanted}", where=where)


def _check_value(name: str, value: Any, where: str, configurations: tuple[str, ...]) -> None:
    """The value must be one of the choices of its option."""
    checks: dict[str, Callable[[Any], bool]] = {
        "seed": lambda v: 0 <= v <= MAX_SEED,
        "brain": lambda v: v == "rules" or re.fullmatch(r"(openai|hf|replay):\S.*", v) is not None,
        "perception": lambda v: v in PERCEPTIONS,
        "evaluator": lambda v: v in EVALUATORS,
        "configuration": lambda v: v in configurations,
        "thread": lambda v: re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", v) is not None,
        "scene": lambda v: bool(v.strip()),
        "json": lambda v: bool(v.strip()),
        "record": lambda v: bool(v.strip()),
    }
    if checks.get(name, lambda _: True)(value):
        return
    choices: dict[str, tuple[str, ...]] = {
        "seed": (f"0 to {MAX_SEED}",),
        "brain": BRAINS,
        "perception": PERCEPTIONS,
        "evaluator": EVALUATORS,
        "configuration": configurations,
        "thread": ("1 to 64 letters, digits, dots, dashes and underscores",),
    }
    what = f'"{value}" is not a choice' if str(value).strip() else "it is empty"
    raise BadInputError(what, where=where, choices=choices.get(name, ()))


def _refuse_nonsense(options: RunOptions) -> None:
    """Options that mean nothing together say so before anything is opened.

    Raises:
        BadInputError: a server or a record for a brain that has none.
        EnvironmentFaultError: names from pictures without a brain that sees.
    """
    if options.base_url is not None and not options.brain.startswith("openai:"):
        raise BadInputError("only an openai: brain has a server", where="--base-url")
    if options.base_url is not None and re.match(r"https?://[^\s/]+", options.base_url) is None:
        raise BadInputError(f'"{options.base_url}" is no address', where="--base-url", choices=("http://HOST:PORT/v1",))
    if options.record_brain is not None and not options.brain.startswith(("openai:", "hf:")):
        raise BadInputError("only openai: and hf: brains can be recorded", where="--record-brain")
    if options.kb_url is not None and (options.kb is not None or options.learn):
        raise BadInputError("a server's knowledge base is only read: leave out --kb and --learn", where="--kb-url")
    if options.perception == "vlm" and options.brain == "rules":
        raise EnvironmentFaultError(
            "--perception vlm needs a vision-language model",
            mend="add --brain openai:MODEL or --brain hf:FOLDER, or use --perception rgbd",
        )


def known_configurations() -> tuple[str, ...]:
    """Names that `--configuration` may have."""
    from agent.configuration import CONFIGURATIONS

    return tuple(CONFIGURATIONS)
