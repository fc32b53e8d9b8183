"""Loads a vision-language model from a folder: in 16 bit, INT8 or NF4, on a GPU or a CPU."""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal, get_args
from urllib.parse import parse_qsl

from kb.errors import BadInputError, EnvironmentFaultError

Weights = Literal["auto", "bf16", "fp16", "fp32", "int8", "nf4"]
Cache = Literal["bf16", "fp8"]
Prefix = Literal["on", "off"]
NEEDED = ("torch", "transformers", "xgrammar")
MEND = "pip install 'agentic-rag-vlm[models]', or --brain rules"
KEPT_IN_16_BIT = ("visual", "model.visual", "model.vision_tower", "vision_tower", "vision_model", "lm_head")
"""Modules, by the beginning of their names, that are not quantised: pictures suffer most from it (ledger G34), and the head is tied to the embeddings."""


@dataclass(frozen=True)
class HfCfg:
    """How a model is loaded."""

    folder: str
    weights: Weights = "auto"
    """"auto": NF4 on a GPU, on a CPU as stored."""
    cache: Cache = "bf16"
    """Key-value cache: in the type of the computation, or FP8."""
    device: str = "auto"
    """"auto": a GPU if there is one."""
    prefix: Prefix = "on"
    """Whether the beginning that prompts share is kept between them; it takes memory for about a thousand tokens a role."""

    @staticmethod
    def read(text: str) -> HfCfg:
        """From `FOLDER` or `FOLDER?weights=nf4&cache=fp8&device=cpu`.

        Raises:
            BadInputError: an unknown key or value.
        """
        folder, _, tail = text.partition("?")
        choices = {
            "weights": get_args(Weights),
            "cache": get_args(Cache),
            "device": ("auto", "cpu", "cuda"),
            "prefix": get_args(Prefix),
        }
        given: dict[str, str] = {}
        for key, value in parse_qsl(tail, keep_blank_values=True):
            if key not in choices:
                raise BadInputError(f"unknown key {key!r}", where=f"--brain hf:{text}", choices=choices)
            if value not in choices[key]:
                raise BadInputError(f"{key}={value} is not a choice", where=f"--brain hf:{text}", choices=choices[key])
            given[key] = value
        return HfCfg(folder=folder, **given)  # pyright: ignore[reportArgumentType]


def load(config: HfCfg) -> tuple[Any, Any]:
    """The model and its processor.

    Raises:
        EnvironmentFaultError: bitsandbytes is missing, or there is no such model to be had here.
    """
    import torch  # pyright: ignore[reportMissingImports]
    from transformers import AutoModelForImageTextToText, AutoProcessor  # pyright: ignore[reportMissingImports]

    quiet()
    device = config.device if config.device != "auto" else ("cuda" if torch.cuda.is_available() else "cpu")
    weights = config.weights if config.weights != "auto" else ("nf4" if device == "cuda" else "stored")
    if weights in ("int8", "nf4") and find_spec("bitsandbytes") is None:
        raise EnvironmentFaultError(f"weights={weights} needs bitsandbytes", mend=MEND)
    try:
        processor = AutoProcessor.from_pretrained(config.folder)
        model = AutoModelForImageTextToText.from_pretrained(
            config.folder, device_map=device, dtype=_dtype(weights), quantization_config=_quantization(weights)
        )
    except (OSError, ValueError) as error:
        local = Path(config.folder).is_dir()
        what = "holds no vision-language model" if local else "is no folder, and no model of that name can be fetched"
        said = " ".join(str(error).split())[:160]
        raise EnvironmentFaultError(
            f"{config.folder} {what} ({said})", mend="give the folder of a model with its processor: --brain hf:FOLDER"
        ) from error
    return model.eval(), processor


def quiet() -> None:
    """Progress bars and warnings of the libraries do not belong into what a person reads."""
    from transformers.utils import logging as told  # pyright: ignore[reportMissingImports]

    told.disable_progress_bar()
    for name in ("transformers", "bitsandbytes", "torchao"):
        logging.getLogger(name).setLevel(logging.ERROR)
    warnings.filterwarnings("ignore", module=r"bitsandbytes|transformers")


def _dtype(weights: str) -> Any:
    """Type of what is not quantised."""
    import torch  # pyright: ignore[reportMissingImports]

    return {"fp16": torch.float16, "int8": torch.float16, "fp32": torch.float32, "stored": "auto"}.get(
        weights, torch.bfloat16
    )


def _quantization(weights: str) -> Any:
    """BitsAndBytes' configuration, or None."""
    import torch  # pyright: ignore[reportMissingImports]
    from transformers import BitsAndBytesConfig  # pyright: ignore[reportMissingImports]

    if weights == "nf4":
        return BitsAndBytesConfig(
            load_in_4bit=True,
            bnb_4bit_quant_type="nf4",
            bnb_4bit_compute_dtype=torch.bfloat16,
            llm_int8_skip_modules=[*KEPT_IN_16_BIT],
        )
    if weights == "int8":
        return BitsAndBytesConfig(load_in_8bit=True, llm_int8_skip_modules=[*KEPT_IN_16_BIT])
    return None
