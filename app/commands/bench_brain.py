"""`ragvlm bench-brain`: speed and memory of a local vision-language model on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Optional

import typer


def bench_brain(
    model: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--model", metavar="FOLDER", help="A model with real weights (default: random weights of --shape)."
        ),
    ] = None,
    shape: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option(
            "--shape", metavar="NAME", help="tiny, qwen3-vl-2b, -4b or -8b (default: 8b on a GPU, tiny on a CPU)."
        ),
    ] = None,
    device: Annotated[str, typer.Option("--device", metavar="NAME", help="auto, cpu or cuda.")] = "auto",
    tokens: Annotated[int, typer.Option("--tokens", metavar="N", min=2, max=4096, help="Length of a reply.")] = 64,
    repetitions: Annotated[int, typer.Option("--repetitions", metavar="N", min=1, max=100)] = 3,
    json_file: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--json", metavar="FILE", help="Write the rows there; - is standard output."),
    ] = None,
) -> None:
    """Tokens a second, time to the first token and memory for FP16, BF16, INT8 and NF4 with both key-value caches."""
    from app.brain_speed import run_bench_brain

    run_bench_brain(model, shape, device, tokens, repetitions, json_file)
