#!/bin/sh
# A long sequence of scans, a file a frame: the worker's memory is that of the volumes it keeps, without growing holes
# in its heap.
set -u
grep -q __asan_init "$PROGRAM_FOLDER/march-worker" && { echo "sanitizers keep what is freed: not measured"; exit 77; }
scratch=$(mktemp -d "${TMPDIR:-/tmp}/worker_memory_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"

# The files have 16 MB each, and no two are alike; the worker keeps 16 of them.
for frame in $(seq 10 89); do
    printf '\%o\1' "$frame" >"s${frame}_200x200x200xuint16.raw"
    truncate -s 16000000 "s${frame}_200x200x200xuint16.raw"
done
cat >job.json <<'JSON'
{ "version": 1, "name": "scans", "frames": "10-89", "fps": 24, "resolution": [16, 9],
  "camera": { "position": [0, 0, 4], "target": [0, 0, 0], "fov": 30 },
  "scene": { "media": [ { "density": { "kind": "grid", "file": "s##_200x200x200xuint16.raw" }, "emission": 1 } ] },
  "quality": { "method": "midpoint", "step_voxels": 20 },
  "output": { "path": "scans.####.exr", "pixel": "half" } }
JSON
"$PROGRAM_FOLDER/march" render job.json --backend software >out 2>err </dev/null &
march=$!
peak=0
while kill -0 "$march" 2>/dev/null; do
    worker=$(cat "/proc/$march/task/$march/children" 2>/dev/null | tr -d ' ')
    now=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\) kB/\1/p' "/proc/${worker:-none}/status" 2>/dev/null)
    [ -z "$now" ] || peak=$now
    sleep 0.1
done
wait "$march" || fail "march render ended with $?"
[ "$(ls scans.*.exr | wc -l)" -eq 80 ] || fail "expected 80 frames"
echo "the worker held $((peak / 1024)) MiB at most"
# The limit is 16 volumes of 15.3 MiB, and a worker without volumes: near 80 MiB, less than 160.
[ "$peak" -gt 50000 ] || fail "the worker's memory was not seen"
[ "$peak" -lt 420000 ] || fail "expected less than 410 MiB"
exit $((failures > 0))
