#!/bin/bash
# Limits of one user: jobs, frames, pixels, bytes of files. The message names them, other users are not affected, no frame is lost.
. "$(dirname "$0")/farm.sh"

[ "$(id -u)" = 0 ] || { echo "skip: other users can be played by root only"; exit 77; }
for name in games man mail; do
    getent passwd "$name" >/dev/null || { echo "skip: no user $name here"; exit 77; }
done
ann=(5 60) bob=(6 12) chief=(7 37)
run_for_others
install -d -o 8 -g 8 "$scratch/state" "$scratch/out" "$scratch/run"
socket=$scratch/run/sock
as_daemon=(setpriv --reuid=8 --regid=8 --clear-groups)

start() { start_daemon --worker-program "$(stub "${worker:-write:20}")" --admin-group operator "$@" && chmod 666 "$socket"; }
# give USER GROUPS NAME RANGE [FILTER] [PAUSED]: submits, prints the answer. NAME is its folder too.
give() { ask_as "$1" "$2" job.submit "{\"paused\":${6:-true},\"document\":$(job "$4" ".name = \"$3\" | .output.path = \"$3/x.####.exr\" | ${5:-.}")}"; }
id_of() { jq '.result.id // empty' <<<"$1"; }

worker=nocontext # a retry lifts the pause of a job that is over: its frames must stay queued
start --user-jobs 3 --user-frames 100 --user-pixels 100000
first=$(id_of "$(give "${ann[@]}" a 1-60)")
expect_error "$(give "${ann[@]}" b 1-41)" 2 "frames: games may have 100 unfinished frames, has 60, and this job adds 41"
second=$(id_of "$(give "${ann[@]}" b 1-40)")
expect_error "$(give "${ann[@]}" c 1)" 2 "frames: games may have 100 unfinished frames, has 100, and this job adds 1"
expect "another's job" "$([ -n "$(id_of "$(give "${bob[@]}" d 1-100)")" ] && echo taken)" taken
expect "an administrator's job" "$([ -n "$(id_of "$(give "${chief[@]}" e 1-500)")" ] && echo taken)" taken
expect "root's job" "$([ -n "$(id_of "$(give 0 0 f 1-500)")" ] && echo taken)" taken
expect "the daemon's own user's job" "$([ -n "$(id_of "$(give 8 8 g 1-500)")" ] && echo taken)" taken

# Canceled and rendered frames do not count; a retry counts again.
ask_as "${ann[@]}" job.cancel "{\"id\":$second}" >/dev/null
third=$(id_of "$(give "${ann[@]}" c 1-40)")
expect_error "$(ask_as "${ann[@]}" job.retry "{\"id\":$second,\"state\":\"canceled\"}")" 2 \
    "frames: games may have 100 unfinished frames, has 100, and this retry adds 40"
expect "a retry of some after a refusal" "$(ask_as "${ann[@]}" job.cancel "{\"id\":$third}" | jq -r .result.state)" canceled
expect "what a retry of all brings back" "$(ask_as "${ann[@]}" job.retry "{\"id\":$second,\"state\":\"canceled\"}" | jq .result.retried)" 40
expect_error "$(ask_as "${ann[@]}" job.retry "{\"id\":$third,\"state\":\"canceled\"}")" 2 "and this retry adds 40"
expect "the refused one" "$(field "$third" .state)" canceled
expect "an administrator's retry" "$(ask_as "${chief[@]}" job.retry "{\"id\":$third,\"state\":\"canceled\"}" | jq .result.retried)" 40
for id in "$second" "$third"; do
    ask_as "${ann[@]}" job.pause "{\"id\":$id}" >/dev/null
