"""Proves pages of reports in a browser: python prove.py PAGE...

Each page is opened offline in headless Chromium. It must ask for nothing, report no error, draw the body, answer its controls,
and have what accessibility.js lists.
With --pictures FOLDER the views are kept as PNG files; with --frame SECONDS, turning a view must take at most so long for each frame.
"""

import argparse
import pathlib
import shutil
import sys
import time

from playwright.sync_api import sync_playwright

# A machine without a graphics card draws with its processor.
ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]

# How often the view is looked at before it counts as unchanged: a busy machine draws late.
LOOKS = 10

# How many pixels of the view differ from its most frequent one: of a blank view none.
PIXELS = """async () => {
  // By the clock of the page, which is late where the machine is busy, as what it draws is.
  await new Promise((done) => setTimeout(done, 300));
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const scene = document.getElementById('view')._fullLayout.scene._scene;
  const picture = new Image();
  picture.src = scene.toImage('png');
  return picture.decode().then(() => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [picture.width, picture.height];
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    const data = new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
    const counts = new Map();
    data.forEach((pixel) => counts.set(pixel, (counts.get(pixel) ?? 0) + 1));
    return { drawn: data.length - Math.max(...counts.values()), sum: data.reduce((a, b) => (31 * a + b) % 4294967291, 7) };
  });
}"""

# The mean time of a frame while the camera goes round, s.
FRAMES = """async () => {
  const view = document.getElementById('view');
  const scene = view._fullLayout.scene._scene;
  const count = 5;
  let start = 0;
  // The first frame prepares what the others use.
  for (let i = -1; i < count; i++) {
    if (i === 0) start = performance.now();
    const eye = { x: 1.8 * Math.cos(i / 5), y: 1.8 * Math.sin(i / 5), z: 0.8 };
    scene.setViewport({ camera: { eye, center: { x: 0, y: 0, z: 0 }, up: { x: 0, y: 0, z: 1 }, projection: { type: 'perspective' } }, aspectmode: 'manual', aspectratio: view._fullLayout.scene.aspectratio });
    scene.glplot.redraw();
    const gl = scene.glplot.gl;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
  return (performance.now() - start) / count / 1000;
}"""

# Points at the last end of each line, and draws; the error if it fails.
LAST_ENDS = """() => {
  const drawing = document.getElementById('view')._fullLayout.scene._scene.glplot;
  const lines = drawing.objects.filter((drawn) => drawn.arcLength);
  for (const line of lines) {
    const data = line.pick({ id: line.pickId, value: [127, 127, 127] });
    Object.assign(drawing.selection, { object: data && line, data, dataPosition: data?.position, dataCoordinate: data?.dataCoordinate });
    try {
      drawing.redraw();
    } catch (error) {
      drawing.selection.object = null;
      return error.message;
    }
  }
  drawing.selection.object = null;
  return lines.length ? "" : "no line is drawn";
}"""

# Controls without a name for readers of screens, and pictures without words.
UNNAMED = """() => [...document.querySelectorAll('button, select, input, [role], img, nav')].filter((e) => !e.closest('.plot, #view > *')).filter((e) =>
  !(e.labels?.length || e.getAttribute('aria-label') || e.getAttribute('alt') || e.textContent.trim() || e.getAttribute('role') === 'status')).map((e) => e.outerHTML.slice(0, 80))"""


ACCESSIBILITY = pathlib.Path(__file__).with_name("accessibility.js").read_text(encoding="utf-8")

RECORD = "JSON.parse(document.getElementById('record').textContent)"
# Charts and what a record has where they are drawn.
CHARTS = {
    "whole": f"{RECORD}.report.fits.some((fit) => fit.whole)",
    "rho": f"{RECORD}.report.fits.some((fit) => fit.whole?.curve.length > 1)",
    "l-curve": f"{RECORD}.report.fits.some((fit) => fit.whole?.curve.length > 1)",
    "descent": f"{RECORD}.report.fits.some((fit) => fit.whole?.curve.some((stage) => stage.objective?.length > 1))",
    "constants": f"{RECORD}.view.networks.some((network) => network.histograms.length > 0)",
}


