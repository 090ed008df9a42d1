#!/bin/bash
# Every example of `march help VERB` and `marchd --help` runs as printed; only large pictures are made small.
. "$PROJECT_ROOT/tests/process/farm.sh"
PATH=$bin:$PATH
export MARCHD_SOCKET=$socket
mkdir "$scratch/out"
cd "$scratch/out" || exit 1
ln -s "$PROJECT_ROOT/jobs" jobs
# The first job of marchd-job(5), whose frames are in `first`: verify wants a job with a tolerance.
sed -n '/^\.EX/,/^\.EE/{//!p}' "$PROJECT_ROOT/deploy/man/marchd-job.5" | sed 's/\\-/-/g' >first.json
start_daemon --progress-limit 3600
small="--set resolution=[32,18] --set 'quality={\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.05}'"

# The examples name jobs 7 and 8.
for id in 1 2 3 4 5; do
    submit "$(job 0 ".output.path = \"other/$id.####.exr\"")" true >/dev/null
done
march submit first.json --wait --set 'resolution=[32,18]' >/dev/null || fail "the first job"
expect "the example's job" "$(submit "$(job 0-120 '.output.path = "seven/seven.####.exr"')" true)" 7
expect "the other" "$(submit "$(job 0 '.output.path = "eight/eight.####.exr"')")" 8

# Prometheus' own check comes with a package that also starts a service (deploy/packages monitoring). Where it is not, the
# example has to give it metrics all the same.
command -v promtool >/dev/null || promtool() { [ "$*" = "check metrics" ] && grep -q '^marchd_'; }

# example VERB MORE-ARGUMENTS: runs the example in the help of the verb.
tried=
example()
{
    local line

    line=$(march help "$1" | sed -n '/^Example/,$s/^  //p')
    [ -n "$line" ] || fail "march help $1 has no example"
    [[ $line == "march $1"* ]] || fail "the example of $1 is of another verb: $line"
    line=${line//\/tmp\//$scratch\/}
    eval "${line//\/var\/backups\//$scratch\/} ${2-}" >"$scratch/shown" 2>&1 || fail "$line: $(cat "$scratch/shown")"
    tried="$tried $1"
}

example submit "$small"
# Job 7, which `retry` queues again, is not over before `resume`: the workers stand still meanwhile.
wait_state 8 succeeded
workers=$(ask worker.list | jq '.result.workers[].pid')
# shellcheck disable=SC2086 # a word each
kill -STOP $workers
for verb in list show frames log pause prio cancel retry resume; do
    example $verb
done
# shellcheck disable=SC2086
kill -CONT $workers
example watch
example wait
example workers
for verb in validate explain completion version help preview; do
    example $verb
done
example render "$small"
example chart '--size 16x9 --methods midpoint:3 --point-limit 1'
example verify
# The examples name the system's queue, which is no test's to touch.
mkdir -m 700 "$scratch/restored"
example backup "$scratch/state"
example restore "$scratch/restored"
for verb in $(march help --json | jq -r '.verbs[].name'); do
    [[ " $tried " == *" $verb "* ]] || example "$verb"
done
stop_daemon

export HOME=$scratch XDG_RUNTIME_DIR=$scratch XDG_STATE_HOME=$scratch/own
unset MARCHD_SOCKET
marchd --help | sed -n '/^Examples/,$s/^  //p' >"$scratch/examples"
[ "$(wc -l <"$scratch/examples")" -ge 2 ] || fail "marchd --help has no examples"
while read -r line; do
    line=${line//\/tmp\//$scratch\/}
    asked=$(grep -o -- '--socket [^ ]*' <<<"$line")
    eval "exec $line" 2>"$scratch/daemon.log" &
    daemon_pid=$!
    # shellcheck disable=SC2086 # an option and its value
    wait_until "$line answers" eval "march workers $asked >/dev/null 2>&1"
    stop_daemon
done <"$scratch/examples"
