#!/bin/bash
# Tokens: whose identity they give, what each scope may ask for, and how they end. The daemon runs as an ordinary user.
. "$(dirname "$0")/farm.sh"

[ "$(id -u)" = 0 ] || { echo "skip: other users can be played by root only"; exit 77; }
for name in games man mail operator; do
    getent passwd "$name" >"$scratch/entry" || getent group "$name" >"$scratch/entry" || { echo "skip: no $name here"; exit 77; }
done
ann=(5 60)    # games
bob=(6 12)    # man
chief=(7 7,37) # lp; what a token of theirs may is asked of the list of users, not of this connection
web=(9 9)     # news: the user of march-web
run_for_others
install -d -o 8 -g 8 "$scratch/state" "$scratch/out" "$scratch/run"
socket=$scratch/run/sock
as_daemon=(setpriv --reuid=8 --regid=8 --clear-groups)
start_farm()
{
    start_daemon --worker-program "$(stub write:20)" --admin-group operator --web-user news --user-frames 30 "$@"
    chmod 666 "$socket"
}
start_farm

# message METHOD [PARAMS]: one line of a conversation.
message() { printf '{"jsonrpc":"2.0","id":"%s","method":"%s","params":%s}\n' "$1" "$1" "${2:-{\}}"; }
# talk UID GIDS: the lines of standard input in one connection.
talk() { as "$1" "$2" "$bin/socket-client" "$socket"; }
# create UID GIDS PARAMS: a token's text.
create() { ask_as "$1" "$2" token.create "$3" | jq -r '.result.token // .error.message'; }
# with TOKEN METHOD [PARAMS]: the answer that a stranger, the web user, gets with that token.
with()
{
    { message auth.drop; message auth.token "{\"token\":\"$1\"}"; message "$2" "${3:-{\}}"; } | talk "${web[@]}" | tail -n 1
}
sign_in() { { message auth.drop; message auth.token "{\"token\":\"$1\"}"; } | talk "${web[@]}" | tail -n 1; }
wrong="token: it is wrong, has expired or was revoked, or its user is gone"

# A token gives its user's identity to a connection of somebody else.
read_token=$(create "${ann[@]}" '{"scope":"read","name":"dashboard"}')
[[ $read_token =~ ^marchd_[A-Za-z0-9_-]{43}$ ]] || fail "a token: $read_token"
expect "who it is" "$(sign_in "$read_token" | jq -c .result)" '{"user":"games","uid":5,"scope":"read","expires":null,"session":null}'
submit_token=$(create "${ann[@]}" '{"scope":"submit","name":"pipeline","expires_s":3600}')
admin_token=$(create "${ann[@]}" '{"scope":"admin"}')
left=$(sign_in "$submit_token" | jq '.result.expires - now')
[ "${left%.*}" -gt 3000 ] && [ "${left%.*}" -le 3600 ] || fail "expires in $left s"

# A connection that dropped its user is nobody's; root's, too.
for who in "${ann[*]}" "${web[*]}" "0 0"; do
    # shellcheck disable=SC2086 # two words
    said=$({ message auth.drop; message daemon.status; message job.list; message token.list; } | talk $who)
    expect "codes after auth.drop of $who" "$(jq -sc 'map(.error.code)' <<<"$said")" '[null,2,2,2]'
    [[ $said == *"job.list: the connection is nobody's, expected auth.token before it"* ]] || fail "said: $said"
done
# The web user's begins so.
expect_error "$(ask_as "${web[@]}" daemon.status)" 2 "daemon.status: the connection is nobody's"
expect_error "$(ask_as "${web[@]}" token.create '{"scope":"read"}')" 2 "nobody's"

# It may ask for notices, until it drops that, too; so may root and the daemon's user, and nobody else.
for who in "${web[*]}" "0 0" "8 8"; do
    # shellcheck disable=SC2086 # two words
    said=$({ message notify.pending; message auth.drop; message notify.pending; } | talk $who)
    expect "codes of notices to $who" "$(jq -sc 'map(.error.code)' <<<"$said")" '[null,null,2]'
done
expect_error "$(ask_as "${ann[@]}" notify.pending)" 2 "notify.pending: "

# Once a connection.
said=$({ message auth.token "{\"token\":\"$read_token\"}"; message auth.token "{\"token\":\"$submit_token\"}"; message auth.drop; } | talk "${bob[@]}")
expect "codes of a second sign-in" "$(jq -sc 'map(.error.code)' <<<"$said")" '[null,3,3]'

