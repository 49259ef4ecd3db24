"""How smooth a floor with many moving phones is: frame intervals, and the processor time the page takes for a frame.

  python3 tests/console/frames.py --server build/server/wayfused --phone build/sdk/wayfuse-phone --cli build/admin/wayfuse --phones 500

Not a test: it prints quantiles. What holds without a clock (a fixed number of strokes and fills a frame, a bounded table) console_test.py
tests. Page, building and survey come from a real server; the positions are made in the page by `crowd.js`, so that 500 phones' sensors
need not run on the machine that is being measured.
"""

import argparse
import asyncio
import json
import pathlib

from browser import Browser
from system import System, add_programs

CROWD = pathlib.Path(__file__).with_name("crowd.js")

# The time between frames over so many seconds.
INTERVALS = """((seconds) => new Promise((done) => {
  const intervals = []; let last = performance.now(); const begin = last;
  const step = (now) => { intervals.push(now - last); last = now;
    if (now - begin < seconds * 1000) requestAnimationFrame(step); else done(intervals.slice(5)); };
  requestAnimationFrame(step);
}))"""


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


def show(name, values):
    print(f"{name:<36} median {quantile(values, 0.5):6.1f} ms   95 % {quantile(values, 0.95):6.1f} ms   worst {max(values):6.1f} ms   ({len(values)} frames)")


async def look(page, what, seconds, meanwhile=None):
    """Processor time is the main thread's own (threadTicks): other processes of the machine do not count."""
    async def spent():
        metrics = {m["name"]: m["value"] for m in (await page.call("Performance.getMetrics"))["metrics"]}
        return metrics["TaskDuration"]
    before = await spent()
    looking = asyncio.create_task(page.run(f"{INTERVALS}({seconds})"))
    if meanwhile:
        await meanwhile
    intervals = await looking
    show(f"between frames, {what}", intervals)
    print(f"{'main thread a frame, ' + what:<36} mean   {1000 * (await spent() - before) / len(intervals):6.1f} ms")


async def look_at_nothing(system, seconds):
    """What this machine and this browser give a page that does nothing: what the rest is held against."""
    page = await Browser.open(f"{system.url}/healthz", 1600, 1000)
    try:
        show("between frames, an empty page", await page.run(f"{INTERVALS}({seconds})"))
    finally:
        await page.close()


async def measure(system, phones, seconds):
    await look_at_nothing(system, seconds)
    page = await Browser.open(f"{system.url}/console/", 1600, 1000)
    try:
        await page.call("Page.addScriptToEvaluateOnNewDocument", source=f"const kCrowd = {phones};\n{CROWD.read_text()}")
        await page.run(f"sessionStorage.setItem('wayfuse-key', {json.dumps(system.key)}); location.reload()")
        await page.until(f"Number(document.getElementById('count')?.textContent) >= {phones}")
        await page.call("Performance.enable", timeDomain="threadTicks")
        print(f"{phones} phones; rows in the table: {await page.run('document.querySelectorAll(`#phones tr`).length')}")
        await look(page, "watching", seconds)
        await page.run("document.querySelector('.map-tools button').click()")
        await look(page, "dragging", seconds, drag(page, seconds))
    finally:
        await page.close()


async def drag(page, seconds):
    await page.call("Input.dispatchMouseEvent", type="mousePressed", x=600, y=500, button="left", clickCount=1)
    for i in range(int(seconds * 20)):
        await page.call("Input.dispatchMouseEvent", type="mouseMoved", x=600 + 80 * ((i % 20) - 10) / 10, y=500 + (i % 40), button="left", buttons=1)
        await asyncio.sleep(0.05)
    await page.call("Input.dispatchMouseEvent", type="mouseReleased", x=600, y=500, button="left", clickCount=1)


def main():
    parser = argparse.ArgumentParser()
    add_programs(parser)
    parser.add_argument("--phones", type=int, default=500)
    parser.add_argument("--seconds", type=float, default=10)
    wanted = parser.parse_args()
    system = System(wanted, phones=1, speed=1)
    try:
        asyncio.run(measure(system, wanted.phones, wanted.seconds))
    finally:
        system.close()


main()
