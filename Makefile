# Needs Python 3.11 or newer; all else comes from the package index that pip is set up with.
#   make paint                                       paint the sample picture on the sample wall
#   make test PYTEST_ARGS="-k canvas"                run some of the tests
#   make paint PYTHON=python3.12                     with another Python
PYTHON ?= python3
PYTEST_ARGS ?=
PAINT_ARGS ?=
BENCH_ARGS ?=

VENV := .venv
BIN := $(VENV)/bin

.PHONY: install paint test lint format bench

install: $(VENV)/.installed

paint: install
	$(BIN)/jaxpaint paint $(PAINT_ARGS)

test: install
	$(BIN)/python -m pytest -n 2 --dist loadfile $(PYTEST_ARGS)

lint: install
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/basedpyright

format: install
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: install
	$(BIN)/jaxpaint bench $(BENCH_ARGS)

# The locked packages; made anew from nothing when the lock changes, so that nothing older stays behind.
$(VENV)/.locked: requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "jaxpaint needs Python 3.11 or newer, and '$(PYTHON)' is not: name another by 'make PYTHON=python3.12'" >&2; \
	  exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements.lock
	@touch $@

# This package, editable, and its program `jaxpaint`.
$(VENV)/.installed: $(VENV)/.locked pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@
