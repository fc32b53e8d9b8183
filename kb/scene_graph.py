"""The scene graph G = (V, E) of Sec. III-B as a value; `tools.build_scene_graph` makes it with networkx."""

from __future__ import annotations

from kb.base import Finite, Noun, Vec3
from kb.vocabulary import ObjectState, Relation


class SceneNode(Noun):
    """v = (p, c, state, frag)."""

    id: str
    category: str
    position: Vec3
    state: ObjectState
    fragility: float
    size: Vec3
    yaw: Finite


class SceneEdge(Noun):
    """e_jk = (v_j, v_k, r_jk): `source relation target`."""

    source: str
    relation: Relation
    target: str
    gap: Finite | None = None
    """Surface-to-surface distance [m], where it matters."""


class SceneGraph(Noun):
    nodes: tuple[SceneNode, ...]
    edges: tuple[SceneEdge, ...]

    def edges_from(self, source: str, relation: Relation | None = None) -> tuple[SceneEdge, ...]:
        """Edges that leave `source`, optionally of one relation."""
        return tuple(e for e in self.edges if e.source == source and relation in (None, e.relation))
