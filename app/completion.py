"""What the shell offers for the values of options. Each imports what it needs when it is asked."""

from __future__ import annotations


def scenes(incomplete: str) -> list[str]:
    """Built-in scenes."""
    from sim.scene_file import builtin_scenes

    return [name for name in builtin_scenes() if name.startswith(incomplete)]


def configurations(incomplete: str) -> list[str]:
    """Configurations by name."""
    from app.options import known_configurations

    return [name for name in known_configurations() if name.startswith(incomplete)]


def perceptions(incomplete: str) -> list[str]:
    """Ways of perceiving."""
    from app.options import PERCEPTIONS

    return [name for name in PERCEPTIONS if name.startswith(incomplete)]


def evaluators(incomplete: str) -> list[str]:
    """Evaluators."""
    from app.options import EVALUATORS

    return [name for name in EVALUATORS if name.startswith(incomplete)]
