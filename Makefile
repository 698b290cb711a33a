# Two commands do everything on a fresh machine that has Python 3.11 or 3.12:
#   make demo    the whole loop: stimuli, a study in the browser, answers, a report
#   make test    every test
# Both make the environment in .venv first.

.DEFAULT_GOAL := help
.PHONY: help demo test check lock clean

PYTHON ?= $(shell for p in python3.11 python3.12 python3; do \
	$$p -c 'import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 13))' \
	2>/dev/null && echo $$p && break; done)
BIN := .venv/bin
COMPILE := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 \
	--no-emit-index-url --no-emit-find-links --no-header --no-annotate pyproject.toml

help:
	@sed -n '2,4s/^# \{0,2\}//p' Makefile

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or 3.12 with its venv module is needed" \
		"(apt install python3.11-venv)"; exit 2; }
	$(PYTHON) -m venv .venv

# The front end is built with the package, so a change to its sources means installing again.
FRONTEND := $(shell find experiments/web/frontend -type f -not -path '*/node_modules/*' 2>/dev/null)

.venv/run.stamp: $(BIN)/python requirements/run.txt pyproject.toml hatch_build.py $(FRONTEND)
	$(BIN)/python -m pip install --quiet -r requirements/run.txt
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	@touch $@

.venv/test.stamp: .venv/run.stamp requirements/test.txt
	$(BIN)/python -m pip install --quiet -r requirements/test.txt
	@touch $@

demo: .venv/run.stamp
	$(BIN)/trompe demo

# Two at once: much of the suite waits for windows and pages. A file's tests stay together, as they
# share what they render. Threads for small matrices would wait for each other, up to six times as long.
test: .venv/test.stamp
	OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m pytest --numprocesses 2 --dist loadfile

check: .venv/test.stamp
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

# One resolution for both locks: what runs is what was tested.
lock:
	$(BIN)/python -m pip install --quiet uv
	$(COMPILE) --upgrade --all-extras --output-file requirements/test.txt
	$(COMPILE) --constraint requirements/test.txt --output-file requirements/run.txt

clean:
	rm -rf .venv build dist demo experiments/web/bundle experiments/web/frontend/node_modules
