"""Laws of `ragvlm serve`: one line and the exit code for what cannot be, and no page that others can reach by accident."""

from __future__ import annotations

import socket
import sys
from typing import Any

import pytest

from app.command_line import run_command_line
from app.exit_codes import ENVIRONMENT, USAGE
from app.web.adding import scene_with
from app.web.gate import bind
from app.web.serve import is_loopback
from kb.errors import BadInputError, EnvironmentFaultError


def test_without_the_extra_it_says_what_to_install(monkeypatch: Any, capsys: Any) -> None:
    """Without viser it is one line with the mend and exit code 3."""
    import importlib.metadata as metadata

    def absent(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", absent)
    assert run_command_line(["serve", "--port", "0"]) == ENVIRONMENT
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "pip install 'agentic-rag-vlm[web]'" in lines[0]


def test_another_version_of_viser_is_refused(monkeypatch: Any) -> None:
    """The guard hooks into viser and was tried with one version only."""
    import importlib.metadata as metadata

    from app.web.serve import require_extra

    monkeypatch.setattr(metadata, "version", lambda _name: "9.9.9")
    with pytest.raises(EnvironmentFaultError, match=r"9\.9\.9"):
        require_extra()


def test_beyond_loopback_needs_permission(capsys: Any) -> None:
    """A host that other machines can reach is refused without --allow-remote, with exit code 2."""
    pytest.importorskip("mjviser")
    assert run_command_line(["serve", "--host", "0.0.0.0", "--port", "0"]) == USAGE
    assert "--allow-remote" in capsys.readouterr().err
    assert all(is_loopback(host) for host in ("127.0.0.1", "::1", "localhost", "127.3.2.1"))
    assert not any(is_loopback(host) for host in ("0.0.0.0", "::", "192.168.1.4", "robot.lab", ""))


def test_a_taken_port_is_said() -> None:
    """A port that is in use is an environment fault that names it; no other port is taken instead."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(EnvironmentFaultError, match=str(taken.getsockname()[1])):
            bind("127.0.0.1", taken.getsockname()[1])


def test_help_does_not_load_the_page() -> None:
    """The command's options are known without loading viser."""
    code = "import sys, app.command_line; sys.exit('viser' in sys.modules or 'app.web.gate' in sys.modules)"
    import subprocess

    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=60).returncode == 0


def test_the_page_has_the_options_of_a_conversation(monkeypatch: Any) -> None:
    """What a language model is sent, and where its replies are kept, is chosen as for `run` and `chat`."""
    given: list[Any] = []

    def serving(options: Any, **_: Any) -> int:
        given.append(options)
        return 0

    monkeypatch.setattr("app.web.serve.serve", serving)
    model = ["--brain", "openai:m", "--base-url", "http://127.0.0.1:1/v1"]
    assert run_command_line(["serve", *model, "--record-brain", "replies.jsonl", "--no-brain-pictures"]) == 0
    assert (given[0].record_brain, given[0].brain_pictures) == ("replies.jsonl", False)
    assert run_command_line(["serve", *model]) == 0
    assert (given[1].record_brain, given[1].brain_pictures) == (None, True)


def test_an_added_object_is_a_scene_of_its_own(tmp_path: Any, monkeypatch: Any) -> None:
    """Adding writes a scene file that holds all there was, as it was, and the new object; unknown models and bad places are refused."""
    from sim.draw_scene import draw_scene
    from sim.scene_file import load_scene
    from tools.open_world import open_world

    monkeypatch.setenv("RAGVLM_HOME", str(tmp_path))
    first = scene_with("cup_near_vase", "tennis_ball", (0.6, 0.2))
    second = scene_with(first, "tennis_ball", None)
    opened = open_world("cup_near_vase", 3)
    before = {thing.id: thing for thing in opened.placed.objects}
    after = draw_scene(load_scene(scene_with("cup_near_vase", "apple", None, opened)), 3)
    for thing in after.objects[:-1]:
        assert thing.position == pytest.approx(before[thing.id].position, abs=1e-6)
        assert (*thing.size, thing.mass) == pytest.approx((*before[thing.id].size, before[thing.id].mass))
        assert [geom.rgba for geom in thing.geoms] == [geom.rgba for geom in before[thing.id].geoms]
    placed = draw_scene(load_scene(second), 3)
    assert [thing.id for thing in placed.objects] == ["cup", "vase", "tennis_ball_1", "tennis_ball_2"]
    assert placed.objects[2].position[:2] == pytest.approx((0.6, 0.2))
    with pytest.raises(BadInputError, match="spaceship"):
        scene_with("cup_near_vase", "spaceship", None)
    with pytest.raises(BadInputError):
        draw_scene(load_scene(scene_with("cup_near_vase", "apple", (5.0, 5.0))), 3)


def test_it_prints_its_address_and_ends_on_sigterm(tmp_path: Any) -> None:
    """The command prints an address with a token that answers, and nothing of viser; SIGTERM ends it with exit code 0."""
    pytest.importorskip("mjviser")
    import os
    import signal
    import subprocess
    import urllib.request

    command = [sys.executable, "-m", "app", "serve", "--port", "0", "--scene", "single_cube"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "RAGVLM_HOME": str(tmp_path), "PYTHONUNBUFFERED": "1"},
    ) as served:
        assert served.stdout is not None
        lines = [served.stdout.readline().strip() for _ in range(3)]
        assert lines[1].startswith("http://127.0.0.1:")
        assert "?token=" in lines[1]
        opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(), urllib.request.ProxyHandler({}))
        assert b"Agentic RAG-VLM" in opener.open(lines[1], timeout=30).read()
        served.send_signal(signal.SIGTERM)
        assert served.wait(timeout=60) == 0
        assert served.stdout.read() == ""
