"""The console in a real Chromium: sign in, see the plan, the reference points and phones that move; nothing from elsewhere."""

import argparse
import asyncio
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    from browser import Browser
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-websockets")
    sys.exit(77)

# What the canvas shows, as the page's own pixels: how many differ from the empty ground.
PAINTED = """(() => { const c = document.getElementById('plan'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (d.length / 4); })()"""

DRAWN = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))"


class System:
    """wayfused on a free port with a surveyed demo building and walking phones."""

    def __init__(self, programs):
        self.programs = programs
        self.folder = tempfile.mkdtemp()
        self.server = subprocess.Popen([programs.server, "--server.data", f"{self.folder}/data", "--listen.port", "0",
                                        "--log.level", "warn"], stdout=subprocess.PIPE, text=True)
        said = [json.loads(self.server.stdout.readline()) for _ in range(2)]
        self.key, self.url = said[0]["admin_key"], said[1]["url"]
        self.environment = {**os.environ, "WAYFUSE_KEY": self.key}
        world = subprocess.run([programs.phone, "world"], check=True, capture_output=True).stdout
        made = subprocess.run([programs.cli, "--server", self.url, "--json", "building", "create", "-"], input=world, check=True,
                              capture_output=True, env=self.environment).stdout
        self.building = str(json.loads(made)["id"])
        self.phone("survey", "--passes", "1").wait()
        self.phones = self.phone("walk", "--phones", "5", "--minutes", "10", "--speed", "2", "--no-compare")

    def phone(self, command, *arguments):
        socket = f"ws{self.url[4:]}/v1/session"
        return subprocess.Popen([self.programs.phone, command, "--server", socket, "--building", self.building, *arguments],
                                env=self.environment, stdout=subprocess.DEVNULL)

    def close(self):
        for process in (self.phones, self.server):
            process.terminate()
            process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


async def sign_in(page, key):
    await page.until("document.getElementById('sign-in').open")
    await page.run("document.getElementById('key').value = 'wf_wrong'; document.querySelector('#sign-in form').requestSubmit()")
    await page.until("document.getElementById('sign-in-fault').textContent.length > 0")
    assert await page.run("document.getElementById('sign-in').open"), "a wrong key must not open the console"
    page.complaints.clear()  # the browser logs the refused request; that one was meant
    await page.run(f"document.getElementById('key').value = {json.dumps(key)}; document.querySelector('#sign-in form').requestSubmit()")
    await page.until("!document.getElementById('sign-in').open")


async def look(system, pictures):
    page = await Browser.open(f"{system.url}/console/")
    try:
        await sign_in(page, system.key)
        await page.until("Number(document.getElementById('count').textContent) === 5")
        assert "live" in await page.run("document.getElementById('link').textContent")
        assert await page.run("document.getElementById('floor').options.length") == 2
        assert await page.run(PAINTED) > 0.2, "the floor plan is drawn"
        where = "JSON.stringify([...document.querySelectorAll('#phones tr')].map((r) => r.textContent))"
        before = await page.run(where)
        await page.until(f"{where} !== {json.dumps(before)}")  # the phones move
        await page.picture(pictures / "console-wide.png")
        await page.prefer("dark")
        await page.run("document.querySelector('#phones tr').click()")
        await page.run("document.getElementById('plan').focus()")
        for key in ("+", "+", "ArrowLeft"):
            await page.press(key)
        await page.run(DRAWN)
        await page.picture(pictures / "console-dark.png")
        await page.press("0")
        await page.resize(390, 800)
        await page.run(DRAWN)
        assert await page.run("document.documentElement.scrollWidth <= 390"), "nothing sticks out on a phone's screen"
        await page.picture(pictures / "console-narrow.png")
        foreign = [url for url in page.requested if not url.startswith(system.url)]
        assert not foreign, f"asked elsewhere: {foreign}"
        assert not page.complaints, page.complaints
    finally:
        await page.close()


def main():
    parser = argparse.ArgumentParser()
    for name in ("server", "phone", "cli", "pictures"):
        parser.add_argument(f"--{name}", required=True)
    programs = parser.parse_args()
    if not shutil.which("chromium"):
        print("SKIPPED: chromium is not installed")
        sys.exit(77)
    system = System(programs)
    try:
        asyncio.run(look(system, pathlib.Path(programs.pictures)))
    finally:
        system.close()
    print("the console shows plan, points and moving phones at three widths, asks nothing elsewhere and complains of nothing")


main()
