"""Speaks wayfuse.v1.json with somebody else's WebSocket library: hello, one scan, an ack and a position.

Usage: foreign_client.py PORT KEY. The building is the hall of running_server.hpp."""
import asyncio
import json
import sys

import websockets

TRANSMITTERS = {"A": (0, 8), "B": (20, 8), "C": (40, 8), "D": (0, 0), "E": (20, 0), "F": (40, 0)}


def level_dbm(x, y, at):
    import math
    distance_m = math.hypot(x - at[0], y - at[1])
    return -30 - 30 * math.log10(math.hypot(distance_m, 1))


async def talk(port, key):
    async with websockets.connect(f"ws://127.0.0.1:{port}/v1/session", subprotocols=["wayfuse.v1.json"],
                                  extra_headers={"Authorization": f"Bearer {key}"}) as connection:
        assert connection.subprotocol == "wayfuse.v1.json"
        hello = {"type": "hello", "role": "track", "building": 1, "device_model": "Foreign", "app": "foreign/1", "phone_time_us": 0}
        await connection.send(json.dumps(hello))
        assert json.loads(await connection.recv())["type"] == "welcome"
        readings = [{"bssid": "00:00:00:00:10:%02x" % ord(name), "rss_dbm": round(level_dbm(20, 4, at), 2), "frequency_mhz": 2412}
                    for name, at in TRANSMITTERS.items()]
        scan = {"kind": "scan", "time_us": 1000000, "readings": readings}
        await connection.send(json.dumps({"type": "samples", "first_sequence": 1, "samples": [scan]}))
        answers = {}
        while "position" not in answers:
            answer = json.loads(await connection.recv())
            answers[answer["type"]] = answer
        assert answers["ack"]["through"] == 1, answers
        print("position:", answers["position"])


asyncio.run(asyncio.wait_for(talk(int(sys.argv[1]), sys.argv[2]), 20))
