"""What an operator does in each view, and what must then be seen. Every check begins in its view and leaves no dialog open."""

import json
import pathlib

import page_checks
from receiver import Receiver

# How much of a canvas layer is painted, by its own pixels.
PAINTED = """(() => { const c = document.querySelector('canvas[data-layer=%s]'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (d.length / 4); })()"""

# Preact listens to `input` and `change`; a value set by script alone is not seen.
FILL = """((selector, value) => { const e = document.querySelector(selector);
  Object.getOwnPropertyDescriptor(Object.getPrototypeOf(e), 'value').set.call(e, value);
  e.dispatchEvent(new Event('input', { bubbles: true })); e.dispatchEvent(new Event('change', { bubbles: true })); })(%s, %s)"""

ROOM = """{"type": "FeatureCollection", "features": [
  {"type": "Feature", "properties": {"kind": "floor", "floor": 0, "label": "Ground"},
   "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [60, 0], [60, 32], [0, 32], [0, 0]]]}},
  {"type": "Feature", "properties": {"kind": "room", "floor": 0, "name": "Lab"},
   "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [10, 0], [10, 7], [0, 7], [0, 0]]]}}]}"""


def fill(selector, value):
    return FILL % (json.dumps(selector), json.dumps(value))


def click(text, inside="document"):
    return f"[...{inside}.querySelectorAll('button, a')].find((b) => b.textContent.trim() === {json.dumps(text)}).click()"


def says(text):
    return f"document.body.innerText.includes({json.dumps(text)})"


async def live(page, system):
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


async def sessions(page, system):
    await page.until("document.querySelectorAll('#sessions tr').length === 5")
    await page.run("document.querySelector('#sessions a').click()")
    await page.until("location.hash.split('/').length === 4 && document.querySelector('.residual')")
    await page.until(f"{PAINTED % 'explanation'} > 0.0005")  # particles and regions
    used = "Number([...document.querySelectorAll('h2')].find((e) => e.textContent.startsWith('Access points used')).querySelector('.badge').textContent)"
    assert await page.run(used) > 3
    assert await page.run("[...document.querySelectorAll('.bar meter')].reduce((sum, e) => sum + e.value, 0)") > 0.9, "floor votes"
    await page.run("document.querySelector('.side tbody button').click()")
    await page.until(f"{says('in the survey')} && {PAINTED % 'points'} > 0.0003")  # where the survey heard it
    await page.run(click("Hold"))
    await page.until(says("Go on"))
    await page.run(f"location.hash = '#/{system.building}/sessions/nobody'")
    await page.until(says("The session has ended"))
    page.complaints = [one for one in page.complaints if "/nobody/explain" not in one]


async def replay(page, system):
    """Records, then lives a session through again: by slider, keys and play; every step comes out as it was."""
    await page.until("!document.querySelector('.loading')")
    assert await page.run(says("Nothing is recorded"))
    await page.run(click("Record"))
    await page.until("document.querySelectorAll('#recordings tr').length === 5")
    steps = "Number(document.querySelector('.player input').max)"
    await page.until("[...document.querySelectorAll('#recordings .sub')].length > 0")
    step = "Number(document.getElementById('step')?.textContent)"
    enough = 12  # steps, so that scans are among what was recorded
    for _ in range(120):  # it still grows, from nothing: looked into until it holds enough to step through
        await page.run("document.querySelector('#recordings a').click()")
        await page.until(f"document.querySelector('.player input') || {says('Nothing was heard of this session yet')}")
        if await page.run("document.querySelector('.player input') !== null") and await page.run(steps) >= enough:
            break
        await page.run("document.querySelector('[aria-label=\"All recordings\"]').click()")
        await page.until("document.querySelector('#recordings a')")
    assert await page.run(steps) >= enough, "the recording does not grow"
    assert await page.run(says("bit for bit")), "the replay differs from the live session"
    await page.run("document.activeElement.blur()")
    await page.press("End")
    await page.until(f"{step} === {steps} && document.querySelector('.residual')")
    await page.until(f"{PAINTED % 'explanation'} > 0.0005")
    await page.press("ArrowLeft")
    await page.until(f"{step} === {steps} - 1")
    await page.press("Home")
    await page.until(f"{step} === 1")
    await page.press(" ")
    await page.until(f"{step} === {steps}")  # it plays to the end
    await page.run(fill(".side select", "p1"))
    await page.until(f"{step} === 1 && document.querySelector('.player input') && !{says('bit for bit')}", 120)
    await page.run("document.activeElement.blur()")
    await page.press("End")
    await page.until(f"{step} === {steps} && document.querySelector('.residual')")
    await page.run("document.querySelector('[aria-label=\"All recordings\"]').click()")
    await page.until(says("Recording every phone"))
    await page.run(click("Stop"))
    await page.until("[...document.querySelectorAll('button')].some((b) => b.textContent === 'Record')")


