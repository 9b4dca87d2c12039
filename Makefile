# make setup|demo|test|check|docs: each makes .venv from requirements.lock when it is missing or stale.
PYTHON ?= python3
BIN := .venv/bin
SPEED ?= 1
SCENARIO ?= straight_5
SEED ?= 1
# make setup EXTRA=companion: only what a drone or a vehicle needs, from its own lock.
EXTRA ?=
LOCK := requirements$(if $(EXTRA),-$(EXTRA)).lock

.PHONY: setup demo test check docs lint lock clean

setup: .venv/.complete

.venv/.complete: $(LOCK) pyproject.toml
	rm -rf .venv
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --no-deps --require-hashes -r $(LOCK)
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	$(BIN)/python -m scenarios.lockstep.warm_up
	touch $@

demo: .venv/.complete
	$(BIN)/scenarios run $(SCENARIO)$(if $(CAMERA),+camera=$(CAMERA)) --speed $(SPEED) --seed $(SEED)

check: lint
	$(BIN)/pytest -q -n 2 --dist loadscope --no-loadscope-reorder -m "not slow and not wire"

# What keeps time with the clock runs after the rest: what mostly waits three at a time, what takes both cores by itself.
# A module's tests share what they fly; in the order of the files the many short ones come last.
test: lint docs
	$(BIN)/pytest -q -n 2 --dist loadscope --no-loadscope-reorder -m "not wire"
	$(BIN)/pytest -q -n 3 --dist loadscope -m "wire and not alone"
	$(BIN)/pytest -q -m alone

# The manual, in build/manual/index.html; needs no network. A warning, such as a broken link, fails it.
docs: .venv/.complete
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --config-file docs/manual/mkdocs.yml

lint: .venv/.complete
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

# Needs uv; the locks carry hashes and name no package index. The drone's has the versions of the other.
COMPILE := --quiet --generate-hashes --no-emit-index-url --no-header --universal --python-version 3.11
lock:
	uv pip compile pyproject.toml --group dev --all-extras $(COMPILE) -o requirements.lock
	uv pip compile pyproject.toml --group build --constraints requirements.lock $(COMPILE) -o requirements-companion.lock

clean:
	rm -rf .venv runs build .mypy_cache .ruff_cache .pytest_cache
