#!/bin/bash
# Webhooks do not reach this machine by an address of its own that is one of the internet's. Such an address is given to the
# loopback of a network namespace, out of which nothing leads.
. "$(dirname "$0")/farm.sh"

if [ "$(id -u)" != 0 ] || ! unshare --net true 2>/dev/null || ! command -v ip >/dev/null; then
    echo "skipped: it takes root, network namespaces and the program ip"
    exit 77
fi
own=9.9.9.9
hooks=$scratch/hooks
touch "$hooks"
cat >"$scratch/inside" <<END
#!/bin/bash
set -e
ip link set lo up
ip address add $own/32 dev lo
python3 "$PROJECT_ROOT/tests/process/web_hooks.py" "$hooks" $own >"$scratch/port" &
while [ ! -s "$scratch/port" ]; do sleep 0.1; done
hook=http://$own:\$(cat "$scratch/port")
exec "$bin/march-web" --config /dev/null --socket "$socket" --listen 127.0.0.1:0 \\
    --notify-target "refused url=\$hook/refused" --notify-target "let url=\$hook/let private=yes"
END
tries() { jq -r "select(.path == \"$1\") | .status" "$hooks" | wc -l; }

start_daemon --worker-program "$(stub write:0)"
unshare --net --pid --fork --kill-child bash "$scratch/inside" 2>>"$scratch/web.log" &
inside=$!
submit "$(job 1 '.output.path = "a/f.####.exr" | .notify = [{on: ["done"], to: "refused"}, {on: ["done"], to: "let"}]')" >/dev/null
wait_until "who may reach it is told" eval '[ "$(tries /let)" = 1 ]'
gives_up() { grep -q 'for refused: given up: its address is of this machine' "$scratch/web.log"; }
wait_until "the other is told or given up" eval 'gives_up || [ "$(tries /refused)" != 0 ]'
expect "what the own address got" "$(tries /refused)" 0
kill -KILL "$inside"
wait "$inside" 2>/dev/null
stop_daemon
