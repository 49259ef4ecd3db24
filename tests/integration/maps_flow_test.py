"""An operator's way with radio maps, by the command line against a real server: a survey that goes live by itself, quality walks,
a poisoned survey that the gate refuses, an override, a rollback, expected accuracy, a plan, access points, metrics."""

import argparse
import json
import os
import shutil
import subprocess
import tempfile
import urllib.request


class House:
    """wayfused on a free port with the demo building, surveyed once."""

    def __init__(self, programs):
        self.programs = programs
        self.folder = tempfile.mkdtemp()
        self.server = subprocess.Popen([programs.server, "--server.data", f"{self.folder}/data", "--listen.port", "0", "--log.level", "warn"],
                                       stdout=subprocess.PIPE, text=True)
        said = [json.loads(self.server.stdout.readline()) for _ in range(2)]
        self.url = said[1]["url"]
        self.environment = {**os.environ, "WAYFUSE_KEY": said[0]["admin_key"], "WAYFUSE_SERVER": self.url}
        self.world = json.loads(self.phone("world", "--pipeline", "wknn"))
        self.building = str(self.ask("building", "create", "-", body=self.world)["id"])

    def phone(self, *arguments):
        return subprocess.run([self.programs.phone, *arguments], check=True, capture_output=True, text=True, env=self.environment).stdout

    def run(self, *arguments, body=None):
        """The command line's status and what it said."""
        done = subprocess.run([self.programs.cli, *arguments], input=None if body is None else json.dumps(body).encode(), capture_output=True,
                              env=self.environment)
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    def ask(self, *arguments, body=None):
        status, said, complaint = self.run("--json", *arguments, body=body)
        assert status == 0, f"{arguments}: {complaint}"
        return json.loads(said) if said.strip() else None

    def until(self, what, wanted):
        """Versions come into force beside the traffic: asks until it is so."""
        for _ in range(2000):
            found = what()
            if wanted(found):
                return found
        raise AssertionError(f"never came: {found}")

    def versions(self):
        return self.ask("map", "list", self.building)["items"]

    def points(self):
        found, after = [], 0
        while True:
            request = urllib.request.Request(f"{self.url}/v1/buildings/{self.building}/points?most=500&after={after}",
                                             headers={"authorization": f"Bearer {self.environment['WAYFUSE_KEY']}"})
            with urllib.request.urlopen(request) as answer:
                page = json.load(answer)
            found += page["points"]
            after = page.get("next", 0)
            if not after:
                return found

    def live(self):
        return next((version["version"] for version in self.versions() if version["live"]), None)

    def close(self):
        self.server.terminate()
        self.server.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def survey_goes_live_by_itself(house):
    house.phone("survey", "--server", f"ws{house.url[4:]}/v1/session", "--building", house.building, "--passes", "1")
    surveyed = house.ask("building", "show", house.building)["survey_version"]
    house.until(house.live, lambda version: version is not None and version >= surveyed)
    history = house.ask("map", "history", house.building)["items"]
    assert history[-1]["act"] == "promoted" and history[-1]["by_key"] == 0, history[-1]
    print("a survey of", surveyed, "batches made", len(house.versions()), "versions; live:", house.live())


def quality_walks_measure_it(house):
    for walk in (1, 2, 3):
        file = f"{house.folder}/walk-{walk}.jsonl"
        house.phone("record", file, "--walk", str(walk), "--minutes", "1")
        added = house.ask("quality-walk", "add", house.building, file, "--name", f"walk {walk}")
        again = house.ask("quality-walk", "add", house.building, file, "--name", f"walk {walk}")
        assert added["id"] == again["id"], "the same recording is the same walk"
    status, _, complaint = house.run("quality-walk", "add", house.building, "-", body={"type": "goodbye"})
    assert status != 0 and "survey_walk" in complaint, complaint
    version = house.ask("map", "build", house.building)
    assert version["live"] and version["quality"]["walks"] == 3, version
    assert 0.1 < version["quality"]["mean_m"] < 15, version["quality"]
    assert len(version["quality"]["error_quantiles_m"]) == 101
    print("measured:", {name: round(version["quality"][name], 3) for name in ("instants", "mean_m", "median_m", "floor_hit", "in68", "in95")})


def poison(house, moved_m):
    """The same points again, five times over, each moved: as a surveyor who stood on the wrong corridor."""
    points = house.points()
    for copy in range(5):
        for start in range(0, len(points), 40):
            batch = []
            for point in points[start:start + 40]:
                place = {**point["place"], "x_m": point["place"]["x_m"] + moved_m}
                batch.append({"place": place, "sigma_m": 0.3, "device_model": point["device_model"], "walk": f"wrong {copy}",
                              "surveyed_at_us": point["surveyed_at_us"], "scans": point["scans"]})
            document = {"type": "survey", "idempotency_key": f"poison-{copy}-{start}", "points": batch}
            house.ask("survey", "upload", house.building, "-", body=document)


