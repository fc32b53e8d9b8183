"""The faces of the conversation as a person has them, in processes of their own: the terminal on a pty, the page's channel.

For measuring and for tests: what goes in are keys and orders, what comes out is what a person would see.
"""

from __future__ import annotations

import contextlib
import http.client
import json
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from kb.errors import EnvironmentFaultError

ESCAPES = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1b\][^\x07]*\x07|\x1b[@-Z\\-_=>]|[\r\x07]")
PATIENCE_S = 60.0
"""How long a loaded machine may take to say something [s]."""
PROMPT = "yo?u>"
"""Only characters that differ from what stood there are drawn: after "working>" the prompt comes without its o."""
SIZE = (50, 150)
"""Rows and columns of the terminal."""


class PtyChat:
    """`ragvlm chat` on a terminal of its own; keys go in, what is shown comes out."""

    def __init__(
        self, home: Path, *options: str, term: str = "xterm-256color", program: tuple[str, ...] = ("app", "chat")
    ) -> None:
        """Starts it with its data in `home`; `bench.timed_chat` as the program writes its halts to `home`/halts."""
        self.home = home
        self.raw, self.text, self._seen = "", "", 0
        master, slave = pty.openpty()
        _set_size(slave)
        environment = {
            **os.environ, "RAGVLM_HOME": str(home), "XDG_STATE_HOME": str(home), "TERM": term, "OMP_NUM_THREADS": "1",
            "PROMPT_TOOLKIT_NO_CPR": "1", "RAGVLM_HALTS": str(home / "halts"),
        }  # fmt: skip
        self.process = subprocess.Popen(
            [sys.executable, "-m", *program, *options], stdin=slave, stdout=slave, stderr=slave, env=environment,
            start_new_session=True, close_fds=True, preexec_fn=_own_terminal,
        )  # fmt: skip
        os.close(slave)
        self._master = master

    def type(self, line: str) -> None:
        """Types a line and presses Enter."""
        self.press(f"{line}\r")

    def press(self, keys: str) -> None:
        """Presses keys, Ctrl-C as chr(3)."""
        data = keys.encode()
        while data:
            # A terminal takes a paste in pieces, and shows what came so far in between.
            shown, takes, _ = select.select([self._master], [self._master], [], PATIENCE_S)
            if not (shown or takes):
                raise TimeoutError(f"the terminal takes no keys; shown was:\n{self.tail()}")
            if shown and not self._read(0.0):
                raise TimeoutError(f"it has ended; shown was:\n{self.tail()}")
            if takes:
                data = data[os.write(self._master, data[:1024]) :]

    def expect(self, pattern: str, patience: float = PATIENCE_S) -> str:
        """Waits until the pattern is shown after what was expected last; returns what it matched.

        Raises:
            TimeoutError: it does not come.
        """
        end = time.monotonic() + patience
        while (found := re.compile(pattern).search(self.text, self._seen)) is None:
            if not self._read(max(0.0, end - time.monotonic())):
                raise TimeoutError(f"{pattern!r} did not come; shown was:\n{self.tail()}")
        self._seen = found.end()
        return found[0]

    def idle(self, seconds: float) -> None:
        """Lets time pass, and reads what is shown meanwhile [s]."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self._read(left)

    def _read(self, patience: float) -> bool:
        ready, _, _ = select.select([self._master], [], [], patience)
        if not ready:
            return False
        try:
            data = os.read(self._master, 65536)
        except OSError:  # the other side has gone
            return False
        shown = data.decode("utf-8", "replace")
        self.raw += shown
        self.text += ESCAPES.sub("", shown)
        return bool(data)

    def tail(self) -> str:
        """The last lines shown."""
        return "\n".join([line for line in self.text.splitlines() if line.strip()][-40:])

    def kill(self) -> None:
        """SIGKILL, as a crash would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(timeout=20)

    def close(self) -> None:
        """Ends it; does nothing where it has ended already."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        with contextlib.suppress(OSError):
            os.close(self._master)


class PageChat:
    """`ragvlm serve` and one page's channel to it (needs the extra `web`, for its WebSocket library)."""

    def __init__(self, home: Path, *options: str) -> None:
        """Starts it with its data in `home`."""
        from websockets.sync.client import connect

        environment = {**os.environ, "RAGVLM_HOME": str(home), "OMP_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            [sys.executable, "-u", "-m", "app", "serve", "--port", "0", *options], stdout=subprocess.PIPE, text=True,
            env=environment,
        )  # fmt: skip
        assert self.process.stdout is not None
        address = next((line.strip() for line in self.process.stdout if "token=" in line), "")
        if not address:
            raise EnvironmentFaultError("the page was not served", mend="see the message above")
        self.address = address
        """With its token, for a browser."""
        host = address.split("/")[2]
        origin: Any = f"http://{host}"
        self._cookie = self._welcome(host, address)
        self._socket: Any = connect(
            f"ws://{host}/talk", additional_headers={"Cookie": self._cookie}, origin=origin, max_size=None, proxy=None
        )
        self.order(type="enter", page="measuring-0001")
        self.expect(lambda message: message["type"] == "hello")

    def _welcome(self, host: str, address: str) -> str:
        connection = http.client.HTTPConnection(host, timeout=PATIENCE_S)
        connection.request("GET", address.partition(host)[2])
        return connection.getresponse().headers["set-cookie"].partition(";")[0]

    def order(self, **order: Any) -> None:
        """Gives an order."""
        self._socket.send(json.dumps(order))

    def expect(self, wanted: Any, patience: float = PATIENCE_S) -> dict[str, Any]:
        """The next message for which `wanted(message)` holds.

        Raises:
            TimeoutError: it does not come.
        """
        end = time.monotonic() + patience
        while True:
            message = json.loads(self._socket.recv(timeout=max(0.0, end - time.monotonic())))
            if wanted(message):
                return message

    def idle(self, seconds: float) -> list[dict[str, Any]]:
        """Lets time pass; what came meanwhile [s]."""
        came: list[dict[str, Any]] = []
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                came.append(json.loads(self._socket.recv(timeout=left)))
            except TimeoutError:
                break
        return came

    def close(self) -> None:
        """Ends server and channel."""
        self._socket.close()
        self.process.terminate()
        try:
            self.process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()


class Browser:
    """A page in Chromium if playwright and Chromium are there, else only the page's channel."""

    def __init__(self, address: str) -> None:
        self._address, self._player, self._opened = address, None, None

    def __enter__(self) -> str:
        import shutil
        from importlib.util import find_spec

        found = shutil.which("chromium") or shutil.which("chromium-browser")
        if found is None or find_spec("playwright") is None:
            return "its channel only: no Chromium here"
        from playwright.sync_api import sync_playwright

        self._player: Any = sync_playwright().start()
        arguments = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        self._opened: Any = self._player.chromium.launch(executable_path=found, args=arguments)
        page = self._opened.new_page(viewport={"width": 1280, "height": 720})
        page.goto(self._address)
        page.wait_for_selector("#state:has-text('ready')", timeout=60_000)
        return "Chromium"

    def __exit__(self, *_: object) -> None:
        if self._opened is not None:
            self._opened.close()
            self._player.stop()


def cpu_seconds(pid: int) -> float:
    """CPU time that a process has used, all its threads [s] (proc(5): fields 14 and 15 of /proc/PID/stat)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident_mb(pid: int) -> float:
    """Memory that a process has in RAM [MB]."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def _own_terminal() -> None:
    """Makes standard input the controlling terminal, so that Ctrl-C reaches the process."""
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _set_size(terminal: int) -> None:
    import fcntl
    import termios

    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", *SIZE, 0, 0))
