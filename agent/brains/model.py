"""A brain that asks a language model: renders prompts, sends them through a chat, and reads typed values from replies.

It decides nothing itself and holds no state between calls. A reply that is not what was asked for is an
`UnusableReplyError`, no reply at all a `BrainFaultError`; what becomes of either is the gate's business.
"""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from pydantic import BaseModel

from agent.brain import (
    BrainFaultError,
    Deliberation,
    Exchange,
    Reflected,
    Situation,
    Spoken,
    UnusableReplyError,
)
from agent.brains import facts
from agent.brains.chat import Chat, Message, Prompt
from agent.brains.pictures import marked_pictures
from agent.brains.replies import (
    MAX_TOKENS,
    AnswerReply,
    PerceiveReply,
    ReflectReply,
    ReplyT,
    ThinkReply,
    UnderstandReply,
    parse,
    schema_of,
)
from agent.brains.said_goals import understanding_of
from agent.goal import Understanding
from kb.grasp import GraspField
from kb.seen import NamedObject, SaidRelation, Seen
from prompts import quoted, render

VERSION = "v1"
"""Folder of the prompts: a new wording is a new version, so that records say which one they were made with."""


class ModelBrain:
    """Understands, sees, thinks, reflects and answers through a language model."""

    def __init__(self, chat: Chat) -> None:
        """A brain on a chat."""
        self.chat = chat

    @property
    def name(self) -> str:
        """As in `--brain`."""
        return self.chat.name

    def understand(self, situation: Situation) -> Understanding:
        """The model says what is to be done in the person's own nouns; the grammar turns that into goals."""
        pending = situation.pending
        reply = self._ask(
            "understand",
            UnderstandReply,
            situation,
            instruction=situation.instruction,
            pending=pending.reference.words if pending is not None and pending.reference is not None else None,
            held=situation.held.category if situation.held is not None else None,
        )
        return understanding_of(reply)

    def perceive(self, situation: Situation) -> Seen:
        """The model names the marks of both pictures."""
        reply = self._ask(
            "perceive",
            PerceiveReply,
            situation,
            pictures=marked_pictures(situation, ("front", "top")) if self.chat.sees else (),
            objects=facts.objects(situation),
        )
        known = {facts.mark(obj.id): obj.id for obj in situation.percept.objects} if situation.percept else {}
        strange = sorted({str(item.mark) for item in reply.objects} - known.keys())
        if strange:
            raise UnusableReplyError(reply.model_dump_json(), f"there is no mark {', '.join(strange)}")
        objects = tuple(
            NamedObject(
                id=known[str(item.mark)],
                category=item.category,
                affordance=item.affordance,
                material=item.material,
                fragility=item.fragility / 10,
                region=item.region,
                state=item.state,
            )
            for item in reply.objects
        )
        relations = tuple(
            SaidRelation(source=known[str(r.source)], relation=r.relation, target=known[str(r.target)])
            for r in reply.relations
            if str(r.source) in known and str(r.target) in known
        )
        return Seen(objects=objects, relations=relations)

    def think(self, situation: Situation) -> Deliberation:
        """The model decides about the planned grasp; the picture comes with the first question about a look."""
        assert situation.plan is not None
        reply = self._ask(
            "think",
            ThinkReply,
            situation,
            pictures=marked_pictures(situation, ("front",)) if self.chat.sees and _first_about_look(situation) else (),
            goal=facts.goal(situation),
            objects=facts.objects(situation),
            relations=facts.relations(situation),
            constraints=facts.constraints(situation),
            experiences=facts.experiences(situation),
            attempts=facts.attempts(situation),
            candidates=facts.candidates(situation),
        )
        if reply.choice != "act":
            return Deliberation(
                text=reply.thought or reply.choice, choice=reply.choice, question=reply.question or None
            )
        names = facts.names(situation.plan)
        if reply.candidate >= len(names):
            raise UnusableReplyError(reply.model_dump_json(), f"there is no candidate {reply.candidate}")
        grasp = (situation.plan.grasp, *(g for g, _, _ in situation.plan.alternatives))[reply.candidate]
        changes: dict[GraspField, float] = {}
        # A number that only repeats the plan, as far as it was shown, is no change.
        if reply.force_n and abs(reply.force_n - grasp.force) > 0.5:
            changes["force"] = float(reply.force_n)
        if reply.opening_mm and reply.opening_mm != round(1000 * grasp.aperture):
            changes["aperture"] = reply.opening_mm / 1000
        if reply.speed_percent and reply.speed_percent != round(100 * grasp.speed):
            changes["speed"] = reply.speed_percent / 100
        candidate = names[reply.candidate] if reply.candidate else None
        return Deliberation(text=reply.thought, candidate=candidate, changes=changes)

    def reflect(self, situation: Situation, offered: Any) -> Reflected:
        """The model chooses among the corrections that are allowed."""
        del offered
        reply = self._ask(
            "reflect",
            ReflectReply,
            situation,
            goal=facts.goal(situation),
            sensed=facts.sensed(situation),
            attempts=facts.attempts(situation),
            experiences=facts.experiences(situation),
            corrections=facts.corrections(situation.allowed),
        )
        if reply.give_up:
            return Reflected(text=reply.thought or "I give up.", give_up=True)
        if situation.allowed and reply.choice >= len(situation.allowed):
            raise UnusableReplyError(reply.model_dump_json(), f"there is no correction {reply.choice}")
        chosen = situation.allowed[reply.choice] if situation.allowed else None
        return Reflected(text=reply.thought, correction=chosen)

    def answer(self, situation: Situation) -> Spoken:
        """The model tells the recorded facts in its own words."""
        reply = self._ask(
            "answer", AnswerReply, situation, instruction=situation.instruction, facts=situation.facts.split("\n")
        )
        return Spoken(text=" ".join(reply.text.split()))

    def _ask(
        self, role: str, kind: type[ReplyT], situation: Situation, pictures: tuple[bytes, ...] = (), **data: Any
    ) -> ReplyT:
        """One exchange.

        Raises:
            UnusableReplyError: the reply is not of the schema.
            BrainFaultError: there is no reply.
        """
        text = render(f"brain/{VERSION}/{role}", **{name: quoted(value) for name, value in data.items()})
        for refusal in situation.refusals:
            shown = {"reply": quoted(refusal.reply), "reason": quoted(refusal.reason)}
            text += "\n" + render(f"brain/{VERSION}/refused", **shown)
        system = Message("system", system_prompt(role, kind))
        prompt = Prompt(
            role=role,
            messages=(system, Message("user", text, pictures)),
            schema=schema_of(kind),
            max_tokens=MAX_TOKENS[kind],
            seconds=situation.seconds,
            hear=situation.hear,
        )
        record = {
            "role": role,
            "version": VERSION,
            "model": self.name,
            "messages": tuple(m.record() for m in prompt.messages),
        }
        try:
            got = self.chat.reply(prompt)
        except BrainFaultError as fault:
            situation.tell(Exchange.model_validate({**record, "reply": "", "fault": fault.what}))
            raise
        used = {"prompt_tokens": got.prompt_tokens, "completion_tokens": got.completion_tokens}
        situation.tell(Exchange.model_validate({**record, "reply": got.text, **used}))
        return parse(got.text, kind)


@cache
def system_prompt(role: str, kind: type[BaseModel]) -> str:
    """What stands before the facts: the same text for every question of a role, so that servers can cache it."""
    schema = json.dumps(schema_of(kind), separators=(",", ":"))
    return render(f"brain/{VERSION}/system", schema=schema, role=render(f"brain/{VERSION}/{role}_role"))


def _first_about_look(situation: Situation) -> bool:
    """Whether no question about this look was asked before: a picture is sent once a look."""
    if situation.refusals or situation.percept is None or situation.percept.perception == "vlm":
        return False
    return all(
        attempt.percept is None or attempt.percept.look != situation.percept.look for attempt in situation.attempts
    )
