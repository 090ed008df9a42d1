#!/bin/bash
# What a stranger's requests and another site's pages are refused: hosts, origins, methods, sizes, paths, slow and many
# connections. The daemon and other clients go on meanwhile.
. "$PROJECT_ROOT/tests/process/farm.sh"
. "$PROJECT_ROOT/tests/process/web.sh"

# Settings that would let everybody in are refused.
for wrong in '--listen 0.0.0.0:8470' '--listen [::]:8470' '--listen 127.0.0.1' '--listen localhost:80' '--origin farm' \
    '--origin https://farm/page' '--origin http://farm.example.org' '--origin http://192.0.2.7:8470' \
    '--origin http://localhost.evil.example' '--listen 0.0.0.0:8470 --origin http://localhost:8470' '--connections 0' '--page-dirs x'; do
    # shellcheck disable=SC2086 # an option and its value
    "$bin/march-web" --config /dev/null --socket "$socket" --check-config $wrong >"$scratch/out.txt" 2>"$scratch/err.txt" &&
        fail "$wrong is taken"
    expect "status of $wrong" "$?" 2
    [ -s "$scratch/err.txt" ] || fail "$wrong: nothing is said"
done
printf 'listen = 127.0.0.1:1\nlisten: x\norigins = https://farm\n' >"$scratch/wrong.conf"
"$bin/march-web" --config "$scratch/wrong.conf" --check-config 2>"$scratch/err.txt" && fail "a wrong file is taken"
grep -q 'wrong.conf:2: expected KEY = VALUE' "$scratch/err.txt" || fail "$(cat "$scratch/err.txt")"
grep -q 'wrong.conf:3: origins: there is no such setting, did you mean origin?' "$scratch/err.txt" || fail "$(cat "$scratch/err.txt")"

"$bin/march-web" --config /dev/null --socket "$socket" --check-config --origin http://farm 2>"$scratch/err.txt"
grep -q "expected https://..., got \"http://farm\": http is for this machine's own names" "$scratch/err.txt" ||
    fail "$(cat "$scratch/err.txt")"
"$bin/march-web" --config /dev/null --socket "$socket" --check-config --origin http://localhost:9000 >"$scratch/out.txt" ||
    fail "an origin of this machine by http is refused"

start_daemon
start_web --origin https://farm.example.org --address-connections 40
secret=$(token submit)
echo top secret >"$scratch/secret.js"
web_python web_walls.py walls "$secret" "$(token read ',"once":true')"
web_python web_walls.py streams "$secret"
web_python web_walls.py slow "$secret"
web_python web_walls.py many "$secret"
web_python web_walls.py full "$secret"
kill -0 "$web_pid" || fail "march-web has ended"
stop_web
! grep -q 'libwebsockets: .*assert' "$scratch/web.log" || fail "libwebsockets has failed"
! grep -qF -- "$secret" "$scratch/web.log" || fail "a token is in the log"
