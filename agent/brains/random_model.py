"""Vision-language models with random weights, saved to a folder: they know nothing, but load, see and speak like real ones.

For tests of the real loading code without a download, and for measuring the speed of a shape before its weights are
there. The tokenizer has one token a byte, so that any text can be read and any reply be written.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from agent.brains.hf_model import quiet

Shape = Literal["tiny", "qwen3-vl-2b", "qwen3-vl-4b", "qwen3-vl-8b"]


@dataclass(frozen=True)
class ShapeCfg:
    """Sizes of a Qwen3-VL (from the published configurations of the models of that name)."""

    hidden: int
    layers: int
    heads: int
    kv_heads: int
    inner: int
    head_dim: int
    vision_hidden: int
    vision_depth: int
    vision_heads: int
    vision_inner: int
    patch: int
    vocab: int
    deepstack: tuple[int, ...]
    sections: tuple[int, int, int]
    positions: int = 2304
    pixels: int = 1_000_000
    """Pictures are scaled down to this many pixels at most."""


SHAPES: dict[Shape, ShapeCfg] = {
    "tiny": ShapeCfg(64, 2, 4, 2, 128, 16, 64, 2, 2, 128, 16, 272, (0,), (4, 2, 2), 256, 32_768),
    "qwen3-vl-2b": ShapeCfg(2048, 28, 16, 8, 6144, 128, 1024, 24, 16, 4096, 16, 151936, (5, 11, 17), (24, 20, 20)),
    "qwen3-vl-4b": ShapeCfg(2560, 36, 32, 8, 9728, 128, 1024, 24, 16, 4096, 16, 151936, (5, 11, 17), (24, 20, 20)),
    "qwen3-vl-8b": ShapeCfg(4096, 36, 32, 8, 12288, 128, 1152, 27, 16, 4304, 16, 151936, (8, 16, 24), (24, 20, 20)),
}
SPECIAL = (
    "<|endoftext|>", "<|im_start|>", "<|im_end|>", "<|vision_start|>", "<|vision_end|>", "<|image_pad|>", "<|video_pad|>",
)  # fmt: skip
TEMPLATE = (
    "{% for message in messages %}<|im_start|>{{ message.role }}\n"
    "{% if message.content is string %}{{ message.content }}{% else %}{% for part in message.content %}"
    "{% if part.type == 'image' %}<|vision_start|><|image_pad|><|vision_end|>"
    "{% elif part.type == 'text' %}{{ part.text }}{% endif %}{% endfor %}{% endif %}<|im_end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)


def make_random_model(folder: Path, shape: Shape = "tiny", *, seed: int = 0) -> Path:
    """Makes and saves a model with its processor, and returns the folder.

    Args:
        folder: where it is saved; created if need be.
        shape: sizes.
        seed: of the weights.
    """
    import torch  # pyright: ignore[reportMissingImports]
    from transformers import Qwen3VLForConditionalGeneration  # pyright: ignore[reportMissingImports]

    quiet()
    processor = make_processor(SHAPES[shape])
    processor.save_pretrained(folder)
    generator = torch.random.fork_rng()
    with generator:
        torch.manual_seed(seed)
        torch.set_default_dtype(torch.bfloat16)
        try:
            model = Qwen3VLForConditionalGeneration(config_of(SHAPES[shape], processor.tokenizer))
        finally:
            torch.set_default_dtype(torch.float32)
    model.generation_config.eos_token_id = processor.tokenizer.convert_tokens_to_ids("<|im_end|>")
    model.generation_config.pad_token_id = processor.tokenizer.convert_tokens_to_ids("<|endoftext|>")
    model.save_pretrained(folder)
    return folder


def config_of(sizes: ShapeCfg, tokenizer: Any) -> Any:
    """The model's configuration with the tokenizer's special tokens."""
    from transformers import Qwen3VLConfig  # pyright: ignore[reportMissingImports]

    ids = {name: tokenizer.convert_tokens_to_ids(name) for name in SPECIAL}
    return Qwen3VLConfig(
        text_config={
            "vocab_size": sizes.vocab,
            "hidden_size": sizes.hidden,
            "intermediate_size": sizes.inner,
            "num_hidden_layers": sizes.layers,
            "num_attention_heads": sizes.heads,
            "num_key_value_heads": sizes.kv_heads,
            "head_dim": sizes.head_dim,
            "rope_scaling": {"rope_type": "default", "mrope_section": [*sizes.sections], "mrope_interleaved": True},
            "max_position_embeddings": 32_768,
        },
        vision_config={
            "depth": sizes.vision_depth,
            "hidden_size": sizes.vision_hidden,
            "intermediate_size": sizes.vision_inner,
            "num_heads": sizes.vision_heads,
            "patch_size": sizes.patch,
            "temporal_patch_size": 2,
            "spatial_merge_size": 2,
            "out_hidden_size": sizes.hidden,
            "num_position_embeddings": sizes.positions,
            "deepstack_visual_indexes": [*sizes.deepstack],
        },
        image_token_id=ids["<|image_pad|>"],
        video_token_id=ids["<|video_pad|>"],
        vision_start_token_id=ids["<|vision_start|>"],
        vision_end_token_id=ids["<|vision_end|>"],
        tie_word_embeddings=sizes.hidden < 4096,
    )


def make_processor(sizes: ShapeCfg) -> Any:
    """Tokenizer with one token a byte, picture and video processors, and a chat template."""
    from tokenizers import AddedToken, Tokenizer, decoders, models, pre_tokenizers  # pyright: ignore[reportMissingImports]
    from transformers import PreTrainedTokenizerFast, Qwen2VLImageProcessor, Qwen3VLProcessor, Qwen3VLVideoProcessor  # pyright: ignore[reportMissingImports]

    letters = sorted(pre_tokenizers.ByteLevel.alphabet())
    inner = Tokenizer(models.BPE(vocab={letter: n for n, letter in enumerate(letters)}, merges=[]))
    inner.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False, use_regex=False)
    inner.decoder = decoders.ByteLevel()
    inner.add_special_tokens([AddedToken(name, special=True) for name in SPECIAL])
    tokenizer = PreTrainedTokenizerFast(
        tokenizer_object=inner, eos_token="<|im_end|>", pad_token="<|endoftext|>", chat_template=TEMPLATE,
        extra_special_tokens={
            "image_token": "<|image_pad|>", "video_token": "<|video_pad|>", "vision_start_token": "<|vision_start|>",
            "vision_end_token": "<|vision_end|>",
        },
    )  # fmt: skip
    area = {"shortest_edge": (2 * sizes.patch) ** 2, "longest_edge": sizes.pixels}
    pictures = Qwen2VLImageProcessor(patch_size=sizes.patch, temporal_patch_size=2, merge_size=2, size=area)
    videos = Qwen3VLVideoProcessor(patch_size=sizes.patch, temporal_patch_size=2, merge_size=2)
    return Qwen3VLProcessor(
        image_processor=pictures, tokenizer=tokenizer, video_processor=videos, chat_template=TEMPLATE
    )


def shape_of(folder: Path) -> str:
    """What a saved model is, in words, from its configuration."""
    row = json.loads((folder / "config.json").read_text(encoding="utf-8"))
    text = row.get("text_config", row)
    return f"{row.get('model_type', 'model')} {text.get('num_hidden_layers')} layers of {text.get('hidden_size')}"
