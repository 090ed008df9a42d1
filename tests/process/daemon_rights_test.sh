#!/bin/bash
# Several users: who may read, who may change, and how one can affect the others. The daemon runs as an ordinary user.
. "$(dirname "$0")/farm.sh"

[ "$(id -u)" = 0 ] || { echo "skip: other users can be played by root only"; exit 77; }
for name in games man mail operator; do
    getent passwd "$name" >"$scratch/entry" || getent group "$name" >"$scratch/entry" || { echo "skip: no $name here"; exit 77; }
done
ann=(5 60)      # games
bob=(6 12)      # man
chief=(7 7,37)  # lp, of the admin group "operator"
service=(8 8)   # mail: the daemon
run_for_others
install -d -o 8 -g 8 "$scratch/state" "$scratch/out" "$scratch/run"
socket=$scratch/run/sock
as_daemon=(setpriv --reuid=8 --regid=8 --clear-groups)

start_daemon --worker-program "$(stub write:20)" --admin-group operator
chmod 666 "$socket"
expect "the daemon's user" "$(stat -c %u "/proc/$daemon_pid")" 8

# submit_as UID GIDS DOCUMENT
submit_as() { ask_as "$1" "$2" job.submit "{\"paused\":true,\"document\":$3}" | jq '.result.id // empty'; }

id=$(submit_as "${ann[@]}" "$(job 1-4 '.output.path = "ann/a.####.exr"')")
expect "its owner" "$(field "$id" '[.owner, .owner_uid] | join(" ")')" "games 5"

# All users may read; only some may change, whatever the method.
for method in pause resume cancel retry; do
    expect_error "$(ask_as "${bob[@]}" "job.$method" "{\"id\":$id}")" 2 "job $id belongs to games"
done
expect_error "$(ask_as "${bob[@]}" job.priority "{\"id\":$id,\"priority\":99}")" 2 "belongs to games"
expect "another's list" "$(ask_as "${bob[@]}" job.list | jq -c '[.result.jobs[] | [.id, .state]]')" "[[$id,\"paused\"]]"
expect "another's frames" "$(ask_as "${bob[@]}" job.frames "{\"id\":$id}" | jq .result.total)" 4
expect "its document, to another" "$(ask_as "${bob[@]}" job.show "{\"id\":$id}" | jq -c '.result | [.name, .document]')" '["cloud",null]'
expect "its document, to its owner" "$(ask_as "${ann[@]}" job.show "{\"id\":$id}" | jq -r .result.document.name)" cloud
expect "its document, to who administers" "$(ask_as "${chief[@]}" job.show "{\"id\":$id}" | jq -r .result.document.name)" cloud
expect "its state and priority" "$(field "$id" '[.state, .priority] | map(tostring) | join(" ")')" "paused 50"

# These may change: the owner, members of the admin group (primary or last of many groups), root, the daemon's own user.
many=$(seq -s, 2000 2200)
for who in "${ann[*]}" "${chief[*]}" "7 37" "7 7,$many,37" "0 0" "${service[*]}"; do
    # shellcheck disable=SC2086 # two words
    expect "the priority that $who sets" "$(ask_as $who job.priority "{\"id\":$id,\"priority\":60}" | jq .result.priority)" 60
done
expect_error "$(ask_as "${ann[@]}" job.priority "{\"id\":$id,\"priority\":101}")" 2 "priority: expected at most 100, got 101"
expect_error "$(ask_as "${ann[@]}" job.submit "{\"document\":$(job 1 '.priority = 150')}")" 2 "expected at most 100, got 150"
expect "a priority for administrators" "$(ask_as "${chief[@]}" job.priority "{\"id\":$id,\"priority\":200}" | jq .result.priority)" 200
grep -q "priority 200, before 60, set by lp" "$scratch/daemon.log" || fail "the log does not say who set the priority"
expect "the priority by the primary group alone" "$(printf '{"jsonrpc":"2.0","id":1,"method":"job.priority","params":{"id":%s,"priority":60}}\n' "$id" |
    setpriv --reuid=7 --regid=37 --clear-groups "$bin/socket-client" "$socket" | jq .result.priority)" 60
