#!/bin/bash
# A token whose user is deleted, renamed, numbered anew, or gets other groups. The list of users is a copy, in a mount namespace.
[ "$(id -u)" = 0 ] || { echo "skip: only root mounts"; exit 77; }
[ "${1-}" = inside ] || { unshare -m true 2>/dev/null || { echo "skip: no mount namespace here"; exit 77; }; exec unshare -m --propagation private "$0" inside; }
. "$(dirname "$0")/farm.sh"
grep -q "^passwd:.*files" /etc/nsswitch.conf || { echo "skip: /etc/passwd is not the list of users here"; exit 77; }
getent passwd tess webber 4321 4323 4324 >"$scratch/entry"
[ ! -s "$scratch/entry" ] || { echo "skip: there is a user tess or webber, or 4321, 4323 or 4324"; exit 77; }
cp /etc/passwd /etc/group "$scratch"
mount --bind "$scratch/passwd" /etc/passwd && mount --bind "$scratch/group" /etc/group || { echo "skip: no file can be mounted here"; exit 77; }
[ -z "$(tail -c 1 "$scratch/passwd")" ] || echo >>"$scratch/passwd"
cp "$scratch/passwd" "$scratch/passwd.before"
# users LINE...: the list of users has these, too.
users() { { cat "$scratch/passwd.before"; printf '%s\n' "$@"; } >/etc/passwd; }
trap 'umount /etc/passwd /etc/group; clean_up' EXIT
run_for_others

users tess:x:4321:4321::/:/bin/sh
echo farmadmins:x:4322: >>/etc/group
start_daemon --worker-program "$(stub write:20)" --admin-group farmadmins --web-user webber
chmod 666 "$socket"
token=$(ask_as 4321 4321 token.create '{"scope":"admin"}' | jq -r .result.token)
once=$(ask_as 4321 4321 token.create '{"scope":"admin","once":true}' | jq -r .result.token)
sign_in() { ask auth.token "{\"token\":\"$1\"}"; }
wrong="token: it is wrong, has expired or was revoked, or its user is gone"
expect "who it is" "$(sign_in "$token" | jq -c '[.result.user, .result.uid]')" '["tess",4321]'

users
expect_error "$(sign_in "$token")" 2 "$wrong"
expect_error "$(sign_in "$once")" 2 "$wrong"
grep -q "token 1 is of tess, uid 4321, who is gone" "$scratch/daemon.log" || fail "the log does not say whose it was"
users rosa:x:4321:4321::/:/bin/sh
expect_error "$(sign_in "$token")" 2 "$wrong"
users tess:x:4323:4321::/:/bin/sh
expect_error "$(sign_in "$token")" 2 "$wrong"
# Another tess is not the one who made it, and neither is another 4321: they see it if the number is theirs.
expect "another tess's tokens" "$(ask_as 4323 4321 token.list | jq -c .result.tokens)" '[]'
users tess:x:4321:4321::/:/bin/sh
expect "who it is again" "$(sign_in "$token" | jq -c .result.user)" '"tess"'

# The user of march-web comes after the daemon's start: its connections are nobody's, too.
expect "a user without a name" "$(ask_as 4324 4324 daemon.status | jq 'has("result")')" true
users tess:x:4321:4321::/:/bin/sh webber:x:4324:4324::/:/bin/sh
expect_error "$(ask_as 4324 4324 daemon.status)" 2 "daemon.status: the connection is nobody's"
expect "notices to it" "$(ask_as 4324 4324 notify.pending | jq -c .error)" null

# Groups are those of the moment of its use.
drain_with() { printf '%s\n' '{"jsonrpc":"2.0","id":1,"method":"auth.token","params":{"token":"'"$1"'"}}' '{"jsonrpc":"2.0","id":2,"method":"daemon.drain"}' | ask_raw | tail -n 1; }
expect_error "$(drain_with "$token")" 2 "only root, the daemon's user and group farmadmins may drain the farm, not tess"
sed 's/^farmadmins:.*/farmadmins:x:4322:tess/' "$scratch/group" >"$scratch/group.new"
cat "$scratch/group.new" >/etc/group
expect "a drain by a new member" "$(drain_with "$token" | jq -c .result)" '{"running":0}'
stop_daemon
