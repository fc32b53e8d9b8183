"""Asks the brain, judges its word, tells it why a word is refused, and lets the rules decide in the end.

This is the only way from a node to a brain. The rules brain is asked once and taken at its word; any other brain gets
its refused replies back as observations, at most `BrainLimits.refusals` times a question. Everything that happens on
the way is told as steps.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from agent import events
from agent.brain import Brain, BrainFaultError, Exchange, Refusal, Situation, UnusableReplyError, unheard
from agent.context import AgentContext
from agent.safety.aloud import Aloud
from agent.safety.gate import RefusedError
from agent.state import State
from kb.errors import EnvironmentFaultError
from kb.run_result import ModelUse

T = TypeVar("T")


@dataclass(frozen=True)
class Consulted(Generic[T]):
    """What was decided, and the model's part in it."""

    value: T
    use: ModelUse = field(default_factory=ModelUse)
    by_rules: bool = True
    """The rules decided: they were asked, or the model's words did not count."""


class Consultation(Generic[T]):
    """One question to the brain."""

    def __init__(
        self, role: str, state: State, context: AgentContext, facts: Situation, ask: Callable[[Brain, Situation], T]
    ) -> None:
        """A question about `facts`; `ask` puts it to a brain and judges the reply.

        Args:
            role: What is asked for, as in `Exchange`.
            state: The state, for what the model has done so far and for whose goal this is.
            context: Brain, limits, clock and listener.
            facts: What the brain may use.
            ask: Asks the brain and judges its word; raises `RefusedError` or `UnusableReplyError` if it does not count.
        """
        self._role, self._state, self._context, self._facts, self._ask = role, state, context, facts, ask
        self._use = ModelUse()
        self._refusals: tuple[Refusal, ...] = ()
        self._aloud = Aloud(context, role, state.current)

    def decide(self) -> Consulted[T]:
        """The brain's word, if it counts in the end, else that of the rules.

        Raises:
            EnvironmentFaultError: the model cannot be had at all, nothing was done yet, and a mend is known.
        """
        if not self._context.guarded:
            return Consulted(self._ask(self._context.brain, self._facts))
        start, before = self._context.clock(), self._state.times.get("brain", 0.0)
        while True:
            seconds = before + self._context.clock() - start
            reason = self._spent(seconds)
            if reason is not None:
                return self._by_rules(reason)
            try:
                value = self._ask(self._context.brain, self._situation(seconds))
            except BrainFaultError as fault:
                return self._by_rules(self._fault(fault))
            except UnusableReplyError as error:
                self._refuse(error.reply, error.reason)
            except RefusedError as error:
                self._refuse(self._last, error.reason)
            else:
                return Consulted(value, self._use, by_rules=False)

    _last: str = ""
    """The reply in question, as it came."""

    def _situation(self, seconds: float) -> Situation:
        limits = self._context.limits
        left = max(1.0, min(limits.reply_seconds, limits.seconds - seconds))
        hear = self._aloud.hear if self._context.aloud else unheard
        return dataclasses.replace(self._facts, refusals=self._refusals, tell=self._heard, hear=hear, seconds=left)

    def _heard(self, exchange: Exchange) -> None:
        """Counts and tells an exchange."""
        self._aloud.end()
        self._last = exchange.reply
        if exchange.fault is None:
            used = ModelUse(calls=1, prompt_tokens=exchange.prompt_tokens, completion_tokens=exchange.completion_tokens)
            text = f"{exchange.role}: {exchange.model} replied with {exchange.completion_tokens} tokens."
        else:
            used = ModelUse(faults=1)
            text = f"{exchange.role}: no reply from {exchange.model}: {exchange.fault}."
        self._use = self._use.plus(used)
        self._context.emit(events.ModelCall(text=text, goal=self._state.current, exchange=exchange))

    def _spent(self, seconds: float) -> str | None:
        """Why the model is not asked (again), or None."""
        limits = self._context.limits
        if len(self._refusals) > limits.refusals:
            return f"{len(self._refusals)} replies were refused, the last because {self._refusals[-1].reason}"
        so_far = self._state.use.plus(self._use)
        if self._state.use.faults:
            return "the model did not reply before"
        return limits.spent(so_far, seconds)

    def _refuse(self, reply: str, reason: str) -> None:
        self._refusals = (*self._refusals, Refusal(reply=reply, reason=reason))
        self._use = self._use.plus(ModelUse(refusals=1))
        self._context.emit(
            events.Refused(
                text=f"Refused ({self._role}): {reason}.",
                goal=self._state.current,
                role=self._role,
                reason=reason,
                count=len(self._refusals),
            )
        )

    def _fault(self, fault: BrainFaultError) -> str:
        """The reason for falling back; a model that never was there ends the run instead."""
        if fault.mend is not None and self._state.use.plus(self._use).calls == 0 and not self._state.executed:
            raise EnvironmentFaultError(fault.what, mend=fault.mend) from fault
        return fault.what

    def _by_rules(self, reason: str) -> Consulted[T]:
        self._context.emit(
            events.Fallback(
                text=f"The rules decide ({self._role}): {reason}.",
                goal=self._state.current,
                role=self._role,
                reason=reason,
            )
        )
        use = self._use.plus(ModelUse(fallbacks=(f"{self._role}: {reason}",)))
        return Consulted(self._ask(self._context.rules, self._facts), use)