done
stop_daemon
worker=write:20
start --user-jobs 3 --user-frames 100 --user-pixels 100000
ask_as "${ann[@]}" job.resume "{\"id\":$first}" >/dev/null
wait_state "$first" succeeded
# 80 are left: 20 fit, which are 80000 - 46080 pixels at most.
expect_error "$(give "${ann[@]}" p 1-20 '.resolution = [64, 48]')" 2 "resolution: games may have 100000 pixels of unfinished frames, has 46080, and this job adds 61440"
fourth=$(id_of "$(give "${ann[@]}" p 1-10 '.resolution = [64, 48]')")
[ -n "$fourth" ] || fail "the pixels fit"
expect_error "$(give "${ann[@]}" q 1 '.resolution = [1, 1]')" 2 "jobs: games may have 3 that are not over, has 3, and this job adds 1"
# The largest pictures and the most frames: no sum overflows.
expect_error "$(give "${bob[@]}" q 0-3999999 '.resolution = [8192, 8192]')" 2 "frames: man may have 100"

# Many submits at once, before the first is on disk.
line() { printf '{"jsonrpc":"2.0","id":%s,"method":"job.submit","params":{"paused":true,"document":%s}}\n' "$1" "$(job 1 ".output.path = \"r$1/x.####.exr\"")"; }
for n in 1 2 3 4 5 6; do line "$n"; done >"$scratch/six"
as 9 13 "$bin/socket-client" "$socket" <"$scratch/six" >"$scratch/rush"
expect "of six at once" "$(jq -c .error.code "$scratch/rush" | sort | uniq -c | xargs)" "3 2 3 null"
kill_daemon

# All amounts count after a restart as before, also with other limits, which a reload may change.
export NOTIFY_SOCKET=$scratch/none # a service manager's daemon reads its settings again
settings() { printf '%s\n' "user-frames = none" "user-pixels = none" "$@" >"$scratch/conf"; }
settings "user-jobs = 4" "admin-group = operator"
start_daemon --worker-program "$(stub write:20)" --config "$scratch/conf"
chmod 666 "$socket"
fifth=$(id_of "$(give "${ann[@]}" q 1)")
[ -n "$fifth" ] || fail "a fourth job after a restart"
expect_error "$(give "${ann[@]}" s 1)" 2 "jobs: games may have 4 that are not over, has 4"
expect "who administers" "$(ask_as "${chief[@]}" job.priority "{\"id\":$fifth,\"priority\":7}" | jq .result.priority)" 7
settings "user-jobs = 5" "admin-group = no-such-group"
kill -HUP "$daemon_pid"
wait_until "settings are read again" grep -q "settings: changed: .*user-jobs" "$scratch/daemon.log"
[ -n "$(id_of "$(give "${ann[@]}" s 1)")" ] || fail "a fifth job after a reload"
expect_error "$(ask_as "${chief[@]}" job.priority "{\"id\":$fifth,\"priority\":8}")" 2 "belongs to games"
stop_daemon
unset NOTIFY_SOCKET

# Bytes of files: a job is paused when its owner reaches the limit, and goes on when there is room.
rm -rf "$scratch/state" "$scratch/out"
install -d -o 8 -g 8 "$scratch/state" "$scratch/out"
# await_pause: the big job is paused and at rest. `made` frames are made; `most` were made or in hand when it was paused.
await_pause()
{
    wait_state "$big" paused
    wait_until "what is begun is kept" eval '[ "$(field "$big" .running)" = 0 ]'
    made=$(field "$big" .succeeded)
    wait_until "the pause is told" told_pause
}

told_pause()
{
    most=$(jq -r --argjson id "$big" '.params.job // {} | select(.id == $id and .state == "paused") | .succeeded + .running' \
        "$scratch/events" | head -n 1)
    [ -n "$most" ]
}