# Who drops their user, or takes another, hears no more of what they subscribed to as before.
job=$(ask_as "${ann[@]}" job.submit "{\"paused\":true,\"document\":$(job 1 '.output.path = "ann/e.####.exr"')}" | jq .result.id)
{ message events.subscribe; message auth.drop; } | as "${ann[@]}" "$bin/socket-client" --keep "$socket" >"$scratch/dropped" &
{ message events.subscribe; message auth.token "{\"token\":\"$read_token\"}"; } | as "${ann[@]}" "$bin/socket-client" --keep "$socket" >"$scratch/taken" &
message events.subscribe | as "${ann[@]}" "$bin/socket-client" --keep "$socket" >"$scratch/kept" &
wait_until "all have begun" eval '[ "$(cat "$scratch"/{dropped,taken,kept} | grep -c "\"result\"")" = 5 ]'
ask_as "${ann[@]}" job.priority "{\"id\":$job,\"priority\":33}" >/dev/null
wait_until "the other hears of it" grep -q '"priority":33' "$scratch/kept"
expect "what they hear" "$(cat "$scratch"/{dropped,taken} | grep -c '"event"')" 0

# What is wrong is told with one text, and the third ends the connection.
gone=$(create "${ann[@]}" '{"scope":"read"}')
id=$(ask_as "${ann[@]}" token.list | jq '.result.tokens[-1].id')
expect "a revoke" "$(ask_as "${ann[@]}" token.revoke "{\"id\":$id}" | jq -c .result)" '{}'
short=$(create "${ann[@]}" '{"scope":"read","expires_s":1}')
wait_until "a token expires" eval '[[ $(sign_in "$short") == *"$wrong"* ]]'
said=$({ message auth.token '{"token":"marchd_guess"}'; message auth.token "{\"token\":\"$gone\"}"; message auth.token "{\"token\":\"$short\"}"
    message auth.token "{\"token\":\"$read_token\"}"; } | talk "${bob[@]}")
expect "three wrong ones and the end" "$(jq -sc 'map([.error.code, .error.message])' <<<"$said")" \
    "$(jq -nc --arg wrong "$wrong" '[[2,$wrong],[2,$wrong],[2,$wrong]]')"
wait_until "the log says who tried" eval 'ask_as "${bob[@]}" auth.token "{\"token\":\"x\"}" >/dev/null; grep -q "token: man tried one that does not hold: there is no such token" "$scratch/daemon.log"'
grep -q "marchd_" "$scratch/daemon.log" && fail "a token is in the log"

# Each scope and each method: R, S and A may it from that scope on, P nobody by a token.
job=$(ask_as "${ann[@]}" job.submit "{\"paused\":true,\"document\":$(job 1-4 '.output.path = "ann/a.####.exr"')}" | jq .result.id)
"$bin/marchd" --openrpc | jq -r '.methods[].name' | grep -v '^auth\.' | sort >"$scratch/methods"
while read -r need method params; do
    echo "$method"
    for scope in read submit admin; do
        name=${scope}_token
        said=$(with "${!name}" "$method" "${params:-{\}}")
        case $need$scope in
        R* | Ssubmit | Sadmin) [[ $said != *"of scope"* && $said != *"no token gives"* ]] || fail "$method, scope $scope: $said" ;;
        Sread | A[rs]*) expect_error "$said" 2 "$method: expected a token of scope " ;;
        Aadmin) expect_error "$said" 2 "only root, the daemon's user and group operator may" ;;
        P*) expect_error "$said" 2 "$method: no token gives the right to it" ;;
        esac
    done
