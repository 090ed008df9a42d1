#!/bin/sh
# Quick looks: drafts in render, verify, submit, list and show.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_draft_test.XXXXXX")
daemon=
finish() {
    [ -z "$daemon" ] || { kill "$daemon" && wait "$daemon"; } 2>/dev/null
    rm -rf "$scratch"
}
trap finish EXIT
cd "$scratch" || exit 1
MARCHD_SOCKET=$scratch/marchd.sock
export MARCHD_SOCKET
unset MARCH_WORKER
cloud=$PROJECT_ROOT/jobs/cloud.json
. "$PROJECT_ROOT/tests/process/march.sh"

# A draft is marked, verified, and never replaces a frame that is none.
render() { march render "$cloud" --set 'resolution=[64,36]' --frames 48 "$@"; }
expect 0 render --draft --out q/quick.####.exr
grep -q "^q/quick.0048.exr  rendered" out || fail "render --draft"
grep -aq "marchd:draft" q/quick.0048.exr || fail "the header says that it is a draft"
grep -aq "a draft: cached takes the fewest evaluations" q/quick.0048.exr || fail "the header says how it was chosen"
expect 0 render --draft --out q/quick.####.exr
grep -q "was there already" out || fail "equal drafts are skipped"
expect 0 march verify q
grep -q "; 1 draft, of no promised accuracy; all well$" out || fail "verify tells of drafts"
expect 0 march verify q --json
grep -q '"drafts":1' out && grep -q '"draft":true' out || fail "verify --json tells of drafts"
expect 1 march verify q --tolerance 0.5
grep -q "expected the frame's measured error" out || fail "a draft keeps no tolerance"
expect 0 march verify "$cloud" --set 'resolution=[64,36]' --set quality=draft --frames 48 --out "q/quick.####.exr"
expect 0 render --set 'quality={"method":"midpoint","step":0.05,"light_step":0.05}' --out q/quick.####.exr
! grep -q "was there already" out || fail "a frame replaces a draft"
! grep -aq "marchd:draft" q/quick.0048.exr || fail "a frame is no draft"
expect 1 render --draft --out q/quick.####.exr
grep -q "no draft, which a draft does not replace" err || fail "a draft does not replace a frame"
expect 0 render --draft --out q/quick.####.exr --set output.existing=overwrite
expect 2 render --draft --plan-of q/quick.0048.exr
grep -q -- '--plan-of: expected no --draft beside it' err || fail "a draft repeats no plan"
expect 2 march render "$cloud" --set quality=quick --frames 48
grep -q 'quality: expected one of "draft", got "quick"' err || fail "the one word is draft"

mkdir pictures
start() {
    marchd --state "$scratch/state" --output-root "$scratch/pictures" --input-root / --workers 1 2>marchd.log &
    daemon=$!
    until march workers >/dev/null 2>&1; do
        kill -0 "$daemon" || { echo "FAILED: no daemon"; cat marchd.log; exit 1; }
        sleep 0.05
    done
}
start
expect 0 march submit "$cloud" --draft --set 'resolution=[64,36]' --set frames=48 --set output.path=d/d.####.exr --wait
grep -aq "marchd:draft" pictures/d/d.0048.exr || fail "submit --draft"
expect 0 march list
grep -q " draft *$" out || fail "list tells of drafts"
expect 0 march list --json
grep -q '"draft":true' out || fail "list --json tells of drafts"
expect 0 march show 1
grep -q "^quality    draft, of no promised accuracy$" out || fail "show tells of drafts"
expect 0 march submit "$cloud" --set 'resolution=[64,36]' --set frames=48 --set output.path=e/e.####.exr --wait \
    --set 'quality={"method":"midpoint","step":0.05,"light_step":0.05}'
expect 0 march show 2 --json
grep -q '"draft":false' out || fail "other jobs are no drafts"
kill "$daemon" && wait "$daemon"
start
expect 0 march show 1 --json
grep -q '"draft":true' out || fail "a draft stays one over a restart"
[ "$failures" -eq 0 ]
