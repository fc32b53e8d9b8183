"""A tiny random Qwen3-VL, made on the spot: saved, loaded in NF4, bound to schemas with pictures, and a whole run through it."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytestmark = pytest.mark.models

FOLDER_OPTIONS = ["weights=fp32", "weights=nf4", "weights=int8", "weights=bf16&cache=fp8"]


@pytest.fixture(scope="module", autouse=True)
def one_thread() -> None:
    """The models are tiny: threads would only fight over the cores."""
    import torch

    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The saved model."""
    from agent.brains.random_model import make_random_model

    return make_random_model(tmp_path_factory.mktemp("tiny"))


def picture(seed: int) -> bytes:
    """A PNG of noise."""
    from PIL import Image

    pixels = np.random.default_rng(seed).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


@pytest.mark.parametrize("options", FOLDER_OPTIONS)
def test_replies_are_valid_whatever_the_weights_and_the_cache(folder: Path, options: str) -> None:
    """Two views in one prompt; every kind of short reply is valid by its schema and ends; the same prompt, the same reply."""
    from agent.brains.chat import Message, Prompt
    from agent.brains.hf_chat import open_hf_chat
    from agent.brains.replies import MAX_TOKENS, AnswerReply, ReflectReply, ThinkReply, parse, schema_of

    chat = open_hf_chat(f"{folder}?{options}")
    assert chat.sees
    for number, kind in enumerate((ThinkReply, ReflectReply, AnswerReply)):
        views = (picture(number), picture(number + 9))
        prompt = Prompt(
            "x",
            (Message("system", "Be brief."), Message("user", "See?", views)),
            schema_of(kind),
            MAX_TOKENS[kind],
            300.0,
        )
        got = chat.reply(prompt)
        assert isinstance(parse(got.text, kind), kind)
        assert got.completion_tokens == chat.pace.tokens
        assert got.prompt_tokens > 20
    assert chat.reply(prompt).text == got.text


@pytest.mark.parametrize("options", ["weights=fp32", "weights=nf4", "weights=bf16&cache=fp8"])
def test_the_kept_beginning_of_prompts_changes_no_reply(folder: Path, options: str) -> None:
    """The same replies with and without the kept beginning, whatever came before, a picture or none; from the second
    question of a role on, only the facts and the picture are computed, not the system message."""
    from agent.brains.chat import Message, Prompt
    from agent.brains.hf_chat import open_hf_chat
    from agent.brains.model import system_prompt
    from agent.brains.replies import AnswerReply, ThinkReply, schema_of

    keeping, forgetful = open_hf_chat(f"{folder}?{options}"), open_hf_chat(f"{folder}?{options}&prefix=off")
    felt: dict[int, list[Any]] = {id(chat): watched_logits(chat) for chat in (keeping, forgetful)}
    seen: set[str] = set()
    firsts: list[Any] = []
    for role, pictures, text, bound in (
        ("think", 1, "A cup stands there.", True), ("answer", 0, "Tell it.", True), ("think", 0, "Two cups.", False),
        ("think", 2, "Three cups.", False), ("answer", 0, "Tell it again.", False), ("think", 1, "A cup stands there.", True),
        ("think", 2, "Three cups.", False),
    ):  # fmt: skip
        kind = {"think": ThinkReply, "answer": AnswerReply}[role]
        user = Message("user", text, tuple(picture(number) for number in range(pictures)))
        schema = schema_of(kind) if bound else {}
        prompt = Prompt(role, (Message("system", system_prompt(role, kind)), user), schema, 24, 300.0)
        got = keeping.reply(prompt)
        assert got == forgetful.reply(prompt)
        steps = [felt[id(chat)][-got.completion_tokens :] for chat in (keeping, forgetful)]
        firsts.append(steps[0][0])
        if options == "weights=fp32":  # the others round
            assert all(abs(one - other).max() < 1e-4 for one, other in zip(*steps, strict=True))
        assert forgetful.pace.prefilled == got.prompt_tokens
        assert keeping.pace.prefilled <= (got.prompt_tokens if role not in seen else 60)
        assert got.prompt_tokens > 900
        seen.add(role)
    assert (firsts[0] == firsts[5]).all()
    assert (firsts[3] == firsts[6]).all()
    assert abs(firsts[2] - firsts[3]).max() > 1e-3  # the picture counts


def watched_logits(chat: Any) -> list[Any]:
    """The list to which a chat adds the logits of each of its steps."""
    steps: list[Any] = []
    chat._model.lm_head.register_forward_hook(lambda _module, _given, logits: steps.append(logits[0, -1].float()))
    return steps


def test_nf4_leaves_the_vision_tower_in_16_bit(folder: Path) -> None:
    """Every linear layer of the language model is NF4; the vision tower and the head are BF16 throughout."""
    import torch
    from bitsandbytes.nn import Linear4bit

    from agent.brains.hf_model import HfCfg, load

    model, _ = load(HfCfg(str(folder), weights="nf4", device="cpu"))
    quantised = [name for name, module in model.named_modules() if isinstance(module, Linear4bit)]
    assert not any("visual" in name or "lm_head" in name for name in quantised)
    linear = [
        (name, m) for name, m in model.named_modules() if isinstance(m, torch.nn.Linear) and "language_model" in name
    ]
    assert len(linear) >= 14  # seven a layer
    assert all(name in quantised and layer.weight.quant_type == "nf4" for name, layer in linear)
    kept = [value.dtype for name, value in model.named_parameters() if "visual" in name or "lm_head" in name]
    assert len(kept) > 20
    assert set(kept) == {torch.bfloat16}


