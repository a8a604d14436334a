PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
RUNS := $(VENV)/.runs
STAMP := $(VENV)/.installed
export OPENBLAS_NUM_THREADS ?= 1
# without its bytecode each of the hundreds of processes that tests start would compile what it imports
unexport PYTHONDONTWRITEBYTECODE
PYTHONS ?= python3.11 python3.12 python3.13

LOCK := $(BIN)/uv pip compile --quiet --no-header --no-annotate --generate-hashes --python-version 3.11 --python-platform linux $(UPGRADE)
LOCKS := deploy/requirements

.PHONY: install demo first-event simulated-model up test test-thorough test-pythons fuzz soak test-browser test-long test-data test-live test-chaos test-containers test-viewers check bench check-speed bench-camera bench-camera-continuous bench-camera-latency bench-continuation bench-continuous bench-growth bench-intent bench-many bench-maps bench-recognition bench-objects bench-page bench-paper bench-ros4hri bench-teaching bench-tracker chaos picture picture-teaching picture-viewer screenshots page-libraries pages docs schemas wheel lock clean
.DEFAULT_GOAL := demo

install: $(STAMP)  ## make .venv with everything

$(RUNS): pyproject.toml hatch_build.py shared/actum/_compiled.c
	@$(PYTHON) -c 'import sys; sys.exit("actum needs Python 3.11 or newer: make PYTHON=python3.12 …" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[actum-command]"
	touch $@

$(STAMP): $(RUNS)
	@echo "everything goes into $(VENV), which takes a minute or more"
	@# PEP 517: without it an older pip warns of how openni is built
	$(BIN)/pip install --quiet --disable-pip-version-check --use-pep517 -e ".[dev]"
	@$(BIN)/pip install --quiet --disable-pip-version-check -e ".[camera]" \
	  || echo "MediaPipe cannot be installed here: without it there is no source camera, and its tests are skipped" >&2
	@# MediaPipe's OpenCV has windows and needs libGL; it shares its files with the one that has none and needs nothing.
	$(BIN)/pip uninstall --quiet --yes opencv-contrib-python
	$(BIN)/pip install --quiet --disable-pip-version-check --force-reinstall --no-deps opencv-python-headless
	touch $@

demo: $(RUNS)  ## simulated people act in continuous scenes, and live processes find what they do; two minutes
	$(BIN)/actum demo

first-event:  ## seconds from a clone in an empty folder to the first event of the demo, and of the README's Run
	$(PYTHON) benchmarks/first_event.py

up: $(RUNS)  ## router and all services, until Ctrl-C
	$(BIN)/actum up

test: check  ## static checks, then most tests; five minutes on two cores
	$(BIN)/pytest -n 6 --dist worksteal

test-thorough: $(STAMP)  ## the tests of the web page, of benchmarks, and the same as make test in more variations
	$(BIN)/pytest -n 4 --dist worksteal -m "browser or thorough"

test-pythons:  ## install and test with each of PYTHONS that is at hand, each in an environment of its own
	@tested=; for python in $(PYTHONS); do \
	  if ! $$python -c "" 2> /dev/null; then echo "$$python: not at hand"; continue; fi; \
	  $(MAKE) --no-print-directory test PYTHON=$$python VENV=.venvs/$$python || { echo "$$python: failed" >&2; exit 1; }; \
	  tested="$$tested $$python"; \
	done; \
	test -n "$$tested" || { echo "none of these is at hand: $(PYTHONS)" >&2; exit 1; }; \
	echo "passed with:$$tested"

test-data: $(STAMP)  ## only the tests on real recordings; fails without ACTUM_DATA
	@test -d "$$ACTUM_DATA" || { echo "test-data needs ACTUM_DATA: the folder that holds msr_action3d/ and utkinect/" >&2; exit 1; }
	$(BIN)/pytest -m "data or data and (long or thorough)"

test-live: $(STAMP)  ## all MSR test recordings through live processes
	@test -d "$$ACTUM_DATA" || { echo "test-live needs ACTUM_DATA: the folder that holds msr_action3d/" >&2; exit 1; }
	$(BIN)/pytest -m live

test-containers: $(STAMP)  ## build and run the compose file; needs a container engine
	$(BIN)/pytest -m containers -s

test-long: $(STAMP)  ## the tests that take minutes: whole sets, the demo, an installed wheel, teaching in a browser
	$(BIN)/pytest -m long

test-browser: $(STAMP)  ## all tests of the web page in Chromium, which has to be installed
	$(BIN)/pytest -m "browser or browser and long"

test-chaos: $(STAMP)  ## a few services and routers killed, paused and cut off; `make chaos` does it to all
	$(BIN)/pytest -m chaos -s

