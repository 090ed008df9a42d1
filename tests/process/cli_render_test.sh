#!/bin/sh
# `march` with a worker of its own: render, explain, preview.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_render_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
cloud=$PROJECT_ROOT/jobs/cloud.json
. "$PROJECT_ROOT/tests/process/march.sh"

# One word for the shell.
stated='--set quality={"method":"midpoint","step":0.01,"light_step":0.02}'
render() { march render "$cloud" --set 'resolution=[32,18]' --set 'quality={"method":"midpoint","step":0.05,"light_step":0.05}' "$@"; }

expect 0 render --frames 48-50
[ "$(ls cloud)" = "cloud.0048.exr
cloud.0049.exr
cloud.0050.exr" ] || fail "expected three frames and nothing else, got: $(ls cloud)"
[ "$(grep -c '^cloud/cloud.00[0-9]*.exr  rendered [0-9.]* s  encoded [0-9.]* s$' out)" -eq 3 ] ||
    fail "expected a line a frame"

expect 0 render --frames 48-50
[ "$(grep -c 'was there already' out)" -eq 3 ] || fail "frames that are there are skipped"
expect 0 render --frames 50,51 --json
grep -q '"succeeded":1,"skipped":1,"failed":0' out || fail "counts in JSON"
[ "$(wc -l <out)" -eq 1 ] || fail "JSON is one line"

expect 0 render --frames 7 --out "$scratch/far/away/picture.%03d.exr"
[ -f far/away/picture.007.exr ] || fail "an absolute --out"
expect 0 render --frames 7 --out near.####.exr
[ -f near.0007.exr ] || fail "a relative --out"

mkdir taken taken/cloud.0001.exr
expect 1 render --frames 1,2 --set output.path=taken/cloud.####.exr --set output.existing=overwrite
[ -f taken/cloud.0002.exr ] || fail "the other frames go on when one fails"
[ "$(ls taken | wc -l)" -eq 2 ] || fail "no part file stays: $(ls taken)"

ln -s far link
expect 1 render --frames 1 --out link/cloud.####.exr
grep -q link err || fail "a link on the way is named"

# A killed worker is replaced, and its frames are tried again.
march render "$cloud" $stated --frames 48-50 --set 'resolution=[480,270]' --out killed/k.####.exr >out 2>err &
pid=$!
until ls killed/* >/dev/null 2>&1 || ! kill -0 "$pid"; do sleep 0.05; done
worker=$(cat "/proc/$pid/task/$pid/children")
# shellcheck disable=SC2086 # one child
kill -KILL $worker
wait "$pid" || fail "a killed worker"
grep -q "ended by signal 9" err || fail "a killed worker is told"
[ "$(ls killed)" = "k.0048.exr
k.0049.exr
k.0050.exr" ] || fail "after a killed worker: $(ls killed)"

# After an interrupt no worker and no part file is left.
march render "$cloud" $stated --frames 40-239 --set 'resolution=[480,270]' --out stopped/s.####.exr >out 2>err &
pid=$!
until set -- stopped/*.part; [ -e "$1" ] || ! kill -0 "$pid"; do sleep 0.005; done
worker=$(cat "/proc/$pid/task/$pid/children")
kill -TERM "$pid"
wait "$pid"
[ $? -eq 130 ] || fail "an interrupted render ends with 130"
# shellcheck disable=SC2086 # one child
! kill -0 $worker 2>/dev/null || fail "the worker outlives an interrupted render"
! ls stopped/*.part 2>/dev/null || fail "a part file outlives an interrupted render"

# The picture as it refines: a whole file each time, and not a bit of the frame changes.
sparse='--set quality={"method":"midpoint","step":0.01,"light_step":0.02,"pixels":{"stride":16,"threshold":0.01}}'
for bad in live.jpg none/live.png killed; do
    expect 2 march render "$cloud" $sparse --frames 48 --out bad/b.####.exr --preview "$bad"
    grep -q -- "--preview: " err || fail "--preview $bad: no reason"
done
[ ! -e bad ] || fail "a preview that cannot be written ends the rendering before it starts"
# shellcheck disable=SC2086 # a word each
expect 0 march render "$cloud" $sparse --set 'resolution=[960,540]' --set output.pixel=float --frames 48 --out plain/p.####.exr
# shellcheck disable=SC2086
march render "$cloud" $sparse --set 'resolution=[960,540]' --set output.pixel=float --frames 48 --out shown/p.####.exr \
    --preview shown.png >out 2>err &
pid=$!
until [ -e shown.png ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.01; done
cp shown.png first.png || fail "no picture before the frame's end"
wait "$pid" || fail "render --preview"
[ "$(head -c 4 first.png | tail -c 3)" = PNG ] || fail "the first picture is a PNG"
[ "$(od -An -tx1 -j16 -N8 first.png)" = "$(od -An -tx1 -j16 -N8 shown.png)" ] || fail "pictures differ in size"
! cmp -s first.png shown.png || fail "the picture did not refine"
! ls shown.png.* 2>/dev/null || fail "a preview leaves a file behind"
difference=$(exr-compare plain/p.0048.exr shown/p.0048.exr 2>&1)
[ "$difference" = "0 0" ] || fail "--preview changes the frame: $difference"
# A folder that is gone later costs the preview, and no frame.
mkdir gone
printf '#!/bin/sh\nrm -r gone\nexec march-worker "$@"\n' >remover
chmod +x remover
expect 0 render --frames 3,4 --out kept/k.####.exr --preview gone/live.png --worker-program ./remover
[ "$(grep -c 'warning: preview: .*gone/live.png: ' err)" -eq 1 ] || fail "a preview that fails is a warning"
[ "$(ls kept | wc -l)" -eq 2 ] || fail "a preview that fails costs a frame"

printf '#!/bin/sh\necho "$@" >arguments\nexec march-worker "$@"\n' >recorder
chmod +x recorder
expect 0 march explain "$cloud" --worker-program ./recorder
grep -q -- "--backend none" arguments || fail "explain works where there is no GL"
expect 1 march explain "$cloud" --shader-dir none
grep -q -- "--shader-dir: none: No such file or directory" err || fail "a folder of shaders that is not there is named"
expect 1 march explain "$cloud" --shader-dir "$cloud"
grep -q "Not a directory" err || fail "shaders are in a folder"
expect 0 march explain "$cloud"
grep -q "fold_fractal" out || fail "explain names the density"
grep -q "^Not modelled" out || fail "explain says what is not modelled"
expect 0 march explain "$cloud" --shader
grep -q "void main" out || fail "explain --shader prints GLSL"
expect 0 march explain "$cloud" --json
grep -q '"shader_hash":"' out || fail "explain --json"
expect 0 march explain "$PROJECT_ROOT/jobs/glass.json" --set 'scene.objects[0].point={"start":[0,-1.2,0],"rate":[0,0.1,0]}' \
    --set 'scene.objects[1].material.interior.sigma_a={"start":0,"rate":1}'
grep -q '^  motion of shape_0_center  *it follows objects.point$' out || fail "explain names a plane's key"
awk '/^  medium 0 / { column = index($0, "homogeneous") }
     /^  motion of medium_1_bounds_center/ { exit index($0, "it follows") != column }' out ||
    fail "explain's reasons do not stand in one column"
expect 2 march explain "$cloud" --set lights=7
grep -q "lights: " err || fail "explain names the place"

expect 0 march preview 'cloud/cloud.####.exr' --frames 48-50 --out sheet.png --columns 2 --tile-width 64
[ "$(cat out)" = "$scratch/sheet.png" ] || fail "preview prints the sheet's path"
[ "$(head -c 4 sheet.png | tail -c 3)" = PNG ] || fail "preview makes a PNG"
expect 0 march preview cloud/cloud.0048.exr --out one.png --exposure -1 --json
grep -q '"exposure":-1' out || fail "preview --json tells the exposure"
expect 1 march preview "$cloud" --out no.png
[ ! -e no.png ] || fail "a preview of no picture leaves no file"
expect 0 march preview cloud --out folder.png
# Of a film only the arguments are looked at: an ffmpeg of ours writes them down.
mkdir tools
cat >tools/ffmpeg <<'EOF'
#!/bin/sh
printf '%s\n' "$@" >film.arguments
for film; do :; done
echo film >"$film"
EOF
chmod +x tools/ffmpeg
expect 0 env "PATH=$scratch/tools:$PATH" march preview cloud --frames 48-50 --out tags.mp4
grep -A1 -x -e -framerate film.arguments | grep -qx 24/1 || fail "a film has its sequence's frames a second"
grep -A1 -x -e -colorspace film.arguments | grep -qx bt709 || fail "a film says its colours"
expect 0 env "PATH=$scratch/tools:$PATH" march preview cloud --frames 48-50 --out tags.mp4 --fps 12
grep -A1 -x -e -framerate film.arguments | grep -qx 12 || fail "--fps overrides the sequence's own"
if command -v ffmpeg >/dev/null; then
    expect 0 march preview 'cloud/cloud.####.exr' --frames 48-50 --out film.mp4 --fps 12.5
    ffprobe -v error -select_streams v -of default=nw=1 -show_entries \
        stream=avg_frame_rate,nb_frames,color_range,color_space,color_transfer,color_primaries film.mp4 | sort >film.facts
    printf '%s\n' avg_frame_rate=25/2 color_primaries=bt709 color_range=tv color_space=bt709 \
        color_transfer=iec61966-2-1 nb_frames=3 | cmp -s - film.facts || fail "what ffprobe reads in a film: $(cat film.facts)"
else
    echo "no ffmpeg: no film is made"
    expect 1 march preview 'cloud/cloud.####.exr' --out film.mp4
    grep -q "apt install ffmpeg" err || fail "a missing ffmpeg is named"
fi

# Before a frame of random paths, what it takes is told.
cat >ball.json <<'JOB'
{ "version": 1, "name": "ball", "frames": "0", "fps": 24, "resolution": [16, 12],
  "camera": { "position": [0, 0, 4], "target": [0, 0, 0], "fov": 35 },
  "lights": [ { "kind": "point", "position": [2, 2, 2], "intensity": 20 } ],
  "scene": { "scattering": { "orders": 3 },
    "media": [ { "sigma_s": 1, "density": { "kind": "homogeneous", "bounds": { "kind": "sphere", "radius": 1 } } } ] },
  "quality": { "tolerance": 0.2 },
  "output": { "path": "ball/ball.####.exr" } }
JOB
expect 0 march render ball.json
grep -qE "^planned in [0-9.:]+ s: a frame's rendering takes (about|less than) [0-9.:]+ s here$" err || fail "the time is told: $(cat err)"

[ "$failures" -eq 0 ]
