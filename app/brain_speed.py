"""Measures a local model and prints the table of `ragvlm bench-brain`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from app.console import make_console
from app.files import refuse_unwritable_file, write_atomically
from kb.errors import BadInputError

if TYPE_CHECKING:
    from bench.brain_speed import BrainSpeed

DEVICES = ("auto", "cpu", "cuda")


def run_bench_brain(
    model: Path | None, shape: str | None, device: str, tokens: int, repetitions: int, json_file: Path | None
) -> None:
    """Measures and prints.

    Args:
        model: Folder with real weights, or None for random ones.
        shape: Shape of the random model; None chooses by the device.
        device: "auto", "cpu" or "cuda".
        tokens: Length of a reply.
        repetitions: Replies per combination.
        json_file: Where the rows go as JSON; "-" is standard output.

    Raises:
        BadInputError: options that exclude each other or are no choices.
        EnvironmentFaultError: packages or the model are missing.
    """
    from bench.brain_speed import measure_brain, random_folder, require_packages

    if device not in DEVICES:
        raise BadInputError(f'"{device}" is not a choice', where="--device", choices=DEVICES)
    if model is not None and shape is not None:
        raise BadInputError("a model with real weights has its own shape", where="--shape")
    if model is not None and not model.is_dir():
        raise BadInputError(f"there is no folder {model}", where="--model")
    to_stdout = json_file is not None and str(json_file) == "-"
    if json_file is not None and not to_stdout:
        refuse_unwritable_file(json_file, where="--json")
    require_packages()
    import torch  # pyright: ignore[reportMissingImports]

    console = make_console(stderr=to_stdout)
    gpu = torch.cuda.is_available() and device != "cpu"
    made = None if model is not None else random_folder(shape or ("qwen3-vl-8b" if gpu else "tiny"))
    folder = str(model) if made is None else made.name
    what = str(model) if made is None else f"random weights of shape {shape or ('qwen3-vl-8b' if gpu else 'tiny')}"
    where = torch.cuda.get_device_name() if gpu else f"CPU, {torch.get_num_threads()} threads"
    console.print(f"{what} on {where}, replies of {tokens} tokens, {repetitions} each")
    rows: list[BrainSpeed] = []
    try:
        for row in measure_brain(folder, device=device, tokens=tokens, repetitions=repetitions):
            rows.append(row)
            console.print(line_of(row))
    finally:
        if made is not None:
            made.cleanup()
    console.print(verdict(rows) + ("; a tiny model says nothing about a real one" if "tiny" in what else ""))
    text = json.dumps({"model": what, "device": where, "rows": [row.row() for row in rows]}, indent=2) + "\n"
    if to_stdout:
        sys.stdout.write(text)
    elif json_file is not None:
        write_atomically(json_file, text)


def line_of(row: BrainSpeed) -> str:
    """One combination on one line."""
    head = f"{row.weights:<5} weights, {row.cache:<4} cache: "
    if row.fault is not None:
        return f"{head}cannot be measured here: {row.fault}"
    ratio = f"{row.ratio:.2f} of FP16" if row.ratio is not None else "no FP16 to compare with"
    return (
        f"{head}{row.tokens_per_s:7.1f} tokens/s ({ratio}), "
        f"first token {row.first_token_s * 1000:.0f} ms, {row.first_token_kept_s * 1000:.0f} ms with the beginning of the "
        f"prompt kept ({row.prefilled_tokens} of {row.prompt_tokens} tokens), "
        f"weights {row.weights_mb:.1f} MB, peak {row.peak_mb:.0f} MB"
    )


def verdict(rows: list[BrainSpeed]) -> str:
    """The ratio beside the paper's."""
    from bench.brain_speed import PAPER_RATIO

    found = next((row for row in rows if row.weights == "nf4" and row.cache == "bf16" and row.ratio is not None), None)
    if found is None or found.ratio is None:
        return f"NF4 against FP16 could not be measured here (paper: {PAPER_RATIO})"
    return f"NF4 against FP16: {found.ratio:.2f} (paper: {PAPER_RATIO})"
