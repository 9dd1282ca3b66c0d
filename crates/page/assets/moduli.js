// Young's modulus by direction, from the stiffness in Kelvin's notation: 1/E(n) = (n ⊗ n) : S : (n ⊗ n).

/** The inverse by Gauss and Jordan; null of a singular matrix. */
function inverse(matrix) {
  const n = matrix.length;
  const rows = matrix.map((row, i) => [...row, ...row.map((_, j) => Number(i === j))]);
  const largest = Math.max(...matrix.flat().map(Math.abs));
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[pivot][k])) pivot = i;
    if (!(Math.abs(rows[pivot][k]) > 1e-9 * largest)) return null;
    [rows[k], rows[pivot]] = [rows[pivot], rows[k]];
    rows[k] = rows[k].map((value) => value / rows[k][k]);
    for (let i = 0; i < n; i++) if (i !== k) rows[i] = rows[i].map((value, j) => value - rows[i][k] * rows[k][j]);
  }
  return rows.map((row) => row.slice(n));
}

/** n ⊗ n in Kelvin's notation. */
function dyad(n) {
  const r = Math.SQRT2;
  return n.length === 3 ? [n[0] ** 2, n[1] ** 2, n[2] ** 2, r * n[0] * n[1], r * n[0] * n[2], r * n[1] * n[2]] : [n[0] ** 2, n[1] ** 2, r * n[0] * n[1]];
}

/** A function from unit vectors to moduli; null where the stiffness is not known or a strain has none. */
function directedModulus(stiffness) {
  if (stiffness.length < 3 || stiffness.flat().some((value) => value === null)) return null;
  const compliance = inverse(stiffness);
  if (!compliance) return null;
  return (n) => {
    const m = dyad(n);
    const value = m.reduce((sum, a, i) => sum + a * m.reduce((inner, b, j) => inner + compliance[i][j] * b, 0), 0);
    return value > 0 ? 1 / value : NaN;
  };
}

function addModuli(record) {
  const fits = record.report.fits.map((fit) => ({ name: fit.name, of: directedModulus(fit.as_material.stiffness), stiffness: fit.as_material.stiffness })).filter((fit) => fit.of);
  if (!fits.length) return;
  let chosen = fits[0];
  const isPlane = chosen.stiffness.length === 3;
  // In the plane the tensor is times the thickness: shown is the share of the mean, which has none.
  const draw = isPlane ? () => plane(chosen) : () => solid(chosen, record.report.young ?? chosen.of([0, 0, 1]));
  if (!isPlane && !hasWebGL()) return;
  const { select, field } = chooser("moduli-fit", "Network", fits.map((fit, i) => [i, cut(fit.name)]), (value) => { chosen = fits[value]; show(); });
  const title = isPlane ? "Young's modulus by direction, as a share of its largest" : "Young's modulus by direction: radius and colour";
  const show = addChart("moduli", title, draw, [field]);
  select.value = "0";
}

function plane(fit) {
  const angles = Array.from({ length: 181 }, (_, i) => 2 * i);
  const values = angles.map((angle) => fit.of([Math.cos(angle * Math.PI / 180), Math.sin(angle * Math.PI / 180)]));
  const largest = Math.max(...values);
  const circle = { type: "scatterpolar", mode: "lines", theta: angles, r: angles.map(() => 1), line: { color: theme.color("soft"), dash: "dot" }, name: "the same in all directions", hoverinfo: "skip" };
  const line = { type: "scatterpolar", mode: "lines", theta: angles, r: values.map((value) => value / largest), line: { color: HUES[0], width: 2.5 }, name: label(fit.name), hovertemplate: "%{theta}°: %{r:.3f}<extra></extra>" };
  const ink = theme.color("line");
  return { data: [circle, line], layout: { ...layout(), polar: { bgcolor: "rgba(0,0,0,0)", radialaxis: { range: [0, 1.05], gridcolor: ink, tickformat: ".1f" }, angularaxis: { gridcolor: ink, ticksuffix: "" } } } };
}

function solid(fit, young) {
  const [rows, columns] = [25, 49];
  const grid = (value) => Array.from({ length: rows }, (_, i) => Array.from({ length: columns }, (_, j) => value(Math.PI * i / (rows - 1), 2 * Math.PI * j / (columns - 1))));
  const [factor, prefix] = prefixFor(young);
  const n = (t, p) => [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
  const modulus = grid((t, p) => fit.of(n(t, p)) / factor);
  const at = (k) => modulus.map((row, i) => row.map((value, j) => value * n(Math.PI * i / (rows - 1), 2 * Math.PI * j / (columns - 1))[k]));
  const [low, largest] = [Math.min(...modulus.flat()), Math.max(...modulus.flat())];
  const axis = (title) => ({ title: { text: title }, range: [-1.1 * largest, 1.1 * largest], gridcolor: theme.color("line"), showspikes: false, nticks: 5, backgroundcolor: "rgba(0,0,0,0)" });
  const surface = { type: "surface", x: at(0), y: at(1), z: at(2), surfacecolor: modulus, colorscale: theme.ramp(), contours: { x: { highlight: false }, y: { highlight: false }, z: { highlight: false } }, cmin: Math.min(low, 0.98 * largest), cmax: largest, colorbar: { title: { text: `E, ${prefix}Pa` }, thickness: 12, len: 0.8, tickformat: ".4~g", nticks: 6 }, lighting: { ambient: 0.8, diffuse: 0.5, specular: 0.05 }, hovertemplate: "E = %{surfacecolor:.4g}<extra></extra>" };
  return { data: [surface], layout: { ...layout({ margin: { l: 0, r: 0, t: 0, b: 0 } }), scene: { xaxis: axis("x"), yaxis: axis("y"), zaxis: axis("z"), aspectmode: "cube", camera: { eye: { x: 1.4, y: -1.4, z: 0.9 } } } } };
}

