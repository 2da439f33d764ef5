# make paper : every check of the paper, with pictures, into report/index.html
# make findings : stored evidence of the claims that take long, renewed where its code changed
# make test  : the tests, one process a core; bytecode is kept, which hundreds of processes import
# make test-versions : some of the tests with the lowest versions declared in pyproject.toml;
#              WITH=3.13 RESOLUTION=highest is for another Python (its number, or where it is), and the
#              newest versions
# make lint  : linter, formatter and type checker
# make bench : the benchmarks beside their peers, into benchmarks/results
# make docs  : the documentation, into site/index.html; GALLERY=0 leaves its scripts unexecuted
# make lock  : requirements.lock, the versions with which .venv is set up
# Each first sets up the virtual environment .venv, where that is missing or out of date.

VENV := .venv
BIN  := $(VENV)/bin
GALLERY ?= 1
READY := $(VENV)/.ready

.PHONY: paper findings test test-versions lock lint bench docs clean

paper: $(READY)
	$(BIN)/fronts check --out report --jobs 2

findings: $(READY)
	$(BIN)/fronts check --record --jobs 2

test: $(READY)
	PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
		$(BIN)/python -m pytest -n auto --dist loadfile

WITH       := $(BIN)/python
RESOLUTION := lowest-direct
SOME_TESTS := tests/test_theory_kinetic.py tests/test_theory_certified.py tests/test_safe_pictures.py
OTHER      := build/versions

test-versions: $(READY)
	$(BIN)/uv venv --quiet --clear --python $(WITH) $(OTHER)
	$(BIN)/uv pip install --quiet --python $(OTHER)/bin/python --resolution $(RESOLUTION) \
		--editable ".[certify,networks,tables,completion]" \
		"pytest>=8" "pytest-xdist>=3.5" "hypothesis>=6.100"
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(OTHER)/bin/python -m pytest -q -n auto \
		--dist loadfile $(SOME_TESTS)

lock: $(READY)
	$(BIN)/uv pip compile pyproject.toml --extra certify --extra dev --extra explore --extra cluster \
		--universal --upgrade --python-version 3.11 --strip-extras --no-header --quiet \
		--no-emit-package excitation-fronts --output-file requirements.lock

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(READY)
	$(BIN)/python -m pip install --quiet --editable ".[bench]"
	$(BIN)/fronts bench

docs: $(READY)
	$(BIN)/python -c 'import sphinx_gallery, numpydoc, myst_parser, pydata_sphinx_theme, joblib' 2>/dev/null \
		|| $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[docs]"
	rm -rf site docs/generated
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m sphinx -b html -d build/doctrees \
		-D plot_gallery=$(GALLERY) --fail-on-warning --keep-going --quiet docs site
	$(BIN)/python docs/check_site.py site

$(READY): pyproject.toml bootstrap.sh requirements.lock
	@sh bootstrap.sh $(VENV)
	@touch $@

clean:
	rm -rf $(VENV) report site docs/generated build *.egg-info
