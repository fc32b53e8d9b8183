"""Prints the events of a conversation, each once and inert: nothing that was typed or read can steer the terminal."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from agent.chat.heard import inert
from app.steps import WIDTH, StepPrinter
from app.verdict_block import print_verdict

if TYPE_CHECKING:
    from rich.console import Console

LABELS: dict[str, tuple[str, str]] = {
    "asked": ("Approve?", "bold yellow"),
    "heeded": ("Heard", "bold yellow"),
    "explained": ("Why", "bold"),
    "compared": ("Compare", "bold"),
    "whatif": ("What if", "bold"),
    "stopped": ("Stopped", "bold red"),
    "noted": ("Note", "yellow"),
    "refused": ("Error", "bold red"),
}
"""Kind of event -> what stands in front of it, and how."""
HOW_TO_ANSWER_A_PLACING = (
    "yes, no, where else (put it on the right), why, or /edit x=450 y=-100 (mm from the robot's base)"
)
HOW_TO_ANSWER = "yes, no, how else (by the handle, gentler, with 5 N), why, or /edit force=5"


class ChatPrinter:
    """Prints events as they come."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._steps = StepPrinter(console)
        self.words = ""
        """What a model is saying at the moment."""
        self.on_words: Callable[[], None] = lambda: None
        """Called when there are more of them."""

    def show(self, event: Any) -> None:
        """Prints one event of `agent.events` or `agent.chat.events`."""
        if event.kind == "saying":
            self._steps.show(event)
            self.words = event.text
            self.on_words()
            return
        self._end_words()
        if event.kind == "finished":
            if any(goal.attempts for goal in event.result.goals):
                print_verdict(self._console, event.result)
        elif event.kind in LABELS:
            self._labelled(event)
        elif event.kind == "understood" and not event.goals:
            return  # the answer or question that follows says it
        elif event.kind == "said":
            self.say(f"you> {event.text}", "dim")
        else:
            self._steps.show(event)

    def say(self, text: str, style: str = "") -> None:
        """Prints a line of the face itself."""
        from rich.text import Text

        self._end_words()
        self._console.print(Text(inert(text), style=style))

    def _end_words(self) -> None:
        self.words = ""
        self._steps.end_words()

    def _labelled(self, event: Any) -> None:
        from rich.text import Text

        label, style = LABELS[event.kind]
        first, *rest = inert(event.text).splitlines() or [""]
        if event.kind == "asked":
            place = event.motion == "place"
            rest = [*([event.thought] if place else []), HOW_TO_ANSWER_A_PLACING if place else HOW_TO_ANSWER]
        if event.kind == "whatif" and event.pictures is not None:
            rest = [*rest, f"both endings side by side: {event.pictures}"]
        line = Text(f"{label:<{WIDTH}}", style=style)
        line.append(first, style="default")
        self._console.print(line)
        for extra in rest:
            self._console.print(Text(" " * WIDTH + extra, style="dim" if event.kind == "asked" else ""))
