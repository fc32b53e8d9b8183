"""What the graph, the gate and the prompts cost around a language model: processor time without the model's own.

    python -m bench.brain_overhead

A chat that replies at once stands in for the model: it takes the planned grasp and tells the recorded facts. What the tools
take (perception, retrieval, planning, motion) is counted by the run itself and left out; what remains, pictures and prompts
included, is divided by the steps that were told and by the questions that were put.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

from agent import build_agent
from agent.brains.chat import Prompt, Reply
from agent.brains.model import ModelBrain
from agent.brains.replies import AnswerReply, GoalReply, PerceiveReply, ReflectReply, ThinkReply, UnderstandReply
from agent.events import BaseStep

SCENES = ("single_cube", "single_cup", "single_bottle", "single_banana", "single_apple", "single_bowl")
SEEDS = (10_001, 10_002, 10_003)
TOOLS = ("perception", "retrieval", "planning", "execution")


class InstantChat:
    """A model that takes no time: acts on what is planned."""

    name, sees = "instant", True

    def __init__(self, thing: str) -> None:
        """Picks up `thing`."""
        goal = GoalReply(action="pick", thing=thing, place="", measure="none", force_n=0)
        think = ThinkReply(
            thought="It stands free.", choice="act", candidate=0, force_n=0, opening_mm=0, speed_percent=0, question=""
        )
        self._replies = {
            "understand": UnderstandReply(goals=[goal], refusal="", question=""),
            "perceive": PerceiveReply(objects=[], relations=[]),
            "think": think,
            "reflect": ReflectReply(thought="Once more.", choice=0, give_up=False),
            "answer": AnswerReply(text="That is what happened."),
        }
        self.asked = 0

    def reply(self, prompt: Prompt) -> Reply:
        """The fixed reply for the question."""
        self.asked += 1
        return Reply(self._replies[prompt.role].model_dump_json())


@dataclass(frozen=True)
class Overhead:
    """One run."""

    seconds: float
    """Processor time outside of the tools [s]."""
    steps: int
    questions: int

    @property
    def per_step_ms(self) -> float:
        """A step [ms]."""
        return 1000 * self.seconds / self.steps

    @property
    def per_question_ms(self) -> float:
        """A question [ms]."""
        return 1000 * self.seconds / self.questions


def overheads() -> Iterator[Overhead]:
    """One value for each scene and seed; the first run, which loads modules, is not among them."""
    measured(SCENES[0], SEEDS[0])
    for scene in SCENES:
        for seed in SEEDS:
            yield measured(scene, seed)


def measured(scene: str, seed: int) -> Overhead:
    """One run of a single-grasp scene with pixel-based perception and analytic motion."""
    thing = scene.removeprefix("single_")
    chat = InstantChat(f"the {thing}")
    agent = build_agent(scene, seed, brain=ModelBrain(chat), evaluator="analytic")
    agent.context.clock = time.process_time
    steps: list[BaseStep] = []
    result = agent.run(f"pick up the {thing}", steps.append)
    spent = result.timings_s.total - sum(getattr(result.timings_s, stage) for stage in TOOLS)
    return Overhead(seconds=spent, steps=len(steps), questions=chat.asked)


def main() -> int:
    """Prints medians and maxima."""
    found = list(overheads())
    for name, values in (
        ("a step", [run.per_step_ms for run in found]),
        ("a question", [run.per_question_ms for run in found]),
    ):
        sys.stdout.write(
            f"{name:10} {statistics.median(values):5.1f} ms, at most {max(values):.1f} ms ({len(values)} runs)\n"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
