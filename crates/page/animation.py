"""An animation of a page's motion, the finite elements beside the springs: python animation.py PAGE OUT.webp [NETWORK] [--sheet FILE.png].

Needs Pillow as well. Every second state is a frame. A sheet has some of the frames beside each other.
"""

import argparse
import io
import pathlib
import shutil

from PIL import Image, ImageChops, ImageDraw, ImageFont
from playwright.sync_api import sync_playwright

from prove import ARGUMENTS

# Width of one half, margin and the place of the words, pixels; time of a frame, ms.
WIDTH, MARGIN, WORDS, FRAME = 400, 12, 34, 80


def shown(page, layer, every):
    """The states with this layer alone."""
    for name in ["fem", "network"]:
        page.locator(f"#layer-{name}").set_checked(name == layer)
    frames = []
    for state in range(0, int(page.locator("#time").get_attribute("max")) + 1, every):
        page.locator("#time").evaluate("(e, state) => { e.value = state; e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change')); }", state)
        page.wait_for_timeout(350)
        frames.append(Image.open(io.BytesIO(page.locator("#view").screenshot())).convert("RGB"))
    return frames


def box(frames):
    """What is drawn in any of the frames."""
    white = Image.new("RGB", frames[0].size, frames[0].getpixel((0, 0)))
    boxes = [ImageChops.difference(frame, white).convert("L").point(lambda v: 255 * (v > 12)).getbbox() for frame in frames]
    pick = lambda k, choose: choose(own[k] for own in boxes if own)
    return pick(0, min) - MARGIN, pick(1, min) - MARGIN, pick(2, max) + MARGIN, pick(3, max) + MARGIN


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("out")
    parser.add_argument("network", nargs="?", default="0")
    parser.add_argument("--sheet")
    arguments = parser.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        page = browser.new_context(viewport={"width": 1180, "height": 880}, offline=True).new_page()
        page.set_default_timeout(240_000)
        page.goto(arguments.page.resolve().as_uri())
        page.wait_for_function("document.documentElement.dataset.ready === 'true'")
        page.add_style_tag(content=".modebar, .infolayer { display: none !important }")
        page.select_option("#load", label="motion")
        page.select_option("#network", arguments.network)
        page.select_option("#color", "displacement")
        for name in ["rest", "axes"]:
            page.locator(f"#layer-{name}").set_checked(False)
        name = page.locator("#network option:checked").inner_text()
        halves = [shown(page, layer, 2) for layer in ["fem", "network"]]
        browser.close()
    crop = box(halves[0] + halves[1])
    height = round(WIDTH * (crop[3] - crop[1]) / (crop[2] - crop[0]))
    font = ImageFont.load_default(size=18)
    frames = []
    for pair in zip(*halves):
        frame = Image.new("RGB", (2 * WIDTH, height + WORDS), "white")
        draw = ImageDraw.Draw(frame)
        for place, (half, words) in enumerate(zip(pair, ["finite elements", f"springs: {name}"])):
            frame.paste(half.crop(crop).resize((WIDTH, height), Image.LANCZOS), (place * WIDTH, WORDS))
            draw.text((place * WIDTH + WIDTH / 2, WORDS / 2), words, font=font, fill="#1d2126", anchor="mm")
        frames.append(frame)
    frames[0].save(arguments.out, save_all=True, append_images=frames[1:], duration=FRAME, loop=0, quality=70, method=6)
    if arguments.sheet:
        some = frames[:: max(1, len(frames) // 6)]
        sheet = Image.new("RGB", (2 * WIDTH * 2, frames[0].height * ((len(some) + 1) // 2)), "white")
        for i, frame in enumerate(some):
            sheet.paste(frame, (i % 2 * 2 * WIDTH, i // 2 * frame.height))
        sheet.save(arguments.sheet)


if __name__ == "__main__":
    main()
