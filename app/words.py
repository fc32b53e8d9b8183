"""Shows what a language model says while it says it: one line that grows, and ends where the next step begins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

LABEL = "Says"
"""In front of words that have not been judged yet; what becomes of them stands in the steps after them."""


class WordsPrinter:
    """Prints the growth of what is said."""

    def __init__(self, console: Console, width: int) -> None:
        """Args: where to; and the column at which texts begin."""
        self._console, self._width = console, width
        self._shown: str | None = None

    def show(self, saying: Any) -> None:
        """Prints what is new of an `agent.events.Saying`; words that do not go on from those before begin a line."""
        from rich.text import Text

        if not saying.text:
            return
        if self._shown is None or not saying.text.startswith(self._shown):
            self.end()
            self._shown = ""
            self._console.print(Text(f"{LABEL:<{self._width}}", style="dim"), end="")
        self._console.print(Text(saying.text[len(self._shown) :], style="dim italic"), end="")
        self._shown = saying.text

    def end(self) -> None:
        """Ends the line, if there is one."""
        if self._shown is not None:
            self._shown = None
            self._console.print()
