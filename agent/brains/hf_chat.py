"""A chat with a vision-language model in this process, over transformers: any folder that `AutoModelForImageTextToText` loads.

`hf_model` loads it. What every prompt of a role begins with is computed once (`prefix_cache`). Decoding is greedy and
bound to the reply's JSON schema by xgrammar, so that every reply is valid; `stream` gives the same reply piece by piece.
Nothing is downloaded unless the name is no
folder and the machine may reach a hub.
"""

from __future__ import annotations

import io
import json
import threading
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

from agent.brain import BrainFaultError
from agent.brains.chat import Message, Prompt, Reply
from agent.brains.hf_model import MEND, NEEDED, Cache, HfCfg, Prefix, load
from agent.brains.pieces import Growing, pieces
from agent.brains.prefix_cache import PrefixCache, forget_pictures
from kb.errors import EnvironmentFaultError


@dataclass
class Pace:
    """How fast the last reply came."""

    prompt_tokens: int = 0
    prefilled: int = 0
    """Tokens of the prompt that were computed for this reply; the others stood in the kept beginning."""
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
        prefix: Prefix = "on",
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
            prefix: whether the beginning that prompts share is kept between them.
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
        supported = bool(model._supports_default_dynamic_cache())
        self._prefixes = PrefixCache(model, self._tokens, self._new_cache) if prefix == "on" and supported else None
        self.pace = Pace()
        """Of the last reply."""
        self._one_at_a_time = threading.Lock()

    def reply(self, prompt: Prompt) -> Reply:
        """The model's reply, valid by its schema unless time or the person ends it.

        Raises:
            BrainFaultError: the time is over, the person has stopped, or the device has no memory left.
        """
        so_far: list[str] = []

        def heard(piece: str) -> None:
            so_far.append(piece)
            prompt.hear("".join(so_far))

        return self._made(prompt, heard, lambda: False)

    def stream(self, prompt: Prompt) -> Generator[str, None, Reply]:
        """The same reply piece by piece, while it is made; what the pieces join to is the text of the generator's value.

        Closing the generator ends the reply.

        Raises:
            BrainFaultError: as `reply`; the pieces until then are no reply.
        """
        return (yield from pieces(lambda tell, left: self._made(prompt, tell, left)))

    def _made(self, prompt: Prompt, tell: Callable[[str], None], left: Callable[[], bool]) -> Reply:
        """The reply; `tell` takes its pieces, `left` says that nobody wants further ones."""
        import torch  # pyright: ignore[reportMissingImports]

        end, growing = self._clock() + prompt.seconds, Growing(tell)
        with self._one_at_a_time:
            inputs = self._inputs(prompt)
            pace = self.pace = Pace(prompt_tokens=int(inputs["input_ids"].shape[1]), started=self._clock())

            def watch(tokens: Any) -> bool:
                growing.grown(self._text(tokens[pace.prompt_tokens :]))
                return left()

            try:
                with torch.inference_mode():
                    begun = self._begun(prompt, inputs["input_ids"], pace)
                    output = self._model.generate(**inputs, **begun, **self._settings(prompt, pace, end, watch))
            except torch.OutOfMemoryError as error:
                raise BrainFaultError("the device has no memory left for this prompt") from error
            pace.total_s = self._clock() - pace.started
        if self._stopped():
            raise BrainFaultError("stopped by the person")
        if self._clock() > end:
            raise BrainFaultError(f"{self.name} is too slow: no whole reply within {prompt.seconds:.0f} s")
        tokens = output[0][pace.prompt_tokens :]
        text = self._text(tokens)
        growing.grown(text, whole=True)
        return Reply(text, pace.prompt_tokens, len(tokens))

    def _text(self, tokens: Any) -> str:
        """Tokens as text. Nothing is tidied, so that the text of the first tokens stands at the beginning of the whole."""
        return self._processor.decode(tokens, skip_special_tokens=True, clean_up_tokenization_spaces=False)

    def _begun(self, prompt: Prompt, input_ids: Any, pace: Pace) -> dict[str, Any]:
        """The key-value cache to start from, with the beginning in it that prompts share."""
        forget_pictures(self._model)
        pace.prefilled = pace.prompt_tokens
        cache, first = None, prompt.messages[0]
        if self._prefixes is not None and first.role == "system" and len(prompt.messages) > 1:
            cache, held, computed = self._prefixes.start(first.text, input_ids)
            forget_pictures(self._model)
            pace.prefilled = pace.prompt_tokens - held + computed
        return {"past_key_values": cache if cache is not None else self._new_cache()}

    def _new_cache(self) -> Any:
        """An empty key-value cache of the wanted type."""
        from transformers import DynamicCache, QuantizedCache  # pyright: ignore[reportMissingImports]

        config = self._model.config.get_text_config(decoder=True)
        return QuantizedCache("fp8", config) if self.cache == "fp8" else DynamicCache(config=config)

    def _tokens(self, system: str, user: str) -> Any:
        """Token ids of a prompt of two texts."""
        return self._inputs(Prompt("", (Message("system", system), Message("user", user))))["input_ids"]

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

    def _settings(self, prompt: Prompt, pace: Pace, end: float, watch: Callable[[Any], bool]) -> dict[str, Any]:
        """What `generate` is told: greedy, bound to the schema, stoppable; `watch` sees all tokens and may end it."""
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
                over = watch(input_ids[0]) or now > end or chat._stopped()
                return torch.full((input_ids.shape[0],), over, dtype=torch.bool, device=input_ids.device)

        settings: dict[str, Any] = {
            "max_new_tokens": prompt.max_tokens,
            "do_sample": False,
            "stopping_criteria": StoppingCriteriaList([Watch()]),
        }
        if prompt.schema:
            settings["logits_processor"] = [LogitsProcessor(self._grammar(prompt.schema))]
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
    return HfChat(f"hf:{text}", model, processor, cache=config.cache, prefix=config.prefix, sees=sees, stopped=stopped)
