"""The user's own MJCF body as convex pieces. Every file it names must lie in the scene file's folder."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np

from kb.errors import BadInputError
from sim.footprint import rotation
from sim.mesh import hull_volumes, pieces_of
from sim.placed import Geom, GeomType
from sim.user_files import inside, read

MAX_INCLUDES = 16
"""Most MJCF files that one object may consist of."""
MAX_PIECES = 64
FOLDER_KEYS = ("meshdir", "texturedir", "assetdir")


def mjcf_geoms(folder: Path, name: str, where: str) -> tuple[list[Geom], float]:
    """Colliding pieces of the one free body in an MJCF file, in its world frame, and its mass [kg].

    Raises:
        BadInputError: it is malformed, reads files outside the folder, or is not one free rigid body.
    """
    path = inside(folder, name, where, (".xml", ".mjcf"))
    _check_files(folder.resolve(), path, where, set())
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except Exception as error:
        detail = " ".join(str(error).split())[:200]
        raise BadInputError(f"{name!r} does not compile: {detail}", where=where) from error
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    if model.njnt != 1 or int(model.jnt_type[0]) != free or model.ntree != 1:
        raise BadInputError(f"{name!r} must hold one body with one free joint and no other joints", where=where)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = int(model.jnt_bodyid[0])
    mine = [k for k in range(model.ngeom) if int(model.body_rootid[model.geom_bodyid[k]]) == body]
    colliding = [k for k in mine if model.geom_contype[k] or model.geom_conaffinity[k]]
    geoms = [piece for k in colliding or mine for piece in _pieces(model, data, k, where)]
    if not geoms or len(geoms) > MAX_PIECES:
        raise BadInputError(f"{name!r} must have 1 to {MAX_PIECES} convex pieces, it has {len(geoms)}", where=where)
    return geoms, float(model.body_subtreemass[body])


def _check_files(root: Path, path: Path, where: str, seen: set[Path]) -> None:
    """Raises BadInputError if the file or anything it includes or names leads out of `root`."""
    seen.add(path)
    if len(seen) > MAX_INCLUDES:
        raise BadInputError(f"{path.name!r} includes too many files", where=where)
    text = read(path, where)
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise BadInputError(f"{path.name!r} has a document type, which is not allowed", where=where)
    try:
        tree = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise BadInputError(f"{path.name!r} is malformed XML: {error}", where=where) from error
    folders = [""]
    for element in tree.iter():
        for key in FOLDER_KEYS:
            if key in element.attrib:
                _inside_folder(root, path.parent, element.attrib[key], where)
                folders.append(element.attrib[key])
    for element in tree.iter():
        for key, value in element.attrib.items():
            if not key.startswith("file"):
                continue
            found = [_named(root, path.parent, f"{part}/{value}" if part else value, where) for part in folders]
            if element.tag == "include" and found[0] is not None and found[0] not in seen:
                _check_files(root, found[0], where, seen)


def _named(root: Path, base: Path, name: str, where: str) -> Path | None:
    """The real path of a file named in an MJCF file, or None if it does not exist (MuJoCo then says so)."""
    _inside_folder(root, base, name, where)
    real = (base / name).resolve()
    if not real.exists():
        return None
    return inside(root, str(real.relative_to(root)), where)


def _inside_folder(root: Path, base: Path, name: str, where: str) -> None:
    path = Path(name)
    if path.is_absolute() or "\\" in name or ":" in name or not (base / path).resolve().is_relative_to(root):
        raise BadInputError(f"{name!r} leads out of the scene file's folder", where=where)


def _pieces(model: Any, data: Any, geom: int, where: str) -> list[Geom]:
    """One geom as convex pieces in the world frame."""
    kinds: dict[int, GeomType] = {
        int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
        int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
        int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
        int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
        int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    }
    counts = {"sphere": 1, "capsule": 2, "ellipsoid": 3, "cylinder": 2, "box": 3}
    kind = int(model.geom_type[geom])
    place, turn = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    rgba = tuple(model.geom_rgba[geom].tolist())
    if kind == int(mujoco.mjtGeom.mjGEOM_MESH):
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        local = np.asarray(model.mesh_vert[first : first + count], float)
        pieces = pieces_of(local, np.asarray(model.mesh_face[start : start + faces], np.int64), where)
        volumes = hull_volumes(pieces)
        return [
            Geom("mesh", vertices=piece @ turn.T + place, rgba=rgba, mass=volume)
            for piece, volume in zip(pieces, volumes, strict=True)
        ]
    if kind not in kinds:
        raise BadInputError("its geoms may be boxes, spheres, capsules, cylinders, ellipsoids and meshes", where=where)
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turn.ravel())
    name = kinds[kind]
    size = tuple(model.geom_size[geom, : counts[name]].tolist())
    share = max(float(np.prod(2 * model.geom_aabb[geom, 3:])), 0.0)
    w, x, y, z = quaternion.tolist()
    return [Geom(name, size, tuple(place.tolist()), (w, x, y, z), rgba=rgba, mass=share)]


def moved(geom: Geom, turn: Any, shift: Any, scale: float) -> Geom:
    """The piece turned by a rotation (3, 3), scaled, then shifted (3,) [m]."""
    factor = geom.mass * scale**3
    if geom.vertices is not None:
        own = geom.vertices @ rotation(geom.quaternion).T + np.asarray(geom.position)
        return replace(
            geom,
            vertices=scale * own @ np.asarray(turn).T + shift,
            position=(0.0, 0.0, 0.0),
            quaternion=(1.0, 0.0, 0.0, 0.0),
            mass=factor,
        )
    place = scale * np.asarray(turn) @ np.asarray(geom.position) + shift
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, (np.asarray(turn) @ rotation(geom.quaternion)).ravel())
    return replace(
        geom,
        size=tuple(scale * value for value in geom.size),
        position=tuple(place.tolist()),
        quaternion=tuple(quaternion.tolist()),
        mass=factor,
    )
