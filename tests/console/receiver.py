"""Stands in for an operator's service that webhooks are posted to: refuses for good until told to take what comes."""

import http.server
import threading


class Receiver:
    def __init__(self):
        self.takes = False
        self.taken = 0
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                self.rfile.read(int(self.headers["content-length"]))
                outer.taken += outer.takes
                self.send_response(204 if outer.takes else 410)  # Gone: not tried again
                self.end_headers()

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}/zones"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()
