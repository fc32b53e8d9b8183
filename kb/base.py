"""The base of every domain noun: frozen, strict about unknown fields, vectors as tuples."""

from __future__ import annotations

from typing import Annotated

from pydantic import AllowInfNan, BaseModel, ConfigDict

Finite = Annotated[float, AllowInfNan(False)]
"""A float that is neither NaN nor infinite."""

Vec2 = tuple[Finite, Finite]
Vec3 = tuple[Finite, Finite, Finite]


class Noun(BaseModel):
    """An immutable domain value that may cross files, models and checkpoints."""

    model_config = ConfigDict(frozen=True, extra="forbid", ser_json_bytes="base64", val_json_bytes="base64")
