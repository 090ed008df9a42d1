#!/bin/sh
# What explain says at once, and what it plans.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_explain_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
cloud=$PROJECT_ROOT/jobs/cloud.json
stated='quality={"method":"midpoint","step":0.01,"light_step":0.02}'
. "$PROJECT_ROOT/tests/process/march.sh"

# Nothing is planned, and no GL is needed, until --plan is given.
printf '#!/bin/sh\necho "$@" >arguments\nexec march-worker "$@"\n' >recorder
chmod +x recorder
expect 0 march explain "$cloud" --set 'quality={"tolerance":0.02}' --set 'resolution=[64,36]' --worker-program ./recorder
grep -q -- "--backend none" arguments || fail "explain of a tolerance needs no GL"
grep -q "^  a tolerance of 0.02: its method is planned when frames are rendered" out || fail "explain says what it left out"
grep -q "^  cached, step .*, light_grid .*, samples 1$" out || fail "explain says what a draft takes"
grep -q "^  [0-9.e+]* evaluations of densities a pixel, [0-9.e+]* a frame, [0-9.e+]* for all 240 frames, at most$" out ||
    fail "explain counts"
grep -q "^  evaluations for one sample, by method, .*: cached [0-9.e+]*, .*midpoint [0-9.e+]*" out || fail "methods are compared"
grep -q "^Modelled$" out || fail "explain lists features"
! grep -q "^Plan for" out || fail "explain plans without --plan"
expect 0 march explain "$cloud" --set 'quality={"tolerance":0.02}' --json
grep -q '^{"counted":{"frames":240,"pixels":2073600,"evaluations":[0-9.]*,"quality":{"method":"cached",' out || fail "counted"
! grep -q '"plan":' out || fail "a plan without --plan"
expect 0 march explain "$cloud" --set "$stated" --json
! grep -q '"counted":{[^}]*"quality"' out || fail "a stated method is not replaced"
expect 0 march explain "$cloud" --set 'quality={"tolerance":0.1}' --set frames=48-60 --set 'resolution=[64,36]' --plan
sed -n 1p out | grep -q "^Counted, not measured$" || fail "--plan begins with what is counted"
grep -q "^Plan for a tolerance of 0.1$" out || fail "--plan plans"
expect 0 march explain "$cloud" --set 'quality={"tolerance":0.1}' --set frames=48-60 --set 'resolution=[64,36]' --plan --json
grep -q '"plan":{"tolerance":0.1,' out || fail "--plan --json"
expect 0 march explain "$cloud" --set "$stated" --plan
! grep -q "^Plan for" out || fail "a stated method needs no plan"

[ "$failures" -eq 0 ]
