#!/bin/bash
# One cloud through the farm, as README has it: submitted, rendered by the real worker, measured, published, verified.
. "$(dirname "$0")/farm.sh"
export MARCHD_SOCKET=$socket

start_daemon
jq '.frames = "0-1" | .resolution = [64, 36] | .quality = {"tolerance": 0.02} | .output = {"path": "cloud/c.####.exr"}' \
    "$PROJECT_ROOT/jobs/cloud.json" >"$scratch/cloud.json"
"$bin/march" submit "$scratch/cloud.json" --wait >"$scratch/said" 2>&1 || fail "march submit: $(cat "$scratch/said")"
expect_files cloud 2
"$bin/march" verify "$scratch/cloud.json" --out "$scratch/out/cloud/c.####.exr" >"$scratch/said" 2>&1 || fail "march verify: $(cat "$scratch/said")"
grep -q "all well" "$scratch/said" || fail "march verify says: $(cat "$scratch/said")"
expect "frames without a measured error" "$("$bin/march" frames --json 1 | jq '[.frames[] | select(.measured_error == null)] | length')" 0
stop_daemon
