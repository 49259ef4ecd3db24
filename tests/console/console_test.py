"""The console in a real Chromium, against a real server with stand-in phones: every view, three widths, light and dark, by keyboard;
nothing is asked of anybody else, and the page complains of nothing."""

import argparse
import asyncio
import json
import pathlib
import shutil
import sys

try:
    from browser import Browser
except ImportError as error:
    print(f"SKIPPED: {error}; install python3-websockets")
    sys.exit(77)
import page_checks
from system import System, add_programs
from view_checks import VIEWS, fill, says

SCREENS = {"wide": (1600, 1000), "tablet": (820, 1100), "phone": (390, 844)}


# What a view has to open before it is looked at: what is pressed, and what must then be there.
OPENED = {"live": [("#phones button", "[aria-pressed=true].link")], "sessions": [("#sessions a", ".residual")],
          "replay": [("#recordings a", ".player")]}


def unmeant(page):
    """What the page complained of, without the 404 that says that a floor has no picture."""
    return [one for one in page.complaints if "/image/placement" not in one]


async def sign_in(page, key):
    await page.until("document.getElementById('sign-in')")
    await page_checks.hold(page, "sign in")
    await page.run(fill("#key", "wf_wrong"))
    await page.run("document.getElementById('sign-in').requestSubmit()")
    await page.until(says("does not know this key"))
    assert await page.run("sessionStorage.length") == 0, "a wrong key must not be kept"
    page.complaints.clear()  # the browser logs the refused request; that one was meant
    await page.run(fill("#key", key))
    await page.run("document.getElementById('sign-in').requestSubmit()")
    await page.until("document.querySelector('.shell')")


async def use_the_keyboard(page, building):
    await page.run(f"location.hash = '#/{building}/live'")
    await page.until("document.querySelector('#phones tr') && document.querySelector('.map-box')")
    await page.run("document.activeElement.blur()")
    # The focused element's name; null where it was met before: once around.
    meet = """(() => { const e = document.activeElement; if (e.dataset.met) return null; e.dataset.met = 'yes';
      return e.getAttribute('aria-label') ?? (e.closest('label') ?? e).innerText; })()"""
    reached = set()
    while True:
        await page.press("Tab")
        if await page.run("document.activeElement === document.body"):
            continue  # past the last, before the first
        unseen = await page.run(page_checks.FOCUS_SEEN)
        assert not unseen, f"focus does not show: {unseen}"
        met = await page.run(meet)
        if met is None:
            break
        reached.add(met)
    for wanted in ("Live", "Survey", "Keys", "Building", "Zoom in", "68 %", "Sign out"):
        assert wanted in reached, f"Tab does not reach {wanted}: {reached}"
    # From the phone's row to why it is where it is.
    await page.run("document.querySelector('#phones button').focus()")
    await page.press("Enter")
    await page.until(says("Why is it here?"))
    await page.run("document.querySelector('.side button').focus()")
    while await page.run("document.activeElement.textContent !== 'Why is it here?'"):
        await page.press("Tab")
    await page.press("Enter")
    await page.until("location.hash.split('/').length === 4 && document.querySelector('.residual')")
    await page.run("history.back()")
    await page.until("document.querySelector('#phones tr') && document.querySelector('.map-box.leaflet-container')")  # it listens
    await page.run("document.querySelector('.map-box').focus()")
    scale = "document.querySelector('.leaflet-control-scale-line').textContent + document.querySelector('.leaflet-control-scale-line').style.width"
    before = await page.run(scale)
    await page.press("+")
    await page.press("+")
    await page.until(f"{scale} !== {json.dumps(before)}")


async def look_at_every_screen(page, building, pictures):
    for screen, (width, height) in SCREENS.items():
        await page.resize(width, height)
        for scheme in ("light", "dark"):
            await page.prefer(scheme)
            await page.until(f"document.documentElement.dataset.theme === '{scheme}'")
            for view in VIEWS:
                await page.run(f"location.hash = '#/{building}/{view}'")
                await page.until(f"document.querySelector('.rail [aria-current]').getAttribute('href').endsWith('/{view}') && !document.querySelector('.loading')")
                for button, shown in OPENED.get(view, ()):
                    await page.run(f"document.querySelector({json.dumps(button)})?.click()")
                    await page.until(f"document.querySelector({json.dumps(shown)})")
                await page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")
                await page_checks.hold(page, f"{view}, {screen}, {scheme}")
                await page.picture(pictures / f"console-{view}-{screen}-{scheme}.png")