async def zones(page, system):
    await page.until(says("No zone yet"))
    await page.run(click("Draw a zone"))
    await page.until("document.getElementById('zone-name')")
    await page_checks.hold(page, "new zone")
    for x, y in ((500, 300), (900, 300), (900, 700), (500, 700), (500, 700)):  # the last corner again ends the drawing
        await page.click_at(x, y)
    await page.until("document.getElementById('zone-corners').value.split('\\n').length === 4")
    await page.run(fill("#zone-corners", "0, 0\n60, 0\n60, 32\n0, 32"))
    await page.run(fill("#zone-name", "Everywhere"))
    await page.run(click("Create zone"))
    await page.until("document.querySelector('#zones tr') && document.querySelector('path.zone.chosen')")
    await page.until("document.querySelector('#zone-events li')")  # those who are there have entered
    await page.until("Number(document.querySelector('.big-fact dd').textContent) > 0")
    await page.run(click("Edit"))
    await page.until("document.querySelectorAll('.leaflet-vertex-icon').length === 4 && document.getElementById('zone-name')")
    await page.run(fill("#zone-name", "The whole floor"))
    await page.run(click("Save"))
    await page.until("document.querySelector('#zones tr')?.dataset.name === 'The whole floor'")


async def survey(page, system):
    await page.until(f"document.querySelector('canvas[data-layer=points]') && {PAINTED % 'points'} > 0.0003")
    await page.until("document.querySelector('img.heat')")  # the expected accuracy
    await page.until(says("Expected median error here now"))
    await page.until("document.querySelector('.walks li') || document.body.innerText.includes('Nothing to gain')")
    await page.run("document.querySelector('.choice input[value=level]').click()")
    await page.until("document.querySelector('.side select')?.options.length > 5")
    await page.until(says("Level, dBm"))


async def maps(page, system):
    system.add_quality_walk()
    await page.until("document.querySelectorAll('[data-version]').length > 1 && !document.querySelector('.loading')")
    await page.run(click("Build from the survey"))
    await page.until(says("is built and measured"), 180)
    live = "document.querySelector('[data-version]:has(.badge.good)')?.dataset.version"
    before = await page.run(live)
    await page.run(click("Compare"))
    await page.until("document.querySelectorAll('polyline.curve').length === 2", 180)  # both versions' errors
    await page.until(says("All walks"))
    await page.run(click("Promote"))
    await page.until("document.getElementById('promotion-reason')")
    await page_checks.hold(page, "promote")
    await page.run(fill("#promotion-reason", "a second look"))
    await page.run(click("Promote", "document.querySelector('dialog')"))
    # A version that is worse is refused, and the operator may override; one walk does not say beforehand which of the two it is.
    await page.until("!document.querySelector('dialog[open]') || document.querySelector('dialog .notice.bad')", 180)
    if await page.run("document.querySelector('dialog .notice.bad') !== null"):
        page.complaints = [one for one in page.complaints if "/promotion" not in one]
        await page.run("document.querySelector('dialog input[type=checkbox]').click()")
        await page.run(click("Override and promote", "document.querySelector('dialog')"))
    await page.until(f"!document.querySelector('dialog[open]') && {says('a second look')} && {live} !== {json.dumps(before)}", 180)
    await page.run(click("Roll back"))
    await page.until("document.querySelector('dialog[open] textarea')")
    await page.run(fill("dialog textarea", "back to the first"))
    await page.run(click("Roll back", "document.querySelector('dialog')"))
    await page.until(f"{says('back to the first')} && {live} === {json.dumps(before)}", 180)


