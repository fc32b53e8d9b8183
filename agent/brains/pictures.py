"""Pictures for models: the camera's view with a numbered mark on every perceived object (set of marks)."""

from __future__ import annotations

import io

from agent.brain import Situation


def marked_pictures(situation: Situation, names: tuple[str, ...]) -> tuple[bytes, ...]:
    """PNG files of the named views with the marks drawn in; none where this process has not looked.

    Args:
        situation: pictures and percept of the last look.
        names: cameras, in the order in which they are shown.
    """
    if situation.percept is None:
        return ()
    from PIL import Image

    from tools.draw_scene_graph import draw_scene_graph

    found = {view.name: view for view in situation.views}
    files: list[bytes] = []
    for name in names:
        if name in found:
            buffer = io.BytesIO()
            drawn = draw_scene_graph(found[name], situation.percept, scale=1)
            Image.fromarray(drawn).save(buffer, "PNG", compress_level=1)
            files.append(buffer.getvalue())
    return tuple(files)
