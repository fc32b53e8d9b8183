"""The robot as all pages see it: one conversation, its panels, its live view. Orders come in, messages go out.

Orders are given from the server's event loop and return at once: stopping happens there and then, everything else in
the desk's own thread, one after the other.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from app.garbage import Garbage
from app.open_conversation import open_conversation
from app.web.board import Board
from app.web.live import Live
from app.web.pictures import Pictures
from app.web.replays import Replays
from app.web.rows import candidates_of
from app.web.status import Status, status_of
from app.web.transcript import Transcript, entry_of, world_mark
from app.web.worker import Worker

if TYPE_CHECKING:
    from agent.chat import Conversation
    from app.options import RunOptions
    from app.web.view import View


class Desk:
    """Carries out orders and tells the pages."""

    def __init__(self, view: View, tell: Callable[[dict[str, Any]], None]) -> None:
        self.view = view
        self._tell = tell
        self.status = Status()
        self.board = Board(lambda part, value: tell({"type": "board", "part": part, "value": value}))
        self.live = Live(self._show_live, self._halted, self._felt)
        self.pictures = Pictures(lambda names: self.board.put("pictures", names))
        self.transcript = Transcript(None)
        self.replays = Replays()
        self.talk: Conversation | None = None
        self.options: RunOptions | None = None
        self._said = ""
        self._stop_at = 0.0
        self._stop_told = False
        """The page has said itself that the running turn was stopped; the turn need not say it again."""
        self._garbage = Garbage()
        self._worker = Worker(self.refuse, self._over)

    # Sessions -----------------------------------------------------------------------------------------------------

    def open(self, options: RunOptions) -> None:
        """Opens a conversation and closes the one before; a wrong name leaves everything as it is.

        Raises:
            RagVlmError: as `Conversation.open`.
        """
        talk = open_conversation(options, options.thread)
        if self.talk is not None:
            self.live.detach()
            self.talk.close()
        self.talk, self.options = talk, options
        self.transcript = Transcript(talk.folder)
        self.replays = Replays(talk.folder)
        self.replays.load()
        if not self.transcript.entries:
            for speaker, text in talk.messages:
                kind = "said" if speaker == "person" else "answer"
                self.transcript.add({"kind": kind, "label": speaker.capitalize(), "text": text, "details": []})
        self._show_world()

    def _show_world(self) -> None:
        """Everything as the conversation has it now: after opening it, in another scene, or at an earlier point."""
        talk = self.talk
        assert talk is not None
        state = talk.state
        opened = talk.agent.opened
        if state.world:
            talk.agent.context.world.at(state.world)
        self.view.open(opened.placed, opened.world.data.qpos.copy())
        self.live.attach(opened.world)
        self.board.clear()
        self._restore(talk)
        # What the camera shows now, for people only: the robot itself has not looked yet. Its draws are its own.
        self.pictures.look(opened.world.capture(np.random.default_rng(opened.seed)), None)
        self.status = status_of(talk, busy=self.status.busy, speed=self.live.speed)
        self._tell(self.hello())

    def _restore(self, talk: Conversation) -> None:
        """The panels of a session that was left: what it remembers, and what waits for a word."""
        self.board.restore(talk.state, self.transcript.lamps(world_mark(talk.state)))
        self.board.timeline.open(talk.folder, talk.state, talk.agent.opened.motions)
        self.board.remembered(talk.memory)
        if talk.pending is not None:
            self.board.pending(talk.pending)
            self._propose(talk.pending)
        elif talk.state.plan is not None:
            self.view.candidates(candidates_of(talk.state.plan))
            self.view.rest()

    def _propose(self, asked: Any) -> None:
        """Draws the motion that waits: the grasp with its rivals, or the place."""
        if asked.motion == "place":
            self.view.place(asked.point)
        else:
            self.view.candidates(candidates_of(asked.plan))

    def hello(self) -> dict[str, Any]:
        """Everything a page needs that opens now."""
        return {
            "type": "hello",
            "status": self.status.__dict__,
            "board": self.board.parts,
            "transcript": self.transcript.entries,
            "replays": self.replays.cards(self.status.place),
        }

    # Orders: called in the event loop, must return at once -------------------------------------------------------

    def stop(self) -> None:
        """Stops the robot at once; it stays stopped until `release`."""
        if self.talk is not None:
            self._stop_at = time.monotonic()
            self._stop_told = self.status.busy
            self.talk.stop()
        self._set(stopped=True, halted_ms=None, halted_at=None)
        self._note("stopped", "Stopped", "Stopped. Nothing moves until the robot is released.")

    def release(self) -> None:
        """Lets the robot move again."""
        if self.talk is not None:
            self.talk.release()
        self._set(stopped=False)
        self._note("noted", "Released", "Released. The robot may move again when it is told to.")

    def say(self, text: str) -> None:
        """Words of the person: a turn of their own, or steering while one is running."""
        talk = self.talk
        if talk is None:
            return
        if talk.busy:
            self._note("said", "You (while it works)", text)
            talk.steer(text)
            return
        self.turn(text, lambda: talk.say(text))

    def turn(self, words: str, start: Callable[[], Iterator[Any]], *, goes_on: bool = False) -> None:
        """Runs a turn in the desk's thread."""
        self.order(lambda: self._turn(words, start, goes_on=goes_on))

    def order(self, work: Callable[[], None]) -> None:
        """Puts work in line; refuses it when too much waits already."""
        self._worker.order(work)

    def refuse(self, text: str) -> None:
        """Says why something was not done."""
        self._tell({"type": "notice", "text": text})

    def show_replay(self, run: int, share: float) -> None:
        """A moment of a recorded run, unless the robot is at work."""
        replay = self.replays.runs.get(run)
        if replay is None or self.status.busy:
            return
        if self.status.replay != run:
            self._set(replay=run)
        self.view.show(replay.at(share))

    def show_now(self) -> None:
        """Back from a replay to the robot as it is."""
        self._set(replay=None)
        self.live.touch()

    def set_speed(self, speed: float) -> None:
        """How fast simulated time runs."""
        self.live.speed = speed
        self._set(speed=speed)

    def set_asks(self, wanted: bool) -> None:
        """Ask before every motion, or do not."""
        if self.talk is not None:
            self.talk.asks = wanted
        self._set(asks=wanted)

    def change(self, **options: Any) -> None:
        """Opens another session or scene in the desk's thread."""
        assert self.options is not None
        self.order(lambda: self.open(replace(self.options, **options)))  # type: ignore[type-var]

    def move_to(self, scene: str, seed: int) -> None:
        """Another scene in the same conversation; in the desk's thread. A wrong one leaves everything as it is."""
        talk = self.talk
        assert talk is not None
        name = scene.rpartition("/")[2].removesuffix(".yaml")
        self._turn(f"Scene {name}, seed {seed}.", lambda: talk.change_scene(scene, seed), goes_on=False)

    def go_back(self, point: str) -> None:
        """To an earlier point of the conversation; what came after stays on its own branch. In the desk's thread."""
        talk = self.talk
        assert talk is not None
        talk.fork(point)
        self._note("noted", "Back", "From here on the conversation goes on from an earlier point.")
        self._show_world()

    def close(self) -> None:
        """Stops the robot and ends the thread."""
        if self.talk is not None:
            self.talk.stop()
        for part in (self._worker, self.live, self.pictures):
            part.close()
        if self.talk is not None:
            self.talk.close()

    def _over(self) -> None:
        self._set(busy=False)
        self._garbage.collect()

    # The desk's thread --------------------------------------------------------------------------------------------

    def _turn(self, words: str, start: Callable[[], Iterator[Any]], *, goes_on: bool) -> None:
        talk = self.talk
        assert talk is not None
        self._said = self._said if goes_on else words
        self._stop_told = False
        self._set(busy=True, replay=None, unfinished=None)
        if not goes_on:
            self.live.begin()
            self._note("said", "You", words)
        self.board.put("pending", None)
        self.view.place(None)
        last = None
        for step in start():
            last = step
            self._on_step(step)
        if talk.agent.opened.world is not self.live.world:
            # Words, too, can change the scene.
            self._show_world()
        self.live.touch()
        self.board.remembered(talk.memory)
        waits = last is not None and last.kind == "asked"
        if not waits and self.replays.add(self._said, talk.place, self.live.times, self.live.poses) is not None:
            self._tell({"type": "replays", "value": self.replays.cards(self.status.place)})
        self._set(busy=False, unfinished=talk.unfinished)

    def _on_step(self, step: Any) -> None:
        if step.kind == "said" or (step.kind == "stopped" and self._stop_told):
            return
        if step.kind == "saying":
            self._tell({"type": "saying", "text": step.text})
            return
        self.board.on_step(step)
        talk = self.talk
        assert talk is not None
        if step.kind == "look":
            self.pictures.look(talk.agent.views, step.percept)
        elif step.kind == "graphed":
            self.pictures.relate(step.graph, (self.board.parts["look"] or {}).get("target"))
        elif step.kind == "asked":
            self._propose(step)
        elif step.kind in ("planned", "action"):
            if step.plan is not None:
                self.view.candidates(candidates_of(step.plan))
        elif step.kind in ("observation", "finished", "refused"):
            self.view.rest()
        # The answer is said once: as the turn's last step, with the observer's verdict under it.
        if step.kind != "asked" and (entry := entry_of(step, stopped=self.status.stopped)) is not None:
            if step.kind == "finished":
                entry = {**entry, "lamps": self.board.parts["constraints"], "after": world_mark(talk.state)}
            self._enter(entry)

    # Telling ------------------------------------------------------------------------------------------------------

    def _enter(self, entry: dict[str, Any]) -> None:
        self.transcript.add(entry)
        self._tell({"type": "entry", "entry": entry})

    def _note(self, kind: str, label: str, text: str) -> None:
        self._enter({"kind": kind, "label": label, "text": text, "details": []})

    def _set(self, **changes: Any) -> None:
        """Changes the status and tells it, if anything is new."""
        new = replace(self.status, **changes)
        if new != self.status:
            self.status = new
            self._tell({"type": "status", "status": new.__dict__})

    def _show_live(self, qpos: Any) -> None:
        if self.status.replay is None:
            self.view.show(qpos)

    def _felt(self) -> None:
        """A phase is over; called in the thread of physics."""
        self.board.timeline.forces(self.live.forces.rows())

    def _halted(self) -> None:
        """Physics has halted on a stop; called in its thread."""
        passed = (time.monotonic() - self._stop_at) * 1000 if self._stop_at else None
        self._set(halted_ms=None if passed is None else round(passed, 1), halted_at=time.time())
