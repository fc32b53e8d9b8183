"""A chat with a vision-language model in this process, over transformers: any folder that `AutoModelForImageTextToText` loads.

Weights are stored in 16 bit, INT8 or NF4 (BitsAndBytes; the vision tower stays in 16 bit), the key-value cache in 16 bit
or FP8. Decoding is greedy and bound to the reply's JSON schema by xgrammar, so that every reply is valid. Nothing is
downloaded unless the name is no folder and the machine may reach a hub.
"""

from __future__ import annotations

import io
import json
import logging
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal, get_args
from urllib.parse import parse_qsl

from agent.brain import BrainFaultError
from agent.brains.chat import Prompt, Reply
from kb.errors import BadInputError, EnvironmentFaultError

Weights = Literal["auto", "bf16", "fp16", "fp32", "int8", "nf4"]
Cache = Literal["bf16", "fp8"]
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

    @staticmethod
    def read(text: str) -> HfCfg:
        """From `FOLDER` or `FOLDER?weights=nf4&cache=fp8&device=cpu`.

        Raises:
            BadInputError: an unknown key or value.
        """
        folder, _, tail = text.partition("?")
        choices = {"weights": get_args(Weights), "cache": get_args(Cache), "device": ("auto", "cpu", "cuda")}
        given: dict[str, str] = {}
        for key, value in parse_qsl(tail, keep_blank_values=True):
            if key not in choices:
                raise BadInputError(f"unknown key {key!r}", where=f"--brain hf:{text}", choices=choices)
            if value not in choices[key]:
                raise BadInputError(f"{key}={value} is not a choice", where=f"--brain hf:{text}", choices=choices[key])
            given[key] = value
        return HfCfg(folder=folder, **given)  # pyright: ignore[reportArgumentType]


@dataclass
class Pace:
    """How fast the last reply came."""

    prompt_tokens: int = 0
    tokens: int = 0
    first_token_s: float = 0.0
    """From the question to the first token [s]."""
    total_s: float = 0.0
    started: float = field(default=0.0, repr=False)

    @property
    def tokens_per_s(self) -> float:
        """Tokens after the first one, a second."""
        spent = self.total_s - self.first_token_s
        return (self.tokens - 1) / spent if self.tokens > 1 and spent > 0 else 0.0


