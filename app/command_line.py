"""The `ragvlm` command line: registers the commands and turns every error into one line and an exit code.

Nothing heavy is imported here: `ragvlm --help` must answer within 0.6 s, so every command imports inside its function.
"""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from app.commands import bench, bench_brain, chat, doctor, kb, objects, run, scenes, serve, show, tools
from app.exit_codes import INTERRUPTED, USAGE, code_of_fault

_ClickException: type[Exception] = typer.BadParameter.__mro__[2]
"""The root of typer's own usage errors; its import path differs between typer's versions, its place does not."""

app = typer.Typer(
    name="ragvlm",
    help="Tell a Franka Panda what to grasp, watch it reason, and trust what it says about the outcome.",
    epilog="Exit codes: 0 achieved · 1 not achieved · 2 bad usage or input · 3 the environment cannot do it · "
    "130 interrupted.",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
app.command("run")(run.run)
app.command("chat")(chat.chat)
app.command("serve")(serve.serve)
app.command("bench")(bench.bench)
app.command("bench-brain")(bench_brain.bench_brain)
app.add_typer(kb.app, name="kb")
app.command("show")(show.show)
app.command("scenes")(scenes.scenes)
app.command("objects")(objects.objects)
app.command("tools")(tools.tools)
app.command("doctor")(doctor.doctor)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"ragvlm {version('agentic-rag-vlm')}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and leave.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an internal error.")] = False,
) -> None:
    if debug:
        os.environ["RAGVLM_DEBUG"] = "1"


def run_command_line(arguments: list[str] | None = None) -> int:
    """Runs one command and returns its exit code; never raises for what a user can type."""
    # mujoco refuses to be imported if MUJOCO_GL names a library that is missing. Only pictures for people want OpenGL,
    # and they fall back; so the wish is handed to them and the variable taken out of mujoco's sight.
    wish = os.environ.pop("MUJOCO_GL", None)
    if wish:
        os.environ["RAGVLM_OPENGL"] = wish
    given = sys.argv[1:] if arguments is None else arguments
    try:
        # Called without anything, it shows what there is.
        outcome = app(args=given or ["--help"], prog_name="ragvlm", standalone_mode=False)
        return outcome if isinstance(outcome, int) else 0
    except _ClickException as error:
        _complain(_usage_line(error))
        return USAGE
    except (KeyboardInterrupt, typer.Abort):
        _complain("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of a pipe (head, less) has left: nothing is wrong, and nothing more can be said.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        code, line = code_of_fault(error)
        _complain(line)
        return code


def _usage_line(error: Exception) -> str:
    """One line for a usage error: what is wrong, where, and the valid choices."""
    message = " ".join(str(error.format_message()).split())  # type: ignore[attr-defined]
    context = getattr(error, "ctx", None)
    if context is None:
        return message or "bad usage"
    where = context.command_path
    name = type(error).__name__
    if name == "NoSuchOption":
        names = sorted(
            option
            for parameter in context.command.params
            if not getattr(parameter, "hidden", False)
            for option in (*parameter.opts, *parameter.secondary_opts)
            if option.startswith("--")
        )
        message += f" (valid: {', '.join(names)})"
    elif hasattr(context.command, "list_commands") and ("ommand" in message):
        message += f" (valid: {', '.join(context.command.list_commands(context))})"
    if "unexpected extra argument" in message and context.info_name == "run":
        message += " Put the instruction in quotes."
    return f"{where}: {message}"


def _complain(line: str) -> None:
    sys.stdout.flush()
    print(f"ragvlm: error: {line}" if not line.startswith("interrupted") else f"ragvlm: {line}", file=sys.stderr)


def main() -> None:
    """Console script `ragvlm`."""
    sys.exit(run_command_line())
