"""A page of `perilat report` in a browser, as a person has it: no error on the console, nothing asked of any network,
the slider moves the frame and the dots on the curves, the pointer reads what `export` tells; without script all is
there. Arguments: chromium, perilat, the source folder."""

import csv
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from chromium import Browser  # noqa: E402

CHROMIUM, PERILAT, SOURCE = sys.argv[1:4]


def wrong(browser):
    """What went wrong in the page, and what it asked for."""
    asked = [url for url in browser.requests() if not url.startswith(("file:", "data:"))]
    return browser.complaints() + ["asked for " + url for url in asked]


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
    browser.open(page.as_uri())
    frames = browser.value("document.querySelector('input[type=range]').max")
    check(int(frames) >= 3, "there are frames to choose from")
    dot = "document.querySelector('svg.diagram .dot:not(.read)').getAttribute('cx')"
    check(browser.value("document.querySelector('.movie').dataset.frame") == frames and
          browser.value("document.querySelector('.main-curve').textContent.includes('The ring')"),
          "the last frame is seen first, and the ring on the curve is explained")
    check(browser.value("document.querySelector('.movie .when').textContent").startswith(
        "frame %s of %s, t = " % (frames, frames)), "which frame of how many is told")
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
    check(wrong(browser) == [], "no error and no request: %s" % wrong(browser))

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

    browser.open(page.as_uri(), script=False)
    check(wrong(browser) == [], "without script no error and no request")
    wide = browser.ask("Page.getLayoutMetrics")["cssContentSize"]["width"]
    check(wide <= 1200, "the page is no wider than the window")


def try_pair(browser, folder):
    browser.open((folder / "pair.html").as_uri())
    both = "[...document.querySelectorAll('.movie')].map((m) => m.dataset.frame).join()"
    move_slider(browser, 0)
    first = browser.value(both)
    move_slider(browser, 5)
    check(first == "0,0" and browser.value(both) == "5,5", "two results go together")
    check(wrong(browser) == [], "no error and no request: %s" % wrong(browser))


def main():
    with tempfile.TemporaryDirectory(prefix="perilat_browser_", ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        environment = dict(os.environ, PERILAT_MODELS=SOURCE + "/models")
        deck = SOURCE + "/examples/notched_beam/d3_s6.35.nml"
        subprocess.run([PERILAT, "run", deck, "--set", "output.result=beam.h5", "--set", "output.frames=12", "--set",
                        "simulation.end_time=6 ms"], cwd=folder, env=environment, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        subprocess.run([PERILAT, "report", "beam.h5", "-o", "page.html"], cwd=folder, check=True)
        subprocess.run([PERILAT, "report", "beam.h5", "beam.h5", "-o", "pair.html"], cwd=folder, check=True)
        browser = Browser(CHROMIUM, folder / "profile")
        try:
            try_page(browser, folder, "beam.h5")
            try_pair(browser, folder)
        finally:
            browser.process.kill()
            browser.process.wait()


main()
