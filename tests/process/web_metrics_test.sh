#!/bin/bash
# GET /metrics: what march metrics prints, for whoever has a token.
. "$(dirname "$0")/farm.sh"
. "$PROJECT_ROOT/tests/process/web.sh"

# get [HEADER...]: prints status, type and text of /metrics.
get()
{
    python3 - "$web_port" "$@" <<'PYTHON'
import http.client
import sys

connection = http.client.HTTPConnection("127.0.0.1", int(sys.argv[1]), timeout=600)
connection.request("GET", "/metrics", headers=dict(header.split(": ") for header in sys.argv[2:]))
answer = connection.getresponse()
print(answer.status, answer.getheader("Content-Type"))
print(answer.read().decode(), end="")
PYTHON
}

start_daemon --worker-program "$(stub write:1)"
start_web
scraper=$(token read)
id=$(submit "$(job 1-3)")
wait_state "$id" succeeded
expect "without a token" "$(get | sed -n '1s/ .*//p')" 401
expect "with a wrong one" "$(get "Authorization: Bearer ${scraper%?}" | sed -n '1s/ .*//p')" 401
get "Authorization: Bearer $scraper" >"$scratch/text" || fail "no answer"
expect "its type" "$(head -n 1 "$scratch/text")" "200 text/plain; version=0.0.4; charset=utf-8"
grep -qx 'marchd_frames_published_total 3' "$scratch/text" || fail "the text: $(cat "$scratch/text")"
expect "its lines, but for their numbers" "$(sed 1d "$scratch/text" | sed 's/ [0-9.e+-]*$//')" \
    "$("$bin/march" metrics --socket "$socket" | sed 's/ [0-9.e+-]*$//')"
stop_daemon
expect "while the daemon is away" "$(get "Authorization: Bearer $scraper" | sed -n '1s/ .*//p')" 503
stop_web
