#!/bin/bash
# march web signs a browser in, once; a link on another site's page does not, unless the user wants it.
. "$(dirname "$0")/farm.sh"
[ -x "$bin/march-web" ] || fail "there is no $bin/march-web: build all targets"
start_daemon --worker-program "$(stub write:20)"
"$bin/march-web" --config /dev/null --socket "$socket" --listen 127.0.0.1:0 --page-dir "$PROJECT_ROOT/web/page" 2>"$scratch/web.log" &
web_pid=$!
wait_until "march-web listens" grep -q "listens at" "$scratch/web.log"
port=$(sed -n 's/.*(port \([0-9]*\)).*/\1/p' "$scratch/web.log")
address=$("$bin/march" web --print --url "http://localhost:$port" --socket "$socket") || fail "march web: status $?"
python3 - "$port" "/?${address#*\?}" "$PROJECT_ROOT/tests/process" <<'PYTHON' || fail "see above"
import sys

port, path = int(sys.argv[1]), sys.argv[2]
sys.path.insert(0, sys.argv[3])
from web_client import ask

# The browser says where the click was: from a file or another site's page it is asked first, and nothing is used up.
for site in ("cross-site", "same-site"):
    answer = ask(port, "GET", path, {"Sec-Fetch-Site": site})
    assert answer.status == 200 and "set-cookie" not in answer.headers, answer
    assert f'<a id="sign-in" href="{path}">'.encode() in answer.body, answer
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"], answer
answer = ask(port, "GET", "/?token=%22%3E%3Cscript%3E", {"Sec-Fetch-Site": "cross-site"})
assert answer.status == 401 and b"script" not in answer.body, answer
assert ask(port, "GET", "/?a=b", {"Sec-Fetch-Site": "cross-site"}).status == 403

# The link on that page leads to a session, once.
answer = ask(port, "GET", path, {"Sec-Fetch-Site": "same-origin"})
assert answer.status == 303 and answer.headers["location"] == "/", answer
cookie = answer.headers["set-cookie"]
assert cookie.startswith("marchd_session=marchd_") and "HttpOnly" in cookie and "SameSite=Strict" in cookie, answer
answer = ask(port, "GET", "/session", {"Cookie": cookie.split(";")[0], "Sec-Fetch-Site": "same-origin"})
assert answer.status == 200 and answer.json()["scope"] == "submit", answer
assert ask(port, "GET", path, {"Sec-Fetch-Site": "none"}).status == 401
PYTHON
kill "$web_pid"
wait "$web_pid"
stop_daemon
! grep "marchd_" "$scratch/web.log" "$scratch/daemon.log" || fail "a token is in a log"
