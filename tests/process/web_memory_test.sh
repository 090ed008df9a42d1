#!/bin/bash
# What clients of march-web make it keep in memory, by bodies that do not come, answers that are not read and messages that
# nobody takes: no more than the settings say, nobody all of it, and not for longer than they say.
. "$PROJECT_ROOT/tests/process/farm.sh"
. "$PROJECT_ROOT/tests/process/web.sh"

"$bin/march-web" --config /dev/null --socket "$socket" --check-config --buffer-bytes 31M 2>"$scratch/err.txt" &&
    fail "a user's share may be smaller than a message"
grep -q 'buffer-bytes: expected at least 32M, got "31M"' "$scratch/err.txt" || fail "$(cat "$scratch/err.txt")"

run_for_others
start_daemon
chmod 666 "$socket"
cp "$PROGRAM_FOLDER/march-web" "$scratch/bin"
start_web --buffer-bytes 32M
mine=$(token submit)
theirs=$mine
if [ "$(id -u)" = 0 ]; then
    theirs=$(ask_as 7 7 token.create '{"scope":"submit","name":"test"}' | jq -er .result.token) || fail "no token"
fi
long=$(job 1 '.lights = [range(6) | {"kind": "point", "intensity": 1, "position": {"keys":
    [range(9000) | [., [1.012345678901, 2.012345678901, 4.012345678901]]]}}]')
echo "$long" >"$scratch/long.json"
id=$(web_python web_memory.py shares "$mine" "$theirs" "$scratch/long.json" "$scratch/web.log") || exit 1
stop_web
start_web --buffer-bytes 32M --send-time 2
web_python web_memory.py times "$mine" "$theirs" "$scratch/long.json" "$scratch/web.log" "$id"
stop_web
stop_daemon
