"""The page in Chromium, as a person uses it: command, steps, approval, verdict, stop, reload, a second page."""

from __future__ import annotations

import re
import time
from statistics import median_low
from typing import Any

import numpy as np
import pytest

SIZE = {"width": 1280, "height": 720}
WAIT = 60_000
STOP_MS = 50.0
"""From the click to the halt of physics (product contract)."""


@pytest.fixture(scope="module")
def context(browser: Any) -> Any:
    """One browser profile for all pages."""
    opened = browser.new_context(viewport=SIZE)
    opened.set_default_timeout(WAIT)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def asked(context: Any) -> list[str]:
    """Addresses of all requests that any page made."""
    addresses: list[str] = []
    context.on("request", lambda request: addresses.append(request.url))
    return addresses


@pytest.fixture(scope="module")
def page(context: Any, site: Any, asked: list[str]) -> Any:
    """The first page, which has the controls."""
    opened = context.new_page()
    opened.goto(site.address)
    _expect(opened, "#holder").to_have_text("You control", timeout=WAIT)
    return opened


def _expect(page: Any, selector: str) -> Any:
    from playwright.sync_api import expect

    return expect(page.locator(selector))


def _say(page: Any, words: str) -> None:
    page.fill("#words", words)
    page.press("#words", "Enter")


def _done(page: Any, site: Any) -> None:
    """Waits until the desk has ended the turn."""
    deadline = time.monotonic() + WAIT / 1000
    while site.desk.status.busy:
        assert time.monotonic() < deadline
        page.wait_for_timeout(20)


def _idle(page: Any) -> None:
    _expect(page, "#state").to_have_text(re.compile("Live · ready"), timeout=WAIT)


def _a_command_streams_asks_and_is_judged(page: Any, site: Any) -> None:
    """Steps stream in, the motion waits for approval with its numbers, an edit is carried out, the verdict follows."""
    assert "token" not in page.url
    page.check("#asks")
    page.select_option("#speed", "0")
    _say(page, "pick up the cube")
    _expect(page, "#approval").to_be_visible(timeout=WAIT)
    kinds = [line.get_attribute("class") for line in page.locator("#log .entry").all()]
    for kind in ("k-said", "k-look", "k-retrieved", "k-graphed", "k-planned", "k-thought"):
        assert any(kind in str(found) for found in kinds), kind
    assert not any("k-action" in str(found) for found in kinds)
    _expect(page, "#panel-grasps tbody tr.chosen").to_have_count(1)
    assert page.evaluate("(e => e.scrollHeight <= e.clientHeight)(document.querySelector('#approval .why'))")
    _pointing_at_a_gripper_sets_off_its_row(page, site)
    page.fill("#approval input[name=force]", "13")
    page.click("#approval .yes")
    _expect(page, "#log .k-finished").to_contain_text("The observer saw success", timeout=WAIT)
    assert site.desk.talk.state.attempts[-1].plan.grasp.force == 13.0
    page.click("#tab-why")
    _expect(page, "#panel-why").to_contain_text("13.0 N")
    page.click("#tab-attempts")
    _expect(page, "#panel-attempts .attempt").to_contain_text("observed success")
    assert page.locator("#panel-attempts svg path").count() == 2
    page.click("#tab-memory")
    _expect(page, "#panel-memory").to_contain_text("cube")


def _pointing_at_a_gripper_sets_off_its_row(page: Any, site: Any) -> None:
    """The pointer over the palm of the chosen gripper, where the view's own camera sees it, sets off gripper and row."""
    page.wait_for_function("() => document.querySelector('#view').contentWindow.camera", timeout=WAIT)
    camera = page.evaluate("document.querySelector('#view').contentWindow.camera")
    chosen = next(c for c in site.desk.view._candidates if c.chosen)
    w, x, y, z = camera["wxyz"]
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])  # fmt: skip
    palm = np.array(chosen.grasp.position) - 0.08 * chosen.grasp.rotation()[:, 2]
    seen = turn.T @ (palm - np.array(camera["position"]))
    box = page.locator("#view").bounding_box()
    half = box["height"] / 2 / np.tan(camera["fov"] / 2)
    across = box["x"] + box["width"] / 2 + seen[0] / seen[2] * half
    down = box["y"] + box["height"] / 2 + seen[1] / seen[2] * half
    page.mouse.move(across, down)
    _expect(page, "#panel-grasps tr.over").to_have_count(1, timeout=WAIT)
    assert site.desk.view._pointed == page.get_attribute("#panel-grasps tr.over", "data-name")
    page.mouse.move(box["x"] + 5, box["y"] + box["height"] - 5)
    _expect(page, "#panel-grasps tr.over").to_have_count(0, timeout=WAIT)


