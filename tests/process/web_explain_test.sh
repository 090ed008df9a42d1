#!/bin/bash
# What march explain says of a job, over HTTP: to whom, of which files, and what is said of a job that cannot be explained.
. "$(dirname "$0")/farm.sh"
. "$(dirname "$0")/web.sh"

run_for_others
cp "$PROGRAM_FOLDER/march-web" "$scratch/bin"
mkdir -m 777 "$scratch/cache"
mkdir "$scratch/in" "$scratch/in/mine" "$scratch/elsewhere"
head -c 512 /dev/zero >"$scratch/in/mine/v.raw"
cp "$scratch/in/mine/v.raw" "$scratch/elsewhere/v.raw"
: >"$scratch/starts"
chmod 666 "$scratch/starts"
printf '#!/bin/sh\necho "$*" >>%s\nexec %s/march-worker "$@"\n' "$scratch/starts" "$bin" >"$scratch/worker"
chmod 755 "$scratch/worker"
starts() { wc -l <"$scratch/starts"; }
said() { jq -r "$1" "$scratch/body"; }
start_daemon --worker-program "$(stub write:5)" --input-root "$scratch/in"
token=$(token read)
start_web --cache-dir "$scratch/cache/web" --worker-program "$scratch/worker"

# It says what march explain says of the same document.
id=$(submit "$(job 0-3)" true)
ask job.show "{\"id\":$id}" | jq -c .result.document >"$scratch/job.json"
"$bin/march" explain --json "$scratch/job.json" >"$scratch/told" || fail "march explain"
expect_get 200 "/job/$id/explain"
expect "its type" "$(head_of content-type)" application/json
expect "what it says" "$(said '[.counted, .modelled, .not_modelled, .shader_hash]' | md5sum)" \
    "$(jq -r '[.counted, .modelled, .not_modelled, .shader_hash]' "$scratch/told" | md5sum)"
expect "how its worker is started" "$(grep -c -- '--backend none --fenced --memory' "$scratch/starts")" 1
expect "whether it names light that is seen" "$(said '[.modelled[].feature] | index("light 0") != null')" true
before=$(starts)
expect_get 200 "/job/$id/explain"
expect "a known one" "$(get "/job/$id/explain" "If-None-Match: $(head_of etag)")$(wc -c <"$scratch/body")" 3040
expect "workers for what was explained before" "$(starts)" "$before"

# Files of the job are read below the input roots alone.
volume='.quality = {"method": "midpoint", "step": 0.1, "light_step": 0.1} | .scene.media[0].density =
    {"kind": "grid", "file": $file, "size": [8, 8, 8], "type": "uint8", "scale": 0.01, "spacing": [0.1, 0.1, 0.1]}'
with_file() { submit "$(job 0-3 ".output.path = \"$1/x.####.exr\" | ${volume/\$file/\"$2\"}")" true; }
grid=$(with_file grid "$scratch/in/mine/v.raw")
expect_get 200 "/job/$grid/explain"
said '.modelled[] | select(.feature == "medium 0: voxels") | .why' | grep -q "^8 x 8 x 8, from" || fail "no voxels: $(cat "$scratch/body")"
rm "$scratch/in/mine/v.raw"
expect_get 422 "/job/$grid/explain" "v.raw"
ln -s "$scratch/elsewhere/v.raw" "$scratch/in/mine/v.raw"
before=$(starts)
status=$(get "/job/$grid/explain")
[[ $status = 4?? || $status = 500 ]] || fail "a link out of the root gets $status: $(head -c 300 "$scratch/body")"
expect "workers that were told of the link" "$(starts)" $((before + 1))
rm "$scratch/in/mine/v.raw"
head -c 512 /dev/zero >"$scratch/in/mine/v.raw"
expect_get 200 "/job/$grid/explain"

# A sparse grid is unpacked by a program of its own, inside the same walls.
nanovdb_convert -f "$PROJECT_ROOT/jobs/smoke/smoke.0001.nvdb" "$scratch/in/mine/s.vdb" >"$scratch/converted" 2>&1 ||
    fail "nanovdb_convert: $(cat "$scratch/converted")"
sparse=$(submit "$(job 0-3 '.output.path = "sparse/x.####.exr" | .quality = {"method": "midpoint", "step": 0.1, "light_step": 0.1} |
    .scene.media[0].density = {"kind": "grid", "file": "'"$scratch/in/mine/s.vdb"'"}')" true)
expect_get 200 "/job/$sparse/explain"
said '.modelled[] | select(.feature == "medium 0: voxels") | .why' | grep -q " x .* x " || fail "no voxels: $(cat "$scratch/body")"

# Wrong questions.
expect_get 400 "/job/$id/explain?plan=1" "expected nothing after the question mark"
expect_get 400 "/job/$id/show" "expected /job/JOB/explain"
expect_get 404 "/job/99/explain"
kept=$token token=
expect_get 401 "/job/$id/explain"
token=$kept

# keyed COUNT: a job of a long document, as a light moves along so many keys of 50 bytes or a few less.
keyed()
{
    submit "$(job 0-3 ".output.path = \"keyed$1/x.####.exr\" | .lights = [{\"kind\": \"point\", \"intensity\": 1,
        \"position\": {\"keys\": [range($1) | [., [1.0123456789, 2.0123456789, 4.0123456789]]]}}]")" true
}
long=$(keyed 5000)
longer=$(keyed 9000)
expect_get 200 "/job/$long/explain"
stop_web

# A worker that dies of it, or does not end.
rm -rf "$scratch/cache/web"
printf '#!/bin/sh\nexit 9\n' >"$scratch/dead"
chmod 755 "$scratch/dead"
start_web --cache-dir "$scratch/cache/web" --worker-program "$scratch/dead"
expect_get 500 "/job/$id/explain" "the worker ended with status 9"
stop_web
printf '#!/bin/sh\nexec sleep 100000\n' >"$scratch/slow"
chmod 755 "$scratch/slow"
start_web --cache-dir "$scratch/cache/web" --worker-program "$scratch/slow" --picture-time 1
expect_get 504 "/job/$id/explain" "it took longer than 1 s"
expect_get 504 "/job/$long/explain" "it took longer than 1 s" # nor takes a document that no socket holds
expect_get 413 "/job/$longer/explain" "more than 262144 bytes"
stop_web

# Of another user's job there is no document.
if [ "$(id -u)" = 0 ]; then
    chmod 666 "$socket"
    rm -rf "$scratch/cache/web"
    start_web --cache-dir "$scratch/cache/web" --worker-program "$scratch/worker"
    own=$token
    token=$(ask_as 7 7 token.create '{"scope":"submit","name":"test"}' | jq -er .result.token) || fail "no token: $(ask_as 7 7 token.create '{"scope":"submit","name":"test"}')"
    before=$(starts)
    expect_get 403 "/job/$id/explain" "only its owner and administrators may read a job's document"
    expect "workers for another's job" "$(starts)" "$before"
    theirs=$(ask_as 7 7 job.submit "{\"paused\":true,\"document\":$(job 0-3 '.output.path = "theirs/x.####.exr"')}" | jq -er .result.id) || fail "no job"
    expect_get 200 "/job/$theirs/explain"
    token=$own
    expect_get 403 "/job/$theirs/explain" # a token to read has no rights of an administrator
    token=$(token admin)
    expect_get 200 "/job/$theirs/explain"
    stop_web
fi
stop_daemon