@pytest.mark.parametrize(("cache", "kept"), [("bf16", "bfloat16"), ("fp8", "float8_e4m3fn")])
def test_the_cache_has_the_type_that_was_chosen(folder: Path, cache: str, kept: str) -> None:
    """Keys and values of every layer are held in that type; as many as there are tokens."""
    import torch

    from agent.brains.chat import Message, Prompt
    from agent.brains.hf_chat import open_hf_chat

    chat = open_hf_chat(f"{folder}?weights=bf16&cache={cache}&prefix=off")
    caches: list[Any] = []
    new = chat._new_cache
    chat._new_cache = lambda: caches.append(new()) or caches[-1]  # type: ignore[method-assign]
    reply = chat.reply(Prompt("x", (Message("user", "See?", (picture(1),)),), {}, 6, 300.0))
    (used,) = caches
    assert used.get_seq_length() == reply.prompt_tokens + reply.completion_tokens - 1
    for layer in used.layers:
        # The FP8 layer holds each with its scale, the plain one bare.
        values = [v[0] if isinstance(v, tuple) else v for v in vars(layer).values()]
        held = [v for v in values if isinstance(v, torch.Tensor) and v.dim() == 4 and v.numel()]
        assert [tensor.dtype for tensor in held] == [getattr(torch, kept)] * 2
        assert all(tensor.shape[-2] == used.get_seq_length() for tensor in held)


def test_all_views_of_a_look_go_in_as_one_batch(folder: Path) -> None:
    """Four pictures in one prompt pass the vision tower in one call, and each of them counts, its place included."""
    from agent.brains.chat import Message, Prompt
    from agent.brains.hf_chat import open_hf_chat

    chat = open_hf_chat(f"{folder}?weights=fp32")
    felt, grids = watched_logits(chat), list[Any]()
    chat._model.model.visual.register_forward_pre_hook(
        lambda _module, args, named: grids.append(named["grid_thw"] if "grid_thw" in named else args[1]),
        with_kwargs=True,
    )
    views = tuple(picture(number) for number in range(4))
    orders = (views, views[::-1], *((*views[:n], picture(9), *views[n + 1 :]) for n in range(4)), views)
    for shown in orders:
        chat.reply(Prompt("x", (Message("user", "See?", shown),), {}, 1, 300.0))
    assert [tuple(grid.shape) for grid in grids] == [(4, 3)] * len(orders)
    assert (felt[0] == felt[-1]).all()
    assert all(abs(logits - felt[0]).max() > 1e-4 for logits in felt[1:-1])


def test_a_time_limit_and_a_stop_end_the_reply(folder: Path) -> None:
    """A reply that takes too long, or that the person ends, is a fault and no text."""
    from agent.brain import BrainFaultError
    from agent.brains.chat import Message, Prompt
    from agent.brains.hf_chat import HfChat
    from agent.brains.hf_model import HfCfg, load

    model, processor = load(HfCfg(str(folder), weights="fp32", device="cpu"))
    prompt = Prompt("x", (Message("user", "Hello"),), {}, 50, 10.0)
    ticks = iter(range(0, 10_000, 6))
    with pytest.raises(BrainFaultError, match="too slow"):
        HfChat("hf:tiny", model, processor, clock=lambda: float(next(ticks))).reply(prompt)
    with pytest.raises(BrainFaultError, match="stopped"):
        HfChat("hf:tiny", model, processor, stopped=lambda: True).reply(prompt)


def test_what_is_no_model_says_its_mend(tmp_path: Path) -> None:
    """An empty folder, a wrong key and a wrong value."""
    from agent.brains.hf_chat import open_hf_chat
    from kb.errors import BadInputError, EnvironmentFaultError

    with pytest.raises(EnvironmentFaultError, match="--brain hf:FOLDER"):
        open_hf_chat(str(tmp_path))
    with pytest.raises(BadInputError, match="weights, cache, device"):
        open_hf_chat(f"{tmp_path}?bits=4")
    with pytest.raises(BadInputError, match="nf4"):
        open_hf_chat(f"{tmp_path}?weights=nf5")


@pytest.mark.parametrize(("scene", "perception"), [("single_cube", "rgbd"), ("single_apple", "vlm")])
def test_a_whole_run_is_valid_and_ends(folder: Path, scene: str, perception: Any) -> None:
    """The model knows nothing, yet the run ends with a valid result, every model reply is valid JSON of its schema, and
    nothing is moved with more force than the gate allows."""
    import json

    from agent import build_agent
    from agent.safety.limits import BrainLimits
    from kb.run_result import RunResult

    steps: list[Any] = []
    brain = f"hf:{folder}?weights=fp32"
    robot = build_agent(scene, 10_001, brain=brain, perception=perception, brain_limits=BrainLimits(refusals=1))
    result = robot.run(f"pick up the {scene.removeprefix('single_')}", steps.append)
    assert RunResult.model_validate_json(result.model_dump_json()).model_dump_json() == result.model_dump_json()
    calls = [step for step in steps if step.kind == "model_call"]
    assert calls
    assert all(isinstance(json.loads(call.exchange.reply), dict) for call in calls)
    assert result.damage_events == 0
    assert result.answer
