"""The admin API as its OpenAPI document describes it, on a running server: a client made of the document takes a building from
nothing to positions, then asks every operation for every status that a client can provoke, and holds each answer against the
document. An operation that the document describes and nobody asks for here fails the test."""

import argparse
import asyncio
import http.client
import json
import os
import shutil
import struct
import subprocess
import tempfile
import zlib

import websockets

from described_client import Answer, Client

# What takes a broken or full disk, or a server that is going down: seen in the tests of the store and of the process.
OUT_OF_REACH = {500, 503, 507}
# A georeference that changes while a plan is read.
RACES = {("import_plan", 409)}


class Server:
    def __init__(self, programs):
        self.programs, self.folder = programs, tempfile.mkdtemp()
        self.process = subprocess.Popen([programs.server, "--server.data", f"{self.folder}/data", "--listen.port", "0", "--log.level", "error"],
                                        stdout=subprocess.PIPE, text=True)
        said = [json.loads(self.process.stdout.readline()) for _ in range(2)]
        self.key, self.url = said[0]["admin_key"], said[1]["url"]

    def phone(self, *arguments):
        return [self.programs.phone, *arguments, "--server", f"ws{self.url[4:]}/v1/session"]

    def close(self):
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


class Book:
    """Which operation gave which status."""

    def __init__(self, client):
        self.client, self.seen = client, {}
        for name, operation in client.operations.items():
            self.seen[name] = set()
            check = operation.check
            operation.check = lambda answer, name=name, check=check: (check(answer), self.seen[name].add(answer.status))

    def never_asked(self):
        return sorted(name for name, seen in self.seen.items() if not any(status < 400 for status in seen))

    def never_seen(self):
        return {name: sorted(missing) for name, operation in self.client.operations.items()
                if (missing := {status for status in set(operation.responses) - self.seen[name] - OUT_OF_REACH if (name, status) not in RACES})}


def picture():
    """A PNG of one white pixel."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(b"\0\xff")) + chunk(b"IEND", b"")


def jpeg():
    """The head of a JPEG of 1 x 1, all that is read of it."""
    return b"\xff\xd8\xff\xc0\x00\x0b\x08\x00\x01\x00\x01\x01\x01\x11\x00\xff\xd9"


def survey(upload, shift_m=0.0):
    """Points every 2 m along the example building's corridor, heard from both its ends."""
    points = []
    for step in range(10):
        x_m = 1.0 + 2.0 * step + shift_m
        readings = [{"bssid": "3c:84:6a:10:02:7f", "rss_dbm": -40.0 - 1.5 * x_m}, {"bssid": "f0:9f:c2:aa:31:05", "rss_dbm": -70.0 + 1.5 * x_m}]
        points.append({"place": {"x_m": x_m, "y_m": 5.0, "floor": 0}, "sigma_m": 0.3, "device_model": "Pixel 8", "surveyed_at_us": 1764057612345678,
                       "scans": [{"time_us": 81300000000 + 1000000 * i, "readings": readings} for i in range(3)]})
    return {"type": "survey", "idempotency_key": upload, "points": points}


def buildings_and_plans(api, v):
    v["building"] = api.create_building()["id"]
    tag = api.ask("show_building", v).headers["etag"]
    api.replace_building({**v, "If-Match": tag})
    api.replace_floors(v)
    assert api.import_plan(v)["stored"]
    assert api.georeference(v)["stored"]
    assert v["building"] in [each["id"] for each in api.list_buildings()["buildings"]]
    v["floor"] = 0
    api.put_floor_image({**v, "width_m": 20}, body=jpeg(), media_type="image/jpeg")
    assert api.ask("floor_image", v).media_type == "image/jpeg"
    api.put_floor_image(v, body=picture(), media_type="image/png")
    assert api.floor_image(v) == picture()
    assert api.floor_image_placement(v)["width_px"] == 1


