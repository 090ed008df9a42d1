#!/bin/bash
# A fenced worker goes on to jobs of its owner that its fence opens, and what one job leaves in it changes no other job.
# Any other job gets another process.
. "$(dirname "$0")/farm.sh"
mkdir -p "$scratch/in/one" "$scratch/in/two"
head -c 60 /dev/urandom >"$scratch/in/one/a_5x4x3xuint8.raw"
head -c 60 /dev/urandom >"$scratch/in/two/a_5x4x3xuint8.raw"
cp "$PROJECT_ROOT/jobs/textures/floor.png" "$scratch/in/two"

# made FROM NAME [JQ-FILTER]: writes the job NAME, like the example FROM, small, with a stated method.
made()
{
    jq -c --arg name "$2" --arg from "$1" --slurpfile stated "$PROJECT_ROOT/tests/support/stated_quality.json" \
        '.name = $name | .frames = "1-2" | .resolution = [48, 27] | .quality = $stated[0][$from] |
         .output = { path: ("warm/" + $name + "/f.####.exr") } | '"${3:-.}" "$PROJECT_ROOT/jobs/$1.json" >"$scratch/$2.json"
}

# processes: how many workers were started in this daemon's time.
processes() { grep -c "worker 1: started" "$scratch/daemon.log"; }

# queue_up DOCUMENT...: submits them to a daemon without workers; the next one finds them queued.
queue_up()
{
    start_daemon --worker-program "$scratch/no-such-program" --input-root "$scratch/in"
    for document; do submit "$document"; done >"$scratch/ids"
    stop_daemon
    rm "$scratch/daemon.log" # the failed starts
    mapfile -t ids <"$scratch/ids"
}

# The fence of the first job opens the folders of those that come next, a folder each. One process renders them all.
grid='.scene.media = [{ density: { kind: "grid", file: $file }, sigma_s: 3, sigma_a: 0.5 }] | del(.camera.clip)'
made cloud first '.quality = { method: "cached", step: 0.02, light_grid: 32 }'
made noise second
made cloud third "${grid/\$file/\"$scratch/in/one/a_5x4x3xuint8.raw\"}"
made cloud fourth "${grid/\$file/\"$scratch/in/two/a_5x4x3xuint8.raw\"}"
made cloud fifth '.quality = { method: "cached", step: 0.02, light_grid: 32 } | .lights[0].intensity = [1, 2, 3]'
made cloud sixth '.scene.media[0].density = { kind: "glsl", file: "/six.glsl", lipschitz: 1, bounds: { kind: "sphere", center: [0, 0, 0], radius: 1 },
    source: "float density(vec3 p, float t) { return 0.7 - length(p) + 0.1 * t; }\n" } | del(.camera.clip)'
