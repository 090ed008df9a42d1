#!/bin/bash
# Invalid input on the socket: an error that names the member, and no effect on other clients.
. "$(dirname "$0")/farm.sh"

start_daemon --worker-program "$(stub write:5)"
expect "the socket's mode" "$(stat -c %a "$socket")" 660

expect_error "$(ask_raw <<<'{"jsonrpc":"2.0","id":')" -32700 "line 1"
expect_error "$(ask_raw <<<'[1,2]')" -32600 ""
expect_error "$(ask job.sumbit)" -32601 'did you mean "job.submit"'
expect_error "$(ask job.show)" -32602 "params.id"
expect_error "$(ask job.show '{"id":77}')" 1 "job 77"
expect_error "$(ask job.show '{"id":"x"}')" -32602 "params.id: expected"
expect_error "$(ask job.list '{"stat":"queued"}')" -32602 'unknown key "stat", did you mean "state"'
expect_error "$(ask job.submit '{"document":{"version":1}}')" -32602 ""
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.scene.media[0].phase[0].g = 1.2')}")" -32602 "scene.media[0].phase[0].g"
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.resolution = [1e9, 2]')}")" -32602 "resolution"
expect_error "$(ask job.submit "{\"document\":$(job 0-9999999)}")" -32602 "frames"
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.output.path = "../up.####.exr"')}")" -32602 "output.path"
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.output.path = "/etc/up.####.exr"')}")" 2 "output.path: expected a path below $scratch/out"
# The daemon does not know the folder of a job file, so relative paths are refused.
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.scene.media[0].density = {"kind": "grid", "file": "head.nii"} | del(.scene.media[0].phase)')}")" \
    -32602 'scene.media[0].density.file: expected an absolute path, got "head.nii"'
glsl='.scene.media[0].density = {"kind": "glsl", "file": "/a.glsl", "bounds": {"kind": "sphere", "radius": 1}}'
expect_error "$(ask job.submit "{\"document\":$(job 1-2 "$glsl")}")" -32602 "scene.media[0].density.source: expected the text of the file"
floor='.quality = {"method": "midpoint", "step": 0.1, "light_step": 0.1} | .scene.objects = [{"kind": "plane", "point": [0, -1, 0], "material": {"kind": "diffuse", "texture": {"file": "a.png", "size": 1}}}]'
expect_error "$(ask job.submit "{\"document\":$(job 1-2 "$floor")}")" \
    -32602 'scene.objects[0].material.texture.file: expected an absolute path, got "a.png"'
deep=$(printf '%0.s[' $(seq 40))$(printf '%0.s]' $(seq 40))
expect_error "$(ask job.submit "{\"document\":$deep}")" -32700 "deep"
expect_error "$(ask_raw <<<'{"jsonrpc":"2.0","id":1,"method":"job.priority","params":{"id":NaN}}')" -32700 ""

# Several requests in one write, valid after invalid: each is answered.
answers=$(printf '%s\n' '{"jsonrpc":"2.0","id":"a","method":"nothing"}' 'rubbish' '' \
    '{"jsonrpc":"2.0","id":2,"method":"daemon.status"}' | ask_raw)
expect "answers" "$(jq -c '[.id, has("result")]' <<<"$answers" | xargs)" '[a,false] [null,false] [2,true]'

