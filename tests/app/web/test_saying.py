"""A language model's words on the page while they come: text, never markup, gone when the next step is there."""

from __future__ import annotations

import time
from typing import Any

import pytest

from tests.brain_fixtures import GOOD, fault_server, think

WAIT = 60_000
THOUGHT = "It stands free <img src=x onerror=alert(1)> I take it."
KEEP = """
  window.heard = [];
  new MutationObserver(() => {
    for (const box of document.querySelectorAll('.k-saying')) window.heard.push(box.lastElementChild.textContent);
  }).observe(document.getElementById('log'), { childList: true, subtree: true, characterData: true });
"""


def test_words_of_a_server_are_shown_as_text_and_go(browser: Any, home: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the server streams stands under the log while it comes, markup included as text; then the judged thought stands
    there instead, in the transcript, which has no words of a model that were not judged."""
    pytest.importorskip("mjviser", reason="needs the extra web: pip install 'agentic-rag-vlm[web]'")
    from app.options import RunOptions
    from app.web.serve import Site

    monkeypatch.setenv("OPENAI_API_KEY", "sk-none")
    with fault_server(("by_role", GOOD | {"think": think(thought=THOUGHT)})) as server:
        options = RunOptions(
            scene="single_cube", seed=1, thread="saying", brain="openai:good", base_url=server.url, dry_run=True
        )
        with Site(options, port=0) as served:
            page = browser.new_page()
            page.set_default_timeout(WAIT)
            page.goto(served.address)
            page.wait_for_selector("#holder:has-text('You control')")
            page.evaluate(KEEP)
            page.fill("#words", "kindly hoist that cube skyward, dear machine")
            page.press("#words", "Enter")
            page.wait_for_selector(".entry.k-thought")
            deadline = time.monotonic() + WAIT / 1000
            while served.desk.status.busy:
                assert time.monotonic() < deadline
                page.wait_for_timeout(20)
            page.wait_for_function("!document.querySelector('.k-saying')")
            heard = page.evaluate("window.heard")
            assert THOUGHT in heard
            assert page.locator("#log img").count() == 0
            assert THOUGHT in page.locator(".entry.k-thought").inner_text()
            assert all(entry["kind"] != "saying" for entry in served.desk.transcript.entries)
            page.close()
