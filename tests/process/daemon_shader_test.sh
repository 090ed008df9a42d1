#!/bin/bash
# A shader that does not compile is a fault of the job: it fails at once, with module and line; other jobs go on.
. "$(dirname "$0")/farm.sh"

cp -r "$PROJECT_ROOT/shaders" "$scratch/shaders"
sed -i 's/return length(p) - density\.radius;/return length(p) - density.diameter;/' "$scratch/shaders/density/fold_fractal.glsl"
line=$(grep -n 'density\.diameter' "$scratch/shaders/density/fold_fractal.glsl" | cut -d: -f1)
[ -n "$line" ] || fail "nothing was broken"

start_daemon --shader-dir "$scratch/shaders" --backend software
id=$(submit "$(job 0-239)")
wait_state "$id" failed
field "$id" .reason | grep -qF "density/fold_fractal.glsl:$line" ||
    fail "expected module and line $line as the reason, got: $(field "$id" .reason)"
expect "frames that failed" "$(field "$id" .failed)" 240
[ "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')" -le 4 ] || fail "a frame was tried again in vain"
expect "files" "$(find "$scratch/out" -name "*.exr" | wc -l)" 0

# When it is fixed, the same workers render the same job.
cp "$PROJECT_ROOT/shaders/density/fold_fractal.glsl" "$scratch/shaders/density/fold_fractal.glsl"
ask job.retry "{\"id\":$id,\"range\":\"48-50\"}" >/dev/null
wait_until "three frames are done" eval '[ "$(field "$id" .succeeded)" = 3 ]'
expect "workers that were lost" "$(ask worker.list | jq '[.result.workers[] | select(.reason != null)] | length')" 0
stop_daemon
