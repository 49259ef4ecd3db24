"""Paints the README's picture of the console anew: the demo building's ground floor with walking phones, their regions, tracks and zones.

  python3 tests/console/picture.py --server build/server/wayfused --phone build/sdk/wayfuse-phone --cli build/admin/wayfuse admin/console/console.png
"""

import argparse
import asyncio
import json

from browser import Browser
from system import System, add_programs

ZONES = {"Reception": [[0.1, 0.1], [11.9, 0.1], [11.9, 6.9], [0.1, 6.9]], "Lab": [[24.1, 25.1], [35.9, 25.1], [35.9, 31.9], [24.1, 31.9]],
         "Canteen": [[42.1, 0.1], [59.9, 0.1], [59.9, 6.9], [42.1, 6.9]], "Archive": [[48.1, 25.1], [59.9, 25.1], [59.9, 31.9], [48.1, 31.9]],
         "Board room": [[21, 9.7], [33, 9.7], [33, 15.9], [21, 15.9]]}
WALKED_MS = 150_000   # they begin together; by then they are all over the building, and the tracks are as long as they get
ON_THE_GROUND = "[...document.querySelectorAll('#phones tr')].filter((row) => row.cells[1].textContent === 'Ground' && row.innerText.includes('ok'))"


async def paint(system, file):
    for name, ring in ZONES.items():
        system.post(f"/v1/buildings/{system.building}/zones", json.dumps({"name": name, "floor": 0, "region": [ring], "exit_tolerance_m": 1,
                    "tolerance_timeout_us": 10_000_000, "exit_delay_us": 5_000_000, "timeout_us": 120_000_000}).encode())
    page = await Browser.open(f"{system.url}/console/", 1500, 860)
    try:
        await page.run(f"sessionStorage.setItem('wayfuse-key', {json.dumps(system.key)}); location.reload()")
        await page.until(f"performance.now() > {WALKED_MS} && {ON_THE_GROUND}.length > 3", 300)
        await page.run("[...document.querySelectorAll('.map-panel label')].find((e) => e.textContent === '95 %').querySelector('input').click()")
        await page.run(f"{ON_THE_GROUND}[1].querySelector('button').click()")
        await page.until("document.body.innerText.includes('Session')")
        await page.run("document.activeElement.blur(); new Promise((done) => setTimeout(() => done(true), 1500))")  # every layer has followed
        await page.picture(file)
    finally:
        await page.close()


def main():
    parser = argparse.ArgumentParser()
    add_programs(parser)
    parser.add_argument("file")
    wanted = parser.parse_args()
    system = System(wanted, phones=14, speed=1)
    try:
        asyncio.run(paint(system, wanted.file))
    finally:
        system.close()


main()
