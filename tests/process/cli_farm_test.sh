#!/bin/sh
# `march` with a daemon: a job from submission to its files, and all reports about it.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/cli_farm_test.XXXXXX")
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

expect_stdout() { [ "$(cat out)" = "$1" ] || fail "expected stdout \"$1\""; }
submit() { march submit "$cloud" --set 'resolution=[32,18]' --set 'quality={"method":"midpoint","step":0.05,"light_step":0.05}' "$@"; }

mkdir pictures
marchd --state "$scratch/state" --output-root "$scratch/pictures" --input-root / --workers 1 2>marchd.log &
daemon=$!
until march workers >/dev/null 2>&1; do
    kill -0 "$daemon" || { echo "FAILED: no daemon"; cat marchd.log; exit 1; }
    sleep 0.05
done

expect 0 submit --set frames=48-50 --wait
expect_stdout 1
grep -q "job 1: 3 frames to $scratch/pictures/cloud/cloud.####.exr" err || fail "submit says where the files go"
grep -q "^job 1: succeeded" err || fail "submit --wait says how the job ended"
! grep -q "worker" err || fail "that a worker is started for a job is no trouble"
[ "$(ls pictures/cloud)" = "cloud.0048.exr
cloud.0049.exr
cloud.0050.exr" ] || fail "the job's files: $(ls pictures/cloud)"
expect 0 submit --set frames=48,49 --set output.path=two/two.####.exr --watch --set 'comment="for Ada"' --set 'tags=["night","shot 12"]'
expect_stdout 2
grep -q "#2 cloud: 2/2" err || fail "--watch tells the end"
expect 0 march list
grep -q "night, shot 12" out || fail "list tells tags"
expect 0 march show 2
grep -q "^comment    for Ada$" out || fail "show tells the comment"
for text in "for Ada" "night, shot 12" marchd:farm; do
    head -c 3000 pictures/two/two.0048.exr | grep -qa "$text" || fail "the file's header lacks \"$text\""
done
expect 0 submit --json --frames 48 --set output.path=three/three.####.exr --wait
grep -q '{"jobs":\[{"id":3,.*"state":"succeeded"' out || fail "submit --wait --json"

expect 2 submit --set output.path=../out.####.exr
grep -q "cloud.json: " err || fail "a refused job is named by its file"
expect 4 submit --set output.path=/etc/x.####.exr
grep -q "output" err || fail "a path outside the root"

expect 0 submit --paused --set frames=0-9 --set output.path=four/four.####.exr --priority 7
expect 1 submit --set frames=5 --set output.path=four/four.####.exr
grep -q "4" err || fail "a second job on the same files is refused, naming the first"
expect 0 march list --state paused
[ "$(wc -l <out)" -eq 2 ] || fail "list --state shows the titles and one job"
grep -q "paused by" out || fail "list shows why a job waits"
expect 0 march list --json
[ "$(grep -o '"id":' out | wc -l)" -eq 4 ] || fail "list --json"
expect 2 march list --state paussed
expect 0 march list --limit 2 --json
[ "$(grep -o '"id":[0-9]*' out | xargs)" = "id:4 id:3" ] || fail "the newest first with --limit"
grep -q '"next":null,"total":2}$' out || fail "all pages of list --limit are one result"
expect 0 march list --owner nobody-at-all --json
expect_stdout '{"jobs":[],"next":null,"total":0}'
expect 0 march list --owner "$(id -un)" --name CLOU --since 1h --state paused
[ "$(wc -l <out)" -eq 2 ] || fail "list --owner --name --since --state shows one job"
expect 0 march list --since 2100-01-01
[ "$(wc -l <out)" -eq 1 ] || fail "list --since a later day shows no job"
expect 2 march list --since yesterday
grep -q -- '--since: expected an age such as 12h or 30d, or a date such as 2026-03-01 or 2026-03-01T18:30, got "yesterday"' err ||
    fail "a wrong --since"
expect 0 march show 4
grep -q "^priority   7$" out || fail "show"
grep -q "^reason     paused" out || fail "show says why it waits"
expect 0 march prio 4 60
expect_stdout "job 4: priority 60"
expect 0 march frames 1
[ "$(grep -c "succeeded.*$scratch/pictures/cloud/cloud.00" out)" -eq 3 ] || fail "frames"
expect 0 march frames 4 --frames 2-4 --json
grep -q '"total":3}$' out || fail "frames --frames"
expect 0 march frames 1 --state failed --json
expect_stdout '{"frames":[],"next":null,"total":0}'
expect 0 march cancel 4
expect 1 march wait 4
grep -q "^job 4: canceled" out || fail "wait tells what became of the job"
expect 0 march retry 4 --state canceled --range 0-1
expect_stdout "job 4: 2 frames queued again"
expect 0 march resume 4
march wait 4 >/dev/null
expect 0 march frames 4 --state succeeded --json
grep -q '"total":2}$' out || fail "frames queued again are rendered"
expect 0 march retry 4 --state succeeded
grep -q -- "--force renders them too" err || fail "retry says what it leaves"
march wait 4 >/dev/null
expect 0 march frames 4 --state skipped --json
grep -q '"total":2}$' out || fail "frames whose files are good are skipped"
expect 0 march retry 4 --state skipped --frames 1 --force
march wait 4 >/dev/null
expect 0 march frames 4 --state succeeded --json
grep -q '"total":1}$' out || fail "retry --force renders a frame whose file is good"
expect 0 march watch 1 2 --json
[ "$(grep -c '^{"type":"job"' out)" -eq 2 ] || fail "watch --json begins with the jobs as they are"
expect 0 march wait 1 2 3 --json
expect 0 march log 1
expect 1 march show 99
grep -q "99" err || fail "a job that is not there is named"
expect 0 march workers
grep -q "osmesa\|egl" out || fail "workers tells the backend"

# A page has 10000 frames; all pages are requested.
expect 0 submit --paused --set frames=0-25000 --set output.path=many/many.#####.exr
expect 0 march frames 5
[ "$(wc -l <out)" -eq 25002 ] || fail "frames of all pages"
expect 1 march pause 99 5 1 --json
grep -q '^{"jobs":\[{"id":5,.*\],"errors":\[{"id":99,"error":".*"},{"id":1,"error":".*"}\]}$' out ||
    fail "what cannot be done for one job is done for the others"
expect 1 march pause 99 5
expect_stdout "job 5: paused by $(id -un)"
grep -q "job 99" err || fail "what could not be done is told"
march frames 5 | head -n 1 >/dev/null || fail "a reader that goes away"

# Jobs are chosen by owner and state, too; how many is said first, and nothing is done without --yes.
expect 2 march pause
grep -q "expected ids of jobs, or --all, --owner or --state" err || fail "pause without jobs"
expect 2 march resume 5 --all
expect 2 march resume --state paused </dev/null
grep -q "^resume 1 job: 1 of $(id -un)$" err || fail "resume says how many jobs"
grep -q "nothing was done: --yes does it" err || fail "resume wants a yes"
expect 0 march resume --owner nobody-at-all --yes
expect_stdout ""
expect 0 march resume --all --yes
grep -q "^job 5: " out || fail "resume --all"
expect 0 march pause --owner "$(id -un)" --state queued,running --yes
expect_stdout "job 5: paused by $(id -un)"

march watch >watched 2>&1 &
watcher=$!
until [ -s watched ] || ! kill -0 "$watcher"; do sleep 0.05; done
kill -TERM "$watcher"
wait "$watcher"
[ $? -eq 130 ] || fail "an interrupted watch ends with 130"

if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null; then
    # Files for another user, in a folder that they can reach.
    chmod 755 "$scratch"
    cp "$PROGRAM_FOLDER/march" "$PROJECT_ROOT/tests/support/leaks.supp" .
    chmod a+rX march leaks.supp
    nobody() {
        LSAN_OPTIONS="suppressions=$scratch/leaks.supp:print_suppressions=0" \
            setpriv --reuid=65534 --regid=65534 --clear-groups ./march "$@"
    }
    expect 4 nobody list
    grep -q "is not for you" err || fail "a socket one may not open is named"
    chmod 666 marchd.sock
    expect 4 nobody cancel 5
    expect 0 nobody list
fi

# A daemon that is started again finds who waits for it; what waits is told at once, and why.
march wait 5 >waited 2>waited_err &
waiter=$!
until grep -q "job 5: paused by" waited_err || ! kill -0 "$waiter"; do sleep 0.05; done
kill "$daemon"
wait "$daemon" || fail "the daemon's end: $(tail -n 3 marchd.log)"
marchd --state "$scratch/state" --output-root "$scratch/pictures" --input-root / --workers 1 2>>marchd.log &
daemon=$!
until march workers >/dev/null 2>&1; do sleep 0.05; done
expect 0 march cancel 5
wait "$waiter"
[ $? -eq 1 ] || fail "wait goes on with a daemon that was started again: $(cat waited_err)"
grep -q "^job 5: canceled" waited || fail "wait tells the end after a restart"
[ "$(grep -c "waiting up to 300 s for it to come back" waited_err)" -eq 1 ] || fail "wait says once that the daemon is gone"

# Jobs that come after others: one by one, and as a chain. What was submitted before a refusal is told.
expect 0 submit --paused --set frames=0 --set output.path=chain/a.####.exr
before=$(cat out)
expect 0 submit --after "$before" --set frames=0 --set output.path=chain/b.####.exr
grep -q "; waits for job $before (\"cloud\")" err || fail "submit says what the job waits for: $(cat err)"
expect 0 march cancel "$(cat out)"
expect 2 submit --after 1,,2
grep -q -- "--after: expected a job id such as 7" err || fail "a wrong --after"
for name in c d e; do
    jq ".output.path = \"chain/$name.####.exr\" | .frames = \"0\"" "$cloud" >"$name.json"
done
expect 2 march submit c.json d.json
grep -q "expected one job, or --chain for several" err || fail "several jobs without --chain"
expect 0 march submit --chain c.json d.json e.json --after "$before" --set 'quality={"method":"midpoint","step":0.05,"light_step":0.05}' --json
ids=$(grep -o '[0-9]*' out | xargs)
[ "$(cat out)" = "{\"ids\":[$(echo "$ids" | tr ' ' ,)]}" ] || fail "the ids of a chain: $(cat out)"
set -- $ids
march show "$1" --json | grep -q "\"after\":\[$before\]" || fail "the first of a chain comes after --after"
march show "$3" --json | grep -q "\"after\":\[$2\]" || fail "each of a chain comes after the one before"
expect 0 march cancel "$1" "$2" "$3"
jq '.output.path = "chain/a.####.exr"' c.json >taken.json
expect 1 march submit --chain c.json taken.json e.json --paused
grep -q "taken.json: output.path: job $before .*writes a.0000.exr too; submitted before it: [0-9]* (c.json)" err ||
    fail "a refusal in a chain: $(cat err)"
[ "$(wc -l <out)" -eq 1 ] || fail "the ids of a chain that was refused"
expect 0 march cancel "$before" "$(cat out)"

# Jobs that have been over for long are deleted together; how many is said before.
expect 0 march delete --over 1h </dev/null
grep -q "^delete 0 jobs$" err || fail "delete --over says how many jobs"
expect 2 march delete --over 2100-01-01 --state succeeded </dev/null
grep -q "^delete 3 jobs: 3 of $(id -un)$" err || fail "delete --over --state says how many jobs: $(cat err)"
expect 2 march delete --over soon
grep -q -- "--over: expected an age such as 12h or 30d" err || fail "a wrong --over"

# Pictures whose job was deleted are known by their headers.
expect 0 march delete 3
expect 1 submit --frames 48 --set output.path=three/three.####.exr --set camera.fov=47
grep -q "three.0048.exr would be replaced, which march render or a job that was deleted made" err || fail "pictures without a job"
expect 0 submit --frames 48 --set output.path=three/three.####.exr --paused
expect 0 march cancel "$(cat out)"

expect 0 submit --paused --set frames=0 --set output.path=last/last.####.exr
last=$(cat out)
mv pictures elsewhere
expect 1 march delete 5 --files
grep -q "^job 5: output: output root $scratch/pictures is not there" err || fail "the job whose files cannot be removed is named"
mv elsewhere pictures
march wait "$last" --reconnect 0 >out 2>err &
waiter=$!
until [ "$(find "/proc/$waiter/fd" -lname 'socket:*' | wc -l)" -gt 0 ] || ! kill -0 "$waiter"; do sleep 0.05; done
kill "$daemon"
wait "$daemon" || fail "the daemon's end: $(tail -n 3 marchd.log)"
daemon=
wait "$waiter"
[ $? -eq 3 ] || fail "wait without its daemon ends with 3"
expect 3 march list

[ "$failures" -eq 0 ]