expect_error "$(ask_as 7 "7,$many" job.priority "{\"id\":$id,\"priority\":61}")" 2 "belongs to games"
# The farm as a whole is for administrators.
for method in drain undrain reload; do
    expect_error "$(ask_as "${ann[@]}" daemon.$method)" 2 "only root, the daemon's user and group operator may"
done
expect "a drain" "$(ask_as "${chief[@]}" daemon.drain | jq .error)" null
expect "its end" "$(ask_as "${chief[@]}" daemon.undrain | jq .error)" null
grep -q "info: drained by lp: " "$scratch/daemon.log" || fail "the log does not say who drained the farm"
grep -q "info: undrained by lp: " "$scratch/daemon.log" || fail "the log does not say who ended the drain"
# A user in the owner's group is not the owner.
expect_error "$(ask_as 6 60 job.cancel "{\"id\":$id}")" 2 "belongs to games"
# A user without a uid in this namespace.
expect_error "$(ask_as 65534 65534 job.submit "{\"document\":$(job 1)}")" 2 "the job would have no owner"
expect_error "$(ask_as 65534 37 job.cancel "{\"id\":$id}")" 2 "belongs to games"

# Message and exit code of march.
march_as() { as "$1" "$2" "$bin/march" "${@:3}" --socket "$socket" 2>"$scratch/err" >"$scratch/said"; }
march_as "${bob[@]}" cancel "$id"
expect "the exit code of a refusal" $? 4
grep -q "belongs to games" "$scratch/err" || fail "march says: $(cat "$scratch/err")"
march_as "${bob[@]}" retry "$id"
expect "the exit code of a refused retry" $? 4
march_as "${bob[@]}" prio "$id" 3
expect "the exit code of a refused priority" $? 4
march_as "${bob[@]}" delete "$id" --files
expect "the exit code of a refused delete" $? 4
march_as "${bob[@]}" show "$id" || fail "march show: $(cat "$scratch/err")"
march_as "${ann[@]}" resume "$id" || fail "march resume: $(cat "$scratch/err")"
wait_state "$id" succeeded
expect_error "$(ask_as "${bob[@]}" job.retry "{\"id\":$id,\"state\":\"succeeded\"}")" 2 "belongs to games"
# A published file belongs to its owner: no other user may overwrite it.
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 4-9 '.output.path = "ann/a.####.exr" | .output.existing = "overwrite"')}")" \
    2 "output.path: a.0004.exr belongs to job $id of games"

# Files in the output root itself: their worker could write to everybody's folders.
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 1 '.output.path = "mine.####.exr"')}")" 2 "output.path: expected a folder below"
[[ $(ask_as "${chief[@]}" job.submit "{\"document\":$(job 1 '.output.path = "theirs.####.exr"'),\"paused\":true}") == *'"id":'* ]] ||
    fail "an administrator may write there"

# A folder that the daemon may not write, and a file that it may not read: the job names it, others are not affected.
install -d -o 5 -g 60 -m 755 "$scratch/out/private"
expect_error "$(ask_as "${ann[@]}" job.submit "{\"document\":$(job 1 '.output.path = "private/sub/p.####.exr"')}")" -32602 "Permission denied"
locked=$(ask_as "${ann[@]}" job.submit "{\"document\":$(job 1-2 '.output.path = "private/p.####.exr"')}" | jq .result.id)
wait_state "$locked" paused
[[ $(field "$locked" .reason) == "paused: output: "*"Permission denied"* ]] || fail "reason: $(field "$locked" .reason)"
expect "frames that failed" "$(field "$locked" .failed)" 0
chown 8 "$scratch/out/private"
ask_as "${ann[@]}" job.resume "{\"id\":$locked}" >/dev/null
wait_state "$locked" succeeded

# One user's connections are at most 64; root and others still get through, and the user again when some are gone.
holders=()
for _ in $(seq 70); do
    setpriv --reuid=6 --regid=12 --clear-groups "$bin/socket-client" --keep "$socket" </dev/null >>"$scratch/crowd" 2>/dev/null &
    holders+=($!)
done
wait_until "six are refused" eval '[ "$(grep -c "man may have 64" "$scratch/crowd")" = 6 ]'
expect_error "$(ask_as "${bob[@]}" daemon.status)" 2 "connections: man may have 64 at a time"
march_as "${bob[@]}" list
expect "the exit code of one connection too many" $? 4
expect "another's request" "$(ask_as "${ann[@]}" daemon.status | jq 'has("result")')" true
kill "${holders[@]}" 2>/dev/null
wait_until "connections are free again" eval 'ask_as "${bob[@]}" daemon.status | grep -q result'

# Names and messages cannot forge lines of the log, or control a terminal.
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 1 '.name = "a\n<3>forged: line"')}")" -32602 "name: expected 1 to 128 printable"
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 1 '.name = "a\u001b[2Jb"')}")" -32602 "name: expected"
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 1 '.output.path = "x\ny/a.####.exr"')}")" -32602 "output.path"
grep -q "^<3>forged\|^forged" "$scratch/daemon.log" && fail "a forged line: $(grep forged "$scratch/daemon.log")"

