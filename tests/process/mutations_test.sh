#!/bin/bash
# The test of the seed's cloud notices every way in which its light could be wrong.
exec "$PROJECT_ROOT/tests/mutations" "$PROGRAM_FOLDER/../tests/worker_cloud_seed_test"