def worse_maps_are_refused(house):
    good = house.live()
    described = {**house.world, "publication": "reviewed"}
    house.ask("building", "replace", house.building, "-", body=described)
    poison(house, 9.0)
    candidate = house.ask("map", "build", house.building)
    assert not candidate["live"] and candidate["version"] != good
    compared = house.ask("map", "compare", house.building, str(candidate["version"]))
    assert compared["verdict"] == "worse" and compared["live"] == good, compared["reasons"]
    print("refused:", "; ".join(compared["reasons"]))
    status, said, _ = house.run("map", "compare", house.building, str(candidate["version"]))
    assert status == 0 and "worse" in said and "walk 2" in said, said
    status, _, complaint = house.run("map", "promote", house.building, str(candidate["version"]))
    assert status != 0 and "worse" in complaint, complaint
    assert house.live() == good
    status, _, complaint = house.run("map", "promote", house.building, str(candidate["version"]), "--override")
    assert status != 0 and "reason" in complaint, complaint
    house.ask("map", "promote", house.building, str(candidate["version"]), "--override", "--reason", "to see it", "--expected-live", str(good))
    house.until(house.live, lambda version: version == candidate["version"])
    back = house.ask("map", "rollback", house.building, "--reason", "seen")
    assert back["version"] == good and back["by_key"] > 0, back
    house.until(lambda: house.ask("building", "show", house.building)["radio_map_version"], lambda version: version == good)


def survey_says_what_it_promises(house):
    accuracy = house.ask("survey", "accuracy", house.building, "--floor", "0")
    assert accuracy["median_m"] and len(accuracy["expected_m"]) == accuracy["columns"] * accuracy["rows"]
    print("expected:", round(accuracy["median_m"], 2), "m;", accuracy["basis"])
    status, said, _ = house.run("survey", "accuracy", house.building, "--floor", "0")
    assert status == 0 and "median error to expect" in said
    plan = house.ask("survey", "plan", house.building, "--floor", "0")
    assert abs(plan["median_now_m"] - accuracy["median_m"]) < 1e-6
    status, said, _ = house.run("survey", "plan", house.building, "--floor", "0")
    assert status == 0 and "median error to expect now" in said
    print(said.strip())
    status, _, complaint = house.run("survey", "plan", house.building, "--floor", "77")
    assert status != 0 and "neither surveyed nor drawn" in complaint, complaint


def survey_moves_as_a_file(house):
    """Every format the server writes is read back to the same bytes; a second time nothing is uploaded; one bad row keeps all back."""
    described = {**house.world, "georeference": {"origin": {"latitude_deg": 47.3769, "longitude_deg": 8.5417}, "y_axis_azimuth_deg": 12.5},
                 "publication": "reviewed"}
    house.ask("building", "replace", house.building, "-", body=described)
    for format in ("csv", "geojson"):
        _, exported, _ = house.run("survey", "export", house.building, "--format", format)
        file, copy = f"{house.folder}/points.{format}", str(house.ask("building", "create", "-", body=described)["id"])
        with open(file, "w", newline="") as out:
            out.write(exported)
        told = house.ask("survey", "import", copy, file)
        assert told["uploaded"] == told["batches"] > 1 and told["points"] == house.ask("building", "show", copy)["points"], told
        assert house.run("survey", "export", copy, "--format", format)[1] == exported, f"{format} came back otherwise"
        assert house.ask("survey", "import", copy, file)["already_there"] == told["batches"]
        print(format, "carried", told["points"], "points in", told["batches"], "batches")
    with open(f"{house.folder}/bad.csv", "w") as out:
        out.write("x_m,y_m,floor,bssid,rss_dbm\n1,2,0,00:1b:2c:00:00:01,-61\n1,2,0,00:1b:2c:00:00:02,loud\n")
    before = house.ask("building", "show", copy)["points"]
    status, _, complaint = house.run("survey", "import", copy, f"{house.folder}/bad.csv")
    assert status != 0 and "bad.csv:3: rss_dbm: 'loud' is not a number" in complaint and "nothing was uploaded" in complaint, complaint
    status, said, _ = house.run("survey", "import", copy, f"{house.folder}/bad.csv", "--skip-bad")
    assert status == 0 and "1 rows left out" in said and house.ask("building", "show", copy)["points"] == before + 1, said


def access_points_are_trusted_by_hand(house):
    bssid = house.ask("survey", "transmitters", house.building)["transmitters"][0]["bssid"]
    told = house.ask("ap", "trust", house.building, bssid, "never")
    assert told["quarantined"] and told["on_map"], told
    listed = house.ask("ap", "list", house.building)["items"]
    assert [point["bssid"] for point in listed if point["quarantined"]] == [bssid]
    house.ask("ap", "trust", house.building, bssid, "auto")
    assert not [point for point in house.ask("ap", "list", house.building)["items"] if point["quarantined"]]


def metrics_tell(house):
    _, said, _ = house.run("metrics")
    for name in ("wayfuse_fix_radius_meters_bucket", "wayfuse_calibration_68_ratio", "wayfuse_access_points_distrusted", "wayfuse_quality_walks 3"):
        assert name in said, name


def main():
    parser = argparse.ArgumentParser()
    for program in ("--server", "--phone", "--cli"):
        parser.add_argument(program, required=True)
    house = House(parser.parse_args())

    try:
        survey_goes_live_by_itself(house)
        quality_walks_measure_it(house)
        worse_maps_are_refused(house)
        survey_says_what_it_promises(house)
        survey_moves_as_a_file(house)
        access_points_are_trusted_by_hand(house)
        metrics_tell(house)
    finally:
        house.close()


if __name__ == "__main__":
    main()