async def access_points(page, system):
    await page.until("!document.querySelector('.loading')")
    await page.run("document.querySelector('.choice input[value=all]').click()")
    await page.until("document.querySelectorAll('[data-bssid]').length > 5")
    await page.run(fill("[data-bssid] select", "never"))
    await page.until("document.querySelector('[data-bssid]').innerText.includes('left out')")
    await page.run("document.querySelector('[data-bssid] a').click()")  # where the survey heard it
    await page.until(f"location.hash.split('/')[2] === 'survey' && {says('Level, dBm')} && {PAINTED % 'points'} > 0.0003")


async def plans(page, system):
    file = system.folder + "/plan.geojson"
    with open(file, "w") as out:
        out.write(ROOM)
    await page.until("document.getElementById('plan-file')")
    await page.choose_file("#plan-file", file)
    await page.run(fill(".side .fields label:nth-child(2) select", "local"))
    await page.run(click("Check"))
    await page.until("document.getElementById('plan-report')")
    assert await page.run(says("Nothing is stored yet"))
    await page_checks.hold(page, "plan report")


async def webhooks(page, system):
    receiver = Receiver()
    try:
        await page.until(says("No webhook yet"))
        await page.run(click("New webhook"))
        await page.until("document.getElementById('webhook-url')")
        await page_checks.hold(page, "new webhook")
        await page.run(fill("#webhook-url", receiver.url))
        await page.run(click("Create webhook"))
        await page.until("document.getElementById('secret')?.textContent.startsWith('whsec_')")
        await page.run(click("I have kept it"))
        await page.until("document.querySelectorAll('[data-webhook]').length === 1")
        # Whoever is on the floor enters a new zone; the receiver refuses that for good.
        system.post(f"/v1/buildings/{system.building}/zones", json.dumps({"name": "Lobby", "floor": 0, "region": [[[0, 0], [60, 0], [60, 32], [0, 32]]],
                    "exit_tolerance_m": 1, "tolerance_timeout_us": 1000000, "exit_delay_us": 1000000, "timeout_us": 60000000}).encode())
        await page.until("[...document.querySelectorAll('button')].some((b) => b.textContent === 'Dead letters')")
        assert await page.run(says("Last failure"))
        await page.run(click("Dead letters"))
        await page.until("document.querySelectorAll('[data-event]').length > 0")
        await page_checks.hold(page, "dead letters")
        receiver.takes = True
        await page.run(click("Try all again", "document.querySelector('dialog')"))
        await page.until("Number(document.querySelector('[data-label=Delivered]').textContent) > 0")
        assert receiver.taken > 0
        await page.run(click("Deliveries"))
        await page.until("document.querySelectorAll('[data-delivery]').length > 1")
        assert await page.run(says("dead letter")) and await page.run(says("delivered"))
        await page_checks.hold(page, "deliveries")
        await page.run(click("Close", "document.querySelector('dialog')"))
        await page.until("!document.querySelector('dialog[open]')")
        await page.run(click("Edit"))
        await page.until("document.querySelector('dialog[open]') && !document.querySelector('dialog .loading')")
        await page.run("document.querySelector('dialog input[type=checkbox]').click()")
        await page.run(click("Save"))
        await page.until(f"!document.querySelector('dialog[open]') && {says('switched off')}")
    finally:
        receiver.close()


async def data(page, system):
    await page.until("document.getElementById('erase-point')")
    await page.run(click("Verify"))
    await page.until("document.querySelector('.card-head .badge')?.textContent === 'sound'")
    await page.until("document.querySelector('[data-upkeep=Verification]')")
    await page.run(fill("#erase-point", "1"))
    await page.run(click("Erase"))
    await page.until("document.querySelector('dialog[open]')")
    await page_checks.hold(page, "erase")
    await page.run(click("Erase", "document.querySelector('dialog')"))
    await page.until(says("1 point erased"))
    await back_up_remove_restore(page, system)


