PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: install demo up test test-data test-live test-containers check bench bench-maps bench-recognition picture schemas clean
.DEFAULT_GOAL := demo

install: $(STAMP)  ## make .venv with everything

$(STAMP): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit("actum needs Python 3.11 or newer: make PYTHON=python3.12 …" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@

demo: $(STAMP)  ## the paper's experiment with a simulated actor, through live processes
	$(BIN)/actum demo

up: $(STAMP)  ## router and all services, until Ctrl-C
	$(BIN)/actum up

test: check  ## static checks, then every test but the long ones
	$(BIN)/pytest -n 2 --dist worksteal

test-data: $(STAMP)  ## only the tests on real recordings; fails without ACTUM_DATA
	@test -d "$$ACTUM_DATA" || { echo "test-data needs ACTUM_DATA: the folder that holds msr_action3d/ and utkinect/" >&2; exit 1; }
	$(BIN)/pytest -m data

test-live: $(STAMP)  ## all MSR test recordings through live processes
	@test -d "$$ACTUM_DATA" || { echo "test-live needs ACTUM_DATA: the folder that holds msr_action3d/" >&2; exit 1; }
	$(BIN)/pytest -m live

test-containers: $(STAMP)  ## build and run the compose file; needs a container engine
	$(BIN)/pytest -m containers -s

check: $(STAMP)  ## format, lint, types, layers
	$(BIN)/ruff format --check --quiet .
	$(BIN)/ruff check --quiet .
	$(BIN)/mypy --no-error-summary
	$(BIN)/lint-imports --no-cache > /dev/null || $(BIN)/lint-imports

bench: $(STAMP)  ## latency beside a bare Zenoh chain, and throughput
	$(BIN)/python benchmarks/latency.py

bench-maps: $(STAMP)  ## the map library beside MiniSom
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python benchmarks/som.py

bench-recognition: $(STAMP)  ## the recogniser beside its peers on public recordings, about ten minutes
	@test -d "$$ACTUM_DATA" || { echo "bench-recognition needs ACTUM_DATA: the folder that holds msr_action3d/ and utkinect/" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python -m benchmarks.recognition

picture: $(STAMP)  ## the README's pictures
	$(BIN)/python docs/picture.py docs/scene.png
	folder=$$(mktemp -d) && $(BIN)/actum simulate $$folder/learnt.mcap && $(BIN)/actum train $$folder/learnt.mcap -o $$folder/model.npz \
	  && $(BIN)/actum simulate $$folder/seen.mcap --actor 24 --seed 3 --repetitions 2 \
	  && $(BIN)/actum inspect $$folder/model.npz $$folder/seen.mcap -o $$folder && cp $$folder/time-lift.png docs/time.png && rm -r $$folder

schemas: $(STAMP)  ## write the JSON Schemas anew
	$(BIN)/python -m actum.schemas

clean:
	rm -rf $(VENV)
