"""A web server for tests of notices: it keeps what it gets, and answers as its path says.

web_hooks.py FILE [ADDRESS]: listens there, or at 127.0.0.1; writes its port to standard output; each POST becomes a line of FILE once it is answered.
/ok 200; /fail 500; /gone 410; /once 500 to the first, then 200; /hang never; /drip 200 and a body without end;
/away 302 to /ok; /flood 500 with a large body.
"""
import http.server
import json
import sys
import threading
import time


class Hook(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    refused: set[str] = set()
    lock = threading.Lock()
    file = sys.argv[1]

    def log_message(self, *arguments: object) -> None:
        pass

    def keep(self, status: int, body: str) -> None:
        headers = {name.lower(): value for name, value in self.headers.items()}
        line = json.dumps({"path": self.path, "status": status, "headers": headers, "body": body})
        with Hook.lock, open(Hook.file, "a", encoding="utf-8") as kept:
            kept.write(line + "\n")

    def do_GET(self) -> None:
        self.keep(405, "")
        self.answer(405, b"")

    def answer(self, status: int, body: bytes, **headers: str) -> None:
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        path = self.path.split("/")[1]
        if path == "hang":
            self.keep(0, body)
            time.sleep(600)
        elif path == "drip":
            self.keep(200, body)
            self.send_response(200)
            self.send_header("Content-Length", "1000000")
            self.end_headers()
            while True:
                self.wfile.write(b"x")
                self.wfile.flush()
                time.sleep(1)
        elif path == "away":
            self.keep(302, body)
            self.answer(302, b"", Location=f"http://127.0.0.1:{self.server.server_address[1]}/ok")
        elif path == "once" and self.headers["X-Marchd-Id"] not in Hook.refused:
            Hook.refused.add(self.headers["X-Marchd-Id"])
            self.keep(500, body)
            self.answer(500, b"later")
        else:
            status = {"fail": 500, "flood": 500, "gone": 410}.get(path, 200)
            self.keep(status, body)
            self.answer(status, b"y" * 10_000_000 if path == "flood" else b"thanks")


server = http.server.ThreadingHTTPServer((sys.argv[2] if len(sys.argv) > 2 else "127.0.0.1", 0), Hook)
server.daemon_threads = True
print(server.server_address[1], flush=True)
try:
    server.serve_forever()
except KeyboardInterrupt:
    pass
