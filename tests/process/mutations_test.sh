#!/bin/bash
# Tests notice every way in which the light could be wrong.
exec "$PROJECT_ROOT/tests/mutations" "$PROGRAM_FOLDER/../tests"
