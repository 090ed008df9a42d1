#!/bin/bash
# Frames of which some pixels are interpolated: their share of traced pixels is in their files and in what commands say of them.
. "$(dirname "$0")/farm.sh"
cd "$scratch" || exit 1
sparse='.quality.pixels = {"threshold": 0.05} | .resolution = [96, 54]'

# shares FILTER: a share of each frame of the JSON text, in one line.
shares()
{
    jq -c "[.frames[].traced] | $1"
}

# march render: the file, and the file that is found there.
job 47-48 "$sparse" | jq '.output.path = "here/c.####.exr"' >here.json
"$bin/march" render here.json --backend software >said 2>complaints || fail "$(cat complaints)"
grep -qE '^here/c.0047.exr  rendered .* s  encoded .* s  traced [0-9]+(\.[0-9]+)? %$' said || fail "what march render says: $(cat said)"
"$bin/march" render here.json --backend software --json >found || fail "march render --json"
expect "frames that were found" "$(jq -r '[.frames[].state] | unique[]' found)" skipped
expect "shares" "$(shares 'all(0 < . and . < 1)' <found)" true
"$bin/march" verify here.json --json >verified || fail "$(cat verified)"
expect "shares of the files" "$(jq -c '[.files[].traced]' verified)" "$(shares . <found)"
"$bin/march" preview here/c.0047.exr here/c.0048.exr --out sheet.png >said || fail "march preview"
expect "the sheet's first bytes" "$(head -c 4 sheet.png | od -An -tx1 | xargs)" "89 50 4e 47"
# Without the setting nothing is said.
jq 'del(.quality.pixels) | .output.path = "whole/c.####.exr"' here.json >whole.json
"$bin/march" render whole.json --backend software --json >unasked || fail "march render of all pixels"
expect "shares of whole frames" "$(shares . <unasked)" "[null,null]"

# The daemon: frames that are rendered, read from the store by the next daemon, and found by another job.
start_daemon --backend software
id=$(submit "$(job 47-48 "$sparse")")
wait_state "$id" succeeded
expect "shares in the daemon" "$(ask job.frames "{\"id\":$id}" | jq .result | shares .)" "$(shares . <found)"
row=$("$bin/march" frames "$id" --socket "$socket" | tr -s ' ' | sed -n 2p)
[[ $row == *" - - $(printf '%.3g' "$(shares '100 * .[0]' <found)") $scratch/out/cloud/"* ]] || fail "the row of march frames: $row"
stop_daemon
start_daemon --backend software
expect "shares after a restart" "$(ask job.frames "{\"id\":$id}" | jq .result | shares .)" "$(shares . <found)"
again=$(submit "$(job 47-48 "$sparse")")
wait_state "$again" succeeded
expect "frames found" "$(field "$again" .skipped)" 2
expect "shares of frames found" "$(ask job.frames "{\"id\":$again}" | jq .result | shares .)" "$(shares . <found)"
stop_daemon
