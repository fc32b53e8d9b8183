"""A page that is being served, and a browser that looks at it; both once for all tests of a file."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
"""3D without a graphics card."""


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A data folder of the module's own."""
    folder = str(tmp_path_factory.mktemp("home"))
    former = os.environ.get("RAGVLM_HOME")
    os.environ["RAGVLM_HOME"] = folder
    yield folder
    if former is None:
        del os.environ["RAGVLM_HOME"]
    else:
        os.environ["RAGVLM_HOME"] = former


@pytest.fixture(scope="module")
def site(home: str) -> Iterator[Any]:
    """The page of a robot with one cube."""
    pytest.importorskip("mjviser", reason="needs the extra web: pip install 'agentic-rag-vlm[web]'")
    from app.options import RunOptions
    from app.web.serve import Site

    with Site(RunOptions(scene="single_cube", seed=1, thread="tested"), port=0) as served:
        yield served


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Debian's Chromium without a screen."""
    if CHROMIUM is None:
        pytest.skip("needs Debian's package chromium: apt-get install chromium")
    library = pytest.importorskip("playwright.sync_api", reason="needs the package playwright")
    with library.sync_playwright() as player:
        opened = player.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield opened
        opened.close()
