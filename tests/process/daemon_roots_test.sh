#!/bin/bash
# Jobs may write and read only below the roots of the daemon, whatever links and paths they use.
. "$(dirname "$0")/farm.sh"

first=$scratch/first second=$scratch/second inputs=$scratch/inputs
mkdir -p "$first" "$second" "$inputs/ann" "$scratch/secret"
head -c 512 /dev/zero >"$inputs/ann/v_8x8x8xuint8.raw"
cp "$inputs/ann/v_8x8x8xuint8.raw" "$scratch/secret"
ln -s ann "$inputs/inside"
ln -s ../secret "$inputs/outside"
ln -s ../../secret/v_8x8x8xuint8.raw "$inputs/ann/stolen_8x8x8xuint8.raw"
ln -s "$scratch/secret" "$second/link"

start_daemon --worker-program "$(stub write:5)" --output-root "$first" --output-root "$second" \
    --input-root "$inputs" --input-root /usr/share
expect "the roots it tells" "$(ask daemon.status | jq -c '.result | [.output_root, .output_roots, .input_roots]')" \
    "[\"$first\",[\"$first\",\"$second\"],[\"$inputs\",\"/usr/share\"]]"

# Output: relative paths go below the first root, absolute ones below the root that holds them; others are refused.
relative=$(submit "$(job 1-2 '.output.path = "a/r.####.exr"')")
absolute=$(submit "$(job 1-2 ".output.path = \"$second/b/s.####.exr\"")")
wait_state "$relative" succeeded
wait_state "$absolute" succeeded
expect "files of the first" "$(find "$first" -name '*.exr' | sort | xargs -n1 basename | xargs)" "r.0001.exr r.0002.exr"
expect "files of the second" "$(find "$second" -name '*.exr' | sort | xargs -n1 basename | xargs)" "s.0001.exr s.0002.exr"
expect "where it says they are" "$(field "$absolute" .output)" "$second/b/s.####.exr"
for path in "$scratch/third/x.####.exr" "$second" "/etc/x.####.exr" "${second}x/y.####.exr"; do
    expect_error "$(ask job.submit "{\"document\":$(job 1 ".output.path = \"$path\"")}")" 2 "output.path: expected a path below $first or $second, got"
done
expect_error "$(ask job.submit "{\"document\":$(job 1 ".output.path = \"$second/../secret/x.####.exr\"")}")" -32602 "output.path"
expect_error "$(ask job.submit "{\"document\":$(job 1 ".output.path = \"$second/link/x.####.exr\"")}")" -32602 "symbolic link"
# One file by two paths is one file.
held=$(submit "$(job 5 ".output.path = \"$first/a/r.####.exr\"")" true)
expect_error "$(ask job.submit "{\"document\":$(job 5 '.output.path = "a/r.####.exr"')}")" 3 "job $held"
expect "the files there" "$(ls "$scratch/secret")" v_8x8x8xuint8.raw

# Input: a grid's file and a texture's.
grid() { job 1 ".output.path = \"g$RANDOM/g.####.exr\" | del(.scene.media[0].phase) | .quality = {\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.1} | .scene.media[0].density = {\"kind\": \"grid\", \"file\": \"$1\"}"; }
texture() { job 1 ".output.path = \"t$RANDOM/t.####.exr\" | .quality = {\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.1} | .scene.objects = [{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"texture\": {\"file\": \"$1\", \"size\": 1}}}]"; }
refused() { expect_error "$(ask job.submit "{\"document\":$1}")" "$2" "$3"; }
place='scene.media[0].density.file'
wait_state "$(submit "$(grid "$inputs/ann/v_8x8x8xuint8.raw")")" succeeded
wait_state "$(submit "$(grid "$inputs/inside/v_8x8x8xuint8.raw")")" succeeded
wait_state "$(submit "$(texture "$inputs/ann/wood.png")")" succeeded # whether it is there is its frames' matter
refused "$(grid "$scratch/secret/v_8x8x8xuint8.raw")" 2 "$place: expected a file below $inputs or /usr/share, got \"$scratch/secret"
refused "$(grid "$inputs/../secret/v_8x8x8xuint8.raw")" 2 "$place: expected an absolute path without"
refused "$(grid "$inputs//ann/v_8x8x8xuint8.raw")" 2 "$place: expected an absolute path without"
refused "$(grid "${inputs}2/v_8x8x8xuint8.raw")" 2 "$place: expected a file below"
refused "$(grid "$inputs/outside/v_8x8x8xuint8.raw")" 2 "$place: \"outside\" leads out of $inputs"
refused "$(grid "$inputs/ann/stolen_8x8x8xuint8.raw")" 2 "$place: \"ann/stolen_8x8x8xuint8.raw\" leads out of $inputs"
refused "$(grid "$inputs/outside/smoke.####.nvdb")" 2 "$place: \"outside\" leads out of $inputs"
refused "$(grid "$inputs/none/smoke.####.nvdb")" -32602 "No such file"
refused "$(grid /etc/shadow.raw)" 2 "$place: expected a file below"
refused "$(texture /etc/secret.png)" 2 "scene.objects[0].material.texture.file: expected a file below"
refused "$(texture "$inputs/outside/wood.png")" 2 "scene.objects[0].material.texture.file: \"outside\" leads out of"

# Message and exit code of `march submit`.
grid "$scratch/secret/v_8x8x8xuint8.raw" >"$scratch/job.json"
"$bin/march" submit "$scratch/job.json" --socket "$socket" 2>"$scratch/err" >/dev/null
expect "the exit code" $? 4
grep -qF "job.json: $place: expected a file below $inputs or /usr/share" "$scratch/err" || fail "march says: $(cat "$scratch/err")"
grid "../inputs/inside/../ann/v_8x8x8xuint8.raw" >"$scratch/secret/job.json"
"$bin/march" submit --wait "$scratch/secret/job.json" --socket "$socket" >/dev/null || fail "a way up that stays below a root"
stop_daemon

# A job keeps the root with which it was accepted.
start_daemon --worker-program "$(stub write:5)" --output-root "$scratch/third" --input-root "$inputs"
expect "where the files are" "$(field "$absolute" .output)" "$second/b/s.####.exr"
ask job.retry "{\"id\":$absolute,\"state\":\"succeeded\"}" >/dev/null
wait_state "$absolute" succeeded
stop_daemon
