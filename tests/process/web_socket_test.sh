#!/bin/bash
# The WebSocket of march-web: messages unchanged each way, events, a page that reads or writes too slowly, a daemon that
# restarts under an open page, a token that is revoked.
. "$PROJECT_ROOT/tests/process/farm.sh"
. "$PROJECT_ROOT/tests/process/web.sh"

start_daemon --worker-program "$(stub write:20)"
start_web
token=$(token submit)
web_python web_socket.py messages "$token" "$(job 1-20)"
web_python web_socket.py odd "$token"
web_python web_socket.py unread "$token" "$web_pid"

# The daemon restarts, and is killed, under an open page.
for way in TERM KILL; do
    rm -f "$scratch/is_open" "$scratch/is_closed"
    web_python web_socket.py restart "$token" "$scratch/is_open" "$scratch/is_closed" &
    page=$!
    wait_until "the page is open" test -e "$scratch/is_open"
    if [ $way = TERM ]; then stop_daemon; else kill_daemon; fi
    wait_until "the page is closed" test -e "$scratch/is_closed"
    start_daemon --worker-program "$(stub write:20)"
    wait $page || fail "the page does not come back after $way"
done

other=$(token read)
rm -f "$scratch/is_open"
web_python web_socket.py revoked "$other" "$scratch/is_open" &
page=$!
wait_until "the page is open" test -e "$scratch/is_open"
id=$(ask token.list | jq '[.result.tokens[] | select(.scope == "read")][0].id')
ask token.revoke "{\"id\":$id}" >"$scratch/answer"
wait $page || fail "a revoked token keeps its page"

# It ends, and the pages with it.
rm -f "$scratch/is_open"
web_python web_socket.py ended "$token" "$scratch/is_open" &
page=$!
wait_until "the page is open" test -e "$scratch/is_open"
stop_web
wait $page || fail "the page stays open"
! grep -qF -e "$token" -e "$other" "$scratch/web.log" || fail "a token is in the log"
stop_daemon
