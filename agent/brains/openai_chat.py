"""A chat with an OpenAI-compatible server: OpenAI itself, vLLM, llama.cpp, Ollama, and whatever speaks like them.

Replies are streamed, so that a cut or crawling one is noticed. A fault that may pass is tried again with back-off; one
that stays says its mend. The key comes from OPENAI_API_KEY and never leaves this file but in the request's header.
"""

from __future__ import annotations

import base64
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from pydantic import SecretStr

from agent.brain import BrainFaultError
from agent.brains.back_off import back_off, retry_after
from agent.brains.chat import Message, Prompt, Reply
from kb.errors import EnvironmentFaultError

RETRIES = 4
"""Further trials after a fault that may pass."""
CONNECT_SECONDS, READ_SECONDS = 10.0, 60.0
"""Longest wait for a connection, and between two pieces of a reply [s]."""
SLICE = 0.2
"""Waits are cut into slices of this length, so that a stop ends them [s]."""


class Passing(Exception):
    """A fault that may pass."""

    def __init__(self, what: str, *, asked: float | None = None, mend: str | None = None) -> None:
        self.what, self.asked, self.mend = what, asked, mend
        super().__init__(what)


class OpenAIChat:
    """One model on one server."""

    def __init__(
        self,
        model: str,
        base_url: str | None = None,
        *,
        rng: np.random.Generator,
        sees: bool = True,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
        stopped: Callable[[], bool] = lambda: False,
        read_seconds: float = READ_SECONDS,
    ) -> None:
        """Prepares the client; nothing is sent yet.

        Args:
            model: name that the server knows the model by.
            base_url: address up to and including the version ("http://127.0.0.1:8000/v1"); None is OpenAI's own.
            rng: draws the jitter of waits.
            sees: whether pictures are sent.
            sleep: waits [s].
            clock: seconds, for time limits.
            stopped: whether a person wants everything to end.
            read_seconds: longest wait between two pieces of a reply [s].

        Raises:
            EnvironmentFaultError: langchain-openai is not installed, or OpenAI itself is asked for without a key.
        """
        key = os.environ.get("OPENAI_API_KEY", "")
        if not key and base_url is None:
            raise EnvironmentFaultError(
                f"--brain openai:{model} without --base-url asks OpenAI, and OPENAI_API_KEY is not set",
                mend="set OPENAI_API_KEY, or give the address of your own server with --base-url",
            )
        try:
            from langchain_openai import ChatOpenAI
        except ImportError as error:
            raise EnvironmentFaultError(
                "langchain-openai is not installed", mend="pip install 'agentic-rag-vlm[openai]'"
            ) from error
        self.model, self.base_url, self.sees = model, base_url, sees
        self._key = key
        self._rng, self._sleep, self._clock, self._stopped, self._read = rng, sleep, clock, stopped, read_seconds
        self._with_schema = self._with_usage = True
        secret = SecretStr(key or "none")
        self._client: Any = ChatOpenAI(
            model=model, base_url=base_url, api_key=secret, max_retries=0, temperature=0.0, stream_usage=False
        )

    @property
    def name(self) -> str:
        """As in `--brain`."""
        return f"openai:{self.model}"

    @property
    def where(self) -> str:
        """The server, for messages."""
        return self.base_url or "OpenAI"

    def reply(self, prompt: Prompt) -> Reply:
        """The model's reply, after as many trials as it takes within the time that is left.

        Raises:
            BrainFaultError: there is none.
        """
        end = self._clock() + prompt.seconds
        trial = 0
        while True:
            try:
                return self._once(prompt, end)
            except Passing as fault:
                wait = back_off(trial, self._rng, fault.asked)
                if trial >= RETRIES or self._stopped() or self._clock() + wait >= end:
                    tried = f" ({trial + 1} trials)" if trial else ""
                    raise BrainFaultError(f"{fault.what}{tried}", mend=fault.mend) from None
                self._wait(wait)
                trial += 1

    def _wait(self, seconds: float) -> None:
        while seconds > 0 and not self._stopped():
            self._sleep(min(SLICE, seconds))
            seconds -= SLICE

    def _once(self, prompt: Prompt, end: float) -> Reply:
        """One request; what the server does not know is left out and asked again at once.

        Raises:
            Passing: a fault that may pass.
            BrainFaultError: one that stays.
        """
        import openai

        while True:
            try:
                return self._streamed(prompt, end)
            except openai.APIStatusError as error:
                if not self._adapted(error):
                    raise self._judged(error) from None
            except openai.APITimeoutError:
                raise Passing(f"{self.where} did not reply in time") from None
            except openai.APIConnectionError as error:
                if not _unconnected(error):
                    raise Passing(f"the reply of {self.where} was cut off") from None
                raise Passing(
                    f"cannot reach the server at {self.where}",
                    mend="start it, or correct the address given by --base-url",
                ) from None
            except (openai.APIError, ValueError, KeyError, TypeError):
                # The last three are what the client raises for a body that is no stream of replies.
                raise Passing(f"the reply of {self.where} was cut off") from None

    def _streamed(self, prompt: Prompt, end: float) -> Reply:
        from openai import Timeout

        left = max(0.1, end - self._clock())
        extra: dict[str, Any] = {}
        if self._with_schema:
            form = {"name": prompt.role, "schema": prompt.schema, "strict": True}
            extra["response_format"] = {"type": "json_schema", "json_schema": form}
        parts: list[str] = []
        used, finish = (0, 0), None
        timeout = Timeout(min(self._read, left), connect=min(CONNECT_SECONDS, left))
        stream = self._client.stream(
            [self._message(message) for message in prompt.messages],
            max_tokens=prompt.max_tokens,
            extra_body=extra,
            timeout=timeout,
            stream_usage=self._with_usage,
        )
        for chunk in stream:
            parts.append(str(chunk.text))
            prompt.hear(self._keyless("".join(parts), growing=True))
            finish = chunk.response_metadata.get("finish_reason") or finish
            if chunk.usage_metadata:
                used = (chunk.usage_metadata["input_tokens"], chunk.usage_metadata["output_tokens"])
            if self._clock() > end:
                raise BrainFaultError(f"{self.where} is too slow: no whole reply within {prompt.seconds:.0f} s")
            if self._stopped():
                raise BrainFaultError("stopped by the person")
        if finish is None:
            raise Passing(f"the reply of {self.where} was cut off")
        return Reply(self._keyless("".join(parts)), *used)

    def _keyless(self, text: str, *, growing: bool = False) -> str:
        """A server's words without the key, which it may repeat; while they grow, its first letters are held back, too."""
        if not self._key:
            return text
        safe = text.replace(self._key, "[key]")
        ends = (n for n in range(min(len(self._key), len(safe)), 0, -1) if growing and safe.endswith(self._key[:n]))
        return safe[: len(safe) - next(ends, 0)]

    def _message(self, message: Message) -> dict[str, Any]:
        if not message.pictures or not self.sees:
            return {"role": message.role, "content": message.text}
        content: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
        for picture in message.pictures:
            url = "data:image/png;base64," + base64.b64encode(picture).decode()
            content.append({"type": "image_url", "image_url": {"url": url}})
        return {"role": message.role, "content": content}

    def _adapted(self, error: Any) -> bool:
        """Whether something was left out that this server does not know, so that asking again makes sense."""
        if error.status_code not in (400, 415, 422, 500, 501):
            return False
        text = str(error).lower()
        if self.sees and ("image" in text or "multimodal" in text or "vision" in text):
            self.sees = False
            return True
        if self._with_usage and "stream_options" in text:
            self._with_usage = False
            return True
        if self._with_schema and any(word in text for word in ("response_format", "schema", "grammar")):
            self._with_schema = False
            return True
        return False

    def _judged(self, error: Any) -> Exception:
        """What a status code means."""
        status = error.status_code
        if status in (401, 403):
            return BrainFaultError(
                f"the server at {self.where} does not accept the key",
                mend="set OPENAI_API_KEY to a key that it accepts",
            )
        if status == 404:
            known = self._models()
            return BrainFaultError(
                f"the server at {self.where} has no model {self.model!r}",
                mend=f"choose one of: {', '.join(known)}" if known else "check the model's name and --base-url",
            )
        if status in (408, 409, 429) or status >= 500:
            word = "is overloaded" if status == 429 else "failed"
            asked = retry_after(error.response.headers.get("retry-after"))
            return Passing(f"the server at {self.where} {word} (status {status})", asked=asked)
        return BrainFaultError(f"the server at {self.where} refused the request (status {status}): {self._said(error)}")

    def _said(self, error: Any) -> str:
        """The server's own words, short and without the key."""
        return self._keyless(" ".join(str(error).split()))[:200]

    def _models(self) -> list[str]:
        """Models that the server offers, where it says so."""
        try:
            listed = self._client.root_client.models.list(timeout=CONNECT_SECONDS)
            return sorted(str(item.id) for item in listed.data)[:8]
        except Exception:  # any failure here only shortens a hint
            return []


def _unconnected(error: BaseException) -> bool:
    """Whether no connection was made at all, which lies at the root of the client's errors."""
    cause: BaseException | None = error
    while cause is not None:
        if type(cause).__name__ in ("ConnectError", "ConnectTimeout"):  # of httpx or httpx2, by the client's version
            return True
        cause = cause.__cause__
    return False
