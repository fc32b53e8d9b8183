"""The user's meshes: read, repaired, cut into convex pieces (CoACD) and cached.

Cutting takes seconds, so its result is kept under the user's cache folder by the digest of the mesh and of the settings.
trimesh and coacd are imported only here and only when a mesh is met.
"""

from __future__ import annotations

import hashlib
import io
import logging
import os
import tempfile
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kb.errors import BadInputError

SUFFIXES = (".obj", ".stl", ".ply", ".glb")
VERSION = b"1"
"""Changes whenever repair or cutting changes, so that old cache entries are not used."""
SMALLEST_VOLUME = 1e-8
"""Smallest volume of an object [m^3]: 10 mm^3."""
CONVEX_SHARE = 0.97
"""A mesh that fills this share of its hull is taken as convex."""
CONCAVITY = 0.05
"""CoACD's threshold: the largest concavity left, relative to the object's size."""
MAX_PIECES, MAX_CORNERS = 24, 48
"""Convex pieces of an object, and vertices of a piece."""
MAX_FACES = 30_000
"""Meshes with more faces are thinned before they are cut."""

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

_log = logging.getLogger(__name__)


def convex_pieces(blob: bytes, suffix: str, where: str, check: Callable[[Array], None] | None = None) -> list[Array]:
    """Convex pieces (N, 3) of a mesh file, in the file's units and axes, from the cache where possible.

    Args:
        blob: The file's bytes.
        suffix: Its kind, one of `SUFFIXES`.
        where: Place for error messages.
        check: Called with the mesh's extents (3,) before the costly cutting; may raise.

    Raises:
        BadInputError: it cannot be read or has no volume after repair.
    """
    entry = cache_folder() / f"{hashlib.sha256(VERSION + suffix.encode() + blob).hexdigest()}.npz"
    cached = _from_cache(entry)
    if cached is not None:
        return cached
    vertices, faces = _read(blob, suffix, where)
    if check is not None and len(vertices):
        check(np.ptp(vertices, axis=0))
    pieces = pieces_of(vertices, faces, where)
    _to_cache(entry, pieces)
    return pieces


def pieces_of(vertices: Array, faces: Faces, where: str) -> list[Array]:
    """Repairs a mesh, (N, 3) and (M, 3), and cuts each of its closed pieces into convex ones.

    Raises:
        BadInputError: it has no volume after repair.
    """
    import trimesh

    if len(faces) == 0 or not np.isfinite(vertices).all():
        raise BadInputError("the mesh has no faces or has coordinates that are no numbers", where=where)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.merge_vertices()
    mesh.update_faces(mesh.unique_faces() & mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    size = float(np.ptp(mesh.vertices, axis=0).max()) if len(mesh.faces) else 0.0
    with np.errstate(all="ignore"):  # flat pieces divide by their volume
        bodies = [_closed(body) for body in mesh.split(only_watertight=False)] if size > 0 else []
        solid = [body for body in bodies if abs(body.volume) > 1e-7 * size**3]
    if not solid:
        raise BadInputError("the mesh has no volume, even with its holes filled", where=where)
    return [piece for body in solid for piece in _cut(body)]


def cache_folder() -> Path:
    """Where cut meshes are kept: XDG_CACHE_HOME or ~/.cache."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if base and Path(base).is_absolute() else Path.home() / ".cache"
    return root / "ragvlm" / "meshes"


def _read(blob: bytes, suffix: str, where: str) -> tuple[Array, Faces]:
    import trimesh

    options: dict[str, Any] = {"skip_materials": True} if suffix in (".obj", ".glb") else {}
    try:
        # From memory and without a resolver, so that no other file is read through this one.
        loaded = trimesh.load(io.BytesIO(blob), file_type=suffix[1:], process=False, **options)
        mesh: Any = loaded.to_mesh() if isinstance(loaded, trimesh.Scene) else loaded
        return np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    except BadInputError:
        raise
    except Exception as error:
        detail = f"{type(error).__name__} {error}"[:120]
        raise BadInputError(f"it cannot be read as a {suffix} mesh ({detail})", where=where) from error


def _closed(mesh: Any) -> Any:
    """The mesh with every hole closed by a fan around its middle, faces turned outwards."""
    import trimesh

    if not mesh.is_watertight:
        vertices, faces = mesh.vertices.tolist(), mesh.faces.tolist()
        for loop in _boundary_loops(np.asarray(mesh.faces)):
            middle = len(vertices)
            vertices.append(np.mean([vertices[k] for k in loop], axis=0).tolist())
            faces += [[b, a, middle] for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]
        mesh = trimesh.Trimesh(vertices, faces, process=True)
    mesh.fix_normals(multibody=False)
    return mesh


def _boundary_loops(faces: Faces) -> list[list[int]]:
    """Closed chains of the edges that belong to one face only, in the faces' direction."""
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, where, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    following: dict[int, list[int]] = defaultdict(list)
    for start, end in edges[counts[where.ravel()] == 1].tolist():
        following[start].append(end)
    loops: list[list[int]] = []
    for first in list(following):
        while following[first]:
            loop, at = [first], following[first].pop()
            while at != first and following[at]:
                loop.append(at)
                at = following[at].pop()
            if at == first and len(loop) >= 3:
                loops.append(loop)
    return loops


def _cut(mesh: Any) -> list[Array]:
    """Convex pieces of one closed mesh."""
    hull = mesh.convex_hull
    if abs(mesh.volume) >= CONVEX_SHARE * hull.volume:
        return [_thinned_hull(np.asarray(hull.vertices, float))]
    import coacd

    coacd.set_log_level("error")
    vertices, faces = _thinned(np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64))
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces.astype(np.int32)),
        threshold=CONCAVITY,
        max_convex_hull=MAX_PIECES,
        decimate=True,
        max_ch_vertex=MAX_CORNERS,
        mcts_iterations=60,
        mcts_nodes=15,
        seed=0,
    )
    pieces = [np.asarray(points, float) for points, _ in parts]
    return [piece for piece in pieces if _hull_volume(piece) > 0.0] or [_thinned_hull(np.asarray(hull.vertices, float))]


