"""A page of `perilat report` in a browser, as a person has it: no error on the console, nothing asked of any network,
the slider moves the frame and the dots on the curves, the pointer reads what `export` tells; without script all is
there. Arguments: chromium, perilat, the source folder. Speaks the protocol of Chrome's developer tools over pipes."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

CHROMIUM, PERILAT, SOURCE = sys.argv[1:4]


class Browser:
    def __init__(self, folder):
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()
        command = [
            "sh", "-c", 'exec "$@" 3<&%d 4>&%d' % (to_read, to_write), "sh", CHROMIUM, "--headless=new", "--no-sandbox",
            "--disable-gpu", "--remote-debugging-pipe", "--no-first-run", "--disable-background-networking",
            "--user-data-dir=%s" % folder, "about:blank",
        ]
        self.process = subprocess.Popen(command, pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.rest, self.number, self.events, self.session = b"", 0, [], None

    def receive(self):
        while b"\0" not in self.rest:
            part = os.read(self.back, 1 << 16)
            if not part:
                sys.exit("the browser has gone")
            self.rest += part
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    sys.exit("%s: %s" % (method, answer["error"]))
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, method):
        while True:
            for k, event in enumerate(self.events):
                if event.get("method") == method:
                    del self.events[k]
                    return
            self.events.append(self.receive())

    def open(self, path, script=True):
        self.session = None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.events = []
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(domain + ".enable")
        self.ask("Emulation.setDeviceMetricsOverride", width=1200, height=900, deviceScaleFactor=1, mobile=False)
        self.ask("Emulation.setScriptExecutionDisabled", value=not script)
        self.ask("Page.navigate", url=path.as_uri())
        self.wait_for("Page.loadEventFired")

    def value(self, expression):
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in answer:
            sys.exit("%s: %s" % (expression, answer["exceptionDetails"]))
        return answer["result"].get("value")

    def complaints(self):
        """What went wrong in the page, and what it asked for."""
        found = []
        for event in self.events:
            method, values = event.get("method", ""), event.get("params", {})
            if method in ("Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled"):
                found.append("%s: %s" % (method, json.dumps(values)[:400]))
            if method == "Network.requestWillBeSent":
                url = values["request"]["url"]
                if not url.startswith(("file:", "data:")):
                    found.append("asked for " + url)
        return found


def check(good, what):
    if not good:
        sys.exit("FAILED: " + what)
    print("ok:", what)


def move_slider(browser, frame):
    browser.value(
        "{ const s = document.querySelector('input[type=range]'); s.value = %d;"
        "  s.dispatchEvent(new Event('input')); }" % frame)


def picture_sum(browser):
    return browser.value("document.querySelector('.movie canvas').toDataURL().length + ':' + "
                         "document.querySelector('.movie canvas').toDataURL().slice(-4000)")


def try_page(browser, folder, result):
    page = folder / "page.html"
    browser.open(page)
    frames = browser.value("document.querySelector('input[type=range]').max")
    check(int(frames) >= 3, "there are frames to choose from")
    dot = "document.querySelector('svg.diagram .dot:not(.read)').getAttribute('cx')"
    seen = []
    for frame in (0, int(frames)):
        move_slider(browser, frame)
        seen.append((browser.value("document.querySelector('.movie').dataset.frame"), browser.value(dot),
                     picture_sum(browser)))
    check(seen[0][0] == "0" and seen[1][0] == frames, "the slider moves the frame")
    check(seen[0][1] != seen[1][1], "and the dot on the curve")
    check(seen[0][2] != seen[1][2], "and the picture")
    for field in range(int(browser.value("document.querySelector('.movie select').options.length"))):
        browser.value("{ const c = document.querySelector('.movie select'); c.selectedIndex = %d;"
                      "  c.dispatchEvent(new Event('change')); }" % field)
    check(browser.complaints() == [], "no error and no request: %s" % browser.complaints())

    table = list(csv.reader(subprocess.run([PERILAT, "export", result, "--history", "load"], cwd=folder,
                                           capture_output=True, text=True, check=True).stdout.splitlines()))
    times, loads = [float(row[0]) for row in table[1:]], [float(row[1]) for row in table[1:]]
    reading = browser.value(
        "{ const s = [...document.querySelectorAll('svg.diagram')].find((d) => d.dataset.over === '' &&"
        "    d.dataset.series.includes(':load;'));"
        "  const b = s.getBoundingClientRect();"
        "  s.dispatchEvent(new PointerEvent('pointermove', { clientX: b.left + 0.5 * b.width, clientY: b.top + 9 }));"
        "  s.closest('figure').querySelector('.reading').textContent + '|' + s.dataset.x + '|' + s.dataset.y }")
    words, x_axis, y_axis = reading.split("|")
    time, load = (float(part.split()[1]) for part in words.split(",  "))
    x_factor, y_factor = float(x_axis.split()[2]), float(y_axis.split()[2])
    nearest = min(range(len(times)), key=lambda k: abs(times[k] * x_factor - time))
    check("%.6g" % (loads[nearest] * y_factor) == "%.6g" % load, "the pointer reads what export tells: " + words)

    browser.open(page, script=False)
    check(browser.complaints() == [], "without script no error and no request")
    wide = browser.ask("Page.getLayoutMetrics")["cssContentSize"]["width"]
    check(wide <= 1200, "the page is no wider than the window")


def main():
    with tempfile.TemporaryDirectory(prefix="perilat_browser_") as name:
        folder = pathlib.Path(name)
        environment = dict(os.environ, PERILAT_MODELS=SOURCE + "/models")
        deck = SOURCE + "/examples/notched_beam/d3_s6.35.nml"
        subprocess.run([PERILAT, "run", deck, "--set", "output.result=beam.h5", "--set", "output.frames=12", "--set",
                        "simulation.end_time=6 ms"], cwd=folder, env=environment, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        subprocess.run([PERILAT, "report", "beam.h5", "-o", "page.html"], cwd=folder, check=True)
        browser = Browser(folder / "profile")
        try:
            try_page(browser, folder, "beam.h5")
        finally:
            browser.process.kill()
            browser.process.wait()


main()
