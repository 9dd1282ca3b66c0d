// What checkers of accessibility ask of a page, as a list of faults: WCAG 2.2, criteria 1.3.1, 1.4.3, 2.4.2, 2.4.6, 2.5.8, 3.1.1 and 4.1.2.
() => {
  const faults = [];
  const fault = (holds, words) => { if (!holds) faults.push(words); };
  const all = (selector, from = document) => [...from.querySelectorAll(selector)];
  const isSeen = (e) => e.checkVisibility({ opacityProperty: true, visibilityProperty: true }) && e.getClientRects().length > 0;
  const words = (e) => `<${e.tagName.toLowerCase()}${e.id ? ` id=${e.id}` : ""}> ${JSON.stringify(e.textContent.trim().slice(0, 30))}`;

  fault(/^[a-z]{2}/.test(document.documentElement.lang), "the language of the page is not given");
  fault(document.title.trim(), "the page has no title");
  const levels = all("h1, h2, h3, h4, h5, h6").filter(isSeen).map((e) => Number(e.tagName[1]));
  fault(levels.filter((level) => level === 1).length === 1, `${levels.filter((level) => level === 1).length} headings of level 1`);
  fault(levels[0] === 1, "the first heading is not of level 1");
  levels.forEach((level, i) => fault(i === 0 || level <= levels[i - 1] + 1, `a heading of level ${level} follows one of level ${levels[i - 1]}`));
  fault(all("main").length === 1, "the page has not one main part");
  // The library gives each body in space the same id.
  const ids = all("[id]").filter((e) => !e.closest(".svg-container")).map((e) => e.id);
  fault(new Set(ids).size === ids.length, `two elements have one id: ${ids.filter((id, i) => ids.indexOf(id) !== i)}`);
  for (const name of ["aria-labelledby", "aria-describedby", "for"]) {
    all(`[${name}]`).forEach((e) => e.getAttribute(name).split(" ").forEach((id) => fault(document.getElementById(id), `${name} of ${words(e)} names ${id}, which is not there`)));
  }
  all("[role]").forEach((e) => fault(["application", "status", "alert", "region", "img", "group"].includes(e.getAttribute("role")), `role ${e.getAttribute("role")} is not known to the prover`));
  all("table").forEach((e) => fault(e.caption && all("thead th[scope]", e).length, `${words(e)} has no caption, or no headings`));
  all("img").filter(isSeen).forEach((e) => fault(e.alt, "a picture has no words"));

  // The colours of a canvas are those that are seen, whatever the notation.
  const pixel = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const color = (text) => {
    pixel.clearRect(0, 0, 1, 1);
    pixel.fillStyle = text;
    pixel.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = pixel.getImageData(0, 0, 1, 1).data;
    return { rgb: [r, g, b], alpha: a / 255 };
  };
  const over = (top, under) => top.rgb.map((c, i) => top.alpha * c + (1 - top.alpha) * under[i]);
  const paper = (e) => {
    if (!e) return [255, 255, 255];
    const own = color(getComputedStyle(e).backgroundColor);
    return own.alpha === 1 ? own.rgb : over(own, paper(e.parentElement));
  };
  const luminance = (rgb) => rgb.map((c) => c / 255).map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const contrast = (a, b) => {
    const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
  };
  const hasText = (e) => [...e.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
  let read = 0;
  for (const e of all("body *").filter((e) => (hasText(e) || e.matches("input[type=number], select")) && !e.matches("script, style, option") && isSeen(e))) {
    const style = getComputedStyle(e);
    const size = parseFloat(style.fontSize);
    const least = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
    const own = color(e.closest("svg") ? style.fill : style.color);
    own.alpha *= Number(style.opacity) * (e.closest("svg") ? Number(style.fillOpacity) : 1);
    const under = paper(e);
    const found = contrast(over(own, under), under);
    fault(found >= least, `contrast of ${words(e)}: ${found.toFixed(2)}, not ${least}`);
    read += 1;
  }
  fault(read > 20, `${read} texts were found`);

  // What is clicked; a label is clicked for its box.
  // The buttons of figures are seen once the pointer is there.
  const isClicked = (e) => e.matches(".modebar-btn") || (isSeen(e) && !e.matches(".skip"));
  for (const e of all("a[href], button, select, input, summary, .modebar-btn").filter(isClicked)) {
    const isBox = e.matches("[type=checkbox], [type=radio]");
    const { width, height } = (isBox && e.labels[0] || e).getBoundingClientRect();
    fault(Math.min(width, height) >= 24, `${words(e)} ${e.getAttribute("data-title") ?? ""} is ${width.toFixed(1)} by ${height.toFixed(1)} pixels, which a finger misses`);
  }
  return [...new Set(faults)];
}
