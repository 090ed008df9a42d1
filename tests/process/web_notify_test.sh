#!/bin/bash
# Notices reach webhooks and commands: signed, in order, again after failures, and once however often somebody is killed.
. "$(dirname "$0")/farm.sh"

[ -x "$bin/march-web" ] || fail "there is no $bin/march-web: build all targets"
hooks=$scratch/hooks
web_pid=
python3 "$PROJECT_ROOT/tests/process/web_hooks.py" "$hooks" >"$scratch/port" 2>/dev/null &
wait_until "the web server listens" test -s "$scratch/port"
hook=http://127.0.0.1:$(cat "$scratch/port")
touch "$hooks"

# start_web OPTION...: a march-web for the daemon at the socket, on any port.
start_web()
{
    "$bin/march-web" --config /dev/null --socket "$socket" --listen 127.0.0.1:0 "$@" 2>>"$scratch/web.log" &
    web_pid=$!
}
kill_web()
{
    kill -KILL "$web_pid" || fail "march-web was gone already: $(tail "$scratch/web.log")"
    wait "$web_pid" 2>/dev/null
}
stop_web()
{
    local status=0

    kill -TERM "$web_pid"
    wait "$web_pid" || status=$?
    [ "$status" = 0 ] || fail "march-web ended with status $status: $(tail "$scratch/web.log")"
}
pending() { ask notify.pending "${1:-{\}}"; }
count_pending() { pending | jq '.result.notices | length'; }
none_pending() { [ "$(count_pending)" = 0 ]; }
# done_job FOLDER RULES: submits a job whose rules these are; prints its id.
done_job() { submit "$(job 1 ".output.path = \"$1/f.####.exr\" | .notify = $2")"; }
to() { echo "[{\"on\":[\"done\"],\"to\":\"$1\"}]"; }
# got PATH: the jobs that the path was told of with success, in order.
got() { jq -r "select(.path == \"$1\" and .status == 200) | .body | fromjson | .job.id" "$hooks"; }
has_got() { got "$1" | grep -qx "$2"; }
tries() { jq -r "select(.path == \"$1\") | .status" "$hooks" | wc -l; }

# Whether the process has ended, whoever waits for it.
is_gone() { ! grep -q '^State:[[:space:]]*[^Z]' "/proc/$1/status" 2>/dev/null; }

printf 'a secret\n' >"$scratch/secret"
chmod 600 "$scratch/secret"
targets=(
    --notify-target "ok url=$hook/ok secret=$scratch/secret private=yes" --notify-target "gone url=$hook/gone private=yes"
    --notify-target "once url=$hook/once private=yes" --notify-target "hang url=$hook/hang private=yes"
    --notify-target "drip url=$hook/drip private=yes" --notify-target "away url=$hook/away private=yes"
    --notify-target "flood url=$hook/flood private=yes" --notify-target "public url=$hook/public"
    --notify-target "tell command=$scratch/tell --to 'all of them'" --notify-target "slow command=$scratch/slow")
cat >"$scratch/tell" <<END
#!/bin/bash
{ printf '%s|' "\$@"; tr '\n' '|'; echo; env | sort | grep -v '^_=\|^SHLVL\|^PWD' | tr '\n' ' '; pwd; } >>"$scratch/told"
head -c 100000000 /dev/zero | tr '\0' x
END
cat >"$scratch/slow" <<END
#!/bin/bash
echo \$\$ >>"$scratch/slow.pids"
sleep 600 & echo \$! >>"$scratch/slow.pids"
wait
END
chmod +x "$scratch/tell" "$scratch/slow"

start_daemon --worker-program "$(stub write:0)"
before=$(done_job before "$(to ok)") # march-web comes later
start_web "${targets[@]}"
wait_until "the webhook is told" has_got /ok "$before"
wait_until "the daemon knows" none_pending

# What it gets: the body as the daemon made it, signed with the time.
line=$(jq -c 'select(.path == "/ok")' "$hooks")
header() { jq -r ".headers[\"$1\"]" <<<"$line"; }
body=$(jq -r .body <<<"$line")
expect "the event" "$(header x-marchd-event) $(header content-type) $(jq -r .job.state <<<"$body")" "done application/json succeeded"
expect "the id" "$(header x-marchd-id)" "$(jq .id <<<"$body")"
stamp=$(header x-marchd-timestamp)
[ $(($(date +%s) - stamp)) -lt 600 ] || fail "the time: $stamp"
expect "the signature" "$(header x-marchd-signature)" \
    "sha256=$(printf '%s.%s' "$stamp" "$body" | python3 -c 'import hashlib, hmac, sys
print(hmac.new(b"a secret", sys.stdin.buffer.read(), hashlib.sha256).hexdigest())')"

