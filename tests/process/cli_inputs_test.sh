#!/bin/sh
# `march` with jobs that read files: a changed file is rendered again, an unreadable one is named.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_inputs_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"

volume() { head -c 512 /dev/zero | tr '\0' "$1" >jobs/v_8x8x8xuint8.raw; }

mkdir jobs
cat >jobs/grid.json <<'JOB'
{ "version": 1, "name": "grid", "frames": "0-2", "fps": 24, "resolution": [16, 16],
  "camera": { "position": { "start": [0, 0, 3], "rate": [0, 0, 1] }, "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30 },
  "scene": { "media": [ { "density": { "kind": "grid", "file": "v_8x8x8xuint8.raw", "scale": 0.01 }, "sigma_a": 1 } ] },
  "quality": { "method": "midpoint", "step_voxels": 0.5 },
  "output": { "path": "grid/grid.####.exr" } }
JOB

# The file is found beside the job from any folder.
volume A
expect 0 march render jobs/grid.json
[ "$(grep -c 'rendered' out)" -eq 3 ] || fail "three frames"
expect 0 march render jobs/grid.json
[ "$(grep -c 'was there already' out)" -eq 3 ] || fail "frames of the same file are skipped"
touch jobs/v_8x8x8xuint8.raw
expect 0 march render jobs/grid.json
[ "$(grep -c 'was there already' out)" -eq 3 ] || fail "frames of the same contents are skipped"
volume B
expect 0 march render jobs/grid.json
[ "$(grep -c 'rendered' out)" -eq 3 ] || fail "a file that changed is shown anew"
expect 0 march render jobs/grid.json
[ "$(grep -c 'was there already' out)" -eq 3 ] || fail "frames of the new file are skipped"

expect 0 march explain jobs/grid.json
grep -q 'density/grid_linear.glsl' out || fail "the modules of a grid"
grep -q 'transfer/' out && fail "no transfer function, no look-up"
grep -E '^ *medium 0: voxels ' out | grep -qF ' 8 x 8 x 8, from (-0.5, -0.5, -0.5) to (0.5, 0.5, 0.5) m' || fail "where the voxels are"
expect 0 march explain jobs/grid.json --set scene.media[0].density.spacing=[1,2,0.5] --set scene.media[0].density.center=[1,0,0]
grep -qF 'from (-3, -8, -2) to (5, 8, 2) m' out || fail "where the voxels are with a spacing and a center"
expect 0 march explain jobs/grid.json
grep -q 'step 0.0625 m' out || fail "a step in voxels is told in metres"
expect 0 march explain jobs/grid.json --set scene.media[0].density.interpolation=nearest
grep -q 'density/grid_linear.glsl' out && fail "nearest needs no interpolation"
expect 0 march validate jobs/grid.json
[ ! -s err ] || fail "a volume that frames show is no warning"
for verb in validate explain; do
    expect 0 march $verb jobs/grid.json --set 'camera.target=[0,0,9]'
    grep -q "scene.media\[0\]: no frame shows it: the file's volume lies outside" err || fail "$verb: a volume behind the camera"
done
# It moves aside with the camera: the last frame of a sequence shows it.
for n in 0 1 2; do cp jobs/v_8x8x8xuint8.raw jobs/s.${n}_8x8x8xuint8.raw; done
turning='{"keys":[[0,[0,0,9]],[0.08,[0,0,9]],[0.0833,[0,0,0]]]}'
expect 0 march validate jobs/grid.json --set 'scene.media[0].density.file=s.#_8x8x8xuint8.raw' --set "camera.target=$turning"
[ ! -s err ] || fail "a volume that the last frame shows is no warning"
expect 0 march validate jobs/grid.json --set 'scene.media[0].density.file=s.#_8x8x8xuint8.raw' --set 'camera.target=[0,0,9]'
grep -q "neither the first, the middle nor the last frame shows it" err || fail "a sequence behind the camera"

# Files that cannot be read.
head -c 511 /dev/zero >jobs/v_8x8x8xuint8.raw
expect 1 march render jobs/grid.json
grep -q 'scene.media\[0\].density.file: .*v_8x8x8xuint8.raw: ' err || fail "a short file is told with its place"
grep -q ' attempt ' err && fail "a failure is told in the worker's words too"
rm jobs/v_8x8x8xuint8.raw
expect 2 march render jobs/grid.json
grep -q 'scene.media\[0\].density.file: .*v_8x8x8xuint8.raw: ' err || fail "a missing file is told with its place"
expect 2 march explain jobs/grid.json
grep -q 'v_8x8x8xuint8.raw: ' err || fail "explain tells of a missing file"
[ "$(ls grid)" = "grid.0000.exr
grid.0001.exr
grid.0002.exr" ] || fail "what was rendered stays: $(ls grid)"

[ "$failures" -eq 0 ]