done >"$scratch/tried" <<END
R daemon.status
A daemon.drain
A daemon.undrain
A daemon.reload
S job.submit {"document":{}}
R job.list
R job.show {"id":$job}
R job.frames {"id":$job}
R job.frame_map {"id":$job}
R job.plans {"id":$job}
R job.log {"id":$job}
S job.pause {"id":$job}
S job.resume {"id":1000}
S job.cancel {"id":1000}
S job.retry {"id":1000}
S job.priority {"id":$job,"priority":40}
S job.delete {"id":1000}
R worker.list
R daemon.metrics
R events.subscribe
R events.unsubscribe
P token.create {"scope":"read"}
P token.list
P token.revoke {"id":1}
P notify.pending
P notify.done {"id":1}
END
diff <(sort "$scratch/tried") "$scratch/methods" >&2 || fail "methods that no scope was tried with (>), or that are gone (<)"
expect "the priority that a token set" "$(field "$job" .priority)" 40
# Its user's jobs, and nobody else's.
hers=$(with "$submit_token" job.submit "{\"paused\":true,\"document\":$(job 5 '.output.path = "ann/a.####.exr"')}" | jq .result.id)
expect "the owner of what a token submits" "$(field "$hers" '[.owner, .owner_uid] | join(" ")')" "games 5"
his=$(ask_as "${bob[@]}" job.submit "{\"paused\":true,\"document\":$(job 1 '.output.path = "bob/b.####.exr"')}" | jq .result.id)
for name in submit_token admin_token; do
    expect_error "$(with "${!name}" job.cancel "{\"id\":$his}")" 2 "job $his belongs to man"
done
expect "another's document" "$(with "$admin_token" job.show "{\"id\":$his}" | jq .result.document)" null
expect "their own document, by scope read" "$(with "$read_token" job.show "{\"id\":$job}" | jq -r .result.document.name)" cloud

# An administrator's token of scope submit has no administrator's rights; root's neither.
root_submit=$(create 0 0 '{"scope":"submit"}')
root_admin=$(create 0 0 '{"scope":"admin"}')
expect_error "$(with "$root_submit" job.cancel "{\"id\":$his}")" 2 "job $his belongs to man"
expect_error "$(with "$root_submit" job.submit "{\"document\":$(job 1 '.priority = 150')}")" 2 "expected at most 100, got 150"
expect "an administrator's by scope admin" "$(with "$root_admin" job.priority "{\"id\":$his,\"priority\":150}" | jq .result.priority)" 150
expect "a drain by scope admin" "$(with "$root_admin" daemon.drain | jq -c .result)" '{"running":0}'
expect "its end" "$(with "$root_admin" daemon.undrain | jq -c .result)" '{"running":0}'

# Nor are their limits lifted, and what is lifted for the administrator stays so.
expect_error "$(with "$root_submit" job.submit "{\"paused\":true,\"document\":$(job 1-31 '.output.path = "root/s.####.exr"')}")" 2 "frames: root may have 30 unfinished frames"
[[ $(with "$root_submit" job.submit "{\"paused\":true,\"document\":$(job 1-5 '.output.path = "root/s.####.exr"')}") == *'"id":'* ]] || fail "a few frames by scope submit"
[[ $(with "$root_admin" job.submit "{\"paused\":true,\"document\":$(job 1-99 '.output.path = "root/a.####.exr"')}") == *'"id":'* ]] || fail "many frames by scope admin"
[[ $(ask job.submit "{\"paused\":true,\"document\":$(job 1-99 '.output.path = "root/b.####.exr"')}") == *'"id":'* ]] || fail "many frames by the administrator"

# For one use: it gives a session, and never again.
once=$(create "${ann[@]}" '{"scope":"submit","name":"march web","once":true}')
said=$(sign_in "$once")
session=$(jq -r .result.session <<<"$said")
expect "a session" "$(jq -r '.result | [.user, .scope] | join(" ")' <<<"$said")" "games submit"
left=$(jq '.result.expires - now' <<<"$said")
[ "${left%.*}" -gt 40000 ] && [ "${left%.*}" -le 43200 ] || fail "a session of $left s"
expect_error "$(sign_in "$once")" 2 "$wrong"
expect "a session's session" "$(sign_in "$session" | jq -c '.result | [.user, .scope, .session]')" '["games","submit",null]'
expect_error "$(ask_as "${ann[@]}" token.create '{"scope":"read","once":true,"expires_s":301}')" -32602 "params.expires_s: expected"

# Lists and revokes: their own; administrators all.
expect "her tokens" "$(ask_as "${ann[@]}" token.list | jq -c '[.result.tokens[] | [.name, .scope, .once, .user]]')" \
    '[["dashboard","read",false,"games"],["pipeline","submit",false,"games"],["","admin",false,"games"],["march web","submit",false,"games"]]'
expect "his tokens" "$(ask_as "${bob[@]}" token.list | jq -c .result.tokens)" '[]'
expect "all tokens" "$(ask_as "${chief[@]}" token.list | jq -c '[.result.tokens[].user] | unique')" '["games","root"]'
expect "no secret in a list" "$(ask token.list | jq -c '[.result.tokens[] | keys[]] | unique')" \
    '["created","expires","id","last_used","name","once","scope","user"]'
id=$(ask_as "${ann[@]}" token.list | jq '.result.tokens[0].id')
expect_error "$(ask_as "${bob[@]}" token.revoke "{\"id\":$id}")" 2 "token $id belongs to games"
expect_error "$(ask_as "${bob[@]}" token.revoke '{"id":9999}')" 1 "token 9999: there is no such token"
# A revoke ends the connections of the token.
{ message auth.token "{\"token\":\"$read_token\"}"; message events.subscribe; } |
    as "${web[@]}" "$bin/socket-client" --keep "$socket" >"$scratch/watched" &
watcher=$!
wait_until "it is subscribed" eval '[ "$(grep -c "\"result\"" "$scratch/watched")" = 2 ]'
expect "a revoke by an administrator" "$(ask_as "${chief[@]}" token.revoke "{\"id\":$id}" | jq -c .result)" '{}'
wait "$watcher"
expect_error "$(tail -n 1 "$scratch/watched")" 2 "token: it was revoked"
expect_error "$(sign_in "$read_token")" 2 "$wrong"
# So does the end of its time.
short=$(create "${ann[@]}" '{"scope":"read","expires_s":2}')
{ message auth.token "{\"token\":\"$short\"}"; message events.subscribe; } |
    as "${web[@]}" "$bin/socket-client" --keep "$socket" >"$scratch/watched"
expect_error "$(tail -n 1 "$scratch/watched")" 2 "token: it has expired"

# What is asked with one identity is not answered with another: nothing may be due.
ask_early() { { message token.revoke '{"id":1000}'; message job.priority "{\"id\":$job,\"priority\":41}"; message "auth.$1" "$2"; } | talk "${ann[@]}"; }
wait_until "a sign-in comes too early" eval 'ask_early token "{\"token\":\"$submit_token\"}" | grep -q "expected no other request of the connection to be unanswered"'
wait_until "a drop comes too early" eval 'ask_early drop {} | grep -q "expected no other request of the connection to be unanswered"'
said=$({ message job.list; message auth.token "{\"token\":\"$submit_token\"}"; } | talk "${bob[@]}")
expect "a sign-in behind a long answer" "$(jq -sc 'map(has("result"))' <<<"$said")" "[true,true]"

# Bad requests.
expect_error "$(ask_as "${ann[@]}" token.create '{}')" -32602 "params.scope: expected"
expect_error "$(ask_as "${ann[@]}" token.create '{"scope":"all"}')" -32602 "params.scope: expected"
expect_error "$(ask_as "${ann[@]}" token.create '{"scope":"read","name":"a\nb"}')" -32602 "params.name: expected at most 64 printable bytes"
expect_error "$(ask_as "${ann[@]}" token.create '{"scope":"read","expires_s":0}')" -32602 "params.expires_s: expected"
expect_error "$(ask_as "${ann[@]}" auth.token '{"token":7}')" -32602 "params.token: expected"
expect_error "$(ask_as 65534 65534 token.create '{"scope":"read"}')" 2 "the system does not say who you are"
expect_error "$(ask_as 54321 54321 token.create '{"scope":"read"}')" 2 "uid 54321 has no name"

# A user has at most 100.
for _ in $(seq 105); do message token.create '{"scope":"read","name":"many"}'; done | as "${bob[@]}" "$bin/socket-client" "$socket" >"$scratch/many"
expect "tokens of one user" "$(grep -c '"result"' "$scratch/many")" 100
expect_error "$(grep -m 1 '"error"' "$scratch/many")" 2 "tokens: man may have 100 at a time: revoke one"
ask_as "${ann[@]}" token.create '{"scope":"read"}' | grep -q '"result"' || fail "another user may have some"

# No text of a token is in the state folder; they live on after a kill.
kill_daemon
start_farm
for text in "$read_token" "$submit_token" "$admin_token" "$session" "$once" "$root_admin"; do
    grep -rqF -- "$text" "$scratch/state" && fail "the text of a token is in the state folder"
    grep -rqF -- "${text#marchd_}" "$scratch/state" && fail "the text of a token is in the state folder"
done
expect "a token after a restart" "$(sign_in "$submit_token" | jq -r .result.user)" games
expect "a session after a restart" "$(sign_in "$session" | jq -r .result.user)" games
expect_error "$(sign_in "$read_token")" 2 "$wrong"
expect_error "$(sign_in "$once")" 2 "$wrong"

# Each of the web user's connections is somebody's page: it may have more than a user, and a user no more than that.
keep() { for _ in $(seq 70); do message daemon.status | as "$1" "$2" "$bin/socket-client" --keep "$socket" >>"$scratch/stay-$1" & done; }
keep "${web[@]}"
keep "${bob[@]}"
wait_until "all are answered" eval '[ "$(cat "$scratch"/stay-* | wc -l)" = 140 ]'
expect "of the web user's, refused" "$(grep -c '"message":"connections:' "$scratch/stay-${web[0]}")" 0
expect "of a user's, refused" "$(grep -c 'connections: man may have 64 at a time' "$scratch/stay-${bob[0]}")" 6
stop_daemon