def a_survey_becomes_a_map(api, v):
    described = json.loads(api.operations["replace_building"].example()[1])
    api.replace_building(v, body={**described, "publication": "reviewed"})
    assert api.upload_points(v)["stored"] == 2
    assert api.upload_points(v, body=survey("corridor"))["stored"] == 10
    assert [each["points"] for each in api.list_uploads(v)["items"]] == [2, 10]
    page = api.list_points({**v, "most": 5})  # floor 0, as `v` has it: not the two of the example
    assert len(page["points"]) == 5 and len(api.list_points({**v, "after": page["next"]})["points"]) == 5
    assert api.points_csv(v).count(b"\r\n") == 1 + 10 * 3 * 2
    assert len(api.points_geojson({"building": v["building"]})["features"]) == 12
    v["bssid"] = api.list_transmitters(v)["transmitters"][0]["bssid"]
    first = api.build_map(v)["version"]
    api.promote_map({**v, "version": first}, body={"override": True, "reason": "the first"})
    api.upload_points(v, body=survey("corridor again", 1.0) | {"idempotency_key": "corridor-again"})
    v["version"] = api.build_map(v)["version"]
    assert v["version"] > first
    assert api.compare_map(v)["live"] == first
    api.promote_map(v)
    assert api.roll_back_map(v)["version"] == first
    assert [each["act"] for each in api.list_publications(v)["items"]] == ["promoted", "promoted", "rolled_back"]
    assert api.show_map({**v, "version": first})["live"]
    assert {each["version"] for each in api.list_maps(v)["items"]} >= {first, v["version"]}
    assert api.expected_accuracy(v)["expected_m"]
    api.survey_plan(v)
    api.list_access_points(v)
    assert api.trust_access_point(v)["quarantined"]


def walks_measure_it(api, v, recording):
    v["walk"] = api.add_quality_walk({**v, "name": "aisle"}, body=recording, media_type="application/x-ndjson")["id"]
    assert [each["id"] for each in api.list_quality_walks(v)["items"]] == [v["walk"]]


def zones_and_webhooks(api, v):
    v["zone"] = api.make_zone(v)["id"]
    tag = api.ask("show_zone", v).headers["etag"]
    api.replace_zone({**v, "If-Match": tag})
    assert [each["id"] for each in api.list_zones({**v, "floor": 0})["zones"]][-1] == v["zone"]
    assert api.zone_occupants(v)["occupants"] == []
    assert api.follow_events(v).startswith(b"retry:")
    v["webhook"] = api.make_webhook(v)["id"]
    assert api.list_webhooks(v)["webhooks"] and "secret" not in api.show_webhook(v)
    api.replace_webhook({**v, "If-Match": api.ask("show_webhook", v).headers["etag"]})
    assert api.dead_letters(v)["dead_letters"] == []
    assert api.retry_dead_letters(v)["retried"] == 0
    assert api.list_deliveries(v)["deliveries"] == []


def keys_and_the_rest(api, v):
    for public in ("health", "readiness", "version", "openapi", "asyncapi", "docs", "docs_sessions", "metrics"):
        getattr(api, public)()
    v["key"] = api.make_key()["id"]
    assert v["key"] in [each["id"] for each in api.list_keys()["keys"]]
    api.revoke_key(v)
    api.make_session_token()
    assert api.make_building_session_token(v)["building"] == v["building"]
    v["pipeline"] = api.list_pipelines()["pipelines"][0]
    api.show_pipeline(v)
    assert api.list_parts()["parts"]
    assert api.verify(v)["sound"]
    assert api.export(v).startswith(b"PK")
    assert api.audit({"most": 5})["audit"]


def a_silent_phone_is_not_explained(api, v, server):
    async def hello():
        socket = await websockets.connect(f"ws{server.url[4:]}/v1/session", subprotocols=["wayfuse.v1.json"],
                                          extra_headers={"authorization": f"Bearer {server.key}"})
        await socket.send(json.dumps({"type": "hello", "role": "track", "building": v["building"], "device_model": "Silent", "app": "test",
                                      "phone_time_us": 1}))
        welcome = json.loads(await socket.recv())
        assert welcome["type"] == "welcome", welcome
        silent = {**v, "tracked": api.building_sessions(v)["sessions"][0]["tracked"]}
        for name in ("explain_session", "explain_building_session"):
            assert api.ask(name, silent).status == 409
        await socket.close()
    asyncio.run(hello())


def recorded(api, walked):
    for _ in range(20000):
        if found := api.list_recordings(walked)["recordings"]:
            return found[0]["id"]


