#!/bin/bash
# Which pool's workers render which job: by name and tag, by who may use it, and as settings change.
. "$(dirname "$0")/farm.sh"

[ "$(id -u)" = 0 ] || { echo "skip: other users can be played by root only"; exit 77; }
for name in games man; do
    getent passwd $name >"$scratch/entry" || { echo "skip: no $name here"; exit 77; }
done
games=(5 60)
man=(6 12)
run_for_others
install -d -o 8 -g 8 "$scratch/state" "$scratch/out" "$scratch/run"
socket=$scratch/run/sock
as_daemon=(setpriv --reuid=8 --regid=8 --clear-groups)
conf=$scratch/marchd.conf
worker=$(stub write:20)
launcher="command='$bin/march-worker --node --worker $worker'"

# start LINE...: a daemon with one worker here, and the file's lines.
start()
{
    printf '%s\n' "$@" >"$conf"
    start_daemon --workers 1 --worker-program "$worker" --config "$conf"
    chmod 666 "$socket"
}

# submit_as UID GIDS DOCUMENT: prints the answer.
submit_as() { ask_as "$1" "$2" job.submit "{\"document\":$3}"; }
# The frames that the worker here, and those of the node, have rendered so far.
done_by() { ask worker.list | jq -c '[.result.workers | .[0].done, (.[1:] | map(.done) | add)]'; }
# to FOLDER POOL: a filter for `job`; POOL "": any.
to() { echo ".output.path = \"$1/f.####.exr\"${2:+ | .pool = \"$2\"}"; }
idle() { [ "$(ask worker.list | jq -c '[.result.workers[].state] | unique')" = '["idle"]' ]; }

start "pool = far nodes=anna=2 tags=gpu,big $launcher" "pool = local tags=cpu"
wait_until "all workers are idle" idle
expect "a line for each node" "$("$bin/march" workers --nodes --socket "$socket" | awk '{ print $1, $2, $3, $4 }')" \
    $'POOL NODE WORKERS DONE\nlocal - 1 idle\nfar anna 2 idle'
expect "nodes, by march status" "$("$bin/march" status --socket "$socket" | grep '^nodes')" "nodes        1 up"

# By name and by tag; a job that asks for none goes anywhere.
here=$(submit "$(job 1-20 "$(to here cpu)")")
far=$(submit "$(job 1-20 "$(to far far)")")
tagged=$(submit "$(job 1-20 "$(to tagged gpu)")")
for id in "$here" "$far" "$tagged"; do wait_state "$id" succeeded; done
expect "frames of the worker here and of the node" "$(done_by)" "[20,40]"
any=$(submit "$(job 1-5 "$(to any '')")")
wait_state "$any" succeeded
expect "its pool" "$(field "$tagged" .pool)" gpu
expect "the pool of a job that asks for none" "$(field "$any" .pool)" null
expect_error "$(submit_as 0 0 "$(job 1 "$(to x fra)")")" 2 \
    'pool: there is no pool or tag "fra" here: pools are local, far; tags are cpu, gpu, big'
"$bin/march" submit --socket "$socket" --pool fra - 2>"$scratch/said" <<<"$(job 1 "$(to x '')")" >/dev/null && fail "march submits to a pool that is not there"
grep -q 'no pool or tag "fra" here' "$scratch/said" || fail "march submit --pool says $(cat "$scratch/said")"

# The time that is left counts the workers that may take its frames: one here, not all three.
long=$(submit "$(job 1-20000 "$(to long local)")")
wait_until "its time is known" eval '[ "$(field "$long" .eta_s)" != null ]'
expect "its time, by the frames that are left" "$(field "$long" '.eta_s > 0.6 * (.queued + .running) * .seconds_per_frame')" true
# Another job of the pool waits for its worker; one of another pool does not.
next=$(submit "$(job 1-5 "$(to next cpu)")")
expect "why the next one waits" "$(field "$next" .reason)" "waits behind job $long (priority 50)"
other=$(submit "$(job 1-20000 "$(to other big)")")
wait_until "its frames run on the node" eval '"$bin/march" frames --socket "$socket" --state running "$other" | grep -q " on anna$"'
expect "the next one" "$(field "$next" .state)" queued
for id in "$long" "$other"; do ask job.cancel "{\"id\":$id}" >"$scratch/canceled"; done
wait_state "$next" succeeded

# Who may use it, now and after a reload.
reload()
{
    printf '%s\n' "$@" >"$conf"
    ask daemon.reload | jq -c '[.result.changed, .result.restart]'
}
expect "a reload" "$(reload "pool = far nodes=anna=2 tags=gpu users=games $launcher" "pool = local users=@man,games")" '[["pool"],[]]'
expect_error "$(submit_as "${man[@]}" "$(job 1 "$(to man/a gpu)")")" 2 'pool: man may not use "gpu": far is for games'
expect_error "$(submit_as 2 2 "$(job 1 "$(to bin/a '')")")" 2 \
    'pool: bin may use no pool of this farm: local is for @man, games; far is for games'
before=$(done_by)
mans=$(submit_as "${man[@]}" "$(job 1-40 "$(to man/b '')")" | jq .result.id)
wait_state "$mans" succeeded
expect "frames of the node, of man's job" "$(jq -c --argjson before "$before" '.[1] - $before[1]' <<<"$(done_by)")" 0
waiting=$(ask_as "${games[@]}" job.submit "{\"document\":$(job 1-5 "$(to games/b gpu)"),\"paused\":true}" | jq .result.id)
expect "a reload that takes the pool away" "$(reload "pool = far nodes=anna=2 users=man $launcher")" '[["pool"],[]]'
ask job.resume "{\"id\":$waiting}" >"$scratch/resumed"
expect "why it waits" "$(field "$waiting" .reason)" 'waits: there is no pool or tag "gpu" here: pools are local, far'
expect "another reload" "$(reload "pool = far nodes=anna=2 tags=gpu users=man $launcher")" '[["pool"],[]]'
expect "why it waits" "$(field "$waiting" .reason)" 'waits: games may not use "gpu": far is for man'
expect "nodes that change" "$(reload "pool = far nodes=anna=1 tags=gpu users=man $launcher")" '[[],["pool"]]'

# A pool that is not there after a restart: its job waits, others go on.
stop_daemon
start ""
wait_until "the worker is idle" idle
expect "why it waits" "$(field "$waiting" .reason)" 'waits: there is no pool or tag "gpu" here: pools are local'
id=$(submit "$(job 1-5 "$(to on '')")")
wait_state "$id" succeeded
stop_daemon
start "pool = far nodes=anna tags=gpu command=/bin/false"
wait_until "its node fails" eval '[[ "$(field "$waiting" .reason)" == "no worker of pool gpu is ready: node anna: "* ]]'
expect "nodes" "$(ask daemon.status | jq -c .result.nodes)" '{"up":0,"waiting":1}'
stop_daemon
start "pool = far nodes=anna tags=gpu $launcher"
wait_state "$waiting" succeeded
expect_files games/b 5
stop_daemon
