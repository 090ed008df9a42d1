#!/bin/sh
# `march` without a daemon and without a worker: job files, usage, exit codes.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_local_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCHD_SOCKET
cloud=$PROJECT_ROOT/jobs/cloud.json
failures=0

# expect CODE WORDS COMMAND...: checks the exit code, and that stdout or stderr has the words.
expect() {
    code=$1 words=$2
    shift 2
    "$@" >out 2>err </dev/null
    got=$?
    if [ "$got" -ne "$code" ] || ! cat out err | grep -qF -- "$words"; then
        echo "FAILED: $*: expected exit $code and \"$words\", got $got and:"
        cat out err
        failures=$((failures + 1))
    fi
}
# expect_stdout TEXT: checks the whole standard output of the last command.
expect_stdout() {
    [ "$(cat out)" = "$1" ] && return
    echo "FAILED: expected stdout \"$1\", got:"
    cat out
    failures=$((failures + 1))
}

expect 0 "ok, 240 frames of 1920 x 1080" march validate "$cloud"
expect 0 "cloud_seed.json: ok" march validate "$cloud" "$PROJECT_ROOT/jobs/cloud_seed.json"
expect 2 "scene.media[0].phase[0].g: expected a number in [-0.99999, 0.99999], got 1.2" \
    march validate "$cloud" --set 'scene.media[0].phase[0].g=1.2'
expect 2 'did you mean "light_step"' march validate "$cloud" --set 'quality={"method":"midpoint","step":1,"ligth_step":1}'
expect 2 "--set scene.media[4]: the array has 1 element" march validate "$cloud" --set 'scene.media[4].sigma_s=1'
expect 2 "none.json: cannot open: No such file" march validate none.json
expect 2 '"valid":false' march validate --json "$cloud" none.json
printf '{"version": 1,\n "name": x}' >broken.json
expect 2 "broken.json: line 2, column 10" march validate broken.json
printf '{"version": 1}\0' >zero.json
expect 2 "zero.json: " march validate zero.json
head -c 5000000 /dev/zero | tr '\0' ' ' >large.json
expect 2 "large.json: " march validate large.json
if ! march validate - <"$cloud" | grep -qF "standard input: ok"; then
    echo "FAILED: a job on standard input"
    failures=$((failures + 1))
fi

mkdir -p "a#b" # a folder's name is no frame number
cat >"a#b/scan.json" <<END
{"version": 1, "name": "scan", "frames": "1-4", "fps": 24, "resolution": [8, 8], "output": {"path": "s.#.exr"},
 "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "fov": 40}, "quality": {"method": "midpoint", "step_voxels": 1},
 "scene": {"media": [{"density": {"kind": "grid", "file": "scan.##.nii"}, "sigma_a": 1}]}}
END
touch "a#b/scan.01.nii" "a#b/scan.02.nii" "a#b/scan.04.nii"
expect 2 "scan.json: scene.media[0].density.file: $scratch/a#b/scan.03.nii: No such file or directory" march validate "a#b/scan.json"
expect 2 "$scratch/a#b/scan.03.nii: No such file" march submit --dry-run "a#b/scan.json"
touch "a#b/scan.03.nii"
expect 0 "scan.json: ok, 4 frames" march validate "a#b/scan.json"
expect 0 "midpoint, step 1 voxels" march submit --dry-run "a#b/scan.json"
expect 0 "scan.json: ok" march validate "a#b/scan.json" --set 'scene.media[0].density.file=scan.01.nii'
expect 2 "$scratch/a#b/scan.1.nii: No such file" march validate "a#b/scan.json" --set 'scene.media[0].density.file=scan.#.nii'

# A dry run plans where no method is stated.
expect 0 "planned in" march submit --dry-run "$cloud" --set frames=0 --set resolution=[32,18]
stated='quality={"method":"midpoint","step":0.1,"light_step":0.1}'
expect 0 "cloud/cloud.0000.exr to cloud/cloud.0230.exr" march submit --dry-run "$cloud" --set frames=0-239x10 --set "$stated"
expect 0 "files      /srv/a/b.0000.exr" march submit --dry-run "$cloud" --set 'output.path="/srv/a/b.####.exr"' --set "$stated"
expect 0 "1 medium (grid), 0 lights" march submit --dry-run "a#b/scan.json"
expect 0 "reads      $scratch/a#b/scan.##.nii (medium 0)" march submit --dry-run "a#b/scan.json"
cat >glass.json <<END
{"version": 1, "name": "glass", "frames": "1", "fps": 24, "resolution": [8, 8], "output": {"path": "g.#.exr"},
 "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "fov": 40},
 "quality": {"method": "midpoint", "step": 0.1, "light_step": 0.1, "max_depth": 5},
 "scene": {"objects": [
  {"kind": "plane", "point": [0, -1, 0], "material": {"kind": "diffuse", "texture": {"file": "tiles.png", "size": 1}}},
  {"kind": "sphere", "center": [0, 0, 0], "radius": 1, "material": {"kind": "dielectric", "ior": 1.5,
   "interior": {"sigma_a": 1, "density": {"kind": "grid", "file": "a#b/scan.01.nii"}}}}]}}