class HfChat:
    """A loaded model and its processor."""

    def __init__(
        self,
        name: str,
        model: Any,
        processor: Any,
        *,
        cache: Cache = "bf16",
        sees: bool = True,
        stopped: Callable[[], bool] = lambda: False,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Wraps a model; `open_hf_chat` loads one from a folder.

        Args:
            name: as in `--brain`.
            model: what `AutoModelForImageTextToText` gives.
            processor: its processor with a chat template.
            cache: type of the key-value cache.
            sees: whether pictures are sent.
            stopped: whether a person wants everything to end.
            clock: seconds.
        """
        import xgrammar  # pyright: ignore[reportMissingImports]

        self.name, self.sees, self.cache = name, sees and getattr(processor, "image_processor", None) is not None, cache
        self._model, self._processor, self._stopped, self._clock = model, processor, stopped, clock
        tokenizer = getattr(processor, "tokenizer", processor)
        size = int(model.get_input_embeddings().weight.shape[0])
        info = xgrammar.TokenizerInfo.from_huggingface(tokenizer, vocab_size=size)
        # Its own cache fails on long repetitions in patterns (xgrammar 0.2.8); compiled grammars are kept here instead.
        self._compiler = xgrammar.GrammarCompiler(info, cache_enabled=False)
        self._grammars: dict[str, Any] = {}
        self.pace = Pace()
        """Of the last reply."""

    def reply(self, prompt: Prompt) -> Reply:
        """The model's reply, valid by its schema unless time or the person ends it.

        Raises:
            BrainFaultError: the time is over, the person has stopped, or the device has no memory left.
        """
        import torch  # pyright: ignore[reportMissingImports]

        end = self._clock() + prompt.seconds
        inputs = self._inputs(prompt)
        pace = self.pace = Pace(prompt_tokens=int(inputs["input_ids"].shape[1]), started=self._clock())
        try:
            with torch.inference_mode():
                output = self._model.generate(**inputs, **self._settings(prompt, pace, end))
        except torch.OutOfMemoryError as error:
            raise BrainFaultError("the device has no memory left for this prompt") from error
        pace.total_s = self._clock() - pace.started
        if self._stopped():
            raise BrainFaultError("stopped by the person")
        if self._clock() > end:
            raise BrainFaultError(f"{self.name} is too slow: no whole reply within {prompt.seconds:.0f} s")
        tokens = output[0][pace.prompt_tokens :]
        return Reply(self._processor.decode(tokens, skip_special_tokens=True), pace.prompt_tokens, len(tokens))

    def _inputs(self, prompt: Prompt) -> Any:
        """Tokens and pixels of a prompt, on the model's device; all views of a look go in as one batch."""
        messages = [{"role": m.role, "content": self._content(m.text, m.pictures)} for m in prompt.messages]
        inputs = self._processor.apply_chat_template(
            messages, add_generation_prompt=True, tokenize=True, return_dict=True, return_tensors="pt"
        )
        return inputs.to(self._model.device)

    def _content(self, text: str, pictures: tuple[bytes, ...]) -> list[dict[str, Any]]:
        from PIL import Image

        shown = pictures if self.sees else ()
        views = [{"type": "image", "image": Image.open(io.BytesIO(picture)).convert("RGB")} for picture in shown]
        return [*views, {"type": "text", "text": text}]

    def _settings(self, prompt: Prompt, pace: Pace, end: float) -> dict[str, Any]:
        """What `generate` is told: greedy, bound to the schema, stoppable."""
        from transformers import StoppingCriteria, StoppingCriteriaList  # pyright: ignore[reportMissingImports]
        from xgrammar.contrib.hf import LogitsProcessor  # pyright: ignore[reportMissingImports]

        chat = self

        class Watch(StoppingCriteria):
            """Counts tokens, takes the time of the first one, and ends when the time is over or a person stops."""

            def __call__(self, input_ids: Any, scores: Any, **kwargs: Any) -> Any:
                import torch  # pyright: ignore[reportMissingImports]

                pace.tokens += 1
                now = chat._clock()
                if pace.tokens == 1:
                    pace.first_token_s = now - pace.started
                over = now > end or chat._stopped()
                return torch.full((input_ids.shape[0],), over, dtype=torch.bool, device=input_ids.device)

        settings: dict[str, Any] = {
            "max_new_tokens": prompt.max_tokens,
            "do_sample": False,
            "stopping_criteria": StoppingCriteriaList([Watch()]),
        }
        if prompt.schema:
            settings["logits_processor"] = [LogitsProcessor(self._grammar(prompt.schema))]
        if self.cache == "fp8":
            settings |= {"cache_implementation": "quantized", "cache_config": {"backend": "fp8"}}
        return settings

    def _grammar(self, schema: dict[str, Any]) -> Any:
        """The compiled grammar of a schema, made once."""
        text = json.dumps(schema)
        if text not in self._grammars:
            self._grammars[text] = self._compiler.compile_json_schema(text, any_whitespace=False)
        return self._grammars[text]

    def memory_bytes(self) -> int:
        """Memory of the weights, buffers included [byte]."""
        return int(self._model.get_memory_footprint())


def open_hf_chat(text: str, *, sees: bool = True, stopped: Callable[[], bool] = lambda: False) -> HfChat:
    """Loads the model of a folder.

    Args:
        text: `FOLDER`, or with keys as `HfCfg.read` knows them.
        sees: whether pictures are sent.
        stopped: whether a person wants everything to end.

    Raises:
        BadInputError: unknown keys.
        EnvironmentFaultError: a package is missing, or the folder holds no such model.
    """
    config = HfCfg.read(text)
    if any(find_spec(name) is None for name in NEEDED):
        raise EnvironmentFaultError(f"--brain hf:{text} needs {', '.join(NEEDED)}", mend=MEND)
    model, processor = load(config)
    return HfChat(f"hf:{text}", model, processor, cache=config.cache, sees=sees, stopped=stopped)


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
