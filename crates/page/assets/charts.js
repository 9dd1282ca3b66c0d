// The figures of a run; each only where the run has its numbers.

function addHistogram(record) {
  const networks = record.view.networks.filter((network) => network.histograms.length);
  if (!networks.length) return;
  let network = networks[0];
  let kind = network.histograms[0].kind;
  const draw = () => {
    const h = network.histograms.find((h) => h.kind === kind) ?? network.histograms[0];
    const middles = h.counts.map((_, i) => h.first + (i + 0.5) * h.width);
    const bar = (name, color, keep, pattern) => ({
      type: "bar", name, x: middles.filter(keep), y: h.counts.filter((_, i) => keep(middles[i])), width: h.width,
      marker: { color, pattern: { shape: pattern, solidity: 0.25, bgcolor: color, fgcolor: theme.color("paper") }, line: { width: 0 } }, hovertemplate: `k ≈ %{x:.4g} ${h.unit}<br>%{y} springs<extra></extra>`,
    });
    const data = [bar("k ≥ 0", HUES[0], (k) => k >= 0, ""), bar("k < 0", HUES[1], (k) => k < 0, "/")].filter((bar) => bar.x.length);
    const beyond = h.outside[0] + h.outside[1];
    const more = beyond ? `; ${beyond} beyond the axis, from ${short(h.range[0])} to ${short(h.range[1])}` : "";
    return { data, layout: layout({ xaxis: { title: { text: `constant, ${h.unit}${more}` } }, yaxis: { title: { text: "springs" }, rangemode: "tozero" }, bargap: 0, barmode: "overlay", showlegend: data.length > 1 }) };
  };
  const kinds = chooser("histogram-kind", "Springs", [], (value) => { kind = value; show(); });
  const fill = () => kinds.select.replaceChildren(...network.histograms.map((h) => element("option", { value: h.kind }, h.kind)));
  const names = chooser("histogram-fit", "Network", networks.map((n, i) => [i, cut(n.name)]), (value) => {
    network = networks[value];
    fill();
    if (!network.histograms.some((h) => h.kind === kind)) kind = network.histograms[0].kind;
    kinds.select.value = kind;
    show();
  });
  fill();
  const show = addChart("constants", "Spring constants", draw, [element("div", { class: "tools" }, names.field, kinds.field)]);
}

/** Errors so many decades below the largest, as those of rounding, are drawn under the others. */
const DECADES = 4;

function addPrecision(record) {
  const fits = record.report.fits.filter((fit) => fit.loads.some((load) => load.e_rms !== null));
  if (!fits.length) return;
  const loads = fits[0].loads.map((load) => load.name);
  let chosen = 0;
  const draw = () => {
    const points = fits.map((fit) => ({ name: fit.name, time: 1e6 * fit.seconds_per_element, error: fit.loads[chosen]?.e_rms ?? null })).filter((p) => p.error !== null && p.time > 0);
    const largest = Math.max(...points.map((p) => p.error), 1e-9);
    const visible = points.map((p) => p.error).filter((error) => error >= largest * 10 ** -DECADES);
    const floor = Math.min(...visible, largest) / 3;
    const data = points.map((p, i) => {
      const below = p.error < largest * 10 ** -DECADES;
      return {
        type: "scatter", mode: below ? "markers+text" : "markers", name: label(cut(p.name)), x: [p.time], y: [Math.max(p.error, floor)], customdata: [[p.error, label(p.name)]],
        text: [`${short(p.error, 1)} %`], textposition: "middle right",
        marker: { size: 11, color: HUES[i % HUES.length], symbol: below ? "triangle-down-open" : MARKS[i % MARKS.length], line: { width: below ? 2 : 1, color: below ? HUES[i % HUES.length] : theme.color("paper") } },
        hovertemplate: "%{customdata[1]}<br>%{customdata[0]:.3g} % e_rms<br>%{x:.3g} µs/element<extra></extra>",
      };
    });
    const least = points.some((p) => p.error < largest * 10 ** -DECADES) ? floor : Math.min(...points.map((p) => p.error));
    const span = (values) => { const [a, b] = [Math.log10(Math.min(...values)), Math.log10(Math.max(...values))]; const room = Math.max(0.08 * (b - a), 0.2); return [a - room, b + room]; };
    return { data, layout: layout({
      xaxis: { type: "log", title: { text: "time to fit, µs per element" }, range: span(points.map((p) => p.time)), ...ticks(span(points.map((p) => p.time))) },
      yaxis: { type: "log", title: { text: `e_rms under ${label(loads[chosen])}, %` }, range: span([least, largest]), ...ticks(span([least, largest])) },
      hovermode: "closest",
    }) };
  };
  const load = chooser("precision-load", "Load", loads.map((name, i) => [i, cut(name)]), (value) => { chosen = Number(value); show(); });
  const note = element("p", { class: "hint" }, "An open triangle, with its number: the error is too small for the axis.");
  const show = addChart("precision", "Error against time to fit", draw, [load.field, note]);
}

