#!/bin/sh
# `march` with a sky from a file: a changed file is rendered again, an unreadable one is named with its place.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_dome_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"

# The pictures of a background alone are skies of one colour, far above 1.
mkdir jobs
cat >sky.json <<'JOB'
{ "version": 1, "name": "sky", "frames": "1", "fps": 24, "resolution": [8, 4], "background": [200, 100, 50],
  "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "fov": 30 },
  "quality": { "method": "midpoint", "step": 0.1 }, "output": { "path": "sky.#.exr", "pixel": "float" } }
JOB
sky() { # COLOUR
    expect 0 march render sky.json --set "background=$1"
    mv sky.1.exr jobs/noon.exr
}

cat >jobs/ball.json <<'JOB'
{ "version": 1, "name": "ball", "frames": "0-1", "fps": 24, "resolution": [16, 16],
  "camera": { "position": { "start": [0, 0, 4], "rate": [1, 0, 0] }, "target": [0, 0, 0], "fov": 40 },
  "lights": [ { "kind": "dome", "file": "noon.exr", "scale": 0.01, "rotate": { "angle": 90 } } ],
  "scene": { "scattering": { "orders": "all" },
    "media": [ { "sigma_s": 2, "density": { "kind": "homogeneous", "bounds": { "kind": "sphere", "radius": 1 } } } ] },
  "quality": { "method": "paths", "paths": 4 },
  "output": { "path": "ball/ball.####.exr" } }
JOB

# The file is found beside the job from any folder.
sky '[200,100,50]'
expect 0 march validate jobs/ball.json
expect 0 march submit --dry-run jobs/ball.json
grep -qF "reads      $scratch/jobs/noon.exr (light 0)" out || fail "a dry run names the sky"
expect 0 march render jobs/ball.json
[ "$(grep -c 'rendered' out)" -eq 2 ] || fail "two frames"
touch jobs/noon.exr
expect 0 march render jobs/ball.json
[ "$(grep -c 'was there already' out)" -eq 2 ] || fail "frames of the same sky are skipped"
cp ball/ball.0000.exr noon.exr
sky '[50,100,200]'
expect 0 march render jobs/ball.json
[ "$(grep -c 'rendered' out)" -eq 2 ] || fail "a sky that changed is shown anew"
cmp -s noon.exr ball/ball.0000.exr && fail "another sky is another picture"

expect 0 march explain jobs/ball.json
grep -E '^ *light 0: image ' out | grep -qF ' 8 x 4 pixels around the scene, filtered linearly' || fail "the image"

# Files that cannot be read.
truncate -s 300 jobs/noon.exr
expect 1 march render jobs/ball.json
grep -q 'lights\[0\].file: .*noon.exr: ' err || fail "a short file is told with its place"
rm jobs/noon.exr
expect 2 march validate jobs/ball.json
grep -q 'lights\[0\].file: .*noon.exr: No such file' err || fail "a missing file is told with its place"
[ "$(ls ball)" = "ball.0000.exr
ball.0001.exr" ] || fail "what was rendered stays: $(ls ball)"

[ "$failures" -eq 0 ]