class Prover:
    def __init__(self, browser, page, size, scheme):
        self.faults = []
        self.shown = None
        self.name = page.parent.name
        context = browser.new_context(viewport=size, color_scheme=scheme, offline=True)
        self.page = context.new_page()
        self.page.set_default_timeout(120_000)
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("console", lambda said: said.type == "error" and self.faults.append(f"console: {said.text}"))
        self.page.on("request", lambda asked: asked.url.startswith(("file:", "data:", "blob:")) or self.faults.append(f"asks for {asked.url}"))
        start = time.time()
        self.page.goto(page.resolve().as_uri())
        self.page.wait_for_function("document.documentElement.dataset.ready === 'true'", timeout=120_000)
        self.seconds = time.time() - start

    def check(self, holds, what):
        if not holds:
            self.faults.append(what)

    def look(self):
        """Keeps what the view shows, and returns how many pixels are drawn."""
        picture = self.page.evaluate(PIXELS)
        self.shown = picture["sum"]
        return picture["drawn"]

    def changes(self, what, act):
        """That the view shows another picture after the act than at the last look."""
        before = self.shown
        act()
        for _ in range(LOOKS):
            self.look()
            if self.shown != before:
                return
        self.faults.append(f"{what} changes nothing in the view")

    def drag(self):
        mouse = self.page.mouse
        box = self.page.locator("#view").bounding_box()
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        mouse.move(*middle)
        mouse.down()
        mouse.move(middle[0] + 15, middle[1] + 8)
        mouse.move(middle[0] + 30, middle[1] + 15)

    def accessible(self, scheme):
        """In both colours of the system: the page follows them without being loaded again."""
        for own in [scheme, "dark" if scheme == "light" else "light"]:
            self.page.emulate_media(color_scheme=own)
            self.page.wait_for_timeout(700)
            self.faults += [f"{own} colours: {fault}" for fault in self.page.evaluate(ACCESSIBILITY)]

    def controls(self):
        page = self.page
        # Nothing is asked of controls that the run has no use for.
        has = lambda selector: page.locator(selector).count() > 0 and page.locator(selector).is_visible()
        self.look()
        for select in ["#network", "#load", "#color"]:
            if has(select) and page.locator(f"{select} option").count() > 1:
                self.changes(select, lambda: page.select_option(select, index=1))
        if has("#deformation"):
            self.changes("the slider", lambda: page.locator("#deformation").fill("20"))
        if has("#layer-network"):
            self.changes("the layer of springs", lambda: page.locator("#layer-network").uncheck())
            self.changes("the layer of springs", lambda: page.locator("#layer-network").check())
        if has("#find-spring"):
            page.fill("#find-spring", "0")
            page.keyboard.press("Enter")
            page.wait_for_timeout(200)
            self.check("N/m" in page.inner_text("#picked") or "not among" in page.inner_text("#picked"), "a spring is not found")
        page.focus("#view")
        self.look()
        self.changes("an arrow key", lambda: page.keyboard.press("ArrowLeft"))
        self.changes("plus", lambda: page.keyboard.press("+"))
        page.click("#reset")
        motion = page.locator("#load option", has_text="motion")
        if motion.count():
            page.select_option("#load", label="motion")
            self.look()
            self.changes("play", lambda: page.click("#play"))
            page.click("#play")
        heading = page.locator("#tables table th.number button").first
        if heading.count():
            # What is not known is last either way.
            known = lambda: [text for text in page.locator("#tables table").first.locator("tbody tr").evaluate_all("(rows) => rows.map((row) => row.querySelector('td.number').textContent)") if text != "–"]
            heading.click()
            rising = known()
            heading.click()
            self.check(rising == known()[::-1], "a heading does not sort")
        was = page.evaluate("getComputedStyle(document.body).backgroundColor")
        page.click("#theme")
        self.check(was != page.evaluate("getComputedStyle(document.body).backgroundColor"), "the theme does not change")


def prove(browser, path, arguments):
    faults = []
    desktop, phone = ((1024, 720), "light"), ((390, 844), "dark")
    for size, scheme in [desktop] if path in arguments.desktop else [desktop, phone]:
        prover = Prover(browser, path, {"width": size[0], "height": size[1]}, scheme)
        page = prover.page
        if page.locator("#view canvas").count():
            drawn = prover.look()
            prover.check(drawn > 500, f"the view is blank: {drawn} pixels")
        else:
            prover.check(False, "the view has no canvas")
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        prover.check(wide <= 0, f"the page is {wide} pixels wider than the screen")
        prover.check(not page.evaluate(UNNAMED), f"controls without a name: {page.evaluate(UNNAMED)}")
        if arguments.pictures:
            folder = pathlib.Path(arguments.pictures)
            folder.mkdir(parents=True, exist_ok=True)
            page.screenshot(path=folder / f"{prover.name}-{scheme}.png", full_page=True)
        prover.accessible(scheme)
        for name, wanted in CHARTS.items():
            prover.check(page.locator(f"#chart-{name} .main-svg").count() > 0 or not page.evaluate(wanted), f"no chart {name}")
        fault = page.evaluate(LAST_ENDS)
        prover.check(not fault, f"pointing at the end of a line: {fault}")
        prover.look()
        prover.changes("dragging", prover.drag)
        if arguments.frame and scheme == "light":
            frame = page.evaluate(FRAMES)
            prover.check(frame <= arguments.frame, f"a frame takes {frame:.3f} s while the body is turned")
        page.mouse.up()
        # A processor draws a large body too slowly to try each control on it.
        if scheme == "light" and page.evaluate("document.getElementById('view').data.reduce((n, t) => n + t.x.length, 0)") < 100_000:
            prover.controls()
        print(f"{prover.name}, {size[0]} pixels, {scheme}: {path.stat().st_size / 1e6:.2f} MB, ready after {prover.seconds:.1f} s")
        faults += [f"{prover.name}, {scheme}: {fault}" for fault in prover.faults]
        page.context.close()
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pages", nargs="+", type=pathlib.Path)
    parser.add_argument("--pictures")
    parser.add_argument("--frame", type=float)
    parser.add_argument("--desktop", nargs="*", default=[], type=pathlib.Path, help="further pages, at the size of a desktop alone")
    arguments = parser.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        faults = [fault for path in arguments.pages + arguments.desktop for fault in prove(browser, path, arguments)]
        browser.close()
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
