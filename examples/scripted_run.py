"""A run from Python: build an agent, give it one sentence, read the result.

python examples/scripted_run.py
"""

from agent import build_agent


def main() -> None:
    """Picks up the cup and prints what was claimed and what was observed."""
    agent = build_agent(scene="cup_near_vase", seed=3)
    result = agent.run("pick up the cup next to the vase")
    print(result.answer)
    for goal in result.goals:
        for attempt in goal.attempts:
            print(f"level {attempt.level}: claimed {attempt.claimed}, observed {attempt.success}")
            if attempt.grasp is not None:
                for field, sources in attempt.provenance.items():
                    print(f"  {field} = {getattr(attempt.grasp, field)}: {', '.join(s.source for s in sources)}")
    print(f"{result.timings_s.total:.2f} s")


if __name__ == "__main__":
    main()
