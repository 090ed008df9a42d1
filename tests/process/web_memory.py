"""What web_memory_test.sh tries: march-web may keep 32 MiB, so that a user or a place has 8 and strangers have 16."""
# SPDX-License-Identifier: Apache-2.0
import json
import socket
import sys
import time

from web_client import PATIENCE_S, Client, Closed, WebSocket, ask, bearer, call

port = int(sys.argv[1])
mine, theirs, document, log = sys.argv[2:6]
BODY = 4 * 1024 * 1024 - 1


def begin_body(token, size=BODY):
    """A request whose body does not come; the answer to it, where there is one at once, is to say why."""
    client = Client(port)
    client.send(f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
                f"Content-Length: {size}\r\n\r\nx".encode())
    return client


def is_refused(client):
    """Waits a moment for an answer: a place that is taken is not told."""
    client.socket.settimeout(2)
    try:
        answer = client.answer()
    except TimeoutError:
        return False
    assert answer.status == 503 and "too much waits" in answer.json()["error"], answer
    assert answer.headers["connection"] == "close" and answer.headers["retry-after"], answer
    client.socket.settimeout(PATIENCE_S)
    assert client.is_closed()
    return True


def whole_body(token):
    """Whether a body of the largest size is taken."""
    client = Client(port)
    answer = client.ask("POST", "/rpc", bearer(token), b" " * BODY)
    client.socket.close()
    assert answer.status in (200, 503), answer
    return answer.status == 200


def bodies():
    strangers = [begin_body(f"wrong{number}") for number in range(4)]
    assert [is_refused(client) for client in strangers] == [False, False, True, True]
    assert is_refused(begin_body(mine)), "a token that the farm has not seen yet is a stranger's"
    # Small requests are served all the same, and by them the farm knows who asks.
    assert "result" in call(port, mine, "job.list")
    assert "result" in call(port, theirs, "job.list")
    assert whole_body(mine), "strangers have not taken what users have"
    own = [begin_body(mine) for _ in range(3)]
    assert [is_refused(client) for client in own] == [False, False, True]
    assert not whole_body(mine)
    if theirs != mine:
        assert whole_body(theirs), "one user has not taken all"
    assert "result" in call(port, mine, "job.list")
    # What was answered is there again.
    for client in strangers[:2] + own[:2]:
        client.socket.settimeout(PATIENCE_S)
        client.send(b" " * (BODY - 1))
        assert client.answer().status in (200, 401)
    assert whole_body(mine)
    # A token that is not valid any more, or never was, does not become known by being tried.
    assert ask(port, "POST", "/rpc", bearer("never"), '{"jsonrpc":"2.0","id":1,"method":"job.list"}').status == 401
    again = [begin_body("never") for _ in range(3)]
    assert [is_refused(client) for client in again] == [False, False, True]
    for client in again:
        client.socket.close()


def ask_slowly(token, job):
    """Asks for three megabytes with a small window."""
    client = Client(port, window=4096)
    body = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "job.show", "params": {"id": job}})
    client.send(f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
                f"Content-Length: {len(body)}\r\n\r\n{body}".encode())
    return client


def status_of(client):
    while b"\r\n" not in client.buffer:
        data = client.socket.recv(512)
        assert data, client.buffer
        client.buffer += data
    return int(client.buffer.split(b" ")[1])


def readers(job):
    """Who asks for much and reads little has a share, and loses the connection after some seconds."""
    slow = [ask_slowly(mine, job) for _ in range(4)]
    slow.sort(key=status_of)  # the farm's answers come in any order
    assert [status_of(client) for client in slow] == [200, 200, 503, 503]
    if theirs != mine:  # they may not see the document, but have bytes of their own
        assert whole_body(theirs)
    dripped = len(slow[0].buffer)
    began = time.monotonic()
    while time.monotonic() - began < PATIENCE_S:
        try:
            data = slow[0].socket.recv(2048)
        except ConnectionResetError:
            break
        if not data:
            break
        dripped += len(data)
        time.sleep(0.02)
    assert dripped < 2_900_000, f"who drips got all of it, in {time.monotonic() - began} s"
    slow[1].socket.settimeout(PATIENCE_S)
    received = 0
    while slow[1].receive():
        received = len(slow[1].buffer)
    assert received < 2_900_000, "who read nothing got all of it"
    while True:  # the share is free again
        client = ask_slowly(mine, job)
        if status_of(client) == 200:
            assert client.answer().status == 200
            return
        client.socket.close()


def ask_much(job, window):
    """A page that asks for twelve megabytes and reads nothing yet."""
    page = WebSocket(port, bearer(mine), window=window)
    for number in range(4):
        page.send(json.dumps({"jsonrpc": "2.0", "id": number, "method": "job.show", "params": {"id": job}}))
    return page


def end_of(page):
    """What is read of four answers: 4, or else the code with which the page was closed; 0: none came."""
    try:
        for _ in range(4):
            page.receive()
        return 4
    except Closed as closed:
        return closed.code
    except (EOFError, ConnectionResetError):
        return 0
    finally:
        page.close()


def late_count():
    with open(log) as file:
        return file.read().count("its answer was not taken in time")


def stuck(job):
    """One page that does not read is within the user's share, but not for long."""
    page = ask_much(job, 4096)
    before = late_count()
    began = time.monotonic()
    while late_count() == before:  # the kernel tells us only when we read
        assert time.monotonic() - began < PATIENCE_S, "a page that does not read stays"
        time.sleep(0.1)
    assert time.monotonic() - began > 2
    page.close()


def sockets(job):
    """Pages that ask and do not read: the user's share ends it for those that are above it, and for no others."""
    other = WebSocket(port, bearer(theirs))
    pages = [ask_much(job, 4096) for _ in range(6)]
    ends = [end_of(page) for page in pages]
    assert 1013 in ends and set(ends) <= {4, 1013, 0}, ends
    if theirs != mine:
        assert "result" in other.call(1, "job.list")
    other.close()
    # Messages that do not end.
    pages = [WebSocket(port, bearer(mine)) for _ in range(4)]
    for page in pages:
        page.call(1, "daemon.status")
    ends = []
    for page in pages:
        try:
            page.client.send(page.frame(1, b" " * (3 * 1024 * 1024), final=False))
            page.client.send(page.frame(9, b"here"))
            page.client.socket.settimeout(2)
            first, _ = page.client.take(2)
            ends.append(first & 15)
        except (EOFError, OSError):
            ends.append(8)
    assert ends[0] == 10 and 8 in ends, ends
    for page in pages:
        page.close()
    while not whole_body(mine):
        pass


bodies()
with open(document) as file:
    text = {"document": json.load(file), "paused": True}
submitted = call(port, mine, "job.submit", text)
assert "result" in submitted, submitted
JOB = submitted["result"]["id"]
readers(JOB)
stuck(JOB)
sockets(JOB)