# The most fills and strokes in one of 40 frames.
STROKES = """new Promise((done) => { let n = 0, most = 0, left = 40; const pen = CanvasRenderingContext2D.prototype;
  for (const name of ['fill', 'stroke']) { const real = pen[name]; pen[name] = function (...given) { ++n; return real.apply(this, given); }; }
  const step = () => { most = Math.max(most, n); n = 0; if (--left) requestAnimationFrame(step); else done(most); };
  requestAnimationFrame(step); })"""


async def look_at_a_crowd(system):
    """500 phones on one floor cost a frame as many strokes as a few, and the page as many elements (crowd.js makes the positions)."""
    page = await Browser.open(f"{system.url}/console/", *SCREENS["wide"])
    try:
        crowd = pathlib.Path(__file__).with_name("crowd.js").read_text()
        await page.call("Page.addScriptToEvaluateOnNewDocument", source=f"const kCrowd = 500;\n{crowd}")
        await page.run(f"sessionStorage.setItem('wayfuse-key', {json.dumps(system.key)}); location.reload()")
        await page.until("document.getElementById('count')?.textContent === '500'")
        await page.run("document.querySelector('#phones button').click()")
        strokes = await page.run(STROKES)
        # Three states, each regions, tracks and headings; the chosen phone's two outlines, track and dot.
        assert 0 < strokes <= 3 * 4 + 5, f"{strokes} fills and strokes in a frame"
        assert await page.run("document.querySelectorAll('#phones tr').length") == 100
        assert not unmeant(page), unmeant(page)
    finally:
        await page.close()


async def look_with_a_key_for_zones(system):
    """A key that sees zones only is told of entries and exits, and the page asks for no positions with it."""
    key = system.post("/v1/keys", json.dumps({"name": "lobby screen", "scopes": ["observe"], "building": int(system.building), "coarse": True}).encode())["key"]
    page = await Browser.open(f"{system.url}/console/#/{system.building}/live", *SCREENS["phone"])
    try:
        await page.run(f"sessionStorage.setItem('wayfuse-key', {json.dumps(key)}); location.reload()")
        await page.until(f"document.getElementById('link')?.textContent === 'Live' && {says('This key sees which zone a phone is in')}")
        assert await page.run("document.getElementById('phones')") is None
        await page.run(f"location.hash = '#/{system.building}/zones'")
        system.post(f"/v1/buildings/{system.building}/zones", json.dumps({"name": "Everywhere else", "floor": 1, "region": [[[0, 0], [60, 0], [60, 32], [0, 32]]],
                    "exit_tolerance_m": 1, "tolerance_timeout_us": 1000000, "exit_delay_us": 1000000, "timeout_us": 60000000}).encode())
        await page.until("document.querySelector('#zone-events li')")
    finally:
        await page.close()


async def look(system, pictures):
    page = await Browser.open(f"{system.url}/console/", *SCREENS["wide"])
    try:
        await sign_in(page, system.key)
        for view, check in VIEWS.items():
            await page.run(f"location.hash = '#/{system.building}/{view}'")
            await check(page, system)
        await use_the_keyboard(page, system.building)
        await look_at_every_screen(page, system.building, pictures)
        assert await page.run("localStorage.length === 0 && document.cookie === ''"), "the key stays in the tab"
        await page.run("document.querySelector('[aria-label=\"Sign out\"]').click()")
        await page.until("document.getElementById('sign-in')")
        assert await page.run("sessionStorage.length") == 0
        foreign = [url for url in page.requested if not url.startswith((system.url, "data:", "blob:"))]
        assert not foreign, f"asked elsewhere: {foreign}"
        assert not unmeant(page), unmeant(page)
    finally:
        await page.close()


def main():
    parser = argparse.ArgumentParser()
    add_programs(parser)
    parser.add_argument("--pictures", required=True)
    programs = parser.parse_args()
    if not shutil.which("chromium"):
        print("SKIPPED: chromium is not installed")
        sys.exit(77)
    system = System(programs)
    try:
        asyncio.run(look(system, pathlib.Path(programs.pictures)))
        asyncio.run(look_with_a_key_for_zones(system))
        asyncio.run(look_at_a_crowd(system))
    finally:
        system.close()
    print(f"{', '.join(VIEWS)}: at three widths, light and dark, by keyboard; nothing asked elsewhere, nothing complained of")


main()
