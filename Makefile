# FaceEdit: `make run` and `make test` do everything on a fresh machine.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: run test check lint format lock package character demo-take clean help

help:
	@echo "make run    set up what is missing, then open FaceEdit on the demo take"
	@echo "make test   set up what is missing, then run all tests"
	@echo "make check  linters, types and formatting only"
	@echo "make package  wheel, application, archive and .deb into dist/, each tried out"

run: $(READY)
	$(BIN)/faceedit --demo

# Neighbours in a file stay in one process, which prepares what they share only once. A process that
# dies ends the run at once, with the name of its test: a new one would wait for ever. The programs
# that tests start find all modules compiled, also where Python is set not to keep them.
test: $(READY)
	$(BIN)/python -m compileall -q -j 0 faceedit_app tests/support  # once, not in each process
	QT_QPA_PLATFORM=offscreen PYTHONDONTWRITEBYTECODE= \
		$(BIN)/python -m pytest -n auto --dist worksteal --max-worker-restart 0

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
	$(BIN)/python -m assets.builder.tracker || true  # all but films works without it
	touch $(READY)

# Pins what was tested: the versions of the present environment, without registry addresses.
lock:
	$(BIN)/python -m pip freeze --exclude-editable --exclude faceedit \
		| grep -v '^-' | sed 's/+cpu$$//' > requirements.lock

# What is downloaded (docs/releasing.md). The application is made from the wheel, in an environment
# of its own without what only training and tests need; then each is tried on a virtual screen,
# and must export what the source install exports.
PACK := build/venv
PIP := $(PACK)/bin/python -m pip --disable-pip-version-check --quiet
TRY := $(PYTHON) packaging/smoke_test.py

package: $(READY)
	rm -rf build dist
	$(BIN)/python -m assets.builder.tracker
	$(PYTHON) -m venv $(PACK)
	$(PIP) install -r packaging/requirements.txt
	$(PACK)/bin/python -m build --outdir dist .
	$(PIP) install -c requirements.lock dist/faceedit-*.whl
	$(PACK)/bin/python packaging/build.py
	$(TRY) $(PACK)/bin/faceedit --reference $(BIN)/faceedit
	$(TRY) dist/faceedit/faceedit --reference $(BIN)/faceedit --starts 5
	if [ "$$(id -u)" = 0 ] && command -v debootstrap; then \
		sh packaging/linux/try-deb.sh dist/faceedit_*.deb $(BIN)/faceedit; fi

character: $(READY)
	$(BIN)/python -m assets.builder

demo-take: $(READY)
	$(BIN)/python -m faceedit_app.lab.training.demo_take

clean:
	rm -rf $(VENV) out build dist
