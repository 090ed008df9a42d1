#!/bin/sh
# `march chart`: what it measures, writes and refuses, and how it continues a chart.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_chart_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
jobs=$PROJECT_ROOT/jobs
. "$PROJECT_ROOT/tests/process/march.sh"

chart() {
    job=$1
    shift
    march chart "$job" --backend software --size 16x9 --quick "$@"
}

expect 0 chart "$jobs/cloud.json" --frame 48 --out cloud --methods riemann:2,midpoint:1,midpoint:3,equiangular:2
[ "$(ls cloud)" = "cloud.csv
cloud.svg
cloud.truth
cloud_error.png" ] || fail "the chart's files: $(ls cloud)"
[ "$(wc -l <cloud/cloud.csv)" -eq 5 ] || fail "a line a point below one of titles"
grep -q '^cloud,[0-9a-f]*,48,16,9,\(osmesa\|egl\),.*,riemann,2,"{""method"":""riemann"".*,measured,.*,wall,.*,reference,' \
    cloud/cloud.csv || fail "a measured point"
grep -q ',equiangular,2,.*,refused,.*homogeneous' cloud/cloud.csv || fail "a refused point has its reason"
grep -q '</svg>' cloud/cloud.svg || fail "a picture"
[ "$(head -c 4 cloud/cloud_error.png | tail -c 3)" = PNG ] || fail "a picture of the errors"
grep -q '^midpoint  *[0-9.]* ' out || fail "a table of times"

# Finer settings are more exact, and riemann is worse than midpoint.
error_of() { awk -F'measured,' -v series=",$1," 'index($0, series) { split($2, a, ","); print a[4] }' cloud/cloud.csv; }
awk -v coarse="$(error_of midpoint,1)" -v fine="$(error_of midpoint,3)" -v plain="$(error_of riemann,2)" \
    'BEGIN { exit !(fine > 0 && fine < coarse / 4 && plain > fine && coarse < 1) }' ||
    fail "errors: midpoint $(error_of midpoint,1), $(error_of midpoint,3), riemann $(error_of riemann,2)"

# A series that would coincide with another is left out with a reason.
expect 0 chart "$jobs/cloud.json" --frame 48 --out same --methods preintegrated:2,"cached baked:2","cached:2"
grep -q ',preintegrated,2,.*,refused,.*here it is the same program as midpoint' same/cloud.csv || fail "preintegrated"
grep -q ',cached baked,2,.*,refused,.*here it is the same program as cached' same/cloud.csv || fail "cached baked"
grep -q ',cached,2,.*,measured,' same/cloud.csv || fail "cached itself"

# The planner's choice for the job's tolerance is a point and a star.
expect 0 chart "$jobs/cloud.json" --frame 48 --out planned --methods auto,midpoint:2 --set quality='{"tolerance":0.05}'
grep -q ',auto,0,.*,measured,' planned/cloud.csv || fail "the planner's choice is measured"
grep -q 'class="star"' planned/cloud.svg || fail "the planner's choice is drawn"
grep -q 'tolerance 5 %' planned/cloud.svg || fail "the tolerance is drawn"

# A plan states what a job may state: where nothing scatters light, equiangular has no step towards it.
expect 0 chart "$jobs/glass.json" --frame 48 --out surfaces --methods auto
grep -q ',auto,0,.*equiangular.*,measured,' surfaces/glass.csv || fail "a plan without a light_step"

# Existing points are not measured again; new ones are added.
before=$(grep measured cloud/cloud.csv)
expect 0 chart "$jobs/cloud.json" --frame 48 --out cloud --methods riemann:2,midpoint:1,midpoint:2,midpoint:3
[ "$(grep measured cloud/cloud.csv | grep -v ',midpoint,2,')" = "$before" ] || fail "points are measured once"
grep -q ',midpoint,2,.*,measured,' cloud/cloud.csv || fail "a new point"
grep -q '^midpoint  *2 ' err || fail "a new point is told"
! grep -q '^midpoint  *[13] ' err || fail "an old point is not told"

expect 2 chart "$jobs/cloud.json" --frame 49 --out cloud --methods midpoint:1
grep -q "another scene, frame, size or backend" err || fail "points of another frame"
expect 0 chart "$jobs/cloud.json" --frame 48 --out cloud --methods midpoint:1 --json
grep -q '"name":"cloud","frame":48,"width_px":16,' out || fail "facts in JSON"
grep -q '"times":\[{"series":"riemann","seconds":\[' out || fail "times in JSON"
[ "$(wc -l <out)" -eq 1 ] || fail "JSON is one line"

# The reference has no GLSL densities: the finest march is the truth.
expect 0 chart "$jobs/custom.json" --out custom --methods midpoint:1,midpoint:2
[ "$(grep -c ',measured,.*,midpoint,144,' custom/custom.csv)" -eq 2 ] || fail "the truth of GLSL is named"
grep -q "finest midpoint march" custom/custom.svg || fail "the picture names the truth of GLSL"

# A missing camera.clip for riemann is set from the extent of the media; riemann cannot render scenes with objects.
expect 0 chart "$jobs/fog.json" --out fog --methods riemann:2
grep -q ',riemann,2,.*,measured,' fog/fog.csv || fail "riemann in a job without camera.clip"
expect 0 chart "$jobs/glass.json" --out glass --methods riemann:2,equiangular:0 --set quality.samples=1
grep -q ',riemann,2,.*,refused,' glass/glass.csv || fail "riemann among objects"
grep -q ',equiangular,0,.*,measured,' glass/glass.csv || fail "equiangular among objects"

# Above order 1, paths and grids are compared with the same random truth, whose noise counts nothing.
cat >ball.json <<'EOF'
{"version": 1, "name": "ball", "frames": "0", "fps": 24, "resolution": [16, 9],
 "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "fov": 40},
 "lights": [{"kind": "point", "position": [2, 3, 4], "intensity": 40}],
 "scene": {"scattering": {"orders": "all"},
           "media": [{"sigma_s": 4, "sigma_a": 0.2, "density": {"kind": "homogeneous",
                      "bounds": {"kind": "sphere", "center": [0, 0, 0], "radius": 1}}}]},
 "quality": {"tolerance": 0.05}, "output": {"path": "ball.####.exr"}}
EOF
expect 0 chart ball.json --out orders --methods "midpoint:2,paths:1,paths:4,scatter grid:0"
of_orders() { awk -F'measured,' -v series=",$1," 'index($0, series) { split($2, a, ","); print a[4] }' orders/ball.csv; }
awk -v few="$(of_orders paths,1)" -v many="$(of_orders paths,4)" -v grid="$(of_orders "scatter grid,0")" \
    'BEGIN { exit !(many > 0 && many < few / 4 && few < 1 && grid > 0 && grid < 0.1) }' ||
    fail "errors: paths $(of_orders paths,1), $(of_orders paths,4), grid $(of_orders "scatter grid,0")"
grep -q ',midpoint,2,.*,refused,.*scatter_grid' orders/ball.csv || fail "a march without a grid above order 1"

expect 2 chart "$jobs/cloud.json" --methods magic
grep -q 'there is no method "magic"' err || fail "an unknown method"
expect 2 chart "$jobs/cloud.json" --size 0x9
expect 2 chart "$jobs/cloud.json" --size 16x9x
grep -q -- "--size: expected WIDTHxHEIGHT" err || fail "a wrong size"
expect 2 chart "$jobs/cloud.json" --frame 240
grep -q "a frame of the job" err || fail "a frame that the job has not"
expect 2 chart "$jobs/cloud.json" --out "$jobs/cloud.json"
expect 2 march chart
[ ! -e cloud.csv ] || fail "a chart that was refused leaves no file"

# An interrupted chart ends with 130 and keeps its points.
march chart "$jobs/cloud.json" --backend software --size 32x18 --frame 48 --out stopped >out 2>err &
pid=$!
until [ -s stopped/cloud.csv ] || ! kill -0 "$pid"; do sleep 0.05; done
kill -TERM "$pid"
wait "$pid"
[ $? -eq 130 ] || fail "an interrupted chart ends with 130"

[ "$failures" -eq 0 ]
