// The page: what is text first, then what the library draws.

function showSummary(record) {
  const { report } = record;
  const types = [...new Set(report.element_types)].join(", ");
  const given = report.settings.length ? `; with ${report.settings.join(", ")}` : "";
  byId("summary").textContent = `${report.nodes} points, ${report.elements} ${types}, ${report.extent.map((x) => short(x, 3)).join(" × ")} m; ${material(report)}, ${report.law ?? record.state}${given}`;
  const origin = [record.program, record.mesh, record.command].filter(Boolean);
  byId("origin").append(...origin.flatMap((text, i) => [i ? " · " : "", element(i === 2 ? "code" : "span", {}, text)]));
}

function material(report) {
  return report.young === null || report.poisson === null
    ? "materials that differ from cell to cell"
    : `E = ${withUnit(report.young, "Pa")}, ν = ${report.poisson}`;
}

// More notes are folded: the dearest come first.
const MOST_NOTES = 8;

function showNotes(record) {
  const { report, view, notes } = record;
  const section = byId("notes");
  const list = (lines) => element("ul", {}, ...lines.map((line) => element("li", {}, line)));
  const folded = (title, lines) => element("details", {}, element("summary", {}, `${title} (${lines.length})`), list(lines));
  const groups = [["More notes", notes.slice(MOST_NOTES)], ["Left out, because the scene does not ask for it", report.left_out], ["Not drawn", view.left_out]];
  const found = groups.filter(([, lines]) => lines.length).map(([title, lines]) => folded(title, lines));
  if (notes.length) found.unshift(list(notes.slice(0, MOST_NOTES)));
  section.append(...found);
  section.hidden = !found.length;
}

function missing(place, text) {
  place.replaceChildren(element("p", { class: "missing", role: "alert" }, text));
}

function preparePrint(controls) {
  const picture = byId("view-print");
  addEventListener("beforeprint", () => {
    document.querySelectorAll("details").forEach((group) => { group.open = true; });
    const scene = controls?.view.plot._fullLayout?.scene?._scene;
    if (scene?.toImage) picture.src = scene.toImage("png");
  });
}

async function start() {
  const record = readRecord();
  showSummary(record);
  showNotes(record);
  showTables(record);
  byId("theme").addEventListener("click", () => theme.toggle());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => theme.changed.forEach((act) => act()));
  try {
    await loadLibrary();
  } catch (error) {
    missing(byId("view"), `${error.message} The tables are below.`);
    return;
  }
  let controls = null;
  if (!hasWebGL()) missing(byId("view"), "This browser has no WebGL, so the body is not drawn. Figures and tables are below.");
  else {
    const body = new Body(record.view);
    const first = body.cases[0];
    const state = {
      network: 0, case: 0, time: first?.peak ?? 0, color: "constant", factor: first?.factor ?? 1, moving: false, fresh: true, picked: null,
      layers: { rest: body.cases.length > 0, fem: true, network: true, points: false, axes: true },
    };
    controls = new Controls(body, state);
    await controls.start();
    theme.changed.push(() => controls.view.draw());
  }
  showCharts(record);
  preparePrint(controls);
  document.documentElement.dataset.ready = "true";
}

start().catch((error) => {
  document.querySelector("main").prepend(element("p", { class: "missing", role: "alert" }, `The page could not be drawn: ${error.message}`));
  throw error;
});