# A server that hangs, answers errors, redirects, or sends without end holds up nobody else.
stop_web
start_web "${targets[@]}" --notify-timeout 3
for name in hang flood away drip once gone public slow; do done_job "$name" "$(to $name)" >/dev/null; done
tell=$(done_job tell "$(to tell)")
after=$(done_job after "$(to ok)")
wait_until "a good target is told meanwhile" has_got /ok "$after"
wait_until "the second attempt" has_got /once "$((before + 5))"
wait_until "a target that sends without end has got it" has_got /drip "$((before + 4))"
expect "attempts at /drip" "$(tries /drip)" 1
wait_until "attempts at what hangs" eval '[ "$(tries /hang)" -ge 2 ]'
wait_until "attempts at what redirects" eval '[ "$(tries /away)" -ge 2 ]'
wait_until "attempts at what floods" eval '[ "$(tries /flood)" -ge 2 ]'
expect "redirects that were followed" "$(grep -c '"/ok"' "$hooks")" 2
wait_until "a target that is gone is given up" grep -q 'for gone: given up: it answers 410' "$scratch/web.log"
wait_until "a private address is refused" grep -q 'for public: given up: its address is of this machine or of a private network' "$scratch/web.log"
expect "attempts at the private address" "$(tries /public)" 0
expect "attempts at /gone" "$(tries /gone)" 1
wait_until "a command is told" test -s "$scratch/told"
wait_until "the command's end is known" grep -q 'for tell: delivered' "$scratch/web.log"
told=$(head -n 1 "$scratch/told")
[[ $told == "--to|all of them|"*"\"id\":$tell,"* ]] || fail "the command got $told"
expect "its environment and folder" "$(tail -n 1 "$scratch/told")" "LANG=C.UTF-8 PATH=/usr/local/bin:/usr/bin:/bin /"
wait_until "a command that does not end is tried again" eval '[ "$(wc -l <"$scratch/slow.pids")" -ge 4 ]'
for pid in $(head -n 2 "$scratch/slow.pids"); do wait_until "the late command $pid is gone" is_gone "$pid"; done
grep -q "for slow: failed, and is tried again: it took too long" "$scratch/web.log" || fail "the log: $(tail "$scratch/web.log")"
stop_web
while read -r pid; do wait_until "the command $pid ends with march-web" is_gone "$pid"; done <"$scratch/slow.pids"

# After its time a notice is given up, and the daemon's log says so.
start_web "${targets[@]}" --notify-timeout 1 --notify-keep 1
wait_until "nothing waits" none_pending
grep -q 'is given up: it answers 500' "$scratch/daemon.log" || fail "no word about /flood in the daemon's log"
grep -q 'is given up: it answers 302, and redirects are not followed' "$scratch/daemon.log" || fail "no word about /away"
stop_web

# Jobs name addresses where they may, and a private one is refused whatever its name.
start_web "${targets[@]}" --notify-webhooks yes
wait_until "addresses are allowed" eval '[ "$(ask job.submit "{\"document\":$(job 1 ".output.path = \"w1/f.#.exr\" | .notify = [{on: [\"done\"], webhook: \"$hook/job\"}]")}" | jq -c ".result | keys" 2>/dev/null)" = "[\"id\"]" ]'
port=${hook##*:}
done_job w2 "[{\"on\":[\"done\"],\"webhook\":\"http://localhost:$port/job?key=hidden\"}]" >/dev/null
wait_until "both are given up" eval '[ "$(grep -c "for \(127.0.0.1\|localhost\):$port: given up: its address" "$scratch/web.log")" = 2 ]'
expect "what the private address got" "$(tries /job)$(tries '/job?key=hidden')" 00
grep -q hidden "$scratch/web.log" "$scratch/daemon.log" && fail "an address is in a log"
stop_web

# Kills of march-web and of the daemon at any moment: none is lost, and a kill repeats one at the most.
: >"$hooks"
start_web "${targets[@]}"
ids=()
for n in $(seq 60); do ids+=("$(done_job "k$n" "$(to ok)")"); done
kills=0
for n in $(seq 12); do
    sleep "0.$((RANDOM % 5))$((RANDOM % 10))"
    kill_web
    kills=$((kills + 1))
    if [ $((n % 3)) = 0 ]; then
        kill_daemon
        start_daemon --worker-program "$(stub write:0)"
    fi
    start_web "${targets[@]}"
done
for id in "${ids[@]}"; do wait_until "job $id is told" has_got /ok "$id"; done
wait_until "the daemon knows of all" none_pending
repeats=$(($(got /ok | wc -l) - 60))
[ "$repeats" -ge 0 ] && [ "$repeats" -le $kills ] || fail "$repeats of 60 notices are repeated by $kills kills"
got /ok | uniq >"$scratch/order" # a repeated one follows itself
expect "those that are not in order" "$(jq -r 'select(.path == "/ok" and .status == 200) | .headers["x-marchd-id"]' "$hooks" | sort -nc 2>&1)" ""
expect "each job once but for repeats" "$(wc -l <"$scratch/order")" 60
stop_web
stop_daemon

# Wrong settings are told by name.
chmod 644 "$scratch/secret"
"$bin/march-web" --config /dev/null --check-config "${targets[@]}" 2>"$scratch/said" && fail "a secret that others read is taken"
grep -q -- "--notify-target: ok: secret $scratch/secret: mode 0644: expected" "$scratch/said" || fail "march-web says $(cat "$scratch/said")"
"$bin/march-web" --config /dev/null --check-config --notify-target "a command=/nowhere/b" 2>"$scratch/said" && fail "a command that is missing"
grep -q -- "--notify-target: a: command /nowhere/b: No such file" "$scratch/said" || fail "march-web says $(cat "$scratch/said")"
