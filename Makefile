# Needs python3 (3.11 or newer), git and make; everything else goes into .venv.
#
#   make run         the web app, opened in the browser
#   make test        every check: lint, types, contracts, tests, browser tests, wheel (12 minutes at most)
#   make test ROOM=pendant/walls   one room in some seconds: lint, its tests, what rooms may use
#   make test-full   the same, and whole: nothing left out that has passed before, every product, every size of the window
#   make e2e-full    every browser test at every size of the window; make test has one size of what is the same at all
#   make bench       every benchmark, quick sizes (20 minutes at most); make bench-full: full sizes; SEED=1000 is their seed base;
#                    their results are in out/bench; python -m tools.results out/bench takes them over into docs/results
#   make races       page, scripts, network, recorder and laboratory against each other, threads changed every 20 us, for ten minutes;
#                    make races-full: for an hour
#   make soak        the page served for an hour to three clients who do whatever they may; make soak-quick: for ten minutes
#   make mutate      every small change of the pendant's logic that no test notices; 40 minutes on two cores
#   make claims      every claim at twelve seeds, without its switch and with its mutants at three, into out/claims; 40 minutes on two cores
#   make docs        the pages that programs write, into out/docs; docs/results/README.md
#   make site        the documentation as a site with search, gallery and Python interface, into out/site
#   make fuzz        files and messages drawn from their types, and damaged ones, for an hour on all cores (tools/fuzz)
#   make clean       remove what the above made

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Not compiled at once: most of what is installed is never imported, and what is, is compiled then.
INSTALL := -m pip --disable-pip-version-check install --quiet --no-compile
PIP := $(BIN)/python $(INSTALL)
# One more than two cores have: a third of the time, tests wait for a clock.
WORKERS ?= 3
# Tests that only compute: without a clock, a client or a browser.
COMPUTING := tests/pendant tests/app/session \
	$(addprefix tests/sim/,arm compiled control estimation flange motion plant rigid_body sensing)