def a_session_is_lived_through_again(api, v, walked):
    assert api.show_recording_state(walked)["on"]
    here = {**walked, "recording": recorded(api, walked)}
    v["recording"] = here["recording"]
    as_it_was = api.replay_recording(v, body={})
    assert as_it_was["as_it_was"] and as_it_was["differing"] == 0 and as_it_was["steps"], as_it_was
    assert not api.replay_building_recording(here)["as_it_was"]  # the example asks for another pipeline
    assert api.get_recording(v).count(b"\n") > 1 and api.get_building_recording(here).startswith(b'{"type":"wayfuse-recording"')
    api.erase_building_recording(here)
    api.order_recording(walked)
    v["recording"] = recorded(api, walked)
    api.erase_recording(v)
    assert api.erase_recordings(walked)["erased"] == 0


def a_phone_is_explained(api, v, server):
    world = json.loads(subprocess.run([server.programs.phone, "world", "--pipeline", "wknn"], check=True, capture_output=True).stdout)
    walked = {"building": api.create_building(body=world)["id"]}
    environment = {**os.environ, "WAYFUSE_KEY": server.key}
    subprocess.run(server.phone("survey", "--building", str(walked["building"]), "--passes", "1"), check=True, env=environment)
    surveyed = api.show_building(walked)["survey_version"]
    for _ in range(2000):
        if api.show_building(walked)["radio_map_version"] >= surveyed:
            break
    api.order_recording(walked)
    phone = subprocess.Popen(server.phone("walk", "--building", str(walked["building"]), "--phones", "1", "--minutes", "1000", "--speed", "2",
                                          "--no-compare"), env=environment, stdout=subprocess.DEVNULL)
    try:
        for _ in range(20000):
            sessions = api.building_sessions(walked)["sessions"]
            if sessions and "position" in sessions[0]:
                break
        assert any(each["tracked"] == sessions[0]["tracked"] for each in api.list_sessions()["sessions"])
        v["tracked"] = sessions[0]["tracked"]
        assert api.explain_session(v)["used"] and api.explain_building_session({**walked, **{"tracked": v["tracked"]}})["particles"] is not None
        a_session_is_lived_through_again(api, v, walked)
    finally:
        phone.terminate()
        phone.wait()


def ends(api, v):
    """What takes away, last."""
    kept = api.backup(v)
    assert len(api.list_backups(v)["backups"]) == 1
    assert api.erase_points({"building": v["building"], "upload": "corridor"})["erased"] == 10
    api.remove_quality_walk(v)
    for name in ("remove_zone", "remove_webhook", "remove_floor_image"):
        getattr(api, name)(v)
    api.remove_building(v)
    assert api.ask("show_building", v).status == 404
    assert api.restore(body=kept, media_type="application/vnd.sqlite3")["id"] == v["building"]
    assert api.ask("restore", body=kept, media_type="application/vnd.sqlite3").status == 409


# ---------------------------------------------------------------- every status

OTHER_SCOPE = {"admin": "observe", "observe": "track", "track": "observe", "survey": "observe"}


def expect(operation, answer, *statuses):
    assert answer.status in statuses, f"{operation.name}: {answer.status}, not {statuses}: {answer.body[:200]}"


def refusals_of_one(api, v):
    """What only some operations refuse, each for a reason of its own."""
    twice = {"floors": [{"ordinal": 0}, {"ordinal": 0}]}
    assert api.ask("replace_building", v, body={"name": "Head office", **twice}).status == 409
    assert api.ask("replace_floors", v, body=twice).status == 409
    assert api.ask("follow_events", {**v, "last_event_id": "no id"}).status == 422
    assert api.ask("compare_map", {**v, "pipeline": "nobody's"}).status == 422
    plain = {"building": api.create_building(body={"name": "Nothing yet"})["id"]}
    assert api.ask("points_geojson", plain).status == 409  # WGS84 of a building that nobody laid on the earth
    for name in ("expected_accuracy", "survey_plan"):
        assert api.ask(name, plain).status == 404, name


def announce(api, operation, target, bytes_long):
    """A body announced and never sent."""
    connection = http.client.HTTPConnection(api.address, timeout=60)
    connection.putrequest(operation.method, target)
    connection.putheader("authorization", f"Bearer {api.key}")
    connection.putheader("content-length", str(bytes_long))
    connection.endheaders()
    response = connection.getresponse()
    said = {name.lower(): value for name, value in response.getheaders()}
    answer = Answer(response.status, said, response.read())
    connection.close()
    operation.check(answer)
    return answer