made cloud seventh ".scene.objects = [{ kind: \"sphere\", center: [0, 0, 0], radius: 0.3,
    material: { kind: \"diffuse\", texture: { file: \"$scratch/in/two/floor.png\" } } }]"
made noise eighth # the second's pictures
names=(first second third fourth fifth sixth seventh eighth)
documents=()
for name in "${names[@]}"; do documents+=("$(cat "$scratch/$name.json")"); done
queue_up "${documents[@]}"
start_daemon --backend software --workers 1 --input-root "$scratch/in" --log-level debug
for id in "${ids[@]}"; do wait_state "$id" succeeded; done
expect "processes for eight jobs of one owner" "$(processes)" 1
served=$(ask worker.list | jq '.result.workers[0].pid')

# Each picture is the one that a process of its own makes, bit for bit.
for name in "${names[@]}"; do
    "$bin/march" render "$scratch/$name.json" --backend software --out "$scratch/alone/$name.####.exr" >/dev/null 2>"$scratch/said" ||
        fail "$name alone: $(cat "$scratch/said")"
    for frame in 0001 0002; do
        differ=$("$bin/exr-compare" "$scratch/out/warm/$name/f.$frame.exr" "$scratch/alone/$name.$frame.exr") || fail "$name: $differ"
        expect "what the jobs before change of $name, frame $frame" "$(grep -oE '[0-9][0-9.e+-]*' <<<"$differ" | sort -u)" 0
    done
done

# A job inside a folder of the fence is served by the same process; one beside them is not.
id=$(submit "$(jq -c '.output.path = "warm/first/deep/f.####.exr"' "$scratch/first.json")")
wait_state "$id" succeeded
expect "the process for a folder inside" "$(ask worker.list | jq '.result.workers[0].pid')" "$served"
id=$(submit "$(jq -c '.output.path = "beside/f.####.exr"' "$scratch/first.json")")
wait_state "$id" succeeded
expect "processes, with that for a folder beside" "$(processes)" 2

# A folder that was made anew is another one to the kernel: the frame is tried again in a process of its own, and no
# attempt is used up.
held=$(ask worker.list | jq -r '.result.workers[0].sandbox')
rm -r "$scratch/out/beside"
id=$(submit "$(jq -c '.output.path = "beside/g.####.exr"' "$scratch/first.json")")
wait_state "$id" succeeded
expect_files beside 2
if [[ $held == landlock* ]]; then
    expect "processes, with that for a new folder of an old name" "$(processes)" 3
    [[ $(ask job.log "{\"id\":$id}" | jq -r '.result.attempts[].log') == *"Permission denied"* ]] || fail "the kernel opened a new folder"
fi
stop_daemon

# What breaks in a worker that was started for another job is no fault of the job.
queue_up "$(job 1-2 '.output.path = "loyal/a/f.####.exr"')" "$(job 1-2 '.output.path = "loyal/b/f.####.exr"')"
start_daemon --worker-program "$(stub loyal)" --workers 1 --max-attempts 1
for id in "${ids[@]}"; do wait_state "$id" succeeded; done
expect_files loyal 4
expect "attempts that were lost" "$(ask job.log "{\"id\":${ids[1]}}" | jq -c '[.result.attempts[].outcome]')" '["lost"]'
stop_daemon

# A worker whose limit of memory is not the one that holds now serves no further job.
rm "$scratch/daemon.log"
echo "worker-memory = 4G" >"$scratch/conf"
start_daemon --config "$scratch/conf" --worker-program "$(stub write)" --workers 1 --log-level debug
for name in a b; do wait_state "$(submit "$(job 1-2 ".output.path = \"limit/$name.####.exr\"")")" succeeded; done
before=$(processes)
echo "worker-memory = 2G" >"$scratch/conf"
kill -HUP "$daemon_pid"
wait_until "the limit is read" grep -q 'changed: worker-memory' "$scratch/daemon.log"
wait_state "$(submit "$(job 1-2 '.output.path = "limit/c.####.exr"')")" succeeded
expect "processes under the new limit" "$(($(processes) - before))" 1
stop_daemon

# Users: none is served by a process that has served another, or waits for one that could go on.
[ "$(id -u)" = 0 ] || { echo "other users can be played by root only: not tried"; exit 0; }
for name in games man mail; do
    getent passwd "$name" >/dev/null || { echo "no user $name here: not tried"; exit 0; }
done
ann=(5 60) bob=(6 12)
run_for_others
rm -rf "$scratch/state" "$scratch/out" "$scratch/daemon.log"
install -d -o 8 -g 8 "$scratch/state" "$scratch/out" "$scratch/run"
socket=$scratch/run/sock
as_daemon=(setpriv --reuid=8 --regid=8 --clear-groups)
start_daemon --worker-program "$(stub write:20)" --workers 1 --log-level debug
chmod 666 "$socket"

# submit_as UID GIDS FRAMES FILE PRIORITY
submit_as()
{
    ask_as "$1" "$2" job.submit "{\"document\":$(job "$3" ".output.path = \"$4\" | .priority = $5")}" | jq '.result.id // empty'
}

long=$(submit_as "${ann[@]}" 1-300 ann/a.####.exr 50)
wait_until "it is rendered" eval '[ "$(field "$long" .succeeded)" -gt 0 ]'
own=$(ask worker.list | jq '.result.workers[0].pid')
next=$(submit_as "${ann[@]}" 1-60 ann/b.####.exr 50)
his=$(submit_as "${bob[@]}" 1-2 bob/c.####.exr 60)
wait_state "$his" succeeded
expect "ann's next job, when bob's with priority is done" "$(field "$next" .succeeded)" 0
wait_state "$long" succeeded
wait_state "$next" succeeded
[ "$(ask worker.list | jq '.result.workers[0].pid')" != "$own" ] || fail "a worker served bob between two jobs of ann's"

# One that has nothing to do leaves as soon as somebody else's job, even a paused one, writes where it could.
own=$(ask worker.list | jq '.result.workers[0].pid')
[ -n "$(ask_as "${bob[@]}" job.submit "{\"paused\":true,\"document\":$(job 1-2 '.output.path = "ann/bob/f.####.exr"')}" | jq '.result.id // empty')" ] ||
    fail "bob may write below ann"
wait_until "ann's worker is gone" eval '[ "$(ask worker.list | jq "[.result.workers[] | select(.pid == '"$own"')] | length")" = 0 ]'
# A worker that is slow to leave is killed, with a warning, when the daemon stops.
grep -q 'warning: worker' "$scratch/daemon.log" && fail "a change of users is no warning"
stop_daemon
exit 0
