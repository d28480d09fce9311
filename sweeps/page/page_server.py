"""A server of one page, for browsers on this computer only."""

import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from sweeps.page.watched_page import WatchedPage

LOOPBACK = "127.0.0.1"
# Maximum wait of a request for a newer version [s].
PATIENCE = 20.0


class PageServer(ThreadingHTTPServer):
    """Serves a page at the loopback address, and nothing else; it takes no commands.

    A request whose If-None-Match names the current version waits for another one.

    Parameters
    ----------
    page : WatchedPage
    """

    daemon_threads = True

    def __init__(self, page: WatchedPage) -> None:
        super().__init__((LOOPBACK, 0), _Handler)
        self.page = page

    def handle_error(self, *client: object) -> None:
        """Report errors of the server, not browsers that leave while they wait."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(*client)

    @property
    def address(self) -> str:
        """Address of the page."""
        return f"http://{LOOPBACK}:{self.server_port}/"


class _Handler(BaseHTTPRequestHandler):
    """GET of the page; other methods are refused by the base class."""

    server: PageServer
    server_version, sys_version = "sweeps", ""
    timeout = 2 * PATIENCE

    def do_GET(self) -> None:
        # A foreign site whose name resolves to this address could otherwise read the page (DNS rebinding).
        if self.headers["Host"] not in [f"{host}:{self.server.server_port}" for host in (LOOPBACK, "localhost")]:
            self._send(HTTPStatus.MISDIRECTED_REQUEST)
            return
        if self.path != "/":
            self._send(HTTPStatus.NOT_FOUND)
            return
        known = (self.headers["If-None-Match"] or "").strip('"')
        if known:
            self.server.page.wait(known, PATIENCE)
        version, text = self.server.page.page()
        if version == known:
            self._send(HTTPStatus.NOT_MODIFIED, version)
        else:
            self._send(HTTPStatus.OK, version, text.encode())

    def _send(self, status: HTTPStatus, version: str = "", text: bytes = b"") -> None:
        self.send_response(status)
        if version:
            self.send_header("ETag", f'"{version}"')
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(text)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.end_headers()
        self.wfile.write(text)

    def log_message(self, *_: object) -> None:
        """Requests aren't logged."""