def refusals_of(api, operation, v, keys, body):
    """Asks for every fault that any operation of this shape can give; `body` is a good one, None = the document's."""
    name = operation.name
    takes = {parameter["name"] for parameter in operation.parameters}
    api.source = f"127.0.1.{1 + list(api.operations).index(name)}"  # an address that is refused often is let in no more
    expect(operation, api.ask(name, v, key=None), 401)
    api.source = ""
    expect(operation, api.ask(name, v, key=keys[OTHER_SCOPE[operation.scope]]), 403)
    for parameter in operation.parameters:
        if parameter["in"] == "path" and parameter["schema"]["type"] == "integer":
            expect(operation, api.ask(name, {**v, parameter["name"]: 987654321}, body=body), 404)
        if parameter["in"] == "path" and parameter["schema"]["type"] == "string":
            expect(operation, api.ask(name, {**v, parameter["name"]: "nobody's"}, body=body), 404)
        if parameter["in"] == "query" and parameter["schema"]["type"] in ("integer", "number"):
            expect(operation, api.ask(name, {**v, parameter["name"]: "many"}, body=body), 422)
    if "If-Match" in takes:
        expect(operation, api.ask(name, {**v, "If-Match": '"another"'}), 412)
    if "If-None-Match" in takes:
        expect(operation, api.ask(name, {**v, "If-None-Match": api.ask(name, v).headers["etag"]}), 304)
    if "Idempotency-Key" in takes:
        api.ask(name, {**v, "Idempotency-Key": f"{name}-1"}, body=b"{")
        expect(operation, api.ask(name, {**v, "Idempotency-Key": f"{name}-1"}, body=b"["), 409)
        expect(operation, api.ask(name, {**v, "Idempotency-Key": "no key!"}, body=b"{"), 422)
    if operation.bodies:
        expect(operation, announce(api, operation, operation.target(v), 10 ** 13), 413)
        expect(operation, api.ask(name, v, body=b"{", media_type=next(iter(operation.bodies))), 400)
        required = next(iter(operation.bodies.values()))["schema"]
        if api.resolved(required).get("required"):
            expect(operation, api.ask(name, v, body={}), 400, 422)


def too_many(api, v):
    """An address that tries wrong keys is let in no more, with whatever key: the last thing this test does."""
    while api.ask("list_keys", key="wrong").status != 429:
        pass
    for operation in api.operations.values():
        if operation.scope:
            expect(operation, api.ask(operation.name, v), 429)


def main():
    parser = argparse.ArgumentParser()
    for program in ("--server", "--phone"):
        parser.add_argument(program, required=True)
    server = Server(parser.parse_args())
    try:
        document = Client(server.url, {"paths": {"/v1/openapi.json": {"get": {"operationId": "openapi", "security": [], "responses": {
            "200": {"description": "", "content": {"application/json": {"schema": {}}}}}}}}, "components": {}}).openapi()
        api, v = Client(server.url, document, server.key), {}
        book = Book(api)
        recording = f"{server.folder}/walk.jsonl"
        subprocess.run([server.programs.phone, "record", recording, "--minutes", "1"], check=True, stdout=subprocess.DEVNULL)
        with open(recording, "rb") as file:
            walk = file.read()
        buildings_and_plans(api, v)
        a_survey_becomes_a_map(api, v)
        walks_measure_it(api, v, walk)
        zones_and_webhooks(api, v)
        keys_and_the_rest(api, v)
        a_silent_phone_is_not_explained(api, v, server)
        a_phone_is_explained(api, v, server)
        wrong = []
        keys = {scope: api.make_key(body={"name": scope, "scopes": [scope]})["key"] for scope in ("track", "survey", "observe")}
        bodies = {"put_floor_image": picture(), "add_quality_walk": walk}
        for operation in api.operations.values():
            try:
                if operation.scope:
                    refusals_of(api, operation, v, keys, bodies.get(operation.name))
            except AssertionError as misfit:
                wrong.append(str(misfit))
        refusals_of_one(api, v)
        ends(api, v)
        too_many(api, v)
        print(f"{len(api.operations)} operations; statuses seen: {sum(map(len, book.seen.values()))}")
        assert not wrong, "\n".join(wrong)
        assert not book.never_asked(), f"never asked with success: {book.never_asked()}"
        assert not book.never_seen(), f"described and never seen: {json.dumps(book.never_seen(), indent=1)}"
    finally:
        server.close()


if __name__ == "__main__":
    main()
