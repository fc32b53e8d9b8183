"""The catalogue of objects as plain rows, for tables and JSON."""

from __future__ import annotations

from typing import Any


def catalogue_rows() -> list[dict[str, Any]]:
    """One row a model, in the catalogue's order, with nominal size [m] and mass [kg]."""
    from sim.catalogue import MODELS

    return [
        {
            "model": model.name,
            "category": model.category,
            "affordance": model.affordance.type,
            "material": model.affordance.material,
            "fragility": model.affordance.fragility,
            "region": model.affordance.region,
            "size_m": [round(float(side), 4) for side in model.form().size],
            "mass_kg": model.mass,
        }
        for model in MODELS.values()
    ]