test-viewers: $(STAMP)  ## what Rerun and Foxglove are sent; installs both, 600 MB
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[dev,view]"
	$(BIN)/pytest -m "thorough or not thorough" tests/actum_command/test_rerun_entries.py tests/actum_command/test_foxglove_messages.py tests/system/test_viewers.py tests/pages/test_viewers_page.py

fuzz: $(STAMP)  ## hostile messages by the hundred thousand to every service, then atheris; twenty minutes
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[fuzz]"
	PYTHONPATH=tests $(BIN)/python -m fuzzing

MINUTES ?= 20
soak: $(STAMP)  ## all services with four people and images for MINUTES=20: memory, losses, latency by the minute
	$(BIN)/python -m benchmarks.soak --minutes $(MINUTES)

check: docs  ## format, lint, types, layers, pages
	$(BIN)/ruff format --check --quiet .
	$(BIN)/ruff check --quiet .
	$(BIN)/mypy --no-error-summary
	$(BIN)/lint-imports --no-cache > /dev/null || $(BIN)/lint-imports

bench: $(STAMP)  ## latency beside a bare Zenoh chain and behind a secured router, memory, and throughput; six minutes
	$(BIN)/python -m benchmarks.latency

COMMIT ?= HEAD
check-speed: $(STAMP)  ## this tree beside COMMIT=HEAD in turns, and what became slower by a tenth; some minutes
	$(BIN)/python -m benchmarks.speed $(COMMIT)

