#!/usr/bin/env python3
"""Stress-tests a viewer with hostile connections, which must not disturb the run.

Usage: hostile_connections.py URL [--connections N] [--seconds S] [--per-second N]

URL is printed by byre and includes the token. N simultaneous connections, in equal parts, send nothing; send an endless
request, one byte at a time; send garbage; use a wrong token; connect and disconnect. Connections closed by the viewer
are replaced, at a limited rate per second. Twice a second a client with the right token requests /scene. Prints one
line of JSON: connections made and closed by the viewer, and waiting times of the client with the token.
"""
import argparse
import itertools
import json
import os
import socket
import time
import urllib.parse

GARBAGE = os.urandom(8192)
WRONG = b"GET /scene?token=00000000000000000000000000000000 HTTP/1.1\r\nHost: barn\r\n\r\n"
FIRST_BYTES = {"waits": b"", "drips": b"GET /?tok", "garbage": GARBAGE, "wrong token": WRONG, "comes and goes": b""}


def connect(address: tuple[str, int], kind: str) -> socket.socket:
    connection = socket.socket()
    connection.setblocking(False)
    connection.connect_ex(address)
    return connection


def send(connection: socket.socket, data: bytes) -> None:
    try:
        connection.send(data)
    except OSError:
        pass  # not connected


def is_over(connection: socket.socket) -> bool:
    try:
        while connection.recv(4096):
            pass
        return True
    except BlockingIOError:
        return False
    except OSError as error:
        return error.errno not in (socket.errno.ENOTCONN, socket.errno.EAGAIN)


def ask(address: tuple[str, int], token: str) -> float:
    """Seconds until a client with the right token receives the first bytes of an answer; infinite without one."""
    start = time.monotonic()
    try:
        with socket.create_connection(address, timeout=10) as connection:
            connection.sendall(f"GET /scene?token={token} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
            is_answered = connection.recv(12) == b"HTTP/1.1 200"
    except OSError:
        is_answered = False
    return time.monotonic() - start if is_answered else float("inf")


class Crowd:
    def __init__(self, address: tuple[str, int], size: int, per_second: float) -> None:
        self.address, self.size, self.per_second = address, size, per_second
        self.kinds = itertools.cycle(FIRST_BYTES)
        self.members: list[tuple[str, socket.socket, bool]] = []  # kind, socket, first bytes sent
        self.made = self.ended = 0
        self.allowance = 0.0

    def step(self, seconds: float) -> None:
        self.allowance = min(self.allowance + self.per_second * seconds, self.per_second)
        members = []
        for kind, connection, greeted in self.members:
            if is_over(connection) or (kind == "comes and goes" and greeted):
                self.ended += kind != "comes and goes"
                connection.close()
                continue
            send(connection, b"x" if kind == "drips" and greeted else b"" if greeted else FIRST_BYTES[kind])
            members.append((kind, connection, True))
        while len(members) < self.size and self.allowance >= 1.0:
            kind = next(self.kinds)
            members.append((kind, connect(self.address, kind), False))
            self.allowance -= 1.0
            self.made += 1
        self.members = members


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("url")
    parser.add_argument("--connections", type=int, default=300)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--per-second", type=float, default=300.0)
    options = parser.parse_args()
    os.nice(19)  # leaves the processor to the viewer, which is measured
    url = urllib.parse.urlsplit(options.url)
    address = (url.hostname, url.port)
    token = urllib.parse.parse_qs(url.query).get("token", [""])[0]
    crowd = Crowd(address, options.connections, options.per_second)
    waits = []
    start = last = next_question = time.monotonic()
    while (now := time.monotonic()) < start + options.seconds:
        crowd.step(now - last)
        last = now
        if now >= next_question:
            waits.append(ask(address, token))
            next_question = time.monotonic() + 0.5
        time.sleep(0.1)
    waits.sort()
    print(json.dumps({
        "connections": len(crowd.members), "made": crowd.made, "ended_by_the_viewer": crowd.ended,
        "questions": len(waits), "unanswered": waits.count(float("inf")),
        "wait_median_s": round(waits[len(waits) // 2], 4), "wait_most_s": round(waits[-1], 4),
    }))


if __name__ == "__main__":
    main()
