"""Collects the source of every number of a grasp while it is being put together."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from kb.grasp import GraspField, Provenance
from kb.vocabulary import ProvenanceSource

FIELDS: tuple[GraspField, ...] = ("position", "approach", "yaw", "aperture", "force", "type", "standoff", "speed")


@dataclass
class Ledger:
    """Sources per field, in the order in which they acted."""

    entries: dict[GraspField, list[Provenance]] = field(default_factory=dict[GraspField, list[Provenance]])

    def add(self, name: GraspField, source: ProvenanceSource, id_: str, value: Any) -> None:
        """Records that `source` (in particular `id_`) gave or changed the field by `value`."""
        if isinstance(value, float):
            value = round(value, 5)
        if isinstance(value, tuple):
            value = [round(float(item), 5) for item in value]  # pyright: ignore
        self.entries.setdefault(name, []).append(Provenance(source=source, id=id_, value=value))

    def extend(self, name: GraspField, steps: tuple[Provenance, ...]) -> None:
        """Records several steps at once."""
        self.entries.setdefault(name, []).extend(steps)

    def done(self) -> dict[GraspField, tuple[Provenance, ...]]:
        """Sources per field, every field present."""
        return {name: tuple(self.entries.get(name, ())) for name in FIELDS}