# Nor can the output of a worker, which ran code of a user.
stop_daemon
printf '#!/bin/sh\nprintf "a\\033[2Jb\\n12:00:00.000 info: forged\\n" >&2\nexec "%s/stub-worker" --mode crash "$@"\n' "$bin" >"$scratch/loud"
chmod 755 "$scratch/loud"
start_daemon --worker-program "$scratch/loud" --admin-group operator --max-attempts 1 --log-level debug
chmod 666 "$socket"
loud=$(ask_as "${ann[@]}" job.submit "{\"document\":$(job 1 '.output.path = "loud/l.####.exr"')}" | jq .result.id)
wait_state "$loud" failed
said=$(ask job.log "{\"id\":$loud}")
[[ $said == *'a?[2Jb'* ]] || fail "the log: $said"
grep -q "12:00:00.000 info: forged" "$scratch/daemon.log" || fail "the daemon's log should have the worker's words"
grep -q "^12:00:00.000 info: forged" "$scratch/daemon.log" && fail "a forged line"

# The largest requests: the most frames, the deepest JSON, the longest line.
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 0-2147483647)}")" -32602 "frames"
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 0-9999999)}")" -32602 "frames"
expect_error "$(ask_as "${bob[@]}" job.submit "{\"document\":$(job 1 '.resolution = [16384, 16384]')}")" -32602 "resolution: expected at most 67108864 pixels"
line=$(head -c 4194000 /dev/zero | tr '\0' x)
expect_error "$(printf '{"jsonrpc":"2.0","id":1,"method":"job.show","params":{"id":"%s"}}\n' "$line" | as "${bob[@]}" "$bin/socket-client" "$socket")" -32602 "params.id"
expect "the daemon is there" "$(ask daemon.status | jq 'has("result")')" true
stop_daemon

# A file that the daemon's user may not read: the error of the frames names it.
install -d -m 755 "$scratch/in"
head -c 512 /dev/zero >"$scratch/in/v_8x8x8xuint8.raw"
chmod 600 "$scratch/in/v_8x8x8xuint8.raw"
start_daemon --backend software --workers 1 --input-root "$scratch/in"
chmod 666 "$socket"
grid='.output.path = "grid/g.####.exr" | .scene.media = [{density: {kind: "grid", file: $file}, sigma_a: 1}] | .lights = [] | .quality = {method: "midpoint", step_voxels: 0.5}'
locked=$(ask_as "${ann[@]}" job.submit "{\"document\":$(job 1-2 | jq -c --arg file "$scratch/in/v_8x8x8xuint8.raw" "$grid")}" | jq .result.id)
wait_state "$locked" failed
said=$(field "$locked" .reason)$(ask job.frames "{\"id\":$locked}" | jq -r '.result.frames[].error')
[[ $said == *"$scratch/in/v_8x8x8xuint8.raw: "*"Permission denied"* ]] || fail "a file that may not be read: $said"
stop_daemon

# A restart changes no owner.
start_daemon --worker-program "$(stub write:20)" --admin-group operator
chmod 666 "$socket"
expect_error "$(ask_as "${bob[@]}" job.retry "{\"id\":$id,\"state\":\"succeeded\"}")" 2 "belongs to games"
stop_daemon
# An admin group that does not exist: the daemon starts, and the group has no members.
start_daemon --worker-program "$(stub write:20)" --admin-group no-such-group
chmod 666 "$socket"
expect_error "$(ask_as "${chief[@]}" job.retry "{\"id\":$id,\"state\":\"succeeded\"}")" 2 "belongs to games"
stop_daemon
