"""What web_socket_test.sh does with march-web."""
# SPDX-License-Identifier: Apache-2.0
import json
import sys
import time

from web_client import Client, Closed, WebSocket, ask, bearer

import faulthandler
faulthandler.dump_traceback_later(100, exit=True)
port = int(sys.argv[1])
part = sys.argv[2]


def request(number, method, params=None):
    return json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params or {}})


def expect_end(page, *codes):
    """What comes before the end is dropped."""
    try:
        while True:
            page.receive()
    except Closed as closed:
        assert closed.code in codes, closed
        return closed


def messages(token, document):
    page = WebSocket(port, bearer(token))
    assert page.opening.status == 101 and page.opening.headers["sec-websocket-protocol"] == "marchd", page.opening
    assert page.call(1, "job.list")["result"]["jobs"] == []
    # Answers are those of the daemon, letter by letter; what is wrong closes nothing.
    for wrong, code in (("{", -32700), ("[1]", -32600), (request(1, "no.such"), -32601),
                        ('{"jsonrpc":"2.0","id":1,"method":"auth.token","params":{"token":"x"}}', 3)):
        page.send(wrong)
        answer = json.loads(page.receive())
        assert answer["error"]["code"] == code, (wrong, answer)
    # A line feed is a blank of JSON, and begins no second message.
    page.send('{"jsonrpc":"2.0",\n"id":2,\r\n"method":"job.list"\n}\n')
    assert json.loads(page.receive())["id"] == 2
    page.send(request(3, "job.list") + "\n" + request(4, "job.list"))
    assert json.loads(page.receive())["error"]["code"] == -32700
    # In pieces.
    text = request(5, "job.list").encode()
    page.client.send(page.frame(1, text[:10], final=False) + page.frame(0, text[10:20], final=False)
                     + page.frame(9, b"ping") + page.frame(0, text[20:]))
    assert json.loads(page.receive())["id"] == 5
    # A cookie with Origin is as good as the header.
    cookie = {"Cookie": f"marchd_session={token}", "Origin": f"http://localhost:{port}"}
    browser = WebSocket(port, cookie)
    assert "result" in browser.call(1, "daemon.status")
    # Events, and a page's own order of requests.
    assert page.call(6, "events.subscribe")["result"] == {}
    job = browser.call(2, "job.submit", {"document": json.loads(document)})["result"]["id"]
    seen = set()
    while len(seen) < 20 or "job" not in seen:
        event = json.loads(page.receive())["params"]
        if event["type"] == "frame" and event["state"] == "succeeded":
            seen.add(event["frame"])
        elif event["type"] == "job" and event["job"]["id"] == job and event["job"]["state"] == "succeeded":
            seen.add("job")
    # Many at once, and a large one.
    for number in range(100, 600):
        browser.send(request(number, "job.list"))
    assert sorted(json.loads(browser.receive())["id"] for _ in range(500)) == list(range(100, 600))
    large = json.loads(document)
    large["comment"] = "x" * 3_900_000
    assert browser.call(700, "job.submit", {"document": large})["error"]["code"] == -32602
    browser.send(" " * (4 * 1024 * 1024 - 1) + "1")
    assert json.loads(browser.receive())["error"]["code"] == -32600
    browser.close()
    page.close()


def odd(token):
    for send, codes in ((lambda page: page.client.send(page.frame(2, b"{}")), (1003,)),
                        (lambda page: page.send(b" " * (4 * 1024 * 1024 + 1)), (1009,)),
                        (lambda page: page.client.send(page.frame(8, b"\x03\xe8")), (1000,))):
        page = WebSocket(port, bearer(token))
        send(page)
        expect_end(page, *codes)
        page.close()
    # What breaks the protocol ends the connection, one way or the other.
    for raw in (b"\xff" * 100, b"\x81\x85abcd\xff\xfe\xfd\xfc\xfb", b"\x83\x80abcd", b"\x80\x80abcd"):
        page = WebSocket(port, bearer(token))
        page.client.send(raw)
        try:
            expect_end(page, 1000, 1002, 1003, 1007)
        except EOFError:
            pass
        page.close()
    wrong = WebSocket(port, bearer("wrong"))
    assert expect_end(wrong, 1008).reason == "the token is not valid"


def memory_kib(pid):
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


def unread(token, pid):
    """A page that asks and never reads is not heard any more; nothing grows with what it sends, and others go on."""
    page = WebSocket(port, bearer(token))
    before = memory_kib(pid)
    sent = 0
    piece = b"".join(page.frame(1, request(number, "job.list").encode()) for number in range(1000))
    page.client.socket.settimeout(5)
    try:
        while sent < 1 << 30:
            sent += page.client.socket.send(piece)
    except TimeoutError:
        pass
    assert sent < 1 << 30, "a gigabyte of requests is taken from who reads no answer"
    assert memory_kib(pid) - before < 64 * 1024, (before, memory_kib(pid))
    assert ask(port, "GET", "/readyz").status == 200
    other = WebSocket(port, bearer(token))
    assert "result" in other.call(1, "job.list")
    # It reads at last: what it asked is answered, or the daemon has given it up.
    page.client.socket.settimeout(300)
    try:
        assert json.loads(page.receive())["id"] == 0
    except (Closed, EOFError):
        pass
    # The same of one answer that is large, many times.
    half = Client(port)
    half.send(b"GET /vendor/chart.js HTTP/1.1\r\nHost: localhost\r\n\r\n" * 1000)
    assert ask(port, "GET", "/readyz").status == 200
    assert memory_kib(pid) - before < 64 * 1024, (before, memory_kib(pid))
    half.socket.close()
    page.close()
    other.close()


def restart(token, is_open, is_closed):
    page = WebSocket(port, bearer(token))
    page.call(1, "events.subscribe")
    open(is_open, "w").close()
    closed = expect_end(page, 1013)
    assert closed.reason == "the daemon is away", closed
    page.close()
    again = WebSocket(port, bearer(token))
    expect_end(again, 1013)
    open(is_closed, "w").close()
    while True:
        page = WebSocket(port, bearer(token))
        try:
            assert "result" in page.call(1, "job.list")
            return
        except Closed as closed:
            assert closed.code == 1013, closed
            time.sleep(0.1)


def revoked(token, is_open):
    page = WebSocket(port, bearer(token))
    page.call(1, "job.list")
    open(is_open, "w").close()
    expect_end(page, 1013, 1008)
    expect_end(WebSocket(port, bearer(token)), 1008)


def ended(token, is_open):
    page = WebSocket(port, bearer(token))
    page.call(1, "job.list")
    open(is_open, "w").close()
    try:
        expect_end(page, 1001)
    except EOFError:
        pass


globals()[part](*sys.argv[3:])
