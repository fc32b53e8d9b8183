"""How long the visual embedders take: processor time a picture, alone and in batches.

    python -m bench.embedder_speed --embedders shape_colour,efficientnet,clip:weights.safetensors

Pictures are the stored reference views of the knowledge base.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from kb.embedder import Embedder
from kb.errors import RagVlmError
from kb.open_embedder import CORE, embed_views, open_embedder
from kb.reference_views import ReferenceView, load_views, views_path
from kb.store import ExperienceStore


def measure(embedder: Embedder, views: Sequence[ReferenceView]) -> tuple[float, float]:
    """Milliseconds of processor time a picture, one by one and all at once."""
    first = views[0]
    embedder.embed(first.rgb, first.mask, first.depth)  # the first call pays for what is made only once
    began = time.process_time()
    for view in views:
        embedder.embed(view.rgb, view.mask, view.depth)
    alone = time.process_time() - began
    began = time.process_time()
    embed_views(embedder, views)
    together = time.process_time() - began
    return 1000.0 * alone / len(views), 1000.0 * together / len(views)


def say(line: str) -> None:
    """One line on standard output, at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of `python -m bench.embedder_speed`."""
    parser = argparse.ArgumentParser(prog="python -m bench.embedder_speed")
    parser.add_argument("--embedders", default=CORE)
    parser.add_argument("--pictures", type=int, default=16)
    given = parser.parse_args(arguments)
    path = ExperienceStore.open().path
    assert path is not None  # the shipped one is a file
    views = list(load_views(views_path(path)).values())[: given.pictures]
    say("| embedder | numbers | load s | ms a picture | ms a picture in batches |\n|---|---:|---:|---:|---:|")
    for word in given.embedders.split(","):
        began = time.process_time()
        embedder = open_embedder(word)
        load = time.process_time() - began
        alone, together = measure(embedder, views)
        say(f"| {embedder.name} | {embedder.dim} | {load:.1f} | {alone:.1f} | {together:.1f} |")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except RagVlmError as error:
        sys.exit(f"embedder_speed: error: {error}")
