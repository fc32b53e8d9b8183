"""The knowledge base on a real Chroma server, started on the loopback."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from kb.chroma_server import read_server, write_server
from kb.errors import BadInputError, EnvironmentFaultError
from kb.store import ExperienceStore
from tests.experience_fixtures import make_entries, make_store


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a server that is alive until the tests end."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    folder = tmp_path_factory.mktemp("chroma")
    words = [str(Path(sys.executable).with_name("chroma")), "run", "--host", "127.0.0.1", "--port", str(port)]
    environment = {**os.environ, "ANONYMIZED_TELEMETRY": "False"}
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            [*words, "--path", str(folder)], stdout=log, stderr=subprocess.STDOUT, env=environment
        )
    try:
        deadline = time.monotonic() + 40.0
        while True:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=0.5).close()
                break
            except OSError:
                if process.poll() is not None or time.monotonic() > deadline:
                    pytest.fail((folder / "log").read_text())
        yield f"http://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait(10)


def test_what_is_written_there_comes_back(server: str) -> None:
    """The shipped 116 experiences come back equal and in order; a second push replaces the first."""
    with pytest.raises(EnvironmentFaultError, match="holds no knowledge base"):
        read_server(server)
    assert write_server(make_store(make_entries({"cup": (3, 1)})), server) == 3
    assert len(read_server(server)) == 3
    shipped = ExperienceStore.open()
    assert write_server(shipped, server) == 116
    again = read_server(server)
    assert again.all() == shipped.all()
    assert again.header == shipped.header


def test_no_server_and_no_address_are_told() -> None:
    """Nobody there: one line with the mend; no address: one line with an example."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(EnvironmentFaultError, match=r"cannot be used.*chroma run"):
        read_server(f"http://127.0.0.1:{port}")
    with pytest.raises(BadInputError, match="no address"):
        read_server("somewhere")