async def back_up_remove_restore(page, system):
    shed = str(system.post("/v1/buildings", b'{"name": "Shed", "floors": []}')["id"])
    await page.run("location.reload()")
    await page.until(f"document.querySelector('.building-choice select option[value=\"{shed}\"]')")
    await page.run(f"location.hash = '#/{shed}/data'")
    await page.until("document.querySelector('.building-choice select').selectedOptions[0]?.text === 'Shed' && document.getElementById('erase-point')")
    await page.keep_downloads(system.folder)
    await page.run(click("Backup"))
    backup = pathlib.Path(system.folder) / f"building-{shed}.sqlite"
    await page.until_here(lambda: backup.exists() and backup.read_bytes().startswith(b"SQLite format 3"))
    await page.until("document.querySelector('[data-upkeep=Backup]')")
    await page.run(click("Remove"))
    await page.until("document.querySelector('dialog[open]')")
    removing = "document.querySelector('dialog button.danger')"
    assert await page.run(f"{removing}.disabled"), "a building is not removed before its name was typed"
    await page.run(fill("dialog input", "Shed"))
    await page.until(f"!{removing}.disabled")
    await page.run(f"{removing}.click()")
    await page.until("location.hash.endsWith('/buildings') && document.querySelectorAll('[data-building]').length === 1")
    await page.choose_file("#backup-file", backup)
    await page.until(f"document.querySelector('[data-building=\"{shed}\"]')")


async def buildings(page, system):
    await page.until("document.querySelectorAll('[data-building]').length === 2")
    await page.run(click("New building"))
    await page.until("document.querySelector('#building-name')")
    await page_checks.hold(page, "new building")
    await page.run(fill("#building-name", "Annexe"))
    await page.run(click("Create building"))
    await page.until("location.hash.endsWith('/survey') && document.querySelector('.building-choice select').selectedOptions[0]?.text === 'Annexe'")
    await page.until(says("This floor is not surveyed"))


async def keys(page, system):
    await page.until("document.querySelectorAll('[data-key]').length === 1")
    await page.run(click("New key"))
    await page.until("document.querySelector('dialog[open] #key-name')")
    await page_checks.hold(page, "new key")
    await page.run(fill("#key-name", "Visitor app"))
    assert await page.run("document.getElementById('key-coarse').disabled"), "a key that observes nothing cannot see less"
    await page.run("document.querySelectorAll('dialog fieldset input')[2].click()")
    await page.until("!document.getElementById('key-coarse').disabled")
    await page.run("document.getElementById('key-coarse').click()")
    await page.run(click("Create key"))
    await page.until("document.getElementById('secret')")
    secret = await page.run("document.getElementById('secret').textContent")
    assert secret.startswith("wf_") and len(secret) == 46, secret
    await page.run(click("I have kept it"))
    await page.until("document.querySelectorAll('[data-key]').length === 2")
    assert not await page.run(f"document.documentElement.outerHTML.includes({json.dumps(secret)})"), "a key is shown once"
    assert await page.run(says("zones only"))
    await page.run("[...document.querySelectorAll('[data-key]')].find((r) => r.innerText.includes('Visitor app')).querySelector('button').click()")
    await page.until("document.querySelector('dialog[open]')")
    await page.run(click("Revoke", "document.querySelector('dialog')"))
    await page.until("document.querySelectorAll('[data-key]').length === 1")


async def audit(page, system):
    await page.until("document.querySelectorAll('tbody tr').length > 3")
    await page.until(says("first"))  # the key's name, not its number


# In the order an operator meets them; each is also looked at on every screen.
VIEWS = {"live": live, "sessions": sessions, "replay": replay, "zones": zones, "survey": survey, "maps": maps, "access-points": access_points, "plans": plans,
         "webhooks": webhooks, "data": data, "buildings": buildings, "keys": keys, "audit": audit}
