# Shared by the tests of march-web: sourced after farm.sh, whose daemon it stands before.
web_pid=
web_port=
as_web=() # what march-web is started with
export XDG_CACHE_HOME=$scratch # its pictures are kept below
export PYTHONPATH=$PROJECT_ROOT/tests/process PYTHONDONTWRITEBYTECODE=1

[ -x "$bin/march-web" ] || fail "there is no $bin/march-web: build all targets, not only the programs"

web_listens()
{
    web_port=$(sed -n 's/.*listens at .* (port \([0-9]*\)).*/\1/p' "$scratch/web.log" | tail -n 1)
    [ -n "$web_port" ] || ! kill -0 "$web_pid" 2>/dev/null
}

# start_web OPTION...: returns once it listens; its port is in $web_port.
start_web()
{
    : >"$scratch/web.log"
    "${as_web[@]}" "$bin/march-web" --config /dev/null --socket "$socket" --listen 127.0.0.1:0 --log-level debug \
        --page-dir "$PROJECT_ROOT/web/page" --document-dir "$PROJECT_ROOT/jobs" "$@" 2>>"$scratch/web.log" &
    web_pid=$!
    wait_until "march-web listens" web_listens
    kill -0 "$web_pid" 2>/dev/null || { cat "$scratch/web.log" >&2; fail "march-web did not start"; }
}

# stop_web: SIGTERM, and the exit status must be 0 (which also says that no memory leaked).
stop_web()
{
    local status=0

    kill -TERM "$web_pid"
    wait "$web_pid" || status=$?
    [ "$status" = 0 ] || { tail -n 40 "$scratch/web.log" >&2; fail "march-web ended with status $status"; }
}

# token SCOPE [MEMBERS]: prints a new one's text. MEMBERS: more of token.create, as in ',"once":true'.
token()
{
    local answer

    answer=$(ask token.create "{\"scope\":\"$1\",\"name\":\"test\"${2-}}")
    jq -er .result.token <<<"$answer" || fail "token.create: $answer"
}

# web_python FILE ARGUMENT...: a part of a test that talks to march-web.
web_python()
{
    PYTHONDONTWRITEBYTECODE=1 python3 "$PROJECT_ROOT/tests/process/$1" "$web_port" "${@:2}" || {
        tail -n 40 "$scratch/web.log" >&2
        fail "$1"
    }
}

# get PATH [HEADER: VALUE]: asks with $token; prints the status; the body is in $scratch/body, the headers in $scratch/head as JSON.
get()
{
    python3 - "$web_port" "$token" "$scratch" "$@" <<'PYTHON'
import json, sys, web_client
port, token, scratch, path = sys.argv[1:5]
headers = web_client.bearer(token) if token else {}
headers.update([text.split(": ", 1) for text in sys.argv[5:]])
answer = web_client.ask(int(port), "GET", path, headers)
open(scratch + "/body", "wb").write(answer.body)
json.dump(answer.headers, open(scratch + "/head", "w"))
print(answer.status)
PYTHON
}

head_of() { jq -r ".[\"$1\"] // empty" "$scratch/head"; }

# expect_get STATUS PATH [TEXT of the error]
expect_get()
{
    expect "GET $2: $(head -c 300 "$scratch/body" 2>/dev/null | tr -cd '[:print:]')" "$(get "$2")" "$1"
    [ -z "${3-}" ] || [[ $(jq -r .error "$scratch/body") == *"$3"* ]] || fail "GET $2: expected \"$3\", got $(cat "$scratch/body")"
}