def _thinned(vertices: Array, faces: Faces) -> tuple[Array, Faces]:
    """The mesh with vertices joined on a grid that is coarse enough to leave at most `MAX_FACES` faces."""
    cells = 256
    low, size = vertices.min(0), float(np.ptp(vertices, axis=0).max())
    while len(faces) > MAX_FACES and cells >= 16:
        grid = np.round((vertices - low) / size * cells).astype(np.int64)
        _, keep, joined = np.unique(grid, axis=0, return_index=True, return_inverse=True)
        fewer = joined.ravel()[faces]
        whole = (fewer[:, 0] != fewer[:, 1]) & (fewer[:, 1] != fewer[:, 2]) & (fewer[:, 2] != fewer[:, 0])
        vertices, faces = vertices[keep], fewer[whole]
        cells //= 2
    return vertices, faces


def _thinned_hull(vertices: Array) -> Array:
    """At most a few times `MAX_CORNERS` vertices of a hull: those that lie farthest in evenly spread directions."""
    if len(vertices) <= 4 * MAX_CORNERS:
        return vertices
    k = np.arange(4 * MAX_CORNERS) + 0.5
    height, turn = 1 - 2 * k / len(k), np.pi * (1 + np.sqrt(5)) * k
    flat = np.sqrt(1 - height**2)
    directions = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), height])
    return vertices[np.unique((vertices @ directions.T).argmax(0))]


def _hull_volume(points: Array) -> float:
    """Volume of the convex hull of points; 0 where they are flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0


def hull_volumes(pieces: list[Array]) -> list[float]:
    """Volumes of the pieces' convex hulls, in cubed units of the pieces."""
    return [_hull_volume(piece) for piece in pieces]


def _from_cache(entry: Path) -> list[Array] | None:
    try:
        with np.load(entry, allow_pickle=False) as arrays:
            pieces = [np.asarray(arrays[f"piece_{k}"], float) for k in range(len(arrays.files))]
    except (OSError, ValueError, KeyError, EOFError):
        return None
    good = all(piece.ndim == 2 and piece.shape[1] == 3 and np.isfinite(piece).all() for piece in pieces)
    return pieces if pieces and good else None


def _to_cache(entry: Path, pieces: list[Array]) -> None:
    """Writes the pieces beside the entry and renames, so that a reader never sees half a file."""
    try:
        entry.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=entry.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, **{f"piece_{k}": piece for k, piece in enumerate(pieces)})  # type: ignore[arg-type]
            os.replace(name, entry)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as error:
        _log.info("cut mesh not cached: %s", error)