def _numbers_beyond_the_hand_cannot_be_approved(page: Any, site: Any) -> None:
    """The box does not send a force that the hand cannot do; rejecting moves nothing."""
    _idle(page)
    page.select_option("#speed", "0")
    _say(page, "put it back")
    _expect(page, "#approval h2").to_contain_text("put the cube back", timeout=WAIT)
    page.fill("#approval input[name=x]", "900")
    page.click("#approval .yes")
    _expect(page, "#approval").to_be_visible()
    page.fill("#approval input[name=x]", "520")
    page.click("#approval .yes")
    _expect(page, "#log .k-action >> nth=-1").to_contain_text("place", timeout=WAIT)
    _idle(page)
    _say(page, "pick up the cube")
    _expect(page, "#approval").to_be_visible(timeout=WAIT)
    before = site.desk.talk.agent.opened.motions
    page.fill("#approval input[name=force]", "99")
    page.click("#approval .yes")
    _expect(page, "#approval").to_be_visible()
    page.click("#approval .no")
    _idle(page)
    assert site.desk.talk.agent.opened.motions == before


def _what_is_typed_stays_text(page: Any) -> None:
    """Markup and escape sequences are shown as text; nothing of them becomes an element."""
    _idle(page)
    _say(page, "<img src=x onerror=alert(1)> <b>grab</b> \x1b[31mit")
    _expect(page, "#log .k-said >> nth=-1").to_contain_text("<img src=x onerror=alert(1)>")
    _idle(page)
    assert page.locator("#log img").count() == 0
    assert page.locator("#log .entry b").count() == 0


def _stop_halts_physics_in_time_and_latches(page: Any, site: Any, *, stops: int) -> None:
    """Esc in the middle of a motion halts physics; nothing moves until Release; half of the stops take below 50 ms."""
    _idle(page)
    page.uncheck("#asks")
    page.select_option("#speed", "1")
    taken = []
    for number in range(stops):
        _say(page, "put it back" if site.desk.talk.state.held else "pick up the cube")
        motions = site.desk.talk.agent.opened.motions
        deadline = time.monotonic() + 10
        while site.desk.talk.agent.opened.motions == motions and time.monotonic() < deadline:
            page.wait_for_timeout(20)
        page.wait_for_timeout(150 + 130 * number % 1700)
        if number == 1:
            page.click("#stop")
        else:
            page.keyboard.press("Escape")
        _expect(page, "#state").to_have_text(re.compile("Stopped"), timeout=WAIT)
        _done(page, site)
        if site.desk.status.halted_at is not None:
            # Otherwise the robot was thinking between two phases, and there was nothing to halt.
            taken.append(site.desk.status.halted_at * 1000 - page.evaluate("window.stopPressedAt"))
        world = site.desk.talk.agent.opened.world
        still, moment = world.data.qpos.copy(), world.time
        _say(page, "pick up the cube")
        page.wait_for_timeout(200)
        _done(page, site)
        assert world.time == moment
        assert (world.data.qpos == still).all()
        page.click("#release")
        _idle(page)
    assert len(taken) >= stops / 3
    assert median_low(taken) <= STOP_MS, taken


def _a_reload_finds_the_session_and_the_controls(page: Any) -> None:
    """After a reload the transcript, the attempts and the controls are there."""
    before = page.locator("#log .entry").count()
    page.reload()
    _expect(page, "#holder").to_have_text("You control", timeout=WAIT)
    _expect(page, "#log .entry").to_have_count(before)
    _expect(page, "#log").to_contain_text("pick up the cube")
    page.click("#tab-attempts")
    assert page.locator("#panel-attempts .attempt").count() >= 2


def _a_replay_shows_the_past_and_comes_back(page: Any, site: Any) -> None:
    """The slider shows a recorded run and says so; it changes nothing in the world."""
    world = site.desk.talk.agent.opened.world
    moment = world.time
    page.locator("#replay-at").fill("300")
    _expect(page, "#state").to_have_text(re.compile("Replay"))
    page.click("#replay-live")
    _idle(page)
    assert world.time == moment


def _a_second_page_may_only_look_and_stop(page: Any, context: Any, site: Any) -> None:
    """A second page is told who holds the controls; its field is off, its Stop is not."""
    second = context.new_page()
    second.goto(f"http://127.0.0.1:{site.port}/")
    _expect(second, "#holder").to_have_text(re.compile("View only: page 1 controls"))
    assert second.is_disabled("#words")
    assert second.is_enabled("#stop")
    second.close()


