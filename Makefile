# FaceEdit: `make run` and `make test` do everything on a fresh machine.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: run test check lint format lock character demo-take clean help

help:
	@echo "make run    set up what is missing, then open FaceEdit on the demo take"
	@echo "make test   set up what is missing, then run all tests"
	@echo "make check  linters, types and formatting only"

run: $(READY)
	$(BIN)/faceedit --demo

test: $(READY)
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m pytest

check: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

$(READY): pyproject.toml requirements.lock packaging/system-packages.sh
	sh packaging/system-packages.sh
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "FaceEdit needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	touch $(READY)

# Pins what was tested: the versions of the present environment, without registry addresses.
lock:
	$(BIN)/python -m pip freeze --exclude-editable --exclude faceedit \
		| grep -v '^-' | sed 's/+cpu$$//' > requirements.lock

character: $(READY)
	$(BIN)/python -m assets.builder

demo-take: $(READY)
	$(BIN)/python -m faceedit_app.training.demo_take

clean:
	rm -rf $(VENV) out build dist
