"""What the terminal adds to an explanation: the forces that were felt and the observer's word, also after a restart."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from app.force_trace import ForceTrace, sparkline
from app.steps import WIDTH
from app.timeline import Row, Timeline

if TYPE_CHECKING:
    from agent.chat import Conversation
    from sim.recording import Recording
    from sim.world import World

COLUMNS = 60
"""Characters of a force curve."""


class LookingBack:
    """Keeps the timeline of a conversation in the terminal."""

    def __init__(self, conversation: Conversation) -> None:
        self._talk = conversation
        self._timeline = Timeline()
        self._felt: Felt | None = None

    def begin(self) -> None:
        """Before a turn: the sensors of the world as it is now are listened to, and what was kept is read."""
        agent = self._talk.agent
        world = agent.opened.world
        if self._felt is None or self._felt.world is not world:
            if self._felt is not None:
                self._felt.world.recorders.remove(self._felt)
            self._felt = Felt(world, self._timeline)
            self._timeline.open(self._talk.folder, self._talk.state, agent.opened.motions)
        self._felt.clear()

    def again(self) -> None:
        """The conversation has gone to another point: what was kept is read anew."""
        if self._felt is not None:
            self._timeline.open(self._talk.folder, self._talk.state, self._talk.agent.opened.motions)

    def on_step(self, step: Any) -> None:
        """Takes from a step what belongs on the timeline."""
        self._timeline.on_step(step)

    def lines_of(self, step: Any) -> list[str]:
        """For an explanation: what was felt and what the observer saw; nothing for other steps."""
        if step.kind != "explained":
            return []
        row = self._timeline.row_of(self._talk.state, step.attempt)
        return [] if row is None else [" " * WIDTH + line for line in lines_of(row)]


class Felt(ForceTrace):
    """Listens to the sensors of one world."""

    def __init__(self, world: World, timeline: Timeline) -> None:
        super().__init__()
        self.world = world
        self._timeline = timeline
        self.listen_to(world.index.sensors)
        world.recorders.append(self)

    def clear(self) -> None:
        """A turn begins: older samples are on the timeline already."""
        self._rows.clear()

    def on_recording(self, recording: Recording) -> None:
        """One phase is over."""
        super().on_recording(recording)
        self._timeline.forces(self.rows())


def lines_of(row: Row) -> list[str]:
    """Forces as blocks and the observer's word."""
    lines: list[str] = []
    if len(row.curve) > 1:
        span = row.curve[-1][0] - row.curve[0][0]
        lines.append(f"Forces felt over {span:.1f} s:")
        for place, name in ((1, "fingers"), (2, "wrist")):
            values = [point[place] for point in row.curve]
            lines.append(f"  {name:<8}{sparkline(values, COLUMNS)} peak {max(values):.1f} N")
    if row.observed is not None:
        ended = "no success before it was stopped" if row.state == "stopped" else "failure"
        word = "success" if row.observed else (row.observed_failure or ended).lower().replace("_", " ")
        v = row.verdict
        measured = "" if v is None else f": lifted {v.lifted} cm, held {v.held} s, slip {v.slip} mm, peak {v.peak} N"
        lines.append(f"The observer saw {word}{measured}.")
    return lines
