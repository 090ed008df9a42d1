"""What web_memory_test.sh tries: march-web may keep 32 MiB, so that a user or a place has 8 and strangers have 16.

`shares`: nobody is ended for being slow; prints the id of a job of three megabytes.
`times`: who does not read such a job, whose id comes last, is ended after two seconds.
"""
# SPDX-License-Identifier: Apache-2.0
import json
import select
import sys
import time

from web_client import PATIENCE_S, Client, Closed, WebSocket, ask, bearer, call

port = int(sys.argv[1])
part, mine, theirs, document, log = sys.argv[2:7]
BODY = 4 * 1024 * 1024 - 1
CLOSE_TIME_S = 10  # for the client to take why its page is closed
BODY_TIME_S = 60  # for a body to come


def begin_body(token, size=BODY):
    """A request whose body does not come; the answer to it, where there is one at once, is to say why."""
    client = Client(port)
    client.send(f"POST /rpc HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
                f"Content-Length: {size}\r\n\r\nx".encode())
    return client


def expect_refusal(client):
    answer = client.answer()
    assert answer.status == 503 and "too much waits" in answer.json()["error"], answer
    assert answer.headers["connection"] == "close" and answer.headers["retry-after"], answer
    assert client.is_closed()


def those_that_wait(clients, refused):
    """The others, when so many are refused: a place that is taken is not told."""
    waiting = list(clients)
    while len(waiting) > len(clients) - refused:
        ready, _, _ = select.select([client.socket for client in waiting], [], [], PATIENCE_S)
        assert ready, f"{len(clients) - len(waiting)} are refused, expected {refused}"
        for client in [client for client in waiting if client.socket in ready]:
            waiting.remove(client)
            expect_refusal(client)
    for _ in range(2):  # what came before these has been looked at
        ask(port, "GET", "/")
    assert select.select([client.socket for client in waiting], [], [], 0)[0] == [], "more are refused"
    return waiting


def whole_body(token):
    """Whether a body of the largest size is taken."""
    client = Client(port)
    answer = client.ask("POST", "/rpc", bearer(token), b" " * BODY)
    client.socket.close()
    assert answer.status in (200, 503), answer
    return answer.status == 200


def bodies(is_first):
    strangers = those_that_wait([begin_body(f"wrong{number}") for number in range(4)], 2)
    if is_first:
        expect_refusal(begin_body(mine))  # a token that the farm has not seen yet is a stranger's
    # Small requests are served all the same, and by them the farm knows who asks.
    assert "result" in call(port, mine, "job.list")
    assert "result" in call(port, theirs, "job.list")
    assert whole_body(mine), "strangers have not taken what users have"
    own = those_that_wait([begin_body(mine) for _ in range(3)], 1)
    assert not whole_body(mine)
    if theirs != mine:
        assert whole_body(theirs), "one user has not taken all"
    assert "result" in call(port, mine, "job.list")
    # What was answered is there again.
    for client in strangers + own:
        client.send(b" " * (BODY - 1))
        assert client.answer().status in (200, 401)
    assert whole_body(mine)
    # A token that is not valid any more, or never was, does not become known by being tried.
    assert ask(port, "POST", "/rpc", bearer("never"), '{"jsonrpc":"2.0","id":1,"method":"job.list"}').status == 401
    for client in those_that_wait([begin_body("never") for _ in range(3)], 1):
        client.socket.close()


def bodies_in_time():
    """On a slow machine they may be awaited for too long: once more."""
    is_first = True
    while True:
        began = time.monotonic()
        try:
            return bodies(is_first)
        except (AssertionError, EOFError, OSError):
            if time.monotonic() - began < BODY_TIME_S - 5:
                raise
        is_first = False


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
    """Who asks for much and reads little has a share."""
    slow = [ask_slowly(mine, job) for _ in range(4)]
    slow.sort(key=status_of)  # the farm's answers come in any order
    assert [status_of(client) for client in slow] == [200, 200, 503, 503]
    if theirs != mine:  # they may not see the document, but have bytes of their own
        assert whole_body(theirs)
    for client in slow:
        client.socket.close()
    while True:  # the share is free again
        client = ask_slowly(mine, job)
        if status_of(client) == 200:
            assert client.answer().status == 200
            return
        client.socket.close()


def slow_readers(job):
    """Who reads little loses the connection after some seconds."""
    dripped, unread = [ask_slowly(mine, job) for _ in range(2)]
    while late_count() < 2:
        try:
            dripped.buffer += dripped.socket.recv(256)  # for all of it, four minutes
        except ConnectionResetError:
            pass
        time.sleep(0.02)
    for client, what in (dripped, "drips"), (unread, "reads nothing"):
        assert client.is_closed()
        assert len(client.buffer) < 2_900_000, f"who {what} got all of it"


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
    before = late_count()
    began = time.monotonic()
    page = ask_much(job, 4096)
    while late_count() == before:  # the kernel tells us only when we read
        assert time.monotonic() - began < PATIENCE_S, "a page that does not read stays"
        time.sleep(0.1)
    assert time.monotonic() - began > 1.5
    page.close()


def answer_to_ping(page):
    """10; 8 where the page was ended."""
    try:
        page.client.send(page.frame(9, b"here"))
        first, second = page.client.take(2)
        page.client.take(second & 0x7F)
        return first & 15
    except (EOFError, ConnectionError):
        return 8


def begin_message():
    """A page whose message does not end."""
    page = WebSocket(port, bearer(mine))
    try:
        page.call(1, "daemon.status")
        page.client.send(page.frame(1, b" " * (3 * 1024 * 1024), final=False))
    except (EOFError, ConnectionError, Closed):
        pass
    return page


def sockets(job):
    """Pages that ask and do not read: the user's share ends it for those that are above it, and for no others."""
    other = WebSocket(port, bearer(theirs))
    began = time.monotonic()
    pages = [ask_much(job, 4096) for _ in range(6)]
    ends = [end_of(page) for page in pages]
    assert set(ends) <= {4, 1013, 0}, ends
    assert 1013 in ends or 0 in ends and time.monotonic() - began > CLOSE_TIME_S, ends
    if theirs != mine:
        assert "result" in other.call(1, "job.list")
    other.close()
    began = time.monotonic()
    first = begin_message()
    while answer_to_ping(first) != 10:  # until the pages above have been forgotten
        assert time.monotonic() - began < PATIENCE_S, "one message is above the share"
        first.close()
        first = begin_message()
    pages = [begin_message() for _ in range(3)]
    while 8 not in [answer_to_ping(page) for page in pages]:
        assert time.monotonic() - began < PATIENCE_S, "four messages are within the share"
    assert answer_to_ping(first) == 10
    for page in [first, *pages]:
        page.close()
    while not whole_body(mine):
        pass


def submit():
    with open(document) as file:
        text = {"document": json.load(file), "paused": True}
    submitted = call(port, mine, "job.submit", text)
    assert "result" in submitted, submitted
    return submitted["result"]["id"]


if part == "shares":
    bodies_in_time()
    JOB = submit()
    readers(JOB)
    sockets(JOB)
    print(JOB)
else:
    JOB = int(sys.argv[7])
    slow_readers(JOB)
    stuck(JOB)
