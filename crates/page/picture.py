"""A picture of a page: python picture.py PAGE OUT.jpg [--whole | --chart=NAME] [CONTROL=VALUE ...].

It is one of the view, of what the window shows, or of a figure, such as descent. Controls are such as load=1 color=error layer-points=true.
"""

import pathlib
import shutil
import sys

from playwright.sync_api import sync_playwright

from prove import ARGUMENTS


def main():
    page_file, out, *rest = sys.argv[1:]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        page = browser.new_context(viewport={"width": 1180, "height": 880}, device_scale_factor=1, offline=True).new_page()
        page.set_default_timeout(240_000)
        page.goto(pathlib.Path(page_file).resolve().as_uri())
        page.wait_for_function("document.documentElement.dataset.ready === 'true'")
        for given in (word for word in rest if not word.startswith("--")):
            name, value = given.split("=")
            control = page.locator(f"#{name}")
            kind = control.evaluate("(e) => e.type")
            if kind == "checkbox":
                control.set_checked(value == "true")
            elif kind.startswith("select"):
                control.select_option(value)
            else:
                control.fill(value)
            page.wait_for_timeout(1500)
        page.wait_for_timeout(1500)
        page.add_style_tag(content=".modebar { display: none !important }")
        if "--whole" in rest:
            page.screenshot(path=out, type="jpeg", quality=86)
        else:
            charts = [word.removeprefix("--chart=") for word in rest if word.startswith("--chart=")]
            page.locator(f"figure:has(#chart-{charts[0]})" if charts else ".stage").screenshot(path=out, type="jpeg", quality=86)
        browser.close()


if __name__ == "__main__":
    main()