END
expect 2 "glass.json: scene.objects[0].material.texture.file: $scratch/tiles.png: No such file or directory" march validate glass.json
touch tiles.png
expect 0 "1 medium (grid), 2 objects, 0 lights" march submit --dry-run glass.json
expect 0 "reads      $scratch/tiles.png (texture of object 0)" march submit --dry-run glass.json
expect 0 "reads      $scratch/a#b/scan.01.nii (interior of object 1)" march submit --dry-run glass.json
expect 0 "light step 0.1 m, rays up to depth 5" march submit --dry-run glass.json
expect 0 '"objects":2' march submit --dry-run --json glass.json
sky='{"kind": "point", "intensity": 9, "position": [0, 3, 0]}'
ball='{"density": {"kind": "homogeneous", "bounds": {"kind": "sphere", "radius": 1}}, "sigma_s": 2}'
cat >sky.json <<END
{"version": 1, "name": "sky", "frames": "1", "fps": 24, "resolution": [8, 8], "output": {"path": "s.#.exr"},
 "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "fov": 40}, "lights": [$sky],
 "quality": {"method": "paths", "paths": 4}, "scene": {"scattering": {"orders": "all"}, "media": [$ball]}}
END
expect 0 "light      scatters any number of times" march submit --dry-run sky.json
expect 0 "paths, 4 paths a pixel" march submit --dry-run sky.json
expect 0 '"orders":"all"' march submit --dry-run --json sky.json
expect 0 '"paths":4' march submit --dry-run --json sky.json
expect 0 "light      scatters up to 3 times" march submit --dry-run sky.json --set 'scene.scattering={"orders": 3}'
expect 0 "a grid of 8 cells for scattered light, 256 paths a node" march submit --dry-run sky.json \
    --set 'quality={"method": "equiangular", "points": 4, "scatter_grid": 8}'
expect 0 "64 paths a node, similar media after 2 scatterings, a grid of 32 cells for each light" \
    march submit --dry-run sky.json --set 'quality={"method": "cached", "step": 0.1, "light_grid": 32, "scatter_grid": 8, "paths": 64, "similar_after": 2}'
expect 0 "64 particles a node" march submit --dry-run sky.json \
    --set 'quality={"method": "equiangular", "points": 4, "scatter_grid": 8, "paths": 64, "scatter_from": "lights"}'
floor='{"objects": [{"kind": "plane", "point": [0, -1, 0], "material": {"kind": "diffuse", "albedo": 0.5}}], "scattering": {"orders": "all"}}'
expect 0 "0 media, 1 object, 1 light" march submit --dry-run sky.json --set "scene=$floor"
expect 0 '"media":0,"objects":1' march submit --dry-run --json sky.json --set "scene=$floor"
expect 2 'scenes with objects above order 1, but by "paths" (or without a method)' march submit --dry-run sky.json --set "scene=$floor" \
    --set 'quality={"method": "midpoint", "step": 0.1, "light_step": 0.1, "scatter_grid": 8}'
sed 's/"homogeneous"/"noise", "frequency": 2/' sky.json >noise.json
expect 0 "4 paths a pixel, a grid of 24 cells for each light" march submit --dry-run noise.json --set quality.light_grid=24
expect 0 '"light_grid":24,"paths":4' march submit --dry-run --json noise.json --set quality.light_grid=24
expect 0 '"frames":24' march submit --dry-run --json "$cloud" --set frames=0-239x10 --set "$stated"
expect 2 "priority: expected" march submit --dry-run "$cloud" --set priority=201
expect 2 "--priority: expected an integer in [0, 200]" march submit --dry-run "$cloud" --priority 201

for verb in list workers "show 1" "frames 1" "log 1" "watch 1" "wait 1" "pause 1" "resume 1" "cancel 1" "retry 1" "prio 1 5"; do
    # shellcheck disable=SC2086 # the verb and its operands
    expect 3 "$scratch/none.sock" march $verb --socket "$scratch/none.sock"
done
expect 3 "one of your own with" march submit "$cloud" --socket "$scratch/none.sock"
expect 3 "$scratch/env.sock" env MARCHD_SOCKET="$scratch/env.sock" march list
expect 3 '{"error":' march list --json --socket "$scratch/none.sock"
: >file.sock
expect 3 "file.sock" march list --socket file.sock

expect 2 'unknown verb "sumbit", did you mean "submit"?' march sumbit
expect 2 'unknown verb "sumbit", did you mean "submit"?' march help sumbit
expect 2 '{"error":"unknown option --wiat' march submit --json --wiat "$cloud"
expect 2 '{"error":"expected ID"}' march show --json
expect 2 '{"error":"unknown verb' march sumbit --json
expect 2 "--backend: expected auto, egl, osmesa or software" march render "$cloud" --backend vulkan
expect 2 "unknown option --wiat, did you mean --wait?" march submit --wiat "$cloud"
expect 2 "expected ID" march show
expect 2 'expected a job id such as 7, got "x"' march show x
expect 2 "expected a priority in [0, 200]" march prio 1 201
expect 2 "usage: march VERB" march
expect 0 "Example:" march render --help
expect 0 "march retry 7" march help retry
expect 0 '"name":"submit"' march help --json
expect 0 "march " march version
expect 0 '{"version":"' march version --json

expect 1 "$scratch/none: the worker cannot be started" march render "$cloud" --worker-program "$scratch/none"
expect 1 "march-worker ended with exit status 1" march render "$cloud" --worker-program /bin/false
expect 1 "march-worker ended with exit status 1" march explain "$cloud" --worker-program /bin/false
expect 2 "output.path" march render "$cloud" --out ../cloud.####.exr --worker-program /bin/false
expect 2 "output.path" march render "$cloud" --out cloud.exr --worker-program /bin/false
expect 2 "frames: " march render "$cloud" --frames 1:10 --worker-program /bin/false
expect 2 "none.####.exr: no such files" march preview 'none.####.exr'
expect 2 "expected NAME.png or NAME.mp4" march preview file.sock --out sheet.jpg
expect_stdout ""

[ "$failures" -eq 0 ]
