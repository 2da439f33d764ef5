#!/bin/sh
# Make a virtual environment in $1 and install the project into it.
# What the machine lacks is named in one sentence.
set -eu
venv=${1:-.venv}

python=
for candidate in ${PYTHON:-} python3 python3.14 python3.13 python3.12 python3.11; do
    if command -v "$candidate" >/dev/null 2>&1 &&
        "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
        python=$candidate
        break
    fi
done
if [ -z "$python" ]; then
    found=$(python3 --version 2>&1 || true)
    echo "Python 3.11 or later is needed and was not found (python3 says: ${found:-nothing}); install it, or name it as in: make paper PYTHON=/path/to/python3.12" >&2
    exit 2
fi
if ! "$python" -c 'import venv, ensurepip' 2>/dev/null; then
    echo "The venv module of $("$python" --version 2>&1) is missing; on Debian and Ubuntu install it with: apt-get install python3-venv" >&2
    exit 2
fi

echo "Setting up $venv with $("$python" --version 2>&1) ..."
[ -x "$venv/bin/python" ] || "$python" -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --constraint requirements.lock --editable ".[certify,dev]" || {
    echo "Installing the packages named in pyproject.toml failed; the lines above say which one (a network connection is needed the first time)." >&2
    exit 2
}
