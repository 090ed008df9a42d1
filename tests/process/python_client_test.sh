#!/bin/bash
# The Python client: its parts, its methods against a daemon with stub workers, the examples of docs/python.md, its types, and
# that its classes are those of the job's schema and of the daemon's methods.
. "$(dirname "$0")/farm.sh"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "there is no Python 3.11 or later"; exit 77; }
"$PROJECT_ROOT/python/update" --check "$bin" || fail "python/update --check: see above"
export PYTHONPATH=$PROJECT_ROOT/python:$PROJECT_ROOT/tests/python PYTHONDONTWRITEBYTECODE=1 MYPY_CACHE_DIR=$scratch/mypy
if command -v mypy >/dev/null; then
    (cd "$PROJECT_ROOT/python" && mypy --strict marchd ../tests/python/*.py) || fail "types: see above"
else
    echo "without the check of types: there is no mypy"
fi
for name in wire farm web tls examples; do
    python3 -W error::ResourceWarning "$PROJECT_ROOT/tests/python/${name}_test.py" || fail "$name: see above"
done