def _nothing_is_cut_off(page: Any) -> None:
    """At each size the page fits the window, its parts lie beside each other, none outside, and all tabs are seen."""
    for size in ((1280, 720), (1024, 768), (820, 1180)):
        page.set_viewport_size({"width": size[0], "height": size[1]})
        assert page.evaluate("(e => e.scrollWidth <= e.clientWidth)(document.querySelector('.tabs'))"), size
        boxes = {
            name: page.locator(name).bounding_box()
            for name in (".bar", ".stage", ".camera", ".panels", ".chat", "#stop")
        }
        for name, box in boxes.items():
            assert box is not None, name
            assert box["x"] >= 0, name
            assert box["y"] >= 0, name
            assert box["x"] + box["width"] <= size[0] + 1, name
            assert box["y"] + box["height"] <= size[1] + 1, name
            assert box["width"] > 100, name
            assert box["height"] > 40, name
        parts = [box for name, box in boxes.items() if name != "#stop"]
        for number, a in enumerate(parts):
            for b in parts[number + 1 :]:
                apart = a["x"] + a["width"] <= b["x"] + 1 or b["x"] + b["width"] <= a["x"] + 1
                assert apart or a["y"] + a["height"] <= b["y"] + 1 or b["y"] + b["height"] <= a["y"] + 1
    page.set_viewport_size(SIZE)


def _all_is_reached_by_the_keyboard(page: Any) -> None:
    """Tab visits every control of the bar, the panels and the conversation."""
    wanted = {"scene-open", "session-open", "speed", "asks", "stop", "view", "picture-open", "log", "words"}
    page.focus("#scene-open")
    reached: set[str] = set()
    for _ in range(150):
        reached.add(page.evaluate("document.activeElement.id"))
        page.keyboard.press("Tab")
        if wanted <= reached:
            break
    assert wanted <= reached
    page.focus("#tab-attempts")
    page.keyboard.press("ArrowRight")
    _expect(page, "#panel-scene").to_be_visible()


def _nothing_was_fetched_from_elsewhere(site: Any, asked: list[str]) -> None:
    """All requests of all pages went to this server, or stayed in the browser."""
    assert asked
    own = (f"http://127.0.0.1:{site.port}/", f"ws://127.0.0.1:{site.port}/", "blob:", "data:")
    assert [address for address in asked if not address.startswith(own)] == []


def _another_process_finds_the_session(page: Any, site: Any) -> None:
    """Closed and served again under the same thread, the page has the conversation, the memory and the replays."""
    from app.options import RunOptions
    from app.web.serve import Site

    words = [entry["text"] for entry in site.desk.transcript.entries if entry["kind"] == "said"]
    runs = len(site.desk.replays.runs)
    site.close()
    with Site(RunOptions(thread="tested"), port=0) as again:
        page.goto(again.address)
        _expect(page, "#log").to_contain_text(words[0], timeout=WAIT)
        assert [entry["text"] for entry in again.desk.transcript.entries if entry["kind"] == "said"] == words
        assert len(again.desk.replays.runs) == runs >= 1
        assert again.desk.talk is not None
        assert again.desk.talk.memory


def test_a_person_works_with_the_page(page: Any, context: Any, site: Any, asked: list[str]) -> None:
    """One visit, in order: command, approval, verdict, markup, stop, reload, second page, layout, keyboard, restart."""
    _a_command_streams_asks_and_is_judged(page, site)
    _what_is_typed_stays_text(page)
    _stop_halts_physics_in_time_and_latches(page, site, stops=2)
    _a_reload_finds_the_session_and_the_controls(page)
    _a_replay_shows_the_past_and_comes_back(page, site)
    _a_second_page_may_only_look_and_stop(page, context, site)
    _nothing_is_cut_off(page)
    _all_is_reached_by_the_keyboard(page)
    _nothing_was_fetched_from_elsewhere(site, asked)
    _another_process_finds_the_session(page, site)


@pytest.mark.long
def test_more_stops_and_numbers(browser: Any, home: str) -> None:
    """Five stops at different moments of the motion, and an approval box that refuses what the hand cannot do."""
    from app.options import RunOptions
    from app.web.serve import Site

    with Site(RunOptions(scene="single_cube", seed=2, thread="stopped-often"), port=0) as served:
        page = browser.new_page(viewport=SIZE)
        page.set_default_timeout(WAIT)
        page.goto(served.address)
        _expect(page, "#holder").to_have_text("You control", timeout=WAIT)
        _a_command_streams_asks_and_is_judged(page, served)
        _numbers_beyond_the_hand_cannot_be_approved(page, served)
        _stop_halts_physics_in_time_and_latches(page, served, stops=5)
        page.close()