# All files have one size, for the numbers of their frames have three digits.
start --user-disk 1K
small=$(id_of "$(give "${ann[@]}" a 101-102 . false)")
wait_state "$small" succeeded
bytes() { find "$@" -name '*.exr' -printf '%s\n' | awk '{ sum += $1 } END { print sum }'; } # FOLDER...
size=$(stat -c %s "$scratch/out/a/x.0101.exr")
limit=$((size * 10))
stop_daemon
# Most of the big job's frames cannot be in hand when it is paused, however late the daemon is.
worker=write:100
start --user-disk "$limit"
listen "$scratch/events" '{"frames":false}'
big=$(id_of "$(give "${ann[@]}" b 101-500 . false)")
other=$(id_of "$(give "${bob[@]}" c 1-8 . false)")
await_pause
# The file that reaches the limit pauses it; a frame that is begun is kept.
[[ $(field "$big" .reason) == "paused: output: games may have $limit bytes of published files, has $limit: "* ]] || fail "reason: $(field "$big" .reason)"
expect "failed frames" "$(field "$big" .failed)" 0
wait_state "$other" succeeded
[ "$made" -ge 8 ] && [ "$made" -le "$most" ] || fail "it made $made frames; when it was paused, $most were made or in hand"
expect "its files" "$(find "$scratch/out/b" -name '*.exr' | wc -l)" "$made"
expect_error "$(ask_as "${ann[@]}" job.resume "{\"id\":$big}")" 2 "output: games may have $limit bytes of published files, has $(bytes "$scratch/out/a" "$scratch/out/b")"
expect_error "$(give "${ann[@]}" d 1)" 2 "output: games may have $limit bytes"
kill_daemon
# A frame in hand that is not begun is given back. On a busy machine all may be begun: then it is tried again.
for _ in {1..6}; do
    [ "$made" -ge "$most" ] || break
    limit=$((size * (made + 20)))
    start --user-disk "$limit"
    listen "$scratch/events" '{"frames":false}'
    ask_as "${ann[@]}" job.resume "{\"id\":$big}" >/dev/null
    await_pause
    kill_daemon
done
[ "$made" -lt "$most" ] || fail "no frame in hand is given back when a job is paused"
start --user-disk "$limit"
expect_error "$(ask_as "${ann[@]}" job.resume "{\"id\":$big}")" 2 "has $(bytes "$scratch/out/a" "$scratch/out/b")"
# Files that a retry renders again count once, when they are published.
expect_error "$(ask_as "${ann[@]}" job.retry "{\"id\":$small,\"state\":\"succeeded\"}")" 2 "output: games may have"
stop_daemon
start --user-disk "$((size * (made + 20)))"
ask_as "${ann[@]}" job.retry "{\"id\":$small,\"state\":\"succeeded\"}" >/dev/null
wait_state "$small" succeeded
ask_as "${ann[@]}" job.resume "{\"id\":$big}" >/dev/null
wait_state "$big" paused
wait_until "it is quiet" eval '[ "$(field "$big" .running)" = 0 ]'
expect_error "$(ask_as "${ann[@]}" job.resume "{\"id\":$big}")" 2 "has $(bytes "$scratch/out/a" "$scratch/out/b")"
# Room is made: by deleting, with the files or without, or by a larger limit.
expect "the small job, deleted" "$(ask_as "${ann[@]}" job.delete "{\"id\":$small,\"files\":true}" | jq .result.files_removed)" 2
answer=$(ask_as "${ann[@]}" job.resume "{\"id\":$big}")
grep -q '"result"' <<<"$answer" || expect_error "$answer" 2 "has $(bytes "$scratch/out/b"):"
expect_error "$(ask_as "${bob[@]}" job.delete "{\"id\":$other,\"id2\":1}")" -32602 "id2"
expect_error "$(ask_as "${ann[@]}" job.delete "{\"id\":$other}")" 2 "belongs to man"
stop_daemon
worker=write:0
start --user-disk none
ask_as "${ann[@]}" job.resume "{\"id\":$big}" >/dev/null
wait_state "$big" succeeded
expect "all of its files" "$(find "$scratch/out/b" -name '*.exr' | wc -l)" 400
stop_daemon
