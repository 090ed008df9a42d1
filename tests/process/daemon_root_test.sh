#!/bin/bash
# An output root is known by its marker: jobs wait while it is away, nothing is made in its place, and they go on by themselves.
. "$(dirname "$0")/farm.sh"

out=$scratch/out away=$scratch/away
waits() { [ "$(field "$1" .state)" = paused ] && [[ $(field "$1" .reason) == "paused: output root $out "*"; the job goes on when the root is back" ]]; }
root_id() { sed -n 's/^root //p' "$1/.marchd-root"; }
frames_of() { find "$1" -name '*.exr' | wc -l; }

# A farm's first root is made, marked and remembered.
mkdir "$scratch/archive"
start_daemon --worker-program "$(stub write:5)" --output-root "$out" --output-root "$scratch/archive"
id=$(root_id "$out")
expect "the marker's id" "${#id}" 32
grep -qF "output root $out: marked" "$scratch/daemon.log" || fail "the log says nothing of the mark"

# The root goes away while frames run; an empty folder is there instead, as below a mount point.
job=$(submit "$(job 1-400)")
wait_until "frames are published" eval '[ "$(field "$job" .succeeded)" -gt 20 ]'
mv "$out" "$away" && mkdir "$out"
wait_until "the job waits" waits "$job"
wait_until "the reason is what is there now" eval '[[ $(field "$job" .reason) == *"it has no .marchd-root (is its disk mounted?)"* ]]'
expect "what was made in its place" "$(ls -A "$out")" ""
[ "$(field "$job" .succeeded)" -le "$(frames_of "$away")" ] || fail "frames count that are not in the root"
expect_error "$(ask job.submit "{\"document\":$(job 1 '.output.path = "new/n.####.exr"')}")" 3 "output.path: output root $out is not"
expect "attempts that failed" "$(field "$job" .failed)" 0

rmdir "$out" && mv "$away" "$out"
wait_state "$job" succeeded
expect "files" "$(frames_of "$out")" 400
expect "leftovers" "$(find "$out" -name '*.part')" ""
grep -qF "output root $out is there; jobs that go on: 1" "$scratch/daemon.log" || fail "the log does not say that the root is back"

# Killed while files get their names, and started without the root: what it holds is known when it is back. No file that has
# its name is rendered again.
job=$(submit "$(job 1001-2000)")
for round in 1 2 3; do
    wait_until "frames are published" eval '[ "$(field "$job" .succeeded)" -gt $((round * 40)) ]'
    kill_daemon
    mv "$out" "$away"
    find "$away" -name '*.exr' -printf '%i %f\n' >>"$scratch/named"
    start_daemon --worker-program "$(stub write:5)"
    waits "$job" || fail "after a restart: $(field "$job" .reason)"
    mv "$away" "$out"
    wait_until "the root is back" eval '[ "$(field "$job" .state)" != paused ]'
done
wait_state "$job" succeeded
expect "files" "$(frames_of "$out")" 1400
wait_until "leftovers are gone" eval '[ -z "$(find "$out" -name "*.part")" ]'
find "$out" -name '*.exr' -printf '%i %f\n' | sort >"$scratch/inodes"
expect "files that were replaced" "$(sort -u "$scratch/named" | comm -23 - "$scratch/inodes")" ""

# Another root in its place is not it either.
job=$(submit "$(job 401-440)" true)
mv "$out" "$away" && mkdir "$out" && printf 'root %032d\n' 7 >"$out/.marchd-root"
ask job.resume "{\"id\":$job}" >/dev/null
wait_until "the job waits" waits "$job"
[[ $(field "$job" .reason) == *"is another one: its .marchd-root says 00000000, expected ${id:0:8}"* ]] || fail "reason: $(field "$job" .reason)"
# Files of a root that is away are not removed, and the job that has them stays.
over=$(ask job.list '{"state":["succeeded"]}' | jq '.result.jobs[0].id')
expect_error "$(ask job.delete "{\"id\":$over,\"files\":true}")" -32603 "is another one"
stop_daemon

# A start without the root does not make it, and other roots work.
rm -r "$out" "$scratch/archive"
"$bin/notify-listener" "$scratch/notify" >"$scratch/notes" &
wait_until "the manager listens" test -S "$scratch/notify"
export NOTIFY_SOCKET=$scratch/notify
start_daemon --worker-program "$(stub write:5)" --output-root "$out" --output-root "$scratch/second" --output-root "$scratch/archive"
unset NOTIFY_SOCKET
grep -qF "output root $out is not there: No such file or directory; jobs that write there wait until it is" "$scratch/daemon.log" || fail "the log does not name the root"
grep -qF "output root $scratch/second is not there" "$scratch/daemon.log" || fail "the log does not name the second root"
[ ! -e "$out" ] || fail "the root was made again"
"$bin/march" status --socket "$socket" | grep -qxF "             output root $out is not there: No such file or directory" ||
    fail "march status: $("$bin/march" status --socket "$socket")"
waits "$job" || fail "after a restart: $(field "$job" .reason)"
mkdir "$scratch/second"
wait_until "the second root is taken" eval '[ -e "$scratch/second/.marchd-root" ]'
wait_until "it takes jobs" eval 'other=$(submit "$(job 1 ".output.path = \"$scratch/second/a/a.####.exr\"")" 2>/dev/null)'
wait_state "$other" succeeded

# The service manager is told of the root for which jobs wait, before one that nobody needs.
wait_until "it is told of a root" grep -q "^STATUS=.* output root .* is not there" "$scratch/notes"
grep -q "output root $scratch/archive" "$scratch/notes" && fail "told: $(cat "$scratch/notes")"

# An empty marker makes the folder that is there the root.
mkdir "$out"
touch "$out/.marchd-root"
wait_until "the marker is filled" eval '[ "$(root_id "$out")" = "$id" ]'
# Its job's folder is not there: it is made by whoever resumes the job, not by frames.
wait_until "the job is held" eval '[[ $(field "$job" .reason) == "paused: output: folder $out/cloud is gone: march resume makes it again" ]]'
ask job.resume "{\"id\":$job}" >/dev/null
wait_state "$job" succeeded
expect "files" "$(frames_of "$out")" 40

# A retry makes a deleted folder, too.
rm -r "$out/cloud"
ask job.retry "{\"id\":$job,\"state\":\"succeeded\"}" >/dev/null
wait_state "$job" succeeded
expect "files" "$(frames_of "$out")" 40

# What a job leaves in a root that is away is removed when it is back, by a daemon that was started since, too.
rm -r "$away" # the first root, whose place was taken
farm=$(sed -n 's/^farm \(.\{8\}\).*/\1/p' "$out/.marchd-root")
job=$(submit "$(job 1-9 '.output.path = "left/l.####.exr"')" true)
touch "$out/left/l.0001.exr.$farm.$job.1.1.part" "$out/left/l.0001.exr.00000000.$job.1.1.part"
mv -T "$out" "$away"
wait_until "the root is missed" eval '[[ $(ask daemon.status | jq -c ".result.roots[] | select(.path == \"$out\") | .is_there") == false ]]'
ask job.cancel "{\"id\":$job}" >/dev/null
[ -e "$away/left/l.0001.exr.$farm.$job.1.1.part" ] || fail "its part file is gone while the root is away"
mv -T "$away" "$out"
wait_until "its part file is gone" eval '[ ! -e "$out/left/l.0001.exr.$farm.$job.1.1.part" ]'
later=$(submit "$(job 1-9 '.output.path = "left/m.####.exr"')" true)
touch "$out/left/m.0001.exr.$farm.$later.1.1.part"
mv -T "$out" "$away"
wait_until "the root is missed" eval '[[ $(ask daemon.status | jq -c ".result.roots[] | select(.path == \"$out\") | .is_there") == false ]]'
ask job.cancel "{\"id\":$later}" >/dev/null
finished=$(field "$later" .finished)
stop_daemon
start_daemon --worker-program "$(stub write:5)" --output-root "$out"
expect "when it ended" "$(field "$later" .finished)" "$finished"
[ -e "$away/left/m.0001.exr.$farm.$later.1.1.part" ] || fail "its part file is gone while the root is away"
mv -T "$away" "$out"
wait_until "its part file is gone" eval '[ ! -e "$out/left/m.0001.exr.$farm.$later.1.1.part" ]'
expect "when it ended" "$(field "$later" .finished)" "$finished"
stop_daemon

# Another farm may use the root: it takes its id over, and leaves part files of the first alone.
id=$(root_id "$out")
start_daemon --worker-program "$(stub write:5)" --output-root "$out" --state "$scratch/other"
expect "the root's id" "$(root_id "$out")" "$id"
expect "farms in the marker" "$(grep -c '^farm ' "$out/.marchd-root")" 2
other=$(submit "$(job 1-9 '.output.path = "left/l.####.exr"')")
touch "$out/left/l.0002.exr.$farm.$other.1.1.part"
wait_state "$other" succeeded
stop_daemon
[ -e "$out/left/l.0002.exr.$farm.$other.1.1.part" ] || fail "a part file of another farm was removed"
