# The page in a browser's place: march-web's own package and unit. Sourced by tests/service.

web_port=
web_cookie=

# web_get PATH: prints the status; the body is in $work/web_body, the headers as JSON in $work/web_head.
web_get()
{
    PYTHONPATH=$here/process PYTHONDONTWRITEBYTECODE=1 python3 - "$web_port" "$1" "$web_cookie" "$work" <<'PYTHON'
import json, sys, web_client
port, path, cookie, folder = sys.argv[1:]
answer = web_client.ask(int(port), "GET", path, {"Cookie": cookie} if cookie else {})
open(folder + "/web_body", "wb").write(answer.body)
json.dump(answer.headers, open(folder + "/web_head", "w"))
print(answer.status)
PYTHON
}

web_says()
{
    [ "$(web_get "$1" 2>/dev/null)" = "$2" ]
}

web_pid()
{
    inside systemctl show -P MainPID march-web.service
}

page_is_served()
{
    local id address exposure pid

    apt install /root/marchd-web.deb
    expect "before it is turned on" "$(inside systemctl is-active march-web.service || true) $(inside systemctl is-enabled march-web.service || true)" \
        "inactive disabled"
    web_port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
    echo "listen = 127.0.0.1:$web_port" >>"$root/etc/marchd/march-web.conf"
    inside systemctl enable --now march-web.service
    pid=$(web_pid)
    expect "who runs it" "$(inside ps -o user= -p "$pid")" marchd-web
    expect "its cache" "$(inside stat -c '%U %a' /var/cache/marchd-web)" "marchd-web 700"
    exposure=$(inside systemd-analyze security --no-pager march-web.service | sed -nE 's/.*exposure level.*: ([0-9.]+) .*/\1/p')
    echo "exposure: $exposure"
    awk -v e="$exposure" 'BEGIN { exit !(e != "" && e <= 2.0) }' || fail "exposure is $exposure"
    until_true "it is ready" web_says /readyz 200

    # Without a token there is the page, and nothing of the farm.
    expect "the page" "$(web_get /)" 200
    grep -q '<title>' "$work/web_body" || fail "no page: $(head -c 300 "$work/web_body")"
    expect "the page's script" "$(web_get /page/main.js)" 200
    expect "the charts" "$(web_get /vendor/chart.js)" 200
    expect "what methods there are" "$(web_get /openrpc.json)" 200
    expect "metrics for a stranger" "$(web_get /metrics)" 401
    ends 4 "" as eve march web --print --url "http://127.0.0.1:$web_port"

    id=$(submit ann "$(cloud_job 1-2 64 36 shown)")
    as ann march wait "$id"
    address=$(as ann march web --print --url "http://127.0.0.1:$web_port" | grep -o 'http://[^ ]*')
    expect "signing in" "$(web_get "${address#http://127.0.0.1:"$web_port"}")" 303
    web_cookie=$(jq -r '.["set-cookie"]' "$work/web_head" | cut -d ';' -f 1)
    expect "who is signed in" "$(web_get /session) $(jq -r '.user + " " + .scope' "$work/web_body")" "200 ann submit"
    expect "metrics" "$(web_get /metrics)" 200
    grep -q '^# TYPE marchd_' "$work/web_body" || fail "no metrics: $(head -n 3 "$work/web_body")"
    expect "a picture" "$(web_get "/frame/$id/1.png") $(head -c 4 "$work/web_body" | tail -c 3)" "200 PNG"
    expect "what is modelled" "$(web_get "/job/$id/explain")" 200

    # It stays while the daemon is away, says so, and comes back with it.
    inside systemctl stop marchd.socket marchd.service
    until_true "it says that the daemon is away" web_says /readyz 503
    expect "its health" "$(web_get /healthz)" 200
    expect "a session meanwhile" "$(web_get /session)" 503
    inside systemctl start marchd.socket marchd.service
    until_true "it is ready again" web_says /readyz 200
    until_true "the session goes on" web_says /session 200
    expect "its process" "$(web_pid)" "$pid"

    # Another version of the package serves the page at once; without the package nobody does.
    apt install --reinstall /root/marchd-web.deb
    until_true "the new program is ready" web_says /readyz 200
    [ "$(web_pid)" != "$pid" ] || fail "the old program serves the page"
    web_cookie=
    apt purge marchd-web
    expect "processes" "$(inside pgrep -a march-web || true)" ""
    expect "folders" "$(find "$root/var/cache" "$root/etc" -name '*march*web*' ! -path '*/apt/*')" ""
}
