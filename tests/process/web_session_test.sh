#!/bin/bash
# Whom march-web takes a request for: tokens in headers and cookies, one-time tokens, signing out, and what it says while
# the daemon is away. No token is in any log.
. "$PROJECT_ROOT/tests/process/farm.sh"
. "$PROJECT_ROOT/tests/process/web.sh"

start_daemon
start_web
read_token=$(token read)
submit_token=$(token submit)
once=$(token submit ',"once":true')
once_for_head=$(token read ',"once":true')
once_of_another_site=$(token read ',"once":true')
web_python web_session.py there "$read_token" "$submit_token" "$once" "$once_for_head" "$once_of_another_site" \
    "$(job 1-2)" "$scratch/sessions"

# What was kept open for the next call is closed with the token.
id=$(ask token.list | jq '[.result.tokens[] | select(.scope == "read" and .once == false and .expires == null)][0].id')
ask token.revoke "{\"id\":$id}" >"$scratch/revoked"
web_python web_session.py revoked "$read_token"

stop_daemon
web_python web_session.py away "$submit_token"
start_daemon
web_python web_session.py back "$submit_token"

# What asks whether the daemon is there costs it little.
stop_daemon
rm -f "$socket"
web_python web_session.py shared "$socket"

# Another program at the daemon's socket, or one from before tokens: nothing is sent to it with our own rights.
rm -f "$socket"
web_python web_session.py impostor "$submit_token" "$socket"
rm -f "$socket"
stop_web
for secret in "$read_token" "$submit_token" "$once" "$once_for_head" "$once_of_another_site" $(cat "$scratch/sessions"); do
    ! grep -qF -- "$secret" "$scratch/web.log" "$scratch/daemon.log" || fail "a token is in a log"
done
[ "$(wc -w <"$scratch/sessions")" -ge 1 ] || fail "no session was made"
