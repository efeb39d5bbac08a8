"""The playground in a browser, as a person has it: nothing is asked of any network but the page and its program, no
error on the console, messages at their lines; and what the page says of a law, its curves, its marks and its beam, are
those of the command, to the bit. Arguments: chromium, perilat, the source folder, the folder of the page; --all: all laws
and exercises, not some. Status 77: there is no page of this program (cmake --build build --target playground makes it)."""

import functools
import http.server
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from chromium import Browser  # noqa: E402

CHROMIUM, PERILAT, SOURCE, PAGE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
LARGEST = 2e6  # B: page and program


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *what):
        pass


def check(good, what):
    if not good:
        sys.exit("FAILED: " + what)
    print("ok:", what)


def perilat(folder, *arguments):
    done = subprocess.run([PERILAT, *arguments], cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout


def until(browser, expression, seconds):
    begun = time.time()
    while time.time() - begun < seconds:
        if browser.value(expression):
            return time.time() - begun
        time.sleep(0.1)
    sys.exit("FAILED: waited %d s for %s" % (seconds, expression))


def type_path(browser, text):
    browser.value("document.getElementById('path').value = %s" % json.dumps(text))


def type_law(browser, text):
    judged = int(browser.value("document.body.dataset.judged"))
    browser.value("{ const l = document.getElementById('law'); l.value = %s; l.dispatchEvent(new Event('input')); }"
                  % json.dumps(text))
    until(browser, "Number(document.body.dataset.judged) > %d" % judged, 60)


def texts(browser, selector):
    return browser.value("[...document.querySelectorAll(%s)].map(e => e.textContent)" % json.dumps(selector))


def in_page(browser, files, *line):
    """Exit status and what a command prints in the page."""
    for name, text in files.items():
        browser.value("write(%s, %s); 0" % (json.dumps(name), json.dumps(text)))
    answer = browser.value("JSON.stringify(command(%s))" % ", ".join(json.dumps(a) for a in line))
    answer = json.loads(answer)
    return answer["status"], answer["out"]


def try_messages(browser):
    law = "model answer\n  law central bond\n  parameter rho = 2323 [kg/m^3]\n%s\nend model\n"
    type_path(browser, "&path quantity = 'stretch' value = 1e-4 rise = 1 /\n"
                       "&expect quantity = 'peak N' formula = 'EA*1e-4' /\n"
                       "&expect quantity = 'peak N' value = '1 N' /\n")
    type_law(browser, law % "  constant EA = ?\n  force N = EA*strech")
    said = texts(browser, "#messages li")
    check(len(said) == 2 and "line 4" in said[0] and "still to be written [hole]" in said[0] and "line 5" in said[1] and
          "did you mean `stretch`?" in said[1], "messages name their lines: %s" % said)
    check(texts(browser, "#gutter .error") == ["4", "5"], "and stand at them")
    check(texts(browser, "#shown .wrong") == ["?", "strech"], "what is wrong is underlined")
    type_law(browser, law % "  constant EA = 3 [kN]\n  force N = EA*stretch")
    check(texts(browser, "#gutter .error") == [], "a mended law has no marks")
    check(browser.value("document.querySelectorAll('#equations math').length") >= 2, "its equations are shown")
    check(browser.value("[...new Uint8Array(document.getElementById('curve').getContext('2d')"
                        ".getImageData(0, 0, 640, 320).data)].some(v => v)"), "its curve is drawn")
    check(texts(browser, "#expectations .pass") == ["line 2: peak N = 0.3 N, expected 0.3 N"] and
          texts(browser, "#expectations .fail") == ["line 3: peak N = 0.3 N, expected 1 N"], "and what is expected is judged")


def some(paths):
    return sorted(paths)[:: 1 if "--all" in sys.argv else 6]


def try_same_bits(browser, folder):
    """Models: the document of `check`. Paths: the table of `drive`."""
    models, paths = some((SOURCE / "models").glob("*.plm")), some((SOURCE / "models/drives").glob("*.nml"))
    for model in models:
        shutil.copy(model, folder / "law.plm")
        line = ("check", "law.plm", "--diagnostics=json")
        here, there = perilat(folder, *line), in_page(browser, {"law.plm": model.read_text()}, *line)
        if here[0] != there[0] or here[1].rstrip("\n") != there[1].rstrip("\n"):
            sys.exit("FAILED: check of %s\n%s\n%s" % (model.name, here[1], there[1]))
    (folder / "law.plm").unlink()
    for path in paths:
        table = folder / "table.csv"
        table.unlink(missing_ok=True)
        perilat(folder, "drive", str(path), "--csv", "table.csv")
        in_page(browser, {path.name: path.read_text()}, "drive", path.name, "--csv", "table.csv")
        if table.read_text() != browser.value("read('table.csv')"):
            sys.exit("FAILED: the table of %s differs" % path.name)
        browser.value("forget('table.csv'); 0")
    check(True, "%d laws are judged as by the command, %d tables are the same to the bit" % (len(models), len(paths)))


def marks(text):
    """Of each item: points and words."""
    return [(i["title"], i["got"], i["words"], i["state"]) for i in json.loads(text)["answers"][0]["items"]]


def in_seconds(exercise):
    """Its runs, if it has any, are small."""
    return "--all" in sys.argv or exercise.name < "07" or "'run'" not in (exercise / "exercise.nml").read_text()


def try_course(browser):
    """Published exercises: a right answer and a wrong one, marked as by the command, runs and all."""
    solutions = sorted((SOURCE / "examples/course").glob("*/teacher/solution.plm"))
    solutions = [s for s in solutions if in_seconds(PAGE / "course" / s.parent.parent.name)]
    for solution in solutions:
        exercise = PAGE / "course" / solution.parent.parent.name
        wrong = sorted(solution.parent.glob("wrong/*.plm"))[:1]
        for answer in [solution, *wrong]:
            here = perilat(PAGE, "grade", str(exercise), str(answer), "--public", "--json")
            there = in_page(browser, {"law.plm": answer.read_text()}, "grade", "course/" + exercise.name, "law.plm",
                            "--public", "--json")
            if marks(here[1]) != marks(there[1]):
                sys.exit("FAILED: %s\n%s\n%s" % (answer, marks(here[1]), marks(there[1])))
    check(len(solutions) >= 8, "%d exercises are marked as by the command" % len(solutions))


def try_marking(browser):
    """As a student does it: the exercise is chosen, a law written, the button pressed; the page goes on meanwhile."""
    browser.value("{ const c = document.getElementById('choice');"
                  "c.selectedIndex = [...c.options].findIndex(o => o.text.includes('fracture energy'));"
                  "c.dispatchEvent(new Event('change')); }")
    folder = SOURCE / "examples/course/04_fracture_energy/teacher"
    type_law(browser, (folder / "solution.plm").read_text())
    browser.value("document.getElementById('mark').click()")
    check(texts(browser, "#marked")[0].startswith("being marked"), "the page goes on while runs are made")
    until(browser, "document.getElementById('marks').children.length > 0", 120)
    shown = texts(browser, "#marks .pass")
    check(any("costs 0.72 J: 5 of 5" in item for item in shown), "runs are judged in the page: %s" % shown)
    type_law(browser, "model answer")
    check(texts(browser, "#marks li") == [], "marks go when the law changes")


def try_beam(browser, folder):
    """With a step of its own: the automatic one hangs on the library that finds eigenvalues."""
    deck = (SOURCE / "generator/playground/page/beam.nml").read_text()
    deck = deck.replace("step_safety = 0.8", "step = '1.5 us'").replace("'6 ms'", "'1.5 ms'")
    law = (SOURCE / "models/mplm_bilinear.plm").read_text()
    (folder / "law.plm").write_text(law)
    (folder / "beam.nml").write_text(deck)
    status, _ = perilat(folder, "run", "beam.nml", "--interpret", "--no-physics", "--set", "output.result=beam.h5")
    check(status == 0, "the command runs the beam")
    _, loads = perilat(folder, "export", "beam.h5", "--history", "load")
    expected = [float(line.split(",")[1]) for line in loads.split("\n")[1:] if line]
    type_law(browser, law)
    browser.value("document.getElementById('deck').value = %s; document.getElementById('break').click()" % json.dumps(deck))
    seconds = until(browser, "document.body.dataset.beam === 'ended'", 240)
    found = browser.value("series(monitor('load'))")
    check(found == expected, "the beam's load is the same to the bit in %d samples (%.1f s)" % (len(found), seconds))
    damage = browser.value("Math.max(...doubles(number('beam_damage'), number('beam_count')))")
    check(damage > 0.3, "and it breaks: damage %.2f" % damage)


def main():
    page = PAGE / "playground.html"
    if not page.exists() or page.stat().st_mtime < pathlib.Path(PERILAT).stat().st_mtime:
        print("skipped: there is no page of this program; `cmake --build build --target playground` makes it, with emscripten")
        sys.exit(77)
    size = sum((PAGE / name).stat().st_size for name in ("playground.html", "playground.wasm"))
    check(size < LARGEST, "page and program: %d B" % size)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(PAGE)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = "http://127.0.0.1:%d/playground.html" % server.server_port
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as work:
        folder = pathlib.Path(work)
        browser = Browser(CHROMIUM, folder / "profile")
        begun = time.time()
        browser.open(address)
        until(browser, "document.body.dataset.judged", 120)
        print("the first curve is drawn after %.1f s" % (time.time() - begun))
        try_messages(browser)
        try_same_bits(browser, folder)
        try_course(browser)
        try_marking(browser)
        try_beam(browser, folder)
        asked = {url for url in browser.requests() if not url.startswith("blob:")}
        check(asked == {address, address.replace(".html", ".wasm")}, "nothing else is asked of a network: %s" % asked)
        check(browser.complaints() == [], "no complaint on the console: %s" % browser.complaints())
        if "--picture" in sys.argv:
            browser.picture(sys.argv[sys.argv.index("--picture") + 1])
        browser.close()


main()
