# make paper : every check of the paper, with pictures, into report/index.html
# make test  : the tests, one process a core
# Both build their own virtual environment in .venv first. Nothing else is touched.

VENV := .venv
BIN  := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: paper test lint bench clean

paper: $(READY)
	$(BIN)/fronts check --out report --jobs 2

test: $(READY)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --dist loadfile

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(READY)
	$(BIN)/python -m pip install --quiet --editable ".[bench]"
	$(BIN)/fronts bench

$(READY): pyproject.toml bootstrap.sh
	@sh bootstrap.sh $(VENV)
	@touch $@

clean:
	rm -rf $(VENV) report build *.egg-info
