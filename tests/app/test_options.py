"""Options: flag over file over default, and every bad value refused with its choices."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.options import RunOptions, resolve_options
from kb.errors import BadInputError, EnvironmentFaultError

NAMES = ("full", "no_memory")


def resolve(flags: dict[str, object], config: Path | None = None) -> RunOptions:
    """With two configurations to choose from."""
    return resolve_options(flags, config, NAMES)


def test_defaults_are_those_of_the_product() -> None:
    """Without flags and file: rules brain, pixels, physics, the full configuration; scene and seed are the agent's."""
    options = resolve({})
    assert (options.brain, options.perception, options.evaluator, options.configuration, options.seed) == (
        "rules", "rgbd", "mujoco", "full", None,
    )  # fmt: skip
    assert not options.approve
    assert not options.dry_run


def test_a_flag_wins_over_the_file_and_the_file_over_the_default(tmp_path: Path) -> None:
    """Precedence is flag, file, default, also where the flag says no."""
    file = tmp_path / "run.toml"
    file.write_text('seed = 7\nscene = "single_cup"\napprove = true\ndry-run = true\n')
    options = resolve({"seed": 9, "approve": False, "scene": None}, file)
    assert (options.seed, options.scene, options.approve, options.dry_run) == (9, "single_cup", False, True)


@pytest.mark.parametrize("key", ["dry-run", "dry_run"])
def test_dashes_and_underscores_are_the_same_in_the_file(tmp_path: Path, key: str) -> None:
    """`dry-run` as on the command line and `dry_run` as in Python both work."""
    file = tmp_path / "run.toml"
    file.write_text(f"{key} = true\n")
    assert resolve({}, file).dry_run


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('colour = "red"', 'unknown key "colour" (valid: scene, seed, brain'),
        ("seed = 1.5", "seed: 1.5 is not a whole number"),
        ("seed = true", "seed: True is not a whole number"),
        ("seed = -4", 'seed: "-4" is not a choice'),
        ("approve = 1", "approve: 1 is not true or false"),
        ("scene = 3", "scene: 3 is not a text in quotes"),
        ('perception = "eyes"', '"eyes" is not a choice (valid: rgbd, vlm, oracle)'),
        ("seed = ", "malformed TOML"),
        ("[run]\nseed = 3", 'unknown key "run"'),
        ("seed = 1\nseed = 2", "malformed TOML"),
    ],
)
def test_a_bad_file_is_refused_with_what_and_where(tmp_path: Path, text: str, says: str) -> None:
    """The message names the file, the key and the choices, on one line."""
    file = tmp_path / "run.toml"
    file.write_text(text)
    with pytest.raises(BadInputError) as caught:
        resolve({}, file)
    assert says in str(caught.value)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_folder_or_binary_file_is_refused(tmp_path: Path) -> None:
    """Nothing that is not a TOML text is read."""
    binary = tmp_path / "picture.toml"
    binary.write_bytes(b"\x89PNG\xff\xfe\x00")
    for path, says in ((tmp_path / "no.toml", "does not exist"), (tmp_path, "is a folder"), (binary, "UTF-8")):
        with pytest.raises(BadInputError, match=says):
            resolve({}, path)


@pytest.mark.parametrize(
    "flags",
    [
        {"seed": -1},
        {"seed": 2**63},
        {"brain": "gpt"},
        {"brain": "openai:"},
        {"brain": "rules "},
        {"perception": ""},
        {"evaluator": "bullet"},
        {"configuration": "FULL"},
        {"thread": "../x"},
        {"thread": ""},
        {"scene": " "},
        {"json": ""},
        {"record": ""},
    ],
)
def test_every_bad_flag_names_the_option(flags: dict[str, object]) -> None:
    """Bad values are the caller's fault (exit 2), and the option stands in front."""
    (name,) = flags
    with pytest.raises(BadInputError) as caught:
        resolve(flags)
    assert str(caught.value).startswith(f"--{name}: ")
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("flags", "kind", "says"),
    [
        ({"perception": "vlm"}, EnvironmentFaultError, "--brain openai:MODEL"),
        ({"base_url": "http://127.0.0.1:1/v1"}, BadInputError, "--base-url: only an openai: brain"),
        ({"brain": "openai:m", "base_url": "localhost"}, BadInputError, "no address"),
        ({"record_brain": "x.jsonl"}, BadInputError, "--record-brain: only openai: and hf:"),
    ],
)
def test_options_that_mean_nothing_together_say_so(flags: dict[str, object], kind: type[Exception], says: str) -> None:
    """Names from pictures need a brain that sees, a server an openai: brain, a record a model: refused before anything opens."""
    with pytest.raises(kind, match=says):
        resolve(flags)


@given(st.text(max_size=30).filter(lambda text: text != "rules" and not text.startswith(("openai:", "hf:", "replay:"))))
def test_any_other_text_for_a_brain_gives_one_line(text: str) -> None:
    """Whatever is typed for --brain that names no brain is answered by a single line."""
    with pytest.raises(BadInputError) as caught:
        resolve({"brain": text})
    assert len(str(caught.value).splitlines()) == 1
