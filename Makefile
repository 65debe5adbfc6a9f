# make demo and make test set up all they need on a fresh machine: a virtual environment, extras, system packages.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The versions that the tests were green with; `make test CONSTRAINTS=` takes the newest of everything.
CONSTRAINTS ?= constraints.txt
INSTALLED := $(VENV)/.installed
INSTALLED_TEST := $(VENV)/.installed-test
INSTALLED_BENCH := $(VENV)/.installed-bench
INSTALLED_LAB := $(VENV)/.installed-lab

PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check
# $(call install,EXTRAS): where a version of the constraints is not to be had for this Python or platform, the newest ones.
define install
@$(if $(CONSTRAINTS),$(PIP) --constraint $(CONSTRAINTS) -e '.$(1)' || \
  { echo '$(CONSTRAINTS) cannot be met here: installing the newest versions'; $(PIP) -e '.$(1)'; },$(PIP) -e '.$(1)')
endef

.PHONY: demo test pytest lint types test-slow bench bench-arms mutants mutants-all docs notebooks constraints chromium clean

demo: $(INSTALLED)
	$(BIN)/chainbuild demo

# mypy takes a minute of one core: beside the tests it costs half of it.
test: $(INSTALLED_TEST) chromium lint
	@$(MAKE) --no-print-directory -j 2 types pytest

pytest: $(INSTALLED_TEST)
	$(BIN)/python -m pytest chainbuild tests -n 2 --dist loadfile

lint: $(INSTALLED_TEST)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(INSTALLED_TEST)
	$(BIN)/mypy

test-slow: $(INSTALLED_TEST) $(INSTALLED_BENCH) $(INSTALLED_LAB) chromium
	$(BIN)/python -m pytest chainbuild tests -m slow -n 2 --dist worksteal

bench: $(INSTALLED_BENCH) $(INSTALLED_TEST) chromium
	$(BIN)/python -m tests.bench
	$(BIN)/python -m tests.bench.displayed
	$(BIN)/python -m tests.bench.page
	$(BIN)/python -m tests.bench.live
	$(BIN)/python docs/generate.py

# Every branch of many arms. What ssik has to derive for calibrated arms takes a quarter of an hour, once.
bench-arms: $(INSTALLED_BENCH) $(INSTALLED_TEST)
	$(BIN)/python -m tests.bench.arms --build
	$(BIN)/python -m tests.bench.arms

# Six of each file, drawn at random and always the same. All of them, some 2000, take many hours on two cores: those that
# no test kills at once are judged in fresh processes by all tests. Where time ends, another run goes on.
mutants: $(INSTALLED_TEST)
	$(BIN)/python -m tests.mutants --each 6 --minutes 60 --state .mutants

mutants-all: $(INSTALLED_TEST)
	$(BIN)/python -m tests.mutants --minutes 600 --state .mutants-all

docs: $(INSTALLED)
	$(BIN)/python docs/generate.py

# Runs the scripts in notebooks/ and writes the notebooks beside them, with their outputs.
notebooks: $(INSTALLED_TEST)
	$(BIN)/python notebooks/execute.py

# Takes the newest version of everything, runs the tests, and notes what they were green with.
constraints: $(INSTALLED_TEST)
	$(PIP) --upgrade --upgrade-strategy eager -e '.[test]'
	$(MAKE) test
	$(BIN)/python -m tests.project.constraints
	touch $(INSTALLED) $(INSTALLED_TEST)

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit("chainbuild needs Python 3.11 or newer") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)

$(INSTALLED): pyproject.toml $(CONSTRAINTS) | $(VENV)/bin/python
	$(call install,)
	touch $@

$(INSTALLED_TEST): pyproject.toml $(CONSTRAINTS) | $(VENV)/bin/python
	$(call install,[test])
	touch $@ $(INSTALLED)

$(INSTALLED_BENCH): pyproject.toml | $(VENV)/bin/python
	$(PIP) -e '.[bench]'
	touch $@ $(INSTALLED)

$(INSTALLED_LAB): pyproject.toml | $(VENV)/bin/python
	$(PIP) -e '.[lab]'
	touch $@ $(INSTALLED)

# The page that `inspect` exports is tested in a real browser.
chromium:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || \
	  { echo 'installing chromium for the browser tests'; \
	    SUDO=$$( [ "$$(id -u)" = 0 ] || echo sudo ); \
	    $$SUDO apt-get update -qq && $$SUDO apt-get install -y -qq --no-install-recommends chromium >/dev/null; }

clean:
	rm -rf $(VENV) build *.egg-info .pytest_cache .mypy_cache .ruff_cache
