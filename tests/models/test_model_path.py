"""The optional models: the versions that the extra names load and run the paper's model class, offline and on a CPU."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.models

IMAGE_TOKEN, VIDEO_TOKEN, VISION_START, VISION_END = 250, 251, 252, 253
PATCH, MERGE = 8, 2


def tiny_config() -> Any:
    """A Qwen3-VL of about a hundred thousand parameters."""
    from transformers import Qwen3VLConfig

    return Qwen3VLConfig(
        text_config={
            "vocab_size": 256,
            "hidden_size": 32,
            "intermediate_size": 64,
            "num_hidden_layers": 2,
            "num_attention_heads": 2,
            "num_key_value_heads": 1,
            "head_dim": 16,
            "rope_scaling": {"rope_type": "default", "mrope_section": [4, 2, 2], "mrope_interleaved": True},
            "max_position_embeddings": 256,
        },
        vision_config={
            "depth": 2,
            "hidden_size": 32,
            "intermediate_size": 64,
            "num_heads": 2,
            "patch_size": PATCH,
            "temporal_patch_size": 2,
            "spatial_merge_size": MERGE,
            "out_hidden_size": 32,
            "num_position_embeddings": 64,
            "deepstack_visual_indexes": [0],
        },
        image_token_id=IMAGE_TOKEN,
        video_token_id=VIDEO_TOKEN,
        vision_start_token_id=VISION_START,
        vision_end_token_id=VISION_END,
        tie_word_embeddings=True,
    )


def test_a_saved_qwen3_vl_comes_back_and_generates_the_same(tmp_path: Path) -> None:
    """Saved and reloaded through `AutoModelForImageTextToText`, the model answers an image greedily with the same tokens."""
    import torch
    from transformers import AutoModelForImageTextToText, Qwen3VLForConditionalGeneration

    torch.manual_seed(0)
    model = Qwen3VLForConditionalGeneration(tiny_config()).eval()
    model.save_pretrained(tmp_path)
    again = AutoModelForImageTextToText.from_pretrained(tmp_path).eval()
    assert type(again) is type(model)
    grid = torch.tensor([[1, 4, 4]])
    pixels = torch.rand(16, 3 * 2 * PATCH * PATCH)
    tokens = torch.tensor([[5, VISION_START, *[IMAGE_TOKEN] * (16 // MERGE**2), VISION_END, 7, 8]])
    given = {
        "input_ids": tokens,
        "attention_mask": torch.ones_like(tokens),
        "pixel_values": pixels,
        "image_grid_thw": grid,
        "mm_token_type_ids": (tokens == IMAGE_TOKEN).int(),
    }
    answers = [m.generate(**given, max_new_tokens=6, do_sample=False) for m in (model, again)]
    assert answers[0].shape == (1, tokens.shape[1] + 6)
    assert torch.equal(*answers)


def test_torch_and_torchvision_fit_together() -> None:
    """open_clip imports torchvision unconditionally; its compiled operators load only with the matching torch."""
    import torch
    from torchvision.ops import nms

    boxes = torch.tensor([[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 0.9], [2.0, 2.0, 3.0, 3.0]])
    assert nms(boxes, torch.tensor([0.9, 0.8, 0.7]), 0.5).tolist() == [0, 2]
