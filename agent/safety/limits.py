"""How much a language model may cost an instruction before the rules take over: calls, tokens, seconds, refusals."""

from __future__ import annotations

from dataclasses import dataclass

from kb.run_result import ModelUse


@dataclass(frozen=True)
class BrainLimits:
    """The budget of one instruction."""

    refusals: int = 3
    """Times that a refused reply returns to the model; the next refusal hands the question to the rules."""
    calls: int = 60
    """Questions: twelve objects with a first thought each, a few retries and the answer."""
    tokens: int = 300_000
    """Prompt and completion tokens."""
    seconds: float = 900.0
    """Time that the brain may take in total [s]."""
    reply_seconds: float = 120.0
    """Time for one reply, retries included [s]."""

    def spent(self, use: ModelUse, seconds: float) -> str | None:
        """Which part of the budget is used up, or None.

        Args:
            use: What the model has done for this instruction.
            seconds: Time that the brain has taken for it [s].
        """
        if use.calls + use.faults >= self.calls:
            return f"its budget of {self.calls} questions is used up"
        if use.prompt_tokens + use.completion_tokens >= self.tokens:
            return f"its budget of {self.tokens} tokens is used up"
        if seconds >= self.seconds:
            return f"its budget of {self.seconds:g} s is used up"
        return None
