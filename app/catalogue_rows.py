"""The catalogue of objects, known and new ones, as plain rows, for tables and JSON."""

from __future__ import annotations

from typing import Any


def catalogue_rows() -> list[dict[str, Any]]:
    """One row a model, the catalogue first, with nominal size [m] and mass [kg]."""
    from sim.ood_catalogue import ALL_MODELS, group_of

    return [
        {
            "model": model.name,
            "group": group_of(model.name),
            "category": model.category,
            "affordance": model.affordance.type,
            "material": model.affordance.material,
            "fragility": model.affordance.fragility,
            "region": model.affordance.region,
            "size_m": [round(float(side), 4) for side in model.form().size],
            "mass_kg": model.mass,
        }
        for model in ALL_MODELS.values()
    ]
