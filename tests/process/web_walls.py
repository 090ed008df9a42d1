"""What web_walls_test.sh tries."""
# SPDX-License-Identifier: Apache-2.0
import sys
import time

from web_client import PATIENCE_S, Client, WebSocket, ask, bearer, call

port = int(sys.argv[1])
part = sys.argv[2]
BODY = '{"jsonrpc":"2.0","id":1,"method":"job.list"}'


def status(method, path, headers=(), body=None, host=None):
    return ask(port, method, path, headers, body, host).status


def opening(*arguments, **named):
    """The status with which a WebSocket begins, or does not."""
    page = WebSocket(*arguments, **named)
    page.close()
    return page.opening.status


def walls(token, once):
    # Names that were pointed at us (DNS rebinding), also with a right token.
    for host in ("evil.example", f"evil.example:{port}", f"127.0.0.1.nip.io:{port}", "localhost.evil.example", "a",
                 f"localhost:{port}@evil.example", "farm.example.org:1"):
        for path in ("/", "/healthz", "/session", "/page/main.js"):
            answer = ask(port, "GET", path, bearer(token), host=host)
            assert answer.status == 421 and b"evil" not in answer.body, (host, path, answer)
        assert opening(port, bearer(token), host=host) == 421, host
    for host in (f"127.0.0.1:{port}", "localhost", "[::1]:9", "farm.example.org"):
        assert status("GET", "/session", bearer(token), host=host) == 200, host

    # Other sites' pages, also with a right token: a browser says where they are from.
    for origin in ("http://evil.example", f"http://evil.example:{port}", "null", f"http://localhost:{port + 1}",
                   f"https://localhost:{port}", f"http://127.0.0.1:{port}", ""):
        headers = {**bearer(token), "Origin": origin}
        expected = 200 if not origin else 403  # an empty one is none
        assert status("GET", "/session", headers) == expected, origin
        assert status("POST", "/rpc", headers, BODY) == expected, origin
        if origin:
            assert opening(port, headers) == 403, origin
    for site in ("cross-site", "same-site", "strange"):
        headers = {**bearer(token), "Sec-Fetch-Site": site}
        assert status("GET", "/session", headers) == 403, site
        assert status("GET", "/page/main.js", headers) == 403, site
        assert status("GET", "/", headers) == 200, "a link may lead to the page, which holds nothing"
    assert status("GET", "/session", {**bearer(token), "Origin": "https://farm.example.org"},
                  host="farm.example.org") == 200
    assert status("GET", "/session", {**bearer(token), "Origin": "http://farm.example.org"},
                  host="farm.example.org") == 403
    assert opening(port, {"Cookie": f"marchd_session={token}"}) == 403, "a cookie without Origin"
    assert opening(port) == 401
    assert opening(port, bearer(token), path="/") == 404
    assert opening(port, bearer(token), path="/ws?token=" + token) == 400
    assert opening(port, bearer(token), protocol=None) == 400
    assert opening(port, bearer(token), protocol="other") == 400

    # Behind TLS the cookie is for TLS alone.
    answer = ask(port, "GET", f"/?token={once}", host="farm.example.org")
    assert answer.status == 303 and "Secure" in answer.headers["set-cookie"].split("; "), answer

    # No script but our own, no frame, no guess at types, on every answer.
    for method, path, headers in (("GET", "/", ()), ("GET", "/session", bearer(token)), ("GET", "/nothing", ()),
                                  ("GET", "/page/main.js", ()), ("GET", "/vendor/chart.js", ()),
                                  ("POST", "/rpc", bearer("wrong"))):
        answer = ask(port, method, path, headers, BODY if method == "POST" else None)
        policy = answer.headers["content-security-policy"]
        assert "default-src 'none'" in policy and "script-src 'self';" in policy and "unsafe" not in policy, policy
        assert "frame-ancestors 'none'" in policy and "http" not in policy and "*" not in policy, policy
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "no-referrer"
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"
        assert "access-control-allow-origin" not in answer.headers
    page = ask(port, "GET", "/").body.decode()
    assert "http://" not in page and "https://" not in page and "//" not in page.replace("://", ""), "an external host"

    # Paths lead to the page's files and nowhere else.
    for path in ("/page/../../secret.js", "/page/..%2f..%2fsecret.js", "/page/%2e%2e/secret.js", "/page/%00main.js",
                 "/page//etc/passwd", "/page/./main.js/x", "/page/.hidden.js", "/page/", "/page", "/page/main.js%00.js",
                 "/page/main", "/vendor/../page/main.js/..", "/etc/passwd", "//etc/passwd", "/page/main.js/",
                 "/openrpc.jsonx", "/cloud.json", "/page/%ff.js", "/" + "a" * 4000, "/page/" + "../" * 30 + "etc/passwd"):
        try:
            answer = ask(port, "GET", path)
        except EOFError:
            continue  # closed: also no file
        assert answer.status in (400, 403, 404), (path, answer)
        assert b"secret" not in answer.body and b"root:" not in answer.body, path

    # Methods.
    for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "FOO"):
        try:
            assert status(method, "/healthz") in (403, 405), method
        except EOFError:
            pass  # closed
    assert status("POST", "/healthz", body="x") == 405
    assert status("GET", "/rpc", bearer(token)) == 405
    assert status("HEAD", "/healthz") == 200

    # What is unchanged is not sent again.
    first = ask(port, "GET", "/page/main.js")
    again = ask(port, "GET", "/page/main.js", {"If-None-Match": first.headers["etag"]})
    assert again.status == 304 and not again.body and first.headers["cache-control"] == "no-cache", again
    assert ask(port, "GET", "/page/main.js", {"If-None-Match": '"other"'}).status == 200


