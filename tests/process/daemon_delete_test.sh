#!/bin/bash
# Deletion of jobs that are over: with their files or without, by their owner, whatever else happens in the meantime.
. "$(dirname "$0")/farm.sh"

delete() { ask job.delete "{\"id\":$1,\"files\":${2:-false}}"; }
done_job() { local id; id=$(submit "$1"); wait_state "$id" succeeded; echo "$id"; }
rows() { sqlite3 "$scratch/state/queue.db" "SELECT (SELECT count(*) FROM job WHERE id = $1) || ' ' || (SELECT count(*) FROM document WHERE job = $1) || ' ' || (SELECT count(*) FROM frame WHERE job = $1)"; }

start_daemon --worker-program "$(stub write:5)"

# Without files: the files stay; the job is gone, also after a restart, and its id is not used again.
id=$(done_job "$(job 1-5 '.output.path = "stay/s.####.exr"')")
listen "$scratch/events"
expect "deleted" "$(delete "$id" | jq -c .result)" '{"files_removed":0,"files_kept":0,"files_missing":0,"files_found":0}'
expect_error "$(ask job.show "{\"id\":$id}")" 1 "there is no such job"
expect_error "$(delete "$id")" 1 "there is no such job"
expect_files stay 5
wait_until "it is told of" grep -q "\"type\":\"deleted\",\"id\":$id}" "$scratch/events"
kill_daemon
start_daemon --worker-program "$(stub write:5)"
expect_error "$(ask job.show "{\"id\":$id}")" 1 "there is no such job"
expect "the next job's number" "$(submit "$(job 1)" true)" $((id + 1))
expect_error "$(delete $((id + 1)))" 3 "job $((id + 1)) is not over: cancel it first"
ask job.cancel "{\"id\":$((id + 1))}" >/dev/null
expect "a canceled job" "$(delete $((id + 1)) | jq -c .result)" '{"files_removed":0,"files_kept":0,"files_missing":0,"files_found":0}'

# With files: unchanged published files are removed, and the folder when it is empty.
id=$(done_job "$(job 1-9 '.output.path = "a/gone/g.####.exr"')")
expect "deleted with its files" "$(delete "$id" true | jq -c .result)" '{"files_removed":9,"files_kept":0,"files_missing":0,"files_found":0}'
[ ! -e "$scratch/out/a/gone" ] || fail "the folder is there: $(ls "$scratch/out/a/gone")"
[ -d "$scratch/out/a" ] || fail "the folder above went too"
id=$(done_job "$(job 1-6 '.output.path = "b/g.####.exr"')")
cp "$scratch/out/b/g.0001.exr" "$scratch/copy" && touch -d 2000-01-01 "$scratch/copy"
cp -p "$scratch/copy" "$scratch/out/b/new" && mv "$scratch/out/b/new" "$scratch/out/b/g.0001.exr" # another file
echo more >>"$scratch/out/b/g.0002.exr" && touch -d 2000-01-01 "$scratch/out/b/g.0002.exr"
touch "$scratch/out/b/g.0003.exr" # the same file, perhaps with other bytes
ln -sf ../../copy "$scratch/out/b/g.0004.exr"
rm "$scratch/out/b/g.0005.exr"
echo mine >"$scratch/out/b/notes.txt"
expect "only what it published" "$(delete "$id" true | jq -c .result)" '{"files_removed":1,"files_kept":4,"files_missing":1,"files_found":0}'
expect "what stays" "$(find "$scratch/out/b" -mindepth 1 -printf '%f\n' | sort | xargs)" "g.0001.exr g.0002.exr g.0003.exr g.0004.exr notes.txt"
[ -f "$scratch/copy" ] || fail "a link was followed"
id=$(done_job "$(job 1-3 '.output.path = "top.####.exr"')")
expect "in the root" "$(delete "$id" true | jq -c .result)" '{"files_removed":3,"files_kept":0,"files_missing":0,"files_found":0}'
[ -d "$scratch/out" ] || fail "the root is gone"

# Files of a later job stay, and so does a folder that it writes into.
first=$(done_job "$(job 1-4 '.output.path = "c/g.####.exr"')")
second=$(done_job "$(job 3-6 '.output.path = "c/g.####.exr" | .output.existing = "overwrite"')")
third=$(submit "$(job 50 '.output.path = "c/g.####.exr"')" true)
expect "a later job's files" "$(delete "$first" true | jq -c .result)" '{"files_removed":2,"files_kept":2,"files_missing":0,"files_found":0}'
expect "the later job's" "$(delete "$second" true | jq -c .result)" '{"files_removed":4,"files_kept":0,"files_missing":0,"files_found":0}'
[ -d "$scratch/out/c" ] || fail "the folder of a job that waits is gone"
ask job.cancel "{\"id\":$third}" >/dev/null
# The files of frames whose retry was canceled stay, and are counted.
id=$(done_job "$(job 1-5 '.output.path = "again/g.####.exr"')")
ask daemon.drain >/dev/null
ask job.retry "{\"id\":$id,\"state\":\"succeeded\",\"range\":\"2-4\",\"force\":true}" >/dev/null
ask job.cancel "{\"id\":$id}" >/dev/null
ask daemon.undrain >/dev/null
wait_state "$id" canceled
expect "after a canceled retry" "$(delete "$id" true | jq -c .result)" '{"files_removed":2,"files_kept":3,"files_missing":0,"files_found":0}'
# A folder that is gone does not hinder the deletion.
id=$(done_job "$(job 1-3 '.output.path = "d/g.####.exr"')")
rm -r "$scratch/out/d"
expect "with a folder that is gone" "$(delete "$id" true | jq -c .result)" '{"files_removed":0,"files_kept":0,"files_missing":3,"files_found":0}'
id=$(done_job "$(job 1-3 '.output.path = "d/g.####.exr"')")
mv "$scratch/out/d/g.0002.exr" "$scratch/moved.exr"
said=$("$bin/march" delete "$id" --files --socket "$socket" 2>&1)
expect "the status where a file is elsewhere" $? 1
[[ $said == *"job $id: deleted, with 2 files"* && $said == *"job $id: 1 of its files were not there"* ]] || fail "march says: $said"

# A job that is still being swept is deleted after that; a second deletion and a retry in the meantime are refused.
id=$(submit "$(job 1-4000 '.output.path = "e/g.####.exr"')")
wait_until "it runs" eval '[ "$(field "$id" .succeeded)" -gt 3 ]'
answers=$(printf '{"jsonrpc":"2.0","id":%s,"method":"%s","params":%s}\n' 1 job.cancel "{\"id\":$id}" \
    2 job.delete "{\"id\":$id,\"files\":true}" 3 job.delete "{\"id\":$id}" 4 job.retry "{\"id\":$id,\"state\":\"canceled\"}" \
    5 job.frames "{\"id\":$id}" 6 job.log "{\"id\":$id}" | ask_raw)
expect "the answers" "$(jq -c '[.id, .error.code]' <<<"$answers" | sort | xargs)" '[1,null] [2,null] [3,3] [4,3] [5,null] [6,null]'
[ ! -e "$scratch/out/e" ] || fail "left of it: $(ls "$scratch/out/e")"
expect "its rows" "$(rows "$id")" "0 0 0"
expect "frames of the farm" "$(ask daemon.status | jq -c '[.result.frames.canceled, .result.frames.running]')" "[1,0]"

# march prints the result.
id=$(done_job "$(job 1-2 '.output.path = "f/g.####.exr"')")
expect "march delete" "$("$bin/march" delete "$id" --files --socket "$socket")" "job $id: deleted, with 2 files"
id=$(done_job "$(job 1-2 '.output.path = "f/g.####.exr"')")
expect "march delete --json" "$("$bin/march" delete "$id" 9999 --json --socket "$socket" 2>/dev/null | jq -c .)" \
    "{\"deleted\":[{\"id\":$id,\"files_removed\":0,\"files_kept\":0,\"files_missing\":0,\"files_found\":0}],\"errors\":[{\"id\":9999,\"error\":\"job 9999: there is no such job\"}]}"

# Files that were there before the job are not removed.
id=$(done_job "$(job 1-2 '.output.path = "g/g.####.exr"')")
stop_daemon
start_daemon --worker-program "$(stub skip)"
skipped=$(done_job "$(job 1-2 '.output.path = "g/g.####.exr"')")
expect "skipped frames" "$(field "$skipped" .skipped)" 2
expect "files of skipped frames" "$("$bin/march" delete "$skipped" --files --socket "$socket")" \
    "job $skipped: deleted, with 0 files; 2 that it found there and did not render stay"
expect "whose they are" "$(delete "$id" true | jq -c .result)" '{"files_removed":2,"files_kept":0,"files_missing":0,"files_found":0}'
stop_daemon
start_daemon --worker-program "$(stub write:5)"

# A daemon killed during a deletion: either the whole job is there and can be deleted again, or nothing of it is left.
for delay in 0 2 5 10 20 35; do
    id=$(done_job "$(job 1-150 '.output.path = "k/g.####.exr"')")
    delete "$id" true >"$scratch/answer" &
    asked=$!
    sleep "0.$(printf %03d "$delay")"
    kill_daemon
    wait "$asked"
    start_daemon --worker-program "$(stub write:5)"
    if ask job.show "{\"id\":$id}" | grep -q '"result"'; then
        [ -s "$scratch/answer" ] && fail "it was said to be deleted: $(cat "$scratch/answer")"
        expect "the job after a crash" "$(field "$id" '[.state, .succeeded] | join(" ")')" "succeeded 150"
        expect "its rows" "$(rows "$id")" "1 1 150"
        delete "$id" true >/dev/null
    fi
    expect_error "$(ask job.show "{\"id\":$id}")" 1 "there is no such job"
    expect "rows after a delete" "$(rows "$id")" "0 0 0"
    expect "files after a delete" "$(find "$scratch/out/k" -type f 2>/dev/null | wc -l)" 0
done
stop_daemon
