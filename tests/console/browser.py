"""A headless Chromium driven over its DevTools protocol: just what the console's test needs."""

import asyncio
import base64
import itertools
import json
import shutil
import subprocess
import tempfile
import urllib.request

import websockets

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--remote-debugging-port=0", "--hide-scrollbars"]


class Gone(Exception):
    """The page that was asked is no more: another one is being loaded."""


class Browser:
    """One page. Collects everything the page complains about in `complaints` and every URL it asks for in `requested`."""

    @classmethod
    async def open(cls, url, width=1280, height=800):
        self = cls()
        self.profile = tempfile.mkdtemp()
        self.socket = self.reader = None
        self.process = subprocess.Popen([shutil.which("chromium"), *FLAGS, f"--user-data-dir={self.profile}", "about:blank"],
                                        stderr=subprocess.PIPE, text=True)
        try:
            await self._begin(url, width, height)
        except BaseException:
            await self.close()
            raise
        return self

    async def _begin(self, url, width, height):
        port = None
        for line in self.process.stderr:
            if "DevTools listening on" in line:
                port = line.split(":")[-1].split("/")[0]
                break
        assert port, "Chromium did not start"
        pages = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/json"))
        target = next(page for page in pages if page["type"] == "page")
        self.socket = await websockets.connect(target["webSocketDebuggerUrl"], max_size=None)
        self.numbers = itertools.count(1)
        self.waiting = {}
        self.complaints, self.requested = [], []
        self.reader = asyncio.create_task(self._read())
        for domain in ("Page", "Runtime", "Log", "Network"):
            await self.call(f"{domain}.enable")
        await self.resize(width, height)
        await self.call("Page.navigate", url=url)
        await self.until("document.readyState === 'complete' && location.href !== 'about:blank'")

    async def _read(self):
        async for text in self.socket:
            message = json.loads(text)
            if "id" in message:
                self.waiting.pop(message["id"]).set_result(message)
                continue
            method, params = message.get("method"), message.get("params", {})
            if method == "Runtime.exceptionThrown":
                self.complaints.append(json.dumps(params["exceptionDetails"])[:500])
            elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
                self.complaints.append(params["entry"]["text"] + " " + params["entry"].get("url", ""))
            elif method == "Network.requestWillBeSent":
                self.requested.append(params["request"]["url"])

    async def call(self, method, **params):
        number = next(self.numbers)
        self.waiting[number] = asyncio.get_running_loop().create_future()
        await self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        answer = await asyncio.wait_for(self.waiting[number], 60)
        if "navigated" in str(answer.get("error")):
            raise Gone(method)
        assert "error" not in answer, f"{method}: {answer['error']}"
        return answer["result"]

    async def run(self, script):
        result = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    async def until(self, condition, seconds=60):
        """Waits for a condition to become true in the page; asserts that it does."""
        for _ in range(seconds * 5):
            try:
                if await self.run(f"Boolean({condition})"):
                    return
            except Gone:
                pass  # asked while the page was being loaded anew
            await asyncio.sleep(0.2)
        raise AssertionError(f"not within {seconds} s: {condition}")

    async def until_here(self, condition, seconds=60):
        """The same for a condition of ours."""
        for _ in range(seconds * 5):
            if condition():
                return
            await asyncio.sleep(0.2)
        raise AssertionError(f"not within {seconds} s")

    async def resize(self, width, height):
        await self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    async def prefer(self, scheme):
        await self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    async def press(self, key):
        code = {"Tab": 9, "Enter": 13, "Escape": 27, "+": 187, "-": 189, " ": 32, "End": 35, "Home": 36, "ArrowLeft": 37, "ArrowRight": 39}.get(key, 0)
        text = {"Enter": "\r"}.get(key, key if len(key) == 1 else "")
        for kind in ("keyDown" if text else "rawKeyDown", "keyUp"):
            await self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, text=text)

    async def click_at(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            await self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="none" if kind == "mouseMoved" else "left", clickCount=1)

    async def choose_file(self, selector, file):
        root = (await self.call("DOM.getDocument"))["root"]["nodeId"]
        node = (await self.call("DOM.querySelector", nodeId=root, selector=selector))["nodeId"]
        await self.call("DOM.setFileInputFiles", nodeId=node, files=[str(file)])

    async def keep_downloads(self, folder):
        await self.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))

    async def picture(self, file):
        shot = await self.call("Page.captureScreenshot", format="png")
        with open(file, "wb") as out:
            out.write(base64.b64decode(shot["data"]))

    async def close(self):
        if self.reader:
            self.reader.cancel()
            await self.socket.close()
        self.process.kill()
        self.process.wait()
        shutil.rmtree(self.profile, ignore_errors=True)
