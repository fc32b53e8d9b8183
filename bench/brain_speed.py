"""How fast a local vision-language model speaks, and what it takes: tokens a second, time to the first one, memory.

For each kind of weights and key-value cache the model is loaded anew and answers the same prompt with a picture: with the
beginning that our prompts share computed anew, and with it kept from the last question. The ratio to FP16 stands beside the paper's 1.78 (its INT4 against FP16 on its own GPU). With random weights of a real shape
the speed is the same as with trained ones, so it can be measured before anything is downloaded.
"""

from __future__ import annotations

import gc
import io
import logging
import resource
import statistics
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from agent.brain import BrainFaultError
from agent.brains.chat import Message, Prompt
from agent.brains.hf_chat import HfChat, Pace
from agent.brains.hf_model import MEND, NEEDED, Cache, HfCfg, Weights, load
from agent.brains.model import system_prompt
from agent.brains.replies import ThinkReply
from kb.errors import EnvironmentFaultError

log = logging.getLogger(__name__)

PAPER_RATIO = 1.78
"""INT4 against FP16 in the paper (Sec. V; ledger A8): speed-up of its planner."""
WEIGHTS: tuple[Weights, ...] = ("fp16", "bf16", "int8", "nf4")
CACHES: tuple[Cache, ...] = ("bf16", "fp8")
PICTURE = (640, 480)
"""A camera's picture [px]."""


@dataclass(frozen=True)
class BrainSpeed:
    """One row: one kind of weights with one kind of cache."""

    weights: str
    cache: str
    tokens_per_s: float = 0.0
    """Median over the repetitions, after the first token."""
    first_token_s: float = 0.0
    """Median time to the first token, picture and whole prompt included [s]."""
    first_token_kept_s: float = 0.0
    """The same with the beginning of the prompt kept from the question before [s]."""
    prompt_tokens: int = 0
    prefilled_tokens: int = 0
    """Tokens of the prompt that are computed when its beginning is kept."""
    weights_mb: float = 0.0
    """Memory of the weights [MB]."""
    peak_mb: float = 0.0
    """Peak memory of the device, or of this process on a CPU [MB]."""
    ratio: float | None = None
    """Tokens a second against FP16 with the 16-bit cache."""
    fault: str | None = None
    """Why there are no numbers."""

    def row(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def measure_brain(
    folder: Path | str,
    *,
    device: str = "auto",
    tokens: int = 64,
    repetitions: int = 3,
    weights: tuple[Weights, ...] = WEIGHTS,
    caches: tuple[Cache, ...] = CACHES,
    progress: Callable[[str], None] = lambda _text: None,
) -> Iterator[BrainSpeed]:
    """Measures one combination after the other.

    Args:
        folder: the model.
        device: "auto", "cpu" or "cuda".
        tokens: length of each reply; nothing ends it earlier.
        repetitions: replies per combination, after one to warm up.
        weights: kinds of weights.
        caches: kinds of key-value cache.
        progress: told what is being done.

    Raises:
        EnvironmentFaultError: a package is missing, or there is no such model.
    """
    base: float | None = None
    for kind in weights:
        for cache in caches:
            progress(f"{kind} weights, {cache} cache")
            found = _measured(HfCfg(str(folder), kind, cache, device), tokens, repetitions)
            if kind == "fp16" and cache == "bf16" and found.fault is None:
                base = found.tokens_per_s
            ratio = found.tokens_per_s / base if base and found.fault is None else None
            yield BrainSpeed(**{**found.row(), "ratio": ratio})


def _measured(config: HfCfg, tokens: int, repetitions: int) -> BrainSpeed:
    """One combination; what this device cannot do is a row with its reason.

    PyTorch and the packages of quantised caches say so with errors of these three kinds, and the brain with its own. Any
    other error is a fault of this program and ends the measurement.
    """
    _forget()
    try:
        model, processor = load(config)
        _never_end(model)
        chat = HfChat(f"hf:{config.folder}", model, processor, cache=config.cache)
        kept = _paces(chat, tokens, repetitions)
        forgetful = HfChat(f"hf:{config.folder}", model, processor, cache=config.cache, prefix="off")
        anew = _paces(forgetful, 1, repetitions)
    except (BrainFaultError, RuntimeError, ImportError, ValueError) as error:
        log.info("%s weights, %s cache", config.weights, config.cache, exc_info=error)
        said = " ".join(str(error).split())[:160]
        return BrainSpeed(config.weights, config.cache, fault=f"{type(error).__name__}: {said}")
    return BrainSpeed(
        config.weights,
        config.cache,
        tokens_per_s=statistics.median(pace.tokens_per_s for pace in kept),
        first_token_s=statistics.median(pace.first_token_s for pace in anew),
        first_token_kept_s=statistics.median(pace.first_token_s for pace in kept),
        prompt_tokens=kept[-1].prompt_tokens,
        prefilled_tokens=kept[-1].prefilled,
        weights_mb=chat.memory_bytes() / 1e6,
        peak_mb=_peak_mb(),
    )


def _paces(chat: HfChat, tokens: int, repetitions: int) -> list[Pace]:
    """How fast the replies came, without the first one, which warms up and fills what is kept."""
    paces: list[Pace] = []
    for _ in range(repetitions + 1):
        chat.reply(_prompt(tokens))
        paces.append(chat.pace)
    return paces[1:]


def _never_end(model: Any) -> None:
    """Replies have the length asked for: random weights would end at random."""
    model.generation_config.eos_token_id = None


def _prompt(tokens: int) -> Prompt:
    """The system message of a thought, and the same words and picture every time."""
    from PIL import Image

    file = io.BytesIO()
    Image.radial_gradient("L").resize(PICTURE).convert("RGB").save(file, "PNG")
    text = "Say what stands on the table, how fragile each thing is, and how you would grasp it. " * 8
    system = Message("system", system_prompt("think", ThinkReply))
    return Prompt("bench", (system, Message("user", text, (file.getvalue(),))), {}, tokens, 3600.0)


def _forget() -> None:
    """Frees what the combination before has used."""
    import torch  # pyright: ignore[reportMissingImports]

    gc.collect()
    if torch.cuda.is_available():
        torch.cuda.empty_cache()
        torch.cuda.reset_peak_memory_stats()


def _peak_mb() -> float:
    """Peak memory since `_forget` on a GPU, of the whole process on a CPU [MB]."""
    import torch  # pyright: ignore[reportMissingImports]

    if torch.cuda.is_available():
        return float(torch.cuda.max_memory_allocated()) / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1e3


def require_packages() -> None:
    """Everything that measuring needs is there.

    Raises:
        EnvironmentFaultError: it is not.
    """
    from importlib.util import find_spec

    if any(find_spec(name) is None for name in NEEDED):
        raise EnvironmentFaultError(f"measuring a model needs {', '.join(NEEDED)}", mend=MEND)


def random_folder(shape: str) -> tempfile.TemporaryDirectory[str]:
    """A folder with a model of random weights of the shape; close it to delete it.

    Raises:
        BadInputError: there is no such shape.
    """
    from agent.brains.random_model import SHAPES, make_random_model
    from kb.errors import BadInputError

    if shape not in SHAPES:
        raise BadInputError(f'"{shape}" is not a choice', where="--shape", choices=SHAPES)
    folder = tempfile.TemporaryDirectory(prefix="ragvlm-model-")
    make_random_model(Path(folder.name), shape)  # pyright: ignore[reportArgumentType]
    return folder
