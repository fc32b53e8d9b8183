"""`ragvlm serve`: opens the door, prints the address with its token, and waits until it is told to end."""

from __future__ import annotations

import ipaddress
import logging
import signal
import threading
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from app.console import make_console
from app.exit_codes import ACHIEVED
from app.web.names import new_thread
from kb.errors import BadInputError, EnvironmentFaultError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from app.options import RunOptions

MEND = "pip install 'agentic-rag-vlm[web]'"


def serve(options: RunOptions, *, host: str, port: int, allow_remote: bool) -> int:
    """Serves the page until Ctrl-C or SIGTERM; the robot is stopped first.

    Raises:
        BadInputError: a host beyond this machine without permission, or options that cannot be used.
        EnvironmentFaultError: the extra is not installed, or the port is taken.
    """
    require_extra()
    remote = not is_loopback(host)
    if remote and not allow_remote:
        raise BadInputError(
            f"{host} can be reached from other machines; whoever gets the address moves the robot",
            where="--host",
            choices=("127.0.0.1", "or add --allow-remote"),
        )
    console = make_console()
    with Site(options, host, port, remote=remote) as site, _ended_by_signal(site) as over:
        if remote:
            console.print(
                "warning: this page can be reached from other machines, and its connection is not encrypted",
                markup=False,
            )
        console.print(f"session {site.thread}; the page is at", markup=False)
        console.print(site.address, markup=False)
        console.print("Ctrl-C stops the robot and ends", markup=False)
        over.wait()
    return ACHIEVED


class Site:
    """A page that is being served. Close it, or use it in a `with` statement."""

    def __init__(self, options: RunOptions, host: str = "127.0.0.1", port: int = 8080, *, remote: bool = False) -> None:
        """Opens the world and the door."""
        from app.web.desk import Desk
        from app.web.gate import Door, bind, open_gate
        from app.web.guard import Guard
        from app.web.hall import Hall
        from app.web.reception import Reception
        from app.web.view import View

        sock = bind(host, port)
        self.port = int(sock.getsockname()[1])
        self.guard = Guard(self.port, remote=remote)
        self.hall = Hall()
        self.thread = options.thread or new_thread(options.scene)
        receive: list[Reception] = []

        async def talk(connection: Any) -> None:
            await receive[0].talk(connection)

        def page(path: str) -> Any:
            return receive[0].reply(path) if receive else None

        self._server = open_gate(sock, Door(self.guard, page, talk))
        try:
            self.desk = Desk(View(self._server), self.hall.tell)
            self.desk.open(replace(options, thread=self.thread))
        except BaseException:
            self._server.stop()
            raise
        receive.append(Reception(self.desk, self.hall, offers))
        name = f"[{host}]" if ":" in host else host
        self.address = f"http://{name}:{self.port}/?token={self.guard.token}"

    def __enter__(self) -> Site:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops the robot, then the server."""
        import rich

        self.desk.close()
        console = rich.get_console()
        loud, console.quiet = console.quiet, True
        try:
            self._server.stop()
        finally:
            console.quiet = loud


def offers() -> dict[str, Any]:
    """What a page can choose from."""
    from agent.approval import PLACE_LIMITS
    from agent.chat.sessions import list_sessions
    from app.catalogue_rows import catalogue_rows
    from kb.grasp import MAX_APERTURE, MAX_FORCE, MIN_FORCE
    from sim.scene_file import builtin_scenes, load_scene

    scenes = []
    for name in builtin_scenes():
        task = load_scene(name).task
        scenes.append({"name": name, "say": task.instructions[0] if task else ""})
    try:
        sessions = [info.model_dump() for info in list_sessions()][:40]
    except EnvironmentFaultError:
        sessions = []
    limits = {"force": [MIN_FORCE, MAX_FORCE], "aperture": [0.0, MAX_APERTURE], "standoff": [0.02, 0.2],
              "speed": [0.1, 1.0], "yaw": [-3.1416, 3.1416], **PLACE_LIMITS}  # fmt: skip
    return {"scenes": scenes, "models": [row["model"] for row in catalogue_rows()], "sessions": sessions,
            "limits": limits}  # fmt: skip


def require_extra() -> None:
    """Says in one line what to install where the page's libraries are missing.

    Raises:
        EnvironmentFaultError: they are missing, or another version that the guard was not tried with.
    """
    from importlib.metadata import PackageNotFoundError, version
    from importlib.util import find_spec

    try:
        found = version("viser")
    except PackageNotFoundError:
        found = ""
    if not found or find_spec("mjviser") is None:
        raise EnvironmentFaultError("the web page needs the extra `web`, which is not installed", mend=MEND)
    if found != "1.1.1":
        raise EnvironmentFaultError(f"the web page's guard is made for viser 1.1.1, not {found}", mend=MEND)


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach the host."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@contextmanager
def _ended_by_signal(site: Site) -> Iterator[threading.Event]:
    """What Ctrl-C and SIGTERM set, from before the address is printed; the signal stops the robot at once."""
    over = threading.Event()

    def end(_number: int, _frame: object) -> None:
        if site.desk.talk is not None:
            site.desk.talk.stop()
        over.set()

    former: dict[int, Callable[..., Any] | int | None] = {
        number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)
    }
    logging.getLogger("ragvlm.web").setLevel(logging.CRITICAL)
    try:
        yield over
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)
