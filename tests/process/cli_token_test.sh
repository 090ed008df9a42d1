#!/bin/bash
# march token and march web: what they print, what they refuse, and where a secret goes.
. "$(dirname "$0")/farm.sh"
export XDG_RUNTIME_DIR=$scratch/runtime
mkdir -m 700 "$XDG_RUNTIME_DIR"
march() { "$bin/march" "$@" --socket "$socket" >"$scratch/said" 2>"$scratch/err"; }
# status_of WANTED WORDS...: march's exit status.
status_of()
{
    local wanted=$1 status=0

    shift
    march "$@" || status=$?
    expect "the status of march $*" "$status" "$wanted"
}
said() { cat "$scratch/said"; }
sign_in() { ask auth.token "{\"token\":\"$1\"}"; }

status_of 3 token list
start_daemon --worker-program "$(stub write:20)"
status_of 0 token create dashboard
token=$(said)
[[ $token =~ ^marchd_[A-Za-z0-9_-]{43}$ ]] || fail "standard output has more than the token, or less: $token"
grep -q "^token 1 of scope read: keep it" "$scratch/err" || fail "err: $(cat "$scratch/err")"
expect "its scope" "$(sign_in "$token" | jq -r .result.scope)" read
days=$(sign_in "$token" | jq '(.result.expires - now) / 86400')
[ "${days%.*}" = 89 ] || fail "a token holds for $days days"
status_of 0 token create --scope submit --expires 12h --json
expect "members of --json" "$(jq -c keys "$scratch/said")" '["id","token"]'
hours=$(sign_in "$(jq -r .token "$scratch/said")" | jq '(.result.expires - now) / 3600')
[ "${hours%.*}" = 11 ] || fail "a token holds for $hours hours"
status_of 0 token create forever --scope admin --expires never
expect "its end" "$(sign_in "$(said)" | jq -c '[.result.scope, .result.expires]')" '["admin",null]'

# A list shows no secret.
status_of 0 token list
grep -q "^ *ID  NAME *SCOPE *USER *CREATED *EXPIRES *LAST USE" "$scratch/said" || fail "a list: $(said)"
grep -q "^ *1  dashboard *read *$(id -un) *20" "$scratch/said" || fail "a list: $(said)"
grep -q "^ *3  forever *admin *.* -  *20" "$scratch/said" || fail "a list: $(said)"
grep -q "marchd_" "$scratch/said" && fail "a secret in a list"
status_of 0 token list --json
expect "its tokens" "$(jq -c '[.tokens[].id]' "$scratch/said")" '[1,2,3]'

# Revokes, some of which fail.
status_of 0 token revoke 2
expect "what it says" "$(said)" "token 2: revoked"
status_of 1 token revoke 2 3
expect "what it says of the other" "$(said)" "token 3: revoked"
grep -q "token 2: there is no such token" "$scratch/err" || fail "err: $(cat "$scratch/err")"
status_of 1 token revoke 2 1 --json
expect "what --json says" "$(jq -c '[.revoked, [.errors[].id]]' "$scratch/said")" '[[1],[2]]'
expect "what is left" "$(ask token.list | jq -c .result.tokens)" '[]'
[[ $(sign_in "$token") == *'"code":2'* ]] || fail "a revoked token holds"

# Wrong usage changes nothing.
for words in "" nonsense "create a b" "list 1" revoke "revoke x" "create --expires 3x" "create --expires 0d" "create --nonsense"; do
    # shellcheck disable=SC2086 # words
    status_of 2 token $words
done
status_of 2 web nonsense
for url in ftp://x 127.0.0.1:8470 'http://x/"' 'http://x/?a' 'http://x y'; do
    status_of 2 web --url "$url"
done
expect "tokens after wrong usage" "$(ask token.list | jq -c .result.tokens)" '[]'
status_of 2 token create --scope everything
grep -q 'params.scope: expected' "$scratch/err" || fail "err: $(cat "$scratch/err")"

# The page's address: a token for one use, of scope submit, that is in no program's arguments.
status_of 0 web --print
expect "an address" "$(sed 's/marchd_[A-Za-z0-9_-]\{43\}$/T/' "$scratch/said")" "http://127.0.0.1:8470/?token=T"
token=$(sed 's/.*=//' "$scratch/said")
expect "who has it" "$(sign_in "$token" | jq -c '[.result.scope, (.result.session | length)]')" '["submit",50]'
[[ $(sign_in "$token") == *'"code":2'* ]] || fail "a token for one use holds twice"
[ ! -e "$XDG_RUNTIME_DIR/march-web.html" ] || fail "--print writes a file"
status_of 0 web --print --scope read --url https://farm.example/marchd/ --json
expect "another address" "$(jq -r .url "$scratch/said" | sed 's/marchd_[A-Za-z0-9_-]\{43\}$/T/')" "https://farm.example/marchd/?token=T"
mkdir "$scratch/tools"
printf '#!/bin/sh\nprintf "%%s\\n" "$@" >"%s/opened.new"\nmv "%s/opened.new" "%s/opened"\n' "$scratch" "$scratch" "$scratch" >"$scratch/tools/xdg-open"
chmod +x "$scratch/tools/xdg-open"
ln -s "$scratch/elsewhere" "$XDG_RUNTIME_DIR/march-web.html" # which is replaced, not followed
PATH=$scratch/tools:$PATH status_of 0 web
wait_until "the browser is started" test -e "$scratch/opened"
expect "what it is given" "$(cat "$scratch/opened")" "$XDG_RUNTIME_DIR/march-web.html"
expect "who may read that" "$(stat -c %a "$XDG_RUNTIME_DIR/march-web.html")" 600
grep -qF "url=$(said)\"" "$XDG_RUNTIME_DIR/march-web.html" || fail "the file leads elsewhere than to $(said)"
[ ! -e "$scratch/elsewhere" ] || fail "a link was followed"
# Without a browser, or a folder for it, the address is enough.
PATH=$scratch/runtime:$(dirname "$(command -v cat)") status_of 0 web
unset XDG_RUNTIME_DIR
status_of 0 web
grep -q "XDG_RUNTIME_DIR is not set.*: open the address above within five minutes" "$scratch/err" || fail "err: $(cat "$scratch/err")"

# Tokens do not survive a restore: one that was revoked since the copy would be one again.
status_of 0 token create kept --scope admin
token=$(said)
status_of 0 backup "$scratch/copy.db"
status_of 0 token revoke "$(ask token.list | jq '.result.tokens[] | select(.name == "kept") | .id')"
id=$(submit "$(job 1 '.output.path = "a/a.####.exr"')")
wait_state "$id" succeeded
stop_daemon
"$bin/march" restore "$scratch/copy.db" "$scratch/state" >"$scratch/said" 2>&1 || fail "restore: $(said)"
start_daemon --worker-program "$(stub write:20)"
[[ $(sign_in "$token") == *'"code":2'* ]] || fail "a token that was revoked came back with a backup"
expect "tokens after a restore" "$(ask token.list | jq -c .result.tokens)" '[]'
status_of 0 token create anew
stop_daemon
