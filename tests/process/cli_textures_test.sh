#!/bin/sh
# `march` with a texture: a changed file is rendered again, an unreadable one is named with its place.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_textures_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"

# Two neighbouring pixels: both bright, or in two dark colours.
bright=iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAABGdBTUEAAYagMeiWXwAAAAVJREFUeJxjOAFYsVXPAAAABklEQVQGABBvBLEtN2dBAAAAAElFTkSuQmCC
dark=iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAABGdBTUEAAYagMeiWXwAAAAdJREFUeJxjYJCzib9eF8EAAAAISURBVKqYBgAEIQHDciBkTgAAAABJRU5ErkJggg==
image() { echo "$1" | base64 -d >jobs/tiles.png; }

mkdir jobs
cat >jobs/floor.json <<'JOB'
{ "version": 1, "name": "floor", "frames": "0-1", "fps": 24, "resolution": [16, 16],
  "camera": { "position": { "start": [0, 2, 3], "rate": [1, 0, 0] }, "target": [0, 0, 0], "fov": 30 },
  "lights": [ { "kind": "sun", "direction": [0, -1, 0], "intensity": 1 } ],
  "scene": { "objects": [ { "kind": "plane", "point": [0, 0, 0],
    "material": { "kind": "diffuse", "texture": { "file": "tiles.png", "size": 1 } } } ] },
  "quality": { "method": "midpoint", "step": 0.1 },
  "output": { "path": "floor/floor.####.exr" } }
JOB

# The file is found beside the job from any folder.
image "$bright"
expect 0 march validate jobs/floor.json
expect 0 march render jobs/floor.json
[ "$(grep -c 'rendered' out)" -eq 2 ] || fail "two frames"
touch jobs/tiles.png
expect 0 march render jobs/floor.json
[ "$(grep -c 'was there already' out)" -eq 2 ] || fail "frames of the same image are skipped"
cp floor/floor.0000.exr bright.exr
image "$dark"
expect 0 march render jobs/floor.json
[ "$(grep -c 'rendered' out)" -eq 2 ] || fail "an image that changed is shown anew"
cmp -s bright.exr floor/floor.0000.exr && fail "another image is another picture"
expect 0 march render jobs/floor.json
[ "$(grep -c 'was there already' out)" -eq 2 ] || fail "frames of the new image are skipped"

expect 0 march explain jobs/floor.json
grep -E '^ *object 0: texture ' out | grep -qF ' 2 x 1 pixels, decoded from sRGB, filtered linearly, in tiles of 1 x 0.5 m' || fail "the image"
grep -q 'texture/linear.glsl' out || fail "the modules of a texture"
expect 0 march explain jobs/floor.json --set scene.objects[0].material.texture.filter=nearest
grep -q 'texture/linear.glsl' out && fail "nearest needs no interpolation"

# More images than a shader can sample: software GL has 32 units. A grid with its temperature takes four.
smoke=$PROJECT_ROOT/jobs/smoke/smoke.0001.nvdb
jq -c --arg smoke "$smoke" '.scene.objects[0] as $object | .scene.objects = [range(13) | $object] |
    .scene.media = [range(5) | { density: { kind: "grid", file: $smoke, grid: "density" }, sigma_s: 1, sigma_a: 1,
                                 blackbody: { grid: "temperature", kelvin: 560 } }] |
    .quality = { method: "midpoint", step_voxels: 4, light_step_voxels: 8 } | .frames = "0"' jobs/floor.json >jobs/many.json
expect 1 march render jobs/many.json --backend software --out many.####.exr
grep -q 'scene: its textures and grids are 33 images, of which GL here takes 32; expected fewer' err || fail "too many images"

# Files that cannot be read.
image "$bright"
truncate -s 60 jobs/tiles.png
expect 1 march render jobs/floor.json
grep -q 'scene.objects\[0\].material.texture.file: .*tiles.png: PNG: the file ends too soon' err || fail "a short file is told with its place"
rm jobs/tiles.png
expect 2 march validate jobs/floor.json
grep -q 'scene.objects\[0\].material.texture.file: .*tiles.png: ' err || fail "a missing file is told with its place"
[ "$(ls floor)" = "floor.0000.exr
floor.0001.exr" ] || fail "what was rendered stays: $(ls floor)"

[ "$failures" -eq 0 ]