# Plugins that do something at each of ten thousand tests, and nothing for these.
SPARE := -p no:cov -p no:cacheprovider
# Measured within half a millimetre of what a hand does in a real browser: alone on the machine.
PUSHED := tests/e2e/test_push.py
SEED ?= 1000
BENCHES := $(filter-out __init__ arms common network_clients postures viewer,$(basename $(notdir $(wildcard benchmarks/*.py))))
# Where Python is told to keep no compiled modules, each process of the tests would compile all that it imports.
unexport PYTHONDONTWRITEBYTECODE
# Of what is the same at every size of the window, one.
SIZES ?= -m "not every_size"
BROWSERS := chromium chromium-browser google-chrome google-chrome-stable

.PHONY: run test test-full bench bench-full races races-full soak soak-quick mutate claims docs site fuzz clean lint types contracts kernels wheel browser pictures
.PHONY: paced computing pushed e2e e2e-full

run: $(VENV)/run.stamp
	$(BIN)/pendant serve --open

ifdef ROOM
test: $(VENV)/dev.stamp
	@[ -d tests/$(ROOM) ] || { echo "ROOM=$(ROOM): no tests/$(ROOM); a room is a folder like pendant/walls" >&2; exit 1; }
	$(BIN)/ruff check --quiet $(ROOM) tests/$(ROOM)
	$(BIN)/pytest -q tests/$(ROOM) tests/test_rooms.py
else
# What keeps one core busy goes in pairs: the environment of the wheel is filled while that of the tests is, and a third waits for
# the network. Then what only computes takes the time that others wait for a clock, a client or a browser.
test: | $(BIN)/python
	$(MAKE) --no-print-directory -j3 --output-sync=target wheel kernels browser types lint contracts
	$(MAKE) --no-print-directory -j2 --output-sync=target paced computing
	$(MAKE) --no-print-directory pushed
endif

test-full:
	WHOLE=1 $(MAKE) --no-print-directory test SIZES=

$(BIN)/python:
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) not found: install Python 3.11 or newer" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed, this is $$($(PYTHON) --version); try make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && \
		apt-get update -qq && apt-get install -y -qq --no-install-recommends python3-venv; } || \
		{ echo "This Python cannot make a virtual environment; on Debian or Ubuntu: apt-get install python3-venv" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/run.stamp: pyproject.toml | $(BIN)/python
	$(PIP) --editable '.[network,report]'
	@touch $@

$(VENV)/dev.stamp: pyproject.toml | $(BIN)/python
	$(PIP) --editable '.[dev]'
	@touch $@ $(VENV)/run.stamp

lint: $(VENV)/dev.stamp
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types: $(VENV)/dev.stamp
	$(BIN)/pyright --pythonpath $(BIN)/python

contracts: $(VENV)/dev.stamp
	$(BIN)/lint-imports --no-logo

# A fresh clone compiles its kernels and modules once, and not in each worker and process of the tests.
kernels: $(VENV)/dev.stamp
	$(BIN)/python -c "import app.cli, app.serving; from app.runs.warm_up import warm_up; from pendant_sim import load_arm; \
		warm_up(); warm_up(load_arm('iiwa7'))"

# All tests that are neither `computing` nor `pushed`.
paced: $(VENV)/dev.stamp | pictures browser
	$(BIN)/pytest -q -n $(WORKERS) --dist worksteal $(SPARE) $(addprefix --ignore=,tests/e2e $(COMPUTING)) --durations=10
	$(BIN)/pytest -q $(SIZES) tests/e2e $(addprefix --ignore=,$(PUSHED)) --durations=10

# At the lowest priority: what has a clock to keep does not wait for these.
computing: $(VENV)/dev.stamp
	nice -n 19 $(BIN)/pytest -q -n 2 --dist worksteal $(SPARE) -p no:rerunfailures $(COMPUTING) --durations=10

pushed: $(VENV)/dev.stamp | browser
	$(BIN)/pytest -q $(SIZES) $(PUSHED)

# One at a time: these measure motion against the clock of a real browser.
e2e: $(VENV)/dev.stamp | browser
	$(BIN)/pytest -q $(SIZES) tests/e2e

e2e-full: $(VENV)/dev.stamp | browser
	$(BIN)/pytest -q tests/e2e

# After `pictures`, for one alone may install.
browser: | pictures
	@for name in $(BROWSERS); do command -v $$name >/dev/null && exit 0; done; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ]; then \
		echo "Installing Chromium for the browser tests"; \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium; \
	else \
		echo "The browser tests need Chromium, found none of: $(BROWSERS)." >&2; \
		echo "Debian: sudo apt-get install chromium. Fedora: sudo dnf install chromium. macOS: brew install --cask chromium." >&2; \
		exit 1; \
	fi

# MuJoCo draws the pictures of tests by EGL, without a screen.
pictures: | $(BIN)/python
	@$(BIN)/python -c 'import ctypes; ctypes.CDLL("libEGL.so.1")' 2>/dev/null && exit 0; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ]; then \
		echo "Installing EGL for tests that draw pictures"; \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libegl1 libgl1-mesa-dri; \
	else \
		echo "Tests that draw pictures need EGL. Debian: sudo apt-get install libegl1 libgl1-mesa-dri." >&2; \
		exit 1; \
	fi

# The wheel, alone in an empty environment, in an empty folder: it imports the web app, reads all arms, and prepares all sessions
# that show claims; a command that needs an extra names it. It runs none: that would compile all kernels once more, which takes
# longer than all else here.
wheel: | $(BIN)/python
	@rm -rf build/wheel && mkdir -p build/wheel/empty
	$(PYTHON) -m venv build/wheel/venv
	build/wheel/venv/bin/python -m pip --disable-pip-version-check wheel --quiet --no-deps --wheel-dir build/wheel .
	build/wheel/venv/bin/python $(INSTALL) build/wheel/*.whl
	cd build/wheel/empty && ../venv/bin/pendant robots >/dev/null && \
		../venv/bin/python -c "import app.serving; from app.session.prepare import claiming; assert claiming()" && \
		../venv/bin/pendant sweep sequence-limit 2>&1 | grep -q "pip install 'pendant-sim\[studies\]'"
	@rm -rf build/wheel

# All of them run, even when one misses a bar or the code changes under it; the exit code tells.
bench bench-full: $(VENV)/dev.stamp
	@failed=; for name in $(BENCHES); do \
		$(BIN)/python -m benchmarks.$$name --seed $(SEED) $(if $(filter bench-full,$@),--full) || failed="$$failed $$name"; \
	done; [ -z "$$failed" ] || { echo "missed a bar, or gave no result:$$failed" >&2; exit 1; }

# By itself: nothing may break, whatever happens when.
races races-full: $(VENV)/dev.stamp
	$(BIN)/python -m benchmarks.races --seed $(SEED) $(if $(filter races-full,$@),--full)

# By itself, and with the machine to itself: it measures memory and pace.
soak soak-quick: $(VENV)/dev.stamp
	$(BIN)/python -m benchmarks.soak --seed $(SEED) $(if $(filter soak,$@),--full)

mutate: $(VENV)/dev.stamp
	$(PIP) --editable '.[dev,mutate]'
	WHOLE=1 $(BIN)/mutmut run --max-children $(WORKERS)
	$(BIN)/python -m tools.mutants

claims: $(VENV)/dev.stamp kernels
	$(BIN)/python -m tools.claims --seeds 1-12 --mutants-at 1,2,$$((0x$$(git rev-parse --short=6 HEAD) % 10 + 3)) --out out/claims

# Warnings end it: a link that leads nowhere, a name of the interface that is not found.
site: $(VENV)/dev.stamp docs
	$(BIN)/python -m tools.gallery
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "out/site/index.html"

docs: $(VENV)/dev.stamp
	@for page in modules reactions traceability claims.claims_page results; do $(BIN)/python -m tools.$$page || exit 1; done

fuzz: $(VENV)/dev.stamp
	$(BIN)/python -m tools.fuzz --seconds 3600 --seed $(SEED)

clean:
	rm -rf mutants $(VENV) build dist out .pytest_cache .ruff_cache .hypothesis .import_linter_cache .coverage
