"""wayfused on a free port with a surveyed demo building and walking phones: what the console's tests look at."""

import json
import os
import shutil
import subprocess
import tempfile
import urllib.request


class System:
    def __init__(self, programs, phones=5, speed=2):
        self.programs = programs
        self.folder = tempfile.mkdtemp()
        self.server = subprocess.Popen([programs.server, "--server.data", f"{self.folder}/data", "--listen.port", "0",
                                        "--log.level", "warn", "--webhooks.private_targets", "true"], stdout=subprocess.PIPE, text=True)
        said = [json.loads(self.server.stdout.readline()) for _ in range(2)]
        self.key, self.url = said[0]["admin_key"], said[1]["url"]
        self.environment = {**os.environ, "WAYFUSE_KEY": self.key}
        world = subprocess.run([programs.phone, "world"], check=True, capture_output=True).stdout
        made = subprocess.run([programs.cli, "--server", self.url, "--json", "building", "create", "-"], input=world, check=True,
                              capture_output=True, env=self.environment).stdout
        self.building = str(json.loads(made)["id"])
        self.phone("survey", "--passes", "1").wait()
        self.phones = self.phone("walk", "--phones", str(phones), "--minutes", "1000", "--speed", str(speed), "--no-compare")

    def phone(self, command, *arguments):
        socket = f"ws{self.url[4:]}/v1/session"
        return subprocess.Popen([self.programs.phone, command, "--server", socket, "--building", self.building, *arguments],
                                env=self.environment, stdout=subprocess.DEVNULL)

    def add_quality_walk(self):
        """A recorded walk with known truth, put up for the radio maps to be measured by."""
        file = f"{self.folder}/walk.jsonl"
        subprocess.run([self.programs.phone, "record", file, "--minutes", "1"], check=True, stdout=subprocess.DEVNULL)
        with open(file, "rb") as recording:
            self.post(f"/v1/buildings/{self.building}/quality-walks?name=corridor", recording.read())

    def post(self, path, body):
        request = urllib.request.Request(self.url + path, data=body, headers={"authorization": f"Bearer {self.key}"}, method="POST")
        with urllib.request.urlopen(request) as answer:
            return json.load(answer)

    def close(self):
        for process in (self.phones, self.server):
            process.terminate()
            process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def add_programs(parser):
    for name in ("server", "phone", "cli"):
        parser.add_argument(f"--{name}", required=True)
