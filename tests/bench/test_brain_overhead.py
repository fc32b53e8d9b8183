"""What graph, gate and prompts cost around a language model."""

from __future__ import annotations

from bench.brain_overhead import measured


def test_a_step_takes_at_most_50_ms_without_the_model() -> None:
    """Processor time of a first-attempt success with two questions, tools left out: per step, and even per question."""
    measured("single_cup", 10_001)  # loads modules
    found = min((measured("single_cup", 10_001) for _ in range(2)), key=lambda run: run.seconds)
    assert found.questions == 2
    assert found.steps > 8
    assert found.per_step_ms <= 50.0
    assert found.per_question_ms <= 100.0