# A link that leads out of the root.
mkdir -p "$scratch/elsewhere"
ln -s "$scratch/elsewhere" "$scratch/out/link"
expect_error "$(ask job.submit "{\"document\":$(job 1-2 '.output.path = "link/x.####.exr"')}")" -32602 "output.path"
expect "files that left the root" "$(ls "$scratch/elsewhere")" ""

# Two jobs that would write one file.
first=$(submit "$(job 1-10)" true)
expect_error "$(ask job.submit "{\"document\":$(job 10-20)}")" 3 "output.path: job $first (\"cloud\") writes cloud.0010.exr too"
second=$(submit "$(job 11-20)" true)
expect "both in one breath" "$(
    line="{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"job.submit\",\"params\":{\"paused\":true,\"document\":$(job 21-30)}}"
    printf '%s\n%s\n' "$line" "$line" | ask_raw | jq -c .error.code | sort | xargs)" "3 null"

over=$(submit "$(job 31)")
wait_state "$over" succeeded
expect "a retry beside a submit of the same file" "$(
    printf '{"jsonrpc":"2.0","id":1,"method":"job.submit","params":{"paused":true,"document":%s}}\n{"jsonrpc":"2.0","id":2,"method":"job.retry","params":{"id":%s,"state":"succeeded"}}\n' \
        "$(job 31)" "$over" | ask_raw | jq -c '[.id, .error.code]' | sort | xargs)" "[1,null] [2,3]"

again=$(submit "$(job 41)" true)
expect "a submit of the same file beside a cancel and a retry" "$(
    printf '{"jsonrpc":"2.0","id":1,"method":"job.cancel","params":{"id":%s}}\n{"jsonrpc":"2.0","id":2,"method":"job.retry","params":{"id":%s,"state":"canceled"}}\n{"jsonrpc":"2.0","id":3,"method":"job.submit","params":{"paused":true,"document":%s}}\n' \
        "$again" "$again" "$(job 41)" | ask_raw | jq -c '[.id, .error.code]' | sort | xargs)" "[1,null] [2,null] [3,3]"

# More submits in one write than are handled at a time.
for n in $(seq 60); do
    printf '{"jsonrpc":"2.0","id":%s,"method":"job.submit","params":{"paused":true,"document":%s}}\n' "$n" "$(job 1 ".output.path = \"many$n/m.####.exr\"")"
done | ask_raw >"$scratch/many"
expect "answers to many submits" "$(jq -c 'has("result")' "$scratch/many" | sort | uniq -c | xargs)" "60 true"

# A connection has at most 64 subscriptions.
yes '{"jsonrpc":"2.0","id":1,"method":"events.subscribe"}' | head -n 100 | ask_raw >"$scratch/subscribed"
expect "subscriptions that are refused" "$(grep -c 'a connection may subscribe 64 times' "$scratch/subscribed")" 36

# Lines without end, incomplete lines, floods.
head -c 104857600 /dev/zero | tr '\0' 'x' | ask_raw >"$scratch/long" 2>/dev/null
expect_error "$(cat "$scratch/long")" -32600 ""
printf '{"jsonrpc":"2.0","id":1,"method":"job.cancel","params":{"id":%s' "$first" | ask_raw >"$scratch/half"
expect "the answer to half a line" "$(cat "$scratch/half")" ""
expect "the job that half a line named" "$(field "$first" .state)" paused
expect "answers to a flood" "$(yes '{"jsonrpc":"2.0","id":1,"method":"daemon.status"}' | head -n 20000 | ask_raw | wc -l)" 20000
# An endless line does not delay other clients.
yes '{"jsonrpc":"2.0","id":1,"method":"daemon.status"}' | ask_raw >/dev/null &
flood=$!
expect "another's request in a flood" "$(ask daemon.status | jq 'has("result")')" true
kill -0 "$flood" || fail "the flood was over"
kill "$flood"
memory=$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\) kB/\1/p' "/proc/$daemon_pid/status")
[ "$memory" -lt 1000000 ] || fail "the daemon holds $memory kB after a long line and a flood"

# Another user may read, but not change.
if [ "$(id -u)" = 0 ]; then
    run_for_others
    chmod 666 "$socket"
    expect_error "$(ask_as 65534 65534 job.cancel "{\"id\":$first}")" 2 "belongs to $(id -un)"
fi
expect "the queue" "$(ask job.list | jq -c '[.result.jobs[].state] | unique')" '["paused","succeeded"]'
stop_daemon