// The ticks of a logarithmic axis between two powers of ten, with their whole numbers: at least two.
function ticks([from, to]) {
  const digits = to - from < 1 ? [1, 1.5, 2, 3, 4, 5, 7] : to - from < 2 ? [1, 2, 5] : [1];
  const values = [];
  for (let power = Math.floor(from); power <= to; power++) for (const digit of digits) values.push(digit * 10 ** power);
  const inside = values.filter((value) => Math.log10(value) >= from && Math.log10(value) <= to);
  return { tickvals: inside, ticktext: inside.map((value) => String(Number(value.toPrecision(2)))) };
}

function addWhole(record) {
  const fits = record.report.fits.filter((fit) => fit.whole);
  if (!fits.length) return;
  const rowsOf = (fit) => [
    ...fit.whole.relative_errors_fitted.map((load) => ({ ...load, name: cut(load.load, 26) })),
    ...fit.whole.relative_errors_validated.map((load) => ({ ...load, name: `${cut(load.load, 20)} (validation)` })),
  ];
  let chosen = fits[0];
  const draw = () => {
    const rows = rowsOf(chosen);
    // Rows have numbers: names that are cut may be alike.
    const places = rows.map((_, i) => i);
    const names = rows.map((row) => label(row.name));
    const dots = (name, key, color, symbol) => ({ type: "scatter", mode: "markers", name, y: places, text: names, x: rows.map((row) => row[key] === null ? null : 100 * row[key]), marker: { size: 10, color, symbol }, hovertemplate: "%{text}<br>%{x:.3g} %<extra></extra>" });
    const line = { type: "scatter", mode: "lines", y: places.flatMap((place) => [place, place, null]), x: rows.flatMap((row) => [100 * row.before, 100 * row.after, null]), line: { color: theme.color("soft") }, showlegend: false, hoverinfo: "skip" };
    return { data: [line, dots("before", "before", HUES[1], "circle-open"), dots("after", "after", HUES[0], "circle")], layout: layout({ xaxis: { type: "log", title: { text: "‖u − ū‖/‖ū‖, %" } }, yaxis: { autorange: "reversed", tickvals: places, ticktext: names } }) };
  };
  const { select, field } = chooser("whole-fit", "Network", fits.map((fit, i) => [i, cut(fit.name)]), (value) => { chosen = fits[value]; show(); });
  const show = addChart("whole", "Whole-object fits: relative error before and after", draw, [field]);
  select.value = "0";
}

/** The paths of regularizations of whole-object fits: errors against ρ, and the errors of the fitted loads against the change (L-curve). */
function addPaths(record) {
  const fits = record.report.fits.filter((fit) => fit.whole?.curve.filter((stage) => stage.validated !== null && stage.regularization > 0).length > 1);
  if (!fits.length) return;
  const path = (fit) => fit.whole.curve.filter((stage) => stage.validated !== null && stage.regularization > 0);
  const percent = (share) => share === null ? null : 100 * share;
  const lines = (x, y, hover, more = {}) => fits.map((fit, i) => {
    const stages = path(fit);
    const isChosen = (stage) => stage.regularization === fit.whole.regularization;
    const hue = HUES[i % HUES.length];
    return {
      type: "scatter", mode: "lines+markers", name: label(cut(fit.name)), x: stages.map(x), y: stages.map(y), customdata: stages.map((stage) => stage.regularization), line: { color: hue, dash: DASHES[i % DASHES.length], width: 2 },
      marker: { color: hue, symbol: stages.map((stage) => stage.rejected ? "x" : isChosen(stage) ? "star" : "circle"), size: stages.map((stage) => isChosen(stage) ? 14 : 6) },
      hovertemplate: hover, ...more,
    };
  });
  const axis = (text, more = {}) => ({ type: "log", title: { text }, ...more });
  const hint = () => element("p", { class: "hint" }, "Star: the ρ that was chosen, with the least error of validation. Cross: rejected, because the constants differ too much.");
  addChart("rho", "Whole-object fits: error of validation against the regularization ρ", () => ({
    data: lines((stage) => stage.regularization, (stage) => percent(stage.validated), "ρ = %{x:.1e}<br>%{y:.3g} %<extra></extra>"),
    layout: layout({ xaxis: axis("regularization ρ", { autorange: "reversed" }), yaxis: axis("error of validation, %"), hovermode: "closest" }),
  }), [hint()]);
  addChart("l-curve", "Whole-object fits: error of the fitted loads against the change of the constants", () => ({
    data: lines((stage) => stage.change, (stage) => percent(stage.trained), "ρ = %{customdata:.1e}<br>change %{x:.3g}<br>%{y:.3g} %<extra></extra>"),
    layout: layout({ xaxis: axis("change: rms of ln(factor) on the constants"), yaxis: axis("error of the fitted loads, %"), hovermode: "closest" }),
  }), [hint()]);
}

