# make setup|demo|test|check|docs: each makes .venv from requirements.lock when it is missing or stale.
PYTHON ?= python3
BIN := .venv/bin
SPEED ?= 1
SCENARIO ?= straight_5
SEED ?= 1
FRAMES ?= 200000
# make setup EXTRA=companion: only what a drone or a vehicle needs, from its own lock.
EXTRA ?=
LOCK := requirements$(if $(EXTRA),-$(EXTRA)).lock

# Two cores: the kernels compile while the sources are checked, and the fast tests run beside the types.
MAKEFLAGS += --jobs=2
# Byte code is kept whatever the environment says: the tests start hundreds of programs, and each would compile its sources.
unexport PYTHONDONTWRITEBYTECODE
# The only files with tests of the two kinds, so that not all of the others are loaded for them.
WIRE = $(shell grep -rlF pytest.mark.wire tests --include='test_*.py' | sort)
# They take longest, so they begin first.
LONG = $(addprefix tests/,integration/test_fly.py conformance/test_mavsdk.py security/test_secured_landing.py \
    integration/test_view.py scenarios/bench/test_bench.py integration/test_stations.py integration/test_lost_partners.py)
ALONE = $(shell grep -rlF pytest.mark.alone tests --include='test_*.py' | sort)

.PHONY: setup demo test check fast simulated docs lint style types lock fuzz clean

setup: .venv/.complete .venv/.kernels

# On a drone all is compiled to byte code now, for programs that may write none there; else what is loaded is, when it is.
# uv takes a tenth of pip's time.
INSTALL := $(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps
LOCKED := $(INSTALL) --require-hashes $(if $(EXTRA),--compile-bytecode)

.venv/.drone: requirements-uv.lock requirements-companion.lock $(LOCK) pyproject.toml
	@echo 'installing into .venv what $(LOCK) names: on a slow network some minutes, without further output'
	rm -rf .venv
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --no-deps --require-hashes -r requirements-uv.lock
	$(LOCKED) -r requirements-companion.lock
	touch $@

# The kernels need no more than a drone does: they compile while the rest is installed.
.venv/.complete: .venv/.drone
	$(if $(EXTRA),,$(LOCKED) -r $(LOCK))
	$(INSTALL) --no-build-isolation --editable .
	touch $@

.venv/.kernels: .venv/.drone
	$(BIN)/python -m scenarios.lockstep.warm_up
	touch $@

demo: setup
	$(BIN)/scenarios run $(SCENARIO)$(if $(CAMERA),+camera=$(CAMERA)) --speed $(SPEED) --seed $(SEED)

check: fast lint

fast: setup
	$(BIN)/pytest -q -n 2 --dist loadscope --no-loadscope-reorder --hypothesis-profile=quick -m "not slow and not wire"

# What keeps time with the clock runs after the rest: what mostly waits two at a time, what measures time by itself.
test: setup style docs types simulated
	$(BIN)/pytest -q -n 2 --dist loadscope --no-loadscope-reorder -m "wire and not alone" $(LONG) $(filter-out $(LONG),$(WIRE))
	$(BIN)/pytest -q -m alone $(ALONE)

# A module's tests share what they fly; in the order of the files the many short ones come last. Begun while the types,
# which take one core, are checked.
simulated: setup
	$(BIN)/pytest -q -n 2 --dist loadscope --no-loadscope-reorder -m "not wire"

# Drawn anew each time; FRAMES=10000000 goes on for longer. What it finds becomes an example in tests/security.
fuzz: setup
	$(BIN)/scenarios fuzz --frames $(FRAMES) --seed $$(od -An -N4 -tu4 /dev/urandom | tr -d ' ')
	$(BIN)/pytest -q -n 2 --hypothesis-profile=anew -m "hypothesis and not wire"

# The manual, in build/manual/index.html; needs no network. A warning, such as a broken link, or a misspelt word fails it.
docs: .venv/.complete
	$(BIN)/codespell README.md CHANGELOG.md docs companion link scenarios sim_autopilot tests
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --config-file docs/manual/mkdocs.yml

lint: types style

style: .venv/.complete
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: .venv/.complete
	$(BIN)/mypy

# The locks carry hashes and name no package index. The drone's has the versions of the other.
COMPILE := $(BIN)/uv pip compile --quiet --generate-hashes --no-emit-index-url --no-header --universal --python-version 3.11
lock: .venv/.complete
	$(COMPILE) --group pyproject.toml:uv -o requirements-uv.lock
	$(COMPILE) pyproject.toml --group dev --all-extras -o requirements.lock
	$(COMPILE) pyproject.toml --group build --constraints requirements.lock -o requirements-companion.lock

clean:
	rm -rf .venv runs build .mypy_cache .ruff_cache .pytest_cache
