"""What is remembered of a success."""

from __future__ import annotations

from agent import build_agent


def test_what_is_remembered_does_not_drift() -> None:
    """Picking the same cup beside the same vase three times starts each time as high and presses as much: a neighbour's
    constraint acts on what is remembered once, not once more with every repetition."""
    agent = build_agent("cup_near_vase", 10_003, perception="oracle")
    grasps = []
    for _ in range(3):
        agent.run("pick up the cup")
        grasps.append(agent.state.attempts[-1].plan.grasp)
        agent.run("put it back")
    assert max(g.standoff for g in grasps) - min(g.standoff for g in grasps) < 0.001
    assert max(g.force for g in grasps) - min(g.force for g in grasps) < 0.15 * grasps[0].force