/** The objective of a whole-object fit after each step: a line for each ρ of the path, one after another. */
function addDescents(record) {
  const fits = record.report.fits.filter((fit) => fit.whole?.curve.some((stage) => stage.objective?.length > 1));
  if (!fits.length) return;
  let chosen = fits[0];
  const draw = () => {
    let step = 0;
    const data = chosen.whole.curve.filter((stage) => stage.objective.length).map((stage, i) => {
      const start = step;
      step += stage.objective.length - 1;
      const isChosen = stage.regularization === chosen.whole.regularization;
      const hue = HUES[i % HUES.length];
      const last = stage.objective.length - 1;
      return {
        type: "scatter", mode: "lines+markers", name: `ρ = ${label(short(stage.regularization))}${isChosen ? " (chosen)" : ""}`, x: stage.objective.map((_, k) => start + k), y: stage.objective,
        line: { color: hue, width: isChosen ? 3 : 1.5 }, marker: { color: hue, symbol: stage.objective.map((_, k) => isChosen && k === last ? "star" : "circle"), size: stage.objective.map((_, k) => isChosen && k === last ? 14 : 6) },
        hovertemplate: "step %{x}<br>%{y:.4g}<extra></extra>",
      };
    });
    return { data, layout: layout({ xaxis: { title: { text: "step of the path" }, rangemode: "tozero" }, yaxis: { type: "log", title: { text: "objective" } }, hovermode: "closest" }) };
  };
  const { field } = chooser("descent-fit", "Network", fits.map((fit, i) => [i, cut(fit.name)]), (value) => { chosen = fits[value]; show(); });
  const show = addChart("descent", "Whole-object fits: objective after each step", draw, [field, element("p", { class: "hint" }, "Each ρ starts from the end of the one before. Its objective is another one, so that the lines do not join.")]);
}

function addMotion(record) {
  const models = record.report.motion.filter((model) => model.time.length > 1);
  if (!models.length) return;
  const curve = (model, y, i, more = {}) => ({ type: "scatter", mode: "lines", name: label(model.name), x: model.time, y, line: { color: i === 0 ? theme.color("ink") : HUES[(i - 1) % HUES.length], dash: DASHES[i % DASHES.length], width: 2 }, ...more });
  const axes = (what) => layout({ xaxis: { title: { text: "time, s" } }, yaxis: { title: { text: what } }, hovermode: "x unified" });
  const compared = models.filter((model) => model.e_rms.some((error) => error !== null && error > 0));
  if (compared.length) addChart("motion-error", "Motion: distance from the finite elements", () => ({ data: compared.map((model, i) => curve(model, model.e_rms, i + 1)), layout: axes("e_rms, % of the largest displacement") }));
  if (models.some((model) => model.watched[0]?.length)) {
    const size = models[0].watched[0].length;
    const largest = Array.from({ length: size }, (_, k) => Math.max(...models.flatMap((model) => model.watched.map((u) => Math.abs(u[k] ?? 0)))));
    let axis = largest.indexOf(Math.max(...largest));
    const [factor, prefix] = prefixFor(largest[axis]);
    const pick = chooser("watched-axis", "Direction", Array.from({ length: size }, (_, k) => [k, "xyz"[k]]), (value) => { axis = Number(value); show(); });
    const show = addChart("watched", "Motion: mean displacement of the watched points", () => ({ data: models.map((model, i) => curve(model, model.watched.map((u) => u[axis] === null ? null : u[axis] / factor), i)), layout: axes(`u_${"xyz"[axis]}, ${prefix}m`) }), [pick.field]);
    pick.select.value = String(axis);
  }
  addChart("energy", "Motion: kinetic and elastic energy", () => {
    const largest = Math.max(...models.flatMap((model) => [...model.kinetic, ...model.elastic].map((value) => value ?? 0)));
    const [factor, prefix] = prefixFor(largest);
    const scaled = (values) => values.map((value) => value === null ? null : value / factor);
    return { data: models.map((model, i) => curve(model, scaled(model.kinetic.map((value, t) => value === null || model.elastic[t] === null ? null : value + model.elastic[t])), i)), layout: axes(`kinetic + elastic energy, ${prefix}J`) };
  });
}

function showCharts(record) {
  addPrecision(record);
  addHistogram(record);
  addModuli(record);
  addWhole(record);
  addPaths(record);
  addDescents(record);
  addMotion(record);
  if (!document.querySelector(".charts").children.length) document.querySelector(".charts").append(element("p", { class: "missing" }, "The run has no fits, so there is no figure."));
}