bench-camera: $(STAMP)  ## real people in video clips, beside the same peers, about five minutes
	@test -f "$$ACTUM_POSE_MODEL" || { echo "bench-camera needs ACTUM_POSE_MODEL: the file that actum models fetch gets" >&2; exit 1; }
	@test -d "$$ACTUM_DATA" || { echo "bench-camera needs ACTUM_DATA: the folder that holds florence3d_rgb/" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python -m benchmarks.camera

bench-camera-continuous: $(STAMP)  ## real people in joined clips, found live without marks, about ten minutes
	@test -f "$$ACTUM_POSE_MODEL" || { echo "bench-camera-continuous needs ACTUM_POSE_MODEL: the file that actum models fetch gets" >&2; exit 1; }
	@test -d "$$ACTUM_DATA" || { echo "bench-camera-continuous needs ACTUM_DATA: the folder that holds florence3d_rgb/ and people_video/" >&2; exit 1; }
	$(BIN)/python -m benchmarks.camera.continuous

bench-camera-latency: $(STAMP)  ## from a picture's capture to the event, beside the pose model's own time
	@test -f "$$ACTUM_POSE_MODEL" || { echo "bench-camera-latency needs ACTUM_POSE_MODEL: the file that actum models fetch gets" >&2; exit 1; }
	@test -d "$$ACTUM_DATA" || { echo "bench-camera-latency needs ACTUM_DATA: the folder that holds florence3d_rgb/" >&2; exit 1; }
	$(BIN)/python -m benchmarks.camera_latency

bench-continuation: $(STAMP)  ## how postures go on for a second, beside staying and going on at the same speed; about ten minutes
	@test -d "$$ACTUM_DATA" || { echo "bench-continuation needs ACTUM_DATA: the folder that holds msr_action3d/, utkinect/ and msrc12/" >&2; exit 1; }
	$(BIN)/python -m benchmarks.continuation

bench-continuous: $(STAMP)  ## finding actions that nobody marked, beside peers given the same frames
	@test -d "$$ACTUM_DATA" || { echo "bench-continuous needs ACTUM_DATA: the folder that holds utkinect/ and msrc12/" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python -m benchmarks.continuous

bench-growth: $(STAMP)  ## what training costs with 1,000 to a million segments of 100 actions, about a quarter of an hour
	$(BIN)/python -m benchmarks.growth

bench-intent: $(STAMP)  ## how early contacts of hands with objects are foreseen, beside what is simpler; about ten minutes
	$(BIN)/python -m benchmarks.intent

bench-many: $(STAMP)  ## crowds before five sensors, and shared sensors whose classifiers are killed; about five minutes
	$(BIN)/python -m benchmarks.many

bench-maps: $(STAMP)  ## the map library beside MiniSom
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python -m benchmarks.som

bench-recognition: $(STAMP)  ## the recogniser beside its peers on public recordings, about three quarters of an hour
	@test -d "$$ACTUM_DATA" || { echo "bench-recognition needs ACTUM_DATA: the folder that holds msr_action3d/, utkinect/ and msrc12/" >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[benchmarks]"
	$(BIN)/python -m benchmarks.recognition

bench-objects: $(STAMP)  ## the right object in simulated scenes that are hard to see, about fifteen minutes
	$(BIN)/python -m benchmarks.objects

bench-paper: $(STAMP)  ## preset paper by the paper's own protocols, step by step, and its figures
	@test -d "$$ACTUM_DATA" || { echo "bench-paper needs ACTUM_DATA: the folder that holds gharaee_set1/, msr_action3d/ and utkinect/" >&2; exit 1; }
	$(BIN)/python -m benchmarks.paper

bench-page: $(STAMP)  ## what the page costs with several browsers, some minutes; needs Chromium
	$(BIN)/python -m benchmarks.page_cost

bench-ros4hri: $(STAMP)  ## ROS4HRI: what its topics cost, how rightly postures are told, and answers to bodies that came back, five minutes
	@test -d "$$ACTUM_DATA" || { echo "bench-ros4hri needs ACTUM_DATA: the folder that holds msr_action3d/" >&2; exit 1; }
	$(BIN)/python -m benchmarks.ros4hri

bench-teaching: $(STAMP)  ## whether takes end by themselves on the page of a busy machine, ten times three actions, a quarter of an hour; needs Chromium
	$(BIN)/python -m benchmarks.teaching_on_page

bench-tracker: $(STAMP)  ## what the marker tracker costs for an image and how exact it is, beside OpenCV, about ten minutes
	$(BIN)/python -m benchmarks.tracker

chaos: $(STAMP)  ## 40 times a service or router is killed, paused or cut off, and every answer judged; ten minutes; SEED=1
	$(BIN)/python -m benchmarks.chaos $(if $(SEED),--seed $(SEED))

picture: $(STAMP)  ## the README's pictures
	$(BIN)/python -m docs.picture docs/scene.png
	folder=$$(mktemp -d) && $(BIN)/actum simulate $$folder/learnt.mcap && $(BIN)/actum train $$folder/learnt.mcap -o $$folder/model.npz \
	  && $(BIN)/actum simulate $$folder/seen.mcap --actor 24 --seed 3 --repetitions 2 \
	  && $(BIN)/actum inspect $$folder/model.npz $$folder/seen.mcap -o $$folder && cp $$folder/time-lift.png docs/time.png && rm -r $$folder

screenshots: $(STAMP)  ## the page's pictures, in docs: light, dark and as wide as a phone; needs Chromium
	$(BIN)/python -m docs.screenshots docs

picture-teaching: $(STAMP)  ## the animated picture of teaching on the page; needs Chromium
	$(BIN)/python -m docs.teaching_film docs/teaching.png

page-libraries:  ## the page's JavaScript libraries anew from npm, which has to be installed
	services/web_dashboard/page/vendored/fetch.sh

picture-viewer: $(STAMP)  ## the picture of Rerun; needs a program chromium
	$(BIN)/pip install --quiet --disable-pip-version-check -e ".[view]" "playwright>=1.50,<2"
	$(BIN)/python -m docs.viewer_picture docs/viewer.png

pages: $(STAMP)  ## write what the pages show of the code anew
	$(BIN)/python -m docs.generate

docs: $(STAMP)  ## the pages as a site, in site/index.html; fails on a broken link
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --fresh-env --quiet -c docs . site

simulated-model: $(STAMP)  ## train the model of the simulated scene anew that comes with actum; about a minute
	$(BIN)/python -c 'from actum_command.simulated_model import SIMULATED_MODEL, trained; from actum_model_trainer.progress import silent; trained(silent).save(SIMULATED_MODEL)'

background: $(STAMP)  ## make the background anew that training holds against what was taught; half a minute
	$(BIN)/python -m benchmarks.free_people

schemas: $(STAMP)  ## write the JSON Schemas anew
	$(BIN)/python -m actum.schemas

wheel: $(STAMP)  ## source distribution and wheel, in dist
	$(BIN)/python -m build

lock: $(STAMP)  ## pin what the images install, with hashes; make lock UPGRADE=--upgrade takes newer versions
	$(BIN)/pip install --quiet --disable-pip-version-check uv
	echo 'hatchling>=1.27' | $(LOCK) - -o $(LOCKS)/build.txt
	$(LOCK) pyproject.toml -o $(LOCKS)/service.txt
	$(LOCK) pyproject.toml --extra scene-simulator -o $(LOCKS)/scene_simulator.txt
	$(LOCK) pyproject.toml --extra marker-tracker -o $(LOCKS)/marker_tracker.txt
	$(LOCK) pyproject.toml --extra web-dashboard -o $(LOCKS)/web_dashboard.txt
	$(LOCK) pyproject.toml --extra command-line -o $(LOCKS)/actum_command.txt
	@# MediaPipe asks for the OpenCV with windows, which needs 220 MB of Debian's libraries; the one without does as well.
	echo "opencv-contrib-python; python_version < '3'" > $(LOCKS)/excluded.txt
	for extra in camera realsense openni2; do \
	  $(LOCK) pyproject.toml --extra $$extra --extra sensor-gateway --override $(LOCKS)/excluded.txt -o $(LOCKS)/$$extra.txt || exit; done
	rm $(LOCKS)/excluded.txt

clean:
	rm -rf $(VENV) .venvs site