def refused(request, *, may_answer=(400, 403, 405, 411, 501)):
    """Sends a broken request: it is answered with an error or not at all, and the connection ends."""
    with Client(port) as client:
        client.send(request)
        try:
            answer = client.answer()
            assert answer.status in may_answer, (request, answer)
        except EOFError:
            pass
        assert client.is_closed()
        assert b"HTTP/1.1 200" not in client.buffer, (request, client.buffer)


def streams(token):
    head = f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n".encode()
    body = BODY.encode()
    second = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
    # Two lengths, no length, or another way to tell it: servers before us may read the end elsewhere.
    refused(head + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n" + second)
    refused(head + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" + second)
    refused(head + b"Transfer-Encoding : chunked\r\nContent-Length: 4\r\n\r\n0\r\n\r\n" + second)
    refused(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length : 40\r\n\r\n" + second)
    refused(head + b"Content-Length: 5\r\nContent-Length: 6\r\n\r\n" + body + second)
    refused(head + b"Content-Length: 5, 6\r\n\r\n" + body + second)
    refused(head + b"Content-Length: -5\r\n\r\n" + body + second)
    refused(head + b"Content-Length: +5\r\n\r\n" + body + second)
    refused(head + b"Content-Length: 0x10\r\n\r\n" + body + second)
    refused(head + b"Content-Length: 99999999999999999999\r\n\r\n" + body + second, may_answer=(400, 413))
    refused(head + b"\r\n" + body + second)
    refused(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nGET /" + second)
    refused(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n")
    refused(b"GET /healthz HTTP/1.1\r\n\r\n", may_answer=(421,))
    refused(b"GET http://localhost/healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
    refused(b"CONNECT localhost:22 HTTP/1.1\r\nHost: localhost\r\n\r\n")
    refused(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")
    refused(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\n"
            b"HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n\r\n")
    refused(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\0" * 500)
    refused(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * 20000 + b"\r\n\r\n")
    refused(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + b"X: a\r\n" * 3000 + b"\r\n")
    refused(b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n")
    refused(b"GET /healthz?" + b"a=1&" * 40 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n")

    # A body is read before the next request is, in one piece or in many.
    with Client(port) as client:
        client.send(head + b"Content-Length: %d\r\n\r\n" % len(body) + body)
        assert client.answer().status == 200
        for byte in head + b"Content-Length: %d\r\n\r\n" % len(body) + body:
            client.send(bytes([byte]))
        assert client.answer().json()["id"] == 1
    # One who does not wait for an answer is answered in order, or closed: never twice, never by another's.
    with Client(port) as client:
        one = head + b"Content-Length: %d\r\n\r\n" % len(body) + body
        client.send(one + second + second)
        assert client.is_closed() or True
        assert client.buffer.count(b"HTTP/1.1 200") <= 3, client.buffer

    # A body over the limit is refused before it is sent, and the answer can be read.
    with Client(port) as client:
        answer = client.ask("POST", "/rpc", bearer(token), b" " * (4 * 1024 * 1024 + 1))
        assert answer.status == 413 and answer.headers["connection"] == "close", answer
    with Client(port) as client:
        answer = client.ask("POST", "/rpc", bearer(token), b" " * (4 * 1024 * 1024))
        assert answer.status == 200 and answer.json()["error"]["code"] == -32700, answer
    with Client(port) as client:
        assert client.ask("POST", "/logout", (), b"x").status == 413
    assert "result" in call(port, token, "job.list"), "others are served as before"


def slow(token):
    """Slowloris: heads and bodies that never end are closed; who is quick is served meanwhile."""
    began = time.monotonic()
    clients = [Client(port) for _ in range(12)]
    for number, client in enumerate(clients):
        if number % 3 == 1:
            client.send(b"GET /healthz HTTP/1.1\r\nHost: loc")
        elif number % 3 == 2:
            client.send(f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
                        "Content-Length: 100\r\n\r\nx".encode())
    open_clients = list(clients)
    while open_clients:
        assert ask(port, "GET", "/healthz").status == 200
        for client in list(open_clients):
            client.socket.settimeout(0.5)
            try:
                if not client.receive():
                    open_clients.remove(client)
                    continue
                client.send(b"a")  # a byte now and then keeps nobody in
            except TimeoutError:
                try:
                    client.send(b"a")
                except OSError:
                    open_clients.remove(client)
            except OSError:
                open_clients.remove(client)
        assert time.monotonic() - began < 1800, "slow connections stay"
    for client in clients:
        client.socket.close()


def is_open(client, patience=0.2):
    """Whether the server has not closed it; what it sent is in the buffer."""
    client.socket.settimeout(patience)
    try:
        return client.receive()
    except TimeoutError:
        return True


def count_closed(clients, at_least):
    """How many are closed; waits for so many."""
    closed = set()
    began = time.monotonic()
    while len(closed) < at_least and time.monotonic() - began < PATIENCE_S:
        for number, client in enumerate(clients):
            if number not in closed and not is_open(client, 0.05):
                closed.add(number)
    return closed


def many(token):
    """More connections from one machine than it may have: whoever asks is served, those who say nothing make room."""
    body = BODY.encode()
    head = f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer %s\r\nContent-Length: {len(body)}\r\n\r\n"
    assert "result" in call(port, token, "job.list")  # from here on it is known
    page = WebSocket(port, bearer(token))
    assert "result" in page.call(1, "job.list")
    known = Client(port)
    known.send((head % token).encode() + body[:5])
    assert ask(port, "GET", "/healthz").status == 200  # by then its head has been read
    # Also from other addresses of this machine: 127.0.0.0/8 is one place.
    silent = [Client(port, source=f"127.0.0.{2 + number % 50}") for number in range(60)]
    assert ask(port, "GET", "/healthz").status == 200
    closed = count_closed(silent, 20)
    assert max(closed) < 30, ("the oldest go first", closed)
    # Who has begun to send something is no better off, unless the farm knows them.
    beginning = [Client(port) for _ in range(60)]
    for number, client in enumerate(beginning):
        try:
            client.send(b"GET /healthz HTTP/1.1\r\nHost: loc" if number % 2 else (head % f"wrong{number}").encode() + b"x")
        except OSError:
            pass  # closed
        assert "result" in call(port, token, "job.list"), number
    assert len(count_closed(beginning, 20)) >= 20
    assert "result" in page.call(2, "job.list"), "a WebSocket makes no room"
    known.send(body[5:])
    assert known.answer().status == 200, "nor does a request whose user is known"
    for client in [*silent, *beginning, known]:
        client.socket.close()
    page.close()


def full(token):
    """All places are taken by those that may not be closed: the newest is refused, and places come back."""
    pages = []
    while True:
        try:
            page = WebSocket(port, bearer(token))
            page.call(1, "job.list")
            pages.append(page)
        except (EOFError, OSError):
            break
    assert len(pages) == 40, len(pages)
    for page in pages:
        assert "result" in page.call(2, "job.list")
        page.close()
    while True:
        try:
            assert "result" in call(port, token, "job.list")
            return
        except (EOFError, OSError):
            pass


globals()[part](*sys.argv[3:])
