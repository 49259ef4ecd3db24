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

SCREENS = {"wide": (1600, 1000), "tablet": (820, 1100), "phone": (390, 844)}
VIEWS = ["live", "survey", "buildings", "keys"]

# How much of a canvas layer is painted, by its own pixels.
PAINTED = """(() => { const c = document.querySelector('canvas[data-layer=%s]'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (d.length / 4); })()"""

# Preact listens to `input` and `change`; a value set by script alone is not seen.
FILL = """((selector, value) => { const e = document.querySelector(selector);
  Object.getOwnPropertyDescriptor(Object.getPrototypeOf(e), 'value').set.call(e, value);
  e.dispatchEvent(new Event('input', { bubbles: true })); e.dispatchEvent(new Event('change', { bubbles: true })); })(%s, %s)"""


def fill(selector, value):
    return FILL % (json.dumps(selector), json.dumps(value))


def click(text, inside="document"):
    return f"[...{inside}.querySelectorAll('button, a')].find((b) => b.textContent.trim() === {json.dumps(text)}).click()"


def says(text):
    return f"document.body.innerText.includes({json.dumps(text)})"


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


async def look_at_live(page):
    await page.until("document.getElementById('count')?.textContent === '5'")
    await page.until("document.getElementById('link').textContent === 'Live'")
    assert await page.run("document.querySelectorAll('.floor-switch input').length") == 2
    assert await page.run("document.querySelectorAll('path.plan-open').length") > 10, "the walkable areas are drawn"
    await page.until(f"{PAINTED % 'phones'} > 0.0001")
    where = "[...document.querySelectorAll('#phones tr')].map((r) => r.textContent).join()"
    before = await page.run(where)
    await page.until(f"{where} !== {json.dumps(before)}")  # the phones move
    await page.run("document.querySelector('#phones button').click()")
    await page.until(says("What the fix rests on"))
    assert await page.run("Number([...document.querySelectorAll('dt')].find((e) => e.textContent === 'Access points used').nextSibling.textContent)") > 0
    await page.until(says("wayfuse-phone"))  # the session's own data, from the API


async def look_at_survey(page):
    await page.until(f"document.querySelector('canvas[data-layer=points]') && {PAINTED % 'points'} > 0.0005")
    await page.run("document.querySelector('.choice input[value=level]').click()")
    await page.until("document.querySelector('.side select')?.options.length > 5")
    await page.until(says("Level, dBm"))


async def look_at_keys(page, system):
    await page.until("document.querySelectorAll('[data-key]').length === 1")
    await page.run(click("New key"))
    await page.until("document.querySelector('dialog[open] #key-name')")
    await page_checks.hold(page, "new key")
    await page.run(fill("#key-name", "Visitor app"))
    await page.run(click("Create key"))
    await page.until("document.getElementById('secret')")
    secret = await page.run("document.getElementById('secret').textContent")
    assert secret.startswith("wf_") and len(secret) == 46, secret
    await page.run(click("I have kept it"))
    await page.until("document.querySelectorAll('[data-key]').length === 2")
    assert not await page.run(f"document.documentElement.outerHTML.includes({json.dumps(secret)})"), "a key is shown once"
    await page.run("[...document.querySelectorAll('[data-key]')].find((r) => r.innerText.includes('Visitor app')).querySelector('button').click()")
    await page.until("document.querySelector('dialog[open]')")
    await page.run(click("Revoke", "document.querySelector('dialog')"))
    await page.until("document.querySelectorAll('[data-key]').length === 1")


async def look_at_buildings(page):
    await page.until("document.querySelectorAll('[data-building]').length === 1")
    await page.run(click("New building"))
    await page.until("document.querySelector('#building-name')")
    await page_checks.hold(page, "new building")
    await page.run(fill("#building-name", "Annexe"))
    await page.run(click("Create building"))
    await page.until("location.hash.endsWith('/survey') && document.querySelector('.building-choice select').selectedOptions[0]?.text === 'Annexe'")
    await page.until(says("This floor is not surveyed"))


async def use_the_keyboard(page, building):
    await page.run(f"location.hash = '#/{building}/live'")
    await page.until("document.querySelector('#phones tr') && document.querySelector('.map-box')")
    await page.run("document.activeElement.blur()")
    name = "document.activeElement.getAttribute('aria-label') ?? (document.activeElement.closest('label') ?? document.activeElement).innerText"
    reached = set()
    while True:
        await page.press("Tab")
        if await page.run("document.activeElement === document.body"):
            continue  # past the last, before the first
        unseen = await page.run(page_checks.FOCUS_SEEN)
        assert not unseen, f"focus does not show: {unseen}"
        reached_now = await page.run(name)
        if reached_now in reached:
            break  # once around
        reached.add(reached_now)
    for wanted in ("Live", "Survey", "Keys", "Building", "Zoom in", "68 %", "Sign out"):
        assert wanted in reached, f"Tab does not reach {wanted}: {reached}"
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
                await page.run("document.querySelector('[data-layer=phones]') ? document.querySelector('#phones button')?.click() : 0")
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
        assert not page.complaints, page.complaints
    finally:
        await page.close()


async def look(system, pictures):
    page = await Browser.open(f"{system.url}/console/", *SCREENS["wide"])
    try:
        await sign_in(page, system.key)
        await look_at_live(page)
        for view, check in (("survey", look_at_survey(page)), ("keys", look_at_keys(page, system)), ("buildings", look_at_buildings(page))):
            await page.run(f"location.hash = '#/{system.building}/{view}'")
            await check
        await use_the_keyboard(page, system.building)
        await look_at_every_screen(page, system.building, pictures)
        assert await page.run("localStorage.length === 0 && document.cookie === ''"), "the key stays in the tab"
        await page.run("document.querySelector('[aria-label=\"Sign out\"]').click()")
        await page.until("document.getElementById('sign-in')")
        assert await page.run("sessionStorage.length") == 0
        foreign = [url for url in page.requested if not url.startswith((system.url, "data:", "blob:"))]
        assert not foreign, f"asked elsewhere: {foreign}"
        assert not page.complaints, page.complaints
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
        asyncio.run(look_at_a_crowd(system))
    finally:
        system.close()
    print(f"{', '.join(VIEWS)}: at three widths, light and dark, by keyboard; nothing asked elsewhere, nothing complained of")


main()
