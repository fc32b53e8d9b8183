"""What the documentation says exists: linked files, commands with their options, scenes, examples."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import typer

from app.command_line import app
from sim.scene_file import builtin_scenes, load_scene

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)[^)]*\)")
COMMANDS = sorted(
    {
        (page.name, line.removeprefix("$ "))
        for page in PAGES
        for line in page.read_text(encoding="utf-8").splitlines()
        if line.startswith("$ ragvlm ")
    }
)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_linked_file_exists(page: Path) -> None:
    """Relative links lead to files or folders of the repository."""
    targets = [link for link in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in link]
    missing = [link for link in targets if not (page.parent / link).exists()]
    assert missing == []


@pytest.mark.parametrize(("page", "command"), COMMANDS)
def test_every_printed_command_exists_with_its_options(page: str, command: str) -> None:
    """Commands shown in the documentation name commands and options that the program has, and built-in scenes."""
    del page
    words = shlex.split(command.split("#")[0])[1:]
    group = typer.main.get_command(app)
    found = group.commands[words[0]]  # type: ignore[attr-defined]
    if hasattr(found, "commands"):
        found = found.commands[words[1]]
    known = {option for parameter in found.params for option in parameter.opts + parameter.secondary_opts}
    given = [word for word in words if word.startswith("--")]
    assert set(given) <= known | {"--help"}
    if "--scene" in words and not words[words.index("--scene") + 1].endswith(".yaml"):
        assert words[words.index("--scene") + 1] in builtin_scenes()


def test_the_scene_file_of_the_documentation_is_valid(tmp_path: Path) -> None:
    """The long example loads once its mesh exists."""
    import trimesh

    text = re.search(r"```yaml\n(.*?)```", (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8"), re.S)
    assert text is not None
    (tmp_path / "my_table.yaml").write_text(text.group(1))
    trimesh.creation.box(extents=(0.04, 0.05, 0.06)).export(tmp_path / "thing.obj")
    spec = load_scene(str(tmp_path / "my_table.yaml"))
    assert [thing.id for thing in spec.objects] == ["cup", "glass", "bowl", "block", "mystery"]


def test_examples_are_listed_and_parse() -> None:
    """Every example compiles and says in its docstring how it is run."""
    examples = sorted((ROOT / "examples").glob("*.py"))
    assert len(examples) >= 3
    for path in examples:
        source = path.read_text(encoding="utf-8")
        compile(source, str(path), "exec")
        assert f"python examples/{path.name}" in source
