"""Commands that share the options of a run: declared once in `app.flags`, handed over as one `RunOptions`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from app import flags


def with_options(fields: Mapping[str, Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Gives a command the options of `fields` and `--config`; it gets them merged and checked as `options`.

    Args:
        fields: Field of `app.options.RunOptions` -> its option, as in `app.flags.CONVERSATION`.
    """

    def decorated(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command).parameters
        # `options` itself is not looked up: its type costs half a second, and `--help` does not need it.
        names = vars(inspect.getmodule(command))
        kept = [p.replace(annotation=eval(p.annotation, names)) for name, p in own.items() if name != "options"]
        shared = {**fields, "config": flags.Config}
        parameters = [
            *kept,
            *(
                inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=a)
                for n, a in shared.items()
            ),
        ]

        def called(*given: Any, config: Path | None = None, **named: Any) -> None:
            from app.options import known_configurations, resolve_options

            options = resolve_options({name: named.pop(name, None) for name in fields}, config, known_configurations())
            command(*given, options=options, **named)

        called.__doc__, called.__name__, called.__module__ = command.__doc__, command.__name__, command.__module__
        # typer reads signature and annotations at run time.
        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": None}
        return called

    return decorated
