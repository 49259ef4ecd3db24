"""Opens COUNT idle observer sessions and says what each costs the server in resident memory [SAFETY R2].

Usage: idle_sessions.py URL KEY COUNT, URL like http://127.0.0.1:8080 or https://..; certificates are not verified: this is a
measurement on loopback."""
import asyncio
import json
import re
import ssl
import sys
import urllib.request

import websockets


UNVERIFIED = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
UNVERIFIED.check_hostname = False
UNVERIFIED.verify_mode = ssl.CERT_NONE


def resident_bytes(url, key):
    request = urllib.request.Request(url + "/metrics", headers={"Authorization": "Bearer " + key})
    context = UNVERIFIED if url.startswith("https") else None
    with urllib.request.urlopen(request, context=context) as answer:
        return float(re.search(r"^wayfuse_resident_memory_bytes (\S+)", answer.read().decode(), re.M).group(1))


async def open_session(url, key):
    context = UNVERIFIED if url.startswith("https") else None
    connection = await websockets.connect(url.replace("http", "ws", 1) + "/v1/session", ssl=context, ping_interval=None,
                                          open_timeout=60,
                                          subprotocols=["wayfuse.v1.json"], extra_headers={"Authorization": "Bearer " + key})
    await connection.send(json.dumps({"type": "hello", "role": "observe", "building": 1, "device_model": "-", "app": "idle/1",
                                      "phone_time_us": 0}))
    assert json.loads(await connection.recv())["type"] == "welcome"
    return connection


async def measure(url, key, count):
    warm = [await open_session(url, key) for _ in range(20)]
    before = resident_bytes(url, key)
    sessions = []
    for _ in range(count // 10):
        sessions += await asyncio.gather(*(open_session(url, key) for _ in range(10)))
    await asyncio.sleep(2)
    after = resident_bytes(url, key)
    print(f"{len(sessions)} idle sessions: {(after - before) / len(sessions) / 1000:.1f} kB each, {after / 1e6:.0f} MB in all")
    for connection in warm + sessions:
        connection.transport.abort()


asyncio.run(measure(sys.argv[1].rstrip("/"), sys.argv[2], int(sys.argv[3])))
