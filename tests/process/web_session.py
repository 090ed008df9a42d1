"""What web_session_test.sh asks march-web."""
# SPDX-License-Identifier: Apache-2.0
import json
import socket
import sys
import threading
import time

from web_client import PATIENCE_S, Client, Closed, WebSocket, ask, bearer, call

port = int(sys.argv[1])
part = sys.argv[2]


def sign_in(once):
    answer = ask(port, "GET", f"/?token={once}", {"Sec-Fetch-Site": "none"})
    assert answer.status == 303 and answer.headers["location"] == "/", answer
    parts = answer.headers["set-cookie"].split("; ")
    assert set(parts[1:]) >= {"HttpOnly", "SameSite=Strict", "Path=/"}, parts
    assert "Secure" not in parts, "no cookie over plain HTTP where it wants TLS"
    assert answer.headers["referrer-policy"] == "no-referrer" and answer.headers["cache-control"] == "no-store"
    return parts[0]


def there(read_token, submit_token, once, once_for_head, once_of_another_site, document, sessions):
    assert ask(port, "GET", "/readyz").status == 200
    assert ask(port, "GET", "/session").status == 401
    wrong = ask(port, "GET", "/session", bearer("wrong"))
    assert wrong.status == 401 and "token" in wrong.json()["error"], wrong
    assert ask(port, "GET", "/session", bearer('a b"')).status == 401
    shown = ask(port, "GET", "/session", bearer(read_token)).json()
    assert shown["scope"] == "read" and shown["expires"] is None and shown["user"], shown

    # Scopes are the daemon's matter: its answer comes unchanged.
    refused = call(port, read_token, "job.submit", {"document": json.loads(document)})
    assert refused["error"]["code"] == 2, refused
    job = call(port, submit_token, "job.submit", {"document": json.loads(document), "paused": True})["result"]["id"]
    assert call(port, read_token, "job.show", {"id": job})["result"]["state"] == "paused"
    wrong = call(port, submit_token, "job.submit", {"document": {"frames": "x"}})
    assert wrong["error"]["code"] == -32602, wrong
    # The next call over a kept connection is the other token's no more.
    assert call(port, read_token, "job.cancel", {"id": job})["error"]["code"] == 2

    body = '{"jsonrpc":"2.0","id":"\\u00e4","method":"daemon.status"}'
    assert ask(port, "POST", "/rpc", bearer(read_token), body).json()["id"] == "ä"
    for wrong, code in (("{", -32700), ('{"jsonrpc":"2.0","method":"job.list"}', -32600), ("[]", -32600), ("", -32700),
                        ('{"jsonrpc":"2.0","id":1,"method":"events.subscribe"}', -32600),
                        ('{"jsonrpc":"2.0","id":1,"method":"auth.drop"}', -32600),
                        ('{"jsonrpc":"2.0","id":1,"method":"no.such"}', -32601)):
        answer = ask(port, "POST", "/rpc", bearer(read_token), wrong)
        assert answer.status == 200 and answer.json()["error"]["code"] == code, (wrong, answer)
    # Line feeds of a request are no second message.
    with Client(port) as client:
        two = '{"jsonrpc":"2.0",\n"id":5,\n"method":"job.list"}\n{"jsonrpc":"2.0","id":6,"method":"job.list"}'
        assert client.ask("POST", "/rpc", bearer(read_token), two).json()["error"]["code"] == -32700
        one = '{"jsonrpc":"2.0",\n"id":5,\n"method":"job.list"}'
        for _ in range(3):
            assert client.ask("POST", "/rpc", bearer(read_token), one).json()["id"] == 5

    # Only a one-time token signs in by an address, once, by GET, and by no other site's link.
    assert ask(port, "GET", f"/?token={submit_token}").status == 403
    assert ask(port, "GET", "/?token=wrong").status == 401
    assert ask(port, "HEAD", f"/?token={once_for_head}").status == 405
    # Another site's link is asked about, by a link of our own page, and uses nothing up meanwhile.
    for site in ("cross-site", "same-site"):
        answer = ask(port, "GET", f"/?token={once_of_another_site}", {"Sec-Fetch-Site": site})
        assert answer.status == 200 and "set-cookie" not in answer.headers, answer
        assert f'href="/?token={once_of_another_site}"'.encode() in answer.body, answer
        assert ask(port, "GET", '/?token=%22%3E%3Cscript%3E', {"Sec-Fetch-Site": site}).status == 401
    answer = ask(port, "GET", f"/?token={once_of_another_site}", {"Sec-Fetch-Site": "same-origin"})
    assert answer.status == 303 and "set-cookie" in answer.headers, answer
    for path in (f"/session?token={once}", f"/rpc?token={once}", f"/page/main.js?token={once}"):
        assert ask(port, "GET", path).status in (400, 405), path
    cookie = sign_in(once)
    assert ask(port, "GET", f"/?token={once}").status == 401, "it holds once"
    sign_in(once_for_head)

    page = {"Cookie": f"other=1; {cookie}; more=2"}
    assert ask(port, "GET", "/session", page).json()["scope"] == "submit"
    own = f"http://localhost:{port}"
    body = '{"jsonrpc":"2.0","id":1,"method":"job.list"}'
    # A cookie alone may be another site's doing.
    assert ask(port, "POST", "/rpc", page, body).status == 403
    assert ask(port, "POST", "/rpc", {**page, "Origin": "http://evil.example"}, body).status == 403
    assert ask(port, "POST", "/rpc", {**page, "Origin": "http://localhost:1"}, body).status == 403
    assert ask(port, "POST", "/rpc", {**page, "Sec-Fetch-Site": "same-site"}, body).status == 403
    assert ask(port, "POST", "/rpc", {**page, "Origin": own}, body).json()["result"]["total"] == 1
    assert ask(port, "POST", "/rpc", {**page, "Sec-Fetch-Site": "same-origin"}, body).status == 200
    out = ask(port, "POST", "/logout", {**page, "Origin": own}, "")
    assert out.status == 204 and out.headers["set-cookie"].startswith("marchd_session=;"), out
    assert "Max-Age=0" in out.headers["set-cookie"]
    with open(sessions, "w") as file:
        file.write(cookie.split("=", 1)[1] + "\n")


def revoked(token):
    while ask(port, "GET", "/session", bearer(token)).status == 200:
        pass
    body = '{"jsonrpc":"2.0","id":1,"method":"job.list"}'
    while ask(port, "POST", "/rpc", bearer(token), body).status == 200:
        pass  # a connection that was kept is closed within seconds
    assert ask(port, "POST", "/rpc", bearer(token), body).status == 401


def away(token):
    assert ask(port, "GET", "/healthz").status == 200, "the program runs"
    while (answer := ask(port, "GET", "/readyz")).status == 200:
        pass  # an answer holds for a second
    assert answer.status == 503 and "daemon" in answer.json()["error"] and answer.headers["retry-after"], answer
    assert ask(port, "GET", "/session", bearer(token)).status == 503
    assert ask(port, "POST", "/rpc", bearer(token), '{"jsonrpc":"2.0","id":1,"method":"job.list"}').status == 503


def back(token):
    while ask(port, "GET", "/readyz").status != 200:
        pass  # an answer holds for a second
    assert "result" in call(port, token, "job.list")


def impostor(token, path):
    """A listener that knows no auth.drop gets nothing else."""
    heard = []
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(path)
    listener.listen(8)

    def serve():
        while True:
            connection, _ = listener.accept()
            connection.settimeout(PATIENCE_S)
            heard.append(connection.recv(65536))
            connection.sendall(b'{"jsonrpc":"2.0","id":1,"error":{"code":-32601,"message":"no such method"}}\n')
            heard.append(connection.recv(65536))

    threading.Thread(target=serve, daemon=True).start()
    answer = ask(port, "POST", "/rpc", bearer(token), '{"jsonrpc":"2.0","id":1,"method":"job.list"}')
    assert answer.status == 502, answer
    page = WebSocket(port, bearer(token))
    try:
        page.receive()
        raise AssertionError("the WebSocket stays open")
    except Closed as closed:
        assert closed.code == 1013, closed
    said = b"".join(heard)
    assert said.count(b"auth.drop") == 2 and token.encode() not in said and b"job.list" not in said, said


def shared(path):
    """However many ask whether the daemon answers, it is asked once a second."""
    taken = []
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(path)
    listener.listen(256)

    def serve():
        while True:
            connection, _ = listener.accept()
            taken.append(connection)
            connection.recv(65536)
            connection.sendall(b'{"jsonrpc":"2.0","id":1,"result":{}}\n')

    time.sleep(1.5)  # what was said of the daemon before is out of date
    threading.Thread(target=serve, daemon=True).start()
    began = time.monotonic()
    clients = [Client(port) for _ in range(20)]
    for client in clients:
        client.send(b"GET /readyz HTTP/1.1\r\nHost: localhost\r\n\r\n")
    clients.pop().socket.close()  # who goes away takes nobody's answer along
    for client in clients:
        answer = client.answer()
        assert answer.status == 200 and answer.body == b"ok\n", answer
    for _ in range(100):
        assert clients[0].ask("GET", "/readyz").status == 200
    seconds = time.monotonic() - began
    assert 1 <= len(taken) <= seconds + 2, (len(taken), seconds)


globals()[part](*sys.argv[3:])
