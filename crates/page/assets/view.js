// The body in space, drawn by Plotly.

/** Springs that are drawn while something moves: more would take longer than a frame. */
const MOST_MOVING = 6000;
/** A frame that takes longer, s, is one of fewer springs while the reader turns the body. */
const SLOW = 0.1;
/** Points that are drawn as dots. */
const MOST_DOTS = 5000;

/** A view of fewer pixels across has its bar of colours below the body. */
const NARROW = 520;

class View {
  constructor(body, state, pick) {
    Object.assign(this, { body, state, pick, plot: byId("view") });
    this.home = body.view.dimension === 3 ? { eye: { x: 0.95, y: -1.45, z: 0.75 }, up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: -0.03 } } : { eye: { x: 0, y: 0, z: 1.8 }, up: { x: 0, y: 1, z: 0 }, center: { x: 0, y: 0, z: 0 } };
    // In a narrow place the body is farther away, or its sides would be cut off.
    const away = 1.12 * Math.min(2, Math.max(1, 1.15 * this.plot.clientHeight / this.plot.clientWidth));
    for (const axis of "xyz") this.home.eye[axis] *= away;
    this.home.projection = { type: body.view.dimension === 3 ? "perspective" : "orthographic" };
  }

  async start() {
    await Plotly.newPlot(this.plot, this.traces(), this.layout(), { displaylogo: false, responsive: true, scrollZoom: true, modeBarButtonsToRemove: ["hoverClosest3d", "resetCameraLastSave3d"], toImageButtonOptions: { filename: "springfit", scale: 2 } });
    this.mendPick();
    this.isSlow = this.frameTime() > SLOW;
    // The library reports a click with every picture that it draws while the button is held on a spring: one for each press counts, or
    // drawing would never end.
    this.plot.addEventListener("pointerdown", () => { this.isPressed = true; }, true);
    this.plot.on("plotly_click", ({ points: [point] }) => {
      if (!this.isPressed) return;
      this.isPressed = false;
      const name = point.data.meta;
      if (name === "network") this.pick({ spring: this.drawn[Math.floor(point.pointNumber / 3)] });
      else if (name === "points") this.pick({ point: point.pointNumber });
    });
  }

  /** Whether there is no room for the bar of colours beside the body, as on a telephone. */
  get isNarrow() {
    return this.plot.clientWidth < NARROW;
  }

  /** Where the bar of colours stands: beside the body or below it. */
  barPlace(text) {
    return this.isNarrow
      ? { orientation: "h", title: { text, side: "top" }, len: 0.9, x: 0.5, xanchor: "center", y: 0, yanchor: "bottom", ypad: 2 }
      : { title: { text, side: "right" }, len: 0.75, x: 1, xpad: 6 };
  }

  /** What draws in space; none where the browser cannot. */
  get drawing() {
    return this.plot._fullLayout.scene?._scene?.glplot;
  }

  /** The library gives the last end of a line no place, and fails to draw when the pointer is there: nothing is found there instead. */
  mendPick() {
    const line = this.isMended ? null : this.drawing?.objects.find((drawn) => drawn.arcLength);
    if (!line) return;
    const type = Object.getPrototypeOf(line);
    const { pick } = type;
    type.pick = function (pixel) {
      const hit = pick.call(this, pixel);
      return hit?.dataCoordinate ? hit : null;
    };
    this.isMended = true;
  }

  /** The time to draw once more, s; a card that draws lines without delay needs a few milliseconds. */
  frameTime() {
    const { drawing } = this;
    if (!drawing) return 0;
    const start = performance.now();
    drawing.redraw();
    drawing.gl.readPixels(0, 0, 1, 1, drawing.gl.RGBA, drawing.gl.UNSIGNED_BYTE, new Uint8Array(4));
    return (performance.now() - start) / 1000;
  }

  /** Which springs are drawn: fewer while something moves. */
  chosen(count) {
    const most = this.state.moving ? MOST_MOVING : count;
    return count <= most ? Array.from({ length: count }, (_, i) => i) : Array.from({ length: most }, (_, i) => Math.floor(i * count / most));
  }

  traces() {
    const { body, state } = this;
    const own = body.cases[state.case] ?? null;
    const fem = body.moved(body.displacement(own, null, state.time), state.factor);
    const hasFem = own !== null && body.displacement(own, null, state.time) !== null;
    const rest = body.view.points;
    // One point that is not seen: a scene without any trace is none.
    const shown = [{ type: "scatter3d", mode: "markers", x: [rest[0]], y: [rest[1]], z: [rest[2]], showlegend: false, hoverinfo: "skip", marker: { size: 0.01, opacity: 0 } }];
    // Edges cost as much as springs.
    const isLight = state.moving && this.isSlow;
    if (state.layers.rest && !isLight) shown.push(lines("rest", rest, body.view.edges, theme.color("rest"), 1.5));
    if (state.layers.fem && hasFem) {
      shown.push(surface(fem, body.view.triangles, theme.color("fem"), body.view.dimension === 3 ? 0.14 : 0.1));
      if (!isLight) shown.push(lines("fem", fem, body.view.edges, theme.color("fem"), 2));
    } else if (state.layers.fem && body.view.triangles.length) {
      shown.push(surface(rest, body.view.triangles, theme.color("rest"), 0.12));
    }
    if (body.view.networks.length) shown.push(...this.network(own));
    return shown;
  }

  network(own) {
    const { body, state } = this;
    const network = body.view.networks[state.network];
    const u = body.displacement(own, state.network, state.time);
    const isKnown = own === null || u !== null;
    this.positions = body.moved(u, state.factor);
    const ends = body.view.meshes[network.mesh].ends;
    const values = body.values(isKnown ? state.color : "constant", state.network, own, state.time);
    const scale = this.scale(values, own);
    this.drawn = this.chosen(network.constants.length);
    const found = [];
    if (state.layers.network) {
      const x = this.positions;
      const [xs, ys, zs, colors] = [[], [], [], []].map(() => new Array(3 * this.drawn.length));
      this.drawn.forEach((s, i) => {
        for (let k = 0; k < 2; k++) {
          const p = ends[2 * s + k];
          xs[3 * i + k] = x[3 * p]; ys[3 * i + k] = x[3 * p + 1]; zs[3 * i + k] = x[3 * p + 2];
        }
        xs[3 * i + 2] = ys[3 * i + 2] = zs[3 * i + 2] = null;
        colors.fill(values[s], 3 * i, 3 * i + 3);
      });
      found.push({
        type: "scatter3d", mode: "lines", meta: "network", x: xs, y: ys, z: zs, showlegend: false, hoverinfo: "none", connectgaps: false,
        line: { width: this.drawn.length > 20000 ? 1.5 : 3, color: colors, ...scale, colorbar: { ...this.barPlace(scale.title), thickness: 12, exponentformat: "power", tickfont: { color: theme.color("ink") } } },
      });
    }
    if (state.layers.points && body.count <= MOST_DOTS) {
      const axis = (k) => Array.from({ length: body.count }, (_, p) => this.positions[3 * p + k]);
      found.push({ type: "scatter3d", mode: "markers", meta: "points", x: axis(0), y: axis(1), z: axis(2), showlegend: false, hoverinfo: "none", marker: { size: 2.6, color: theme.color("ink") } });
    }
    const chosen = state.picked;
    if (chosen) {
      const points = chosen.spring === undefined ? [chosen.point] : [ends[2 * chosen.spring], ends[2 * chosen.spring + 1]];
      const axis = (k) => points.map((p) => this.positions[3 * p + k]);
      found.push({ type: "scatter3d", mode: "lines+markers", meta: "picked", x: axis(0), y: axis(1), z: axis(2), showlegend: false, hoverinfo: "skip", line: { width: 8, color: theme.color("accent") }, marker: { size: 6, color: theme.color("accent") } });
    }
    return found;
  }

  /** The range of the colours: of constants the middle 98 % of the values, even about zero where they have both signs. */
  scale(values, own) {
    const what = this.state.color;
    const sorted = Float32Array.from(values).filter(Number.isFinite).sort();
    let [low, high] = [quantile(sorted, 0.01), quantile(sorted, 0.99)];
    // That of displacements is the same in all states, so that a colour keeps its meaning while the body moves.
    if (what === "displacement") [low, high] = [0, own?.largest ?? 0];
    if (what === "error") [low, high] = [0, Math.max(quantile(sorted, 0.995), 1e-3)];
    const both = what === "constant" && sorted[0] < 0;
    if (both) high = Math.max(-low, high), low = -high;
    if (!(high > low)) [low, high] = Number.isFinite(low) ? [low - Math.abs(low || 1) / 2, low + Math.abs(low || 1) / 2] : [0, 1];
    const title = { constant: "k, N/m", displacement: "|u|, m", error: "|u − u_FE|, %" }[what];
    return { cmin: low, cmax: high, colorscale: both ? theme.balance() : theme.ramp(), title, showscale: true };
  }

  layout() {
    const { body, state } = this;
    // The box is fixed, so that nothing jumps while the body moves.
    const ranges = body.cases[state.case]?.room ?? body.reach(null);
    const longest = Math.max(...ranges.map(([a, b]) => b - a));
    const ratio = ranges.map(([a, b]) => (b - a) / longest);
    const size = body.view.dimension === 3 ? 1.2 : 1.6;
    const axis = (k) => ({ range: ranges[k], title: { text: `${"xyz"[k]}, m` }, visible: state.layers.axes && k < body.view.dimension, showbackground: false, gridcolor: theme.color("line"), zerolinecolor: theme.color("line"), showspikes: false, nticks: 5, tickangle: 0, tickformat: "~g", tickfont: { size: 10, color: theme.color("soft") } });
    return {
      ...layout({ margin: { l: 0, r: 0, t: 0, b: 0 } }),
      showlegend: false,
      uirevision: "view",
      scene: { domain: { y: [this.isNarrow ? 0.16 : 0, 1] }, xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: "manual", aspectratio: { x: size * ratio[0], y: size * ratio[1], z: size * ratio[2] }, camera: structuredClone(this.plot.layout?.scene?.camera ?? this.home), dragmode: body.view.dimension === 3 ? "orbit" : "pan", uirevision: "view" },
    };
  }

  /** Draws the state. Calls that come while it draws are one call afterwards. */
  async draw() {
    this.wanted = true;
    if (this.isDrawing) return this.isDrawing;
    // What drawing itself causes comes when isDrawing is set.
    this.isDrawing = Promise.resolve().then(async () => {
      while (this.wanted) {
        this.wanted = false;
        await Plotly.react(this.plot, this.traces(), this.layout(), this.plot._context);
        this.mendPick();
      }
    });
    await this.isDrawing;
    this.isDrawing = null;
  }

  camera() {
    return this.plot.layout.scene.camera ?? this.home;
  }

  /** Turns about the vertical and towards it, and divides the distance. */
  turn(across, up, closer = 1) {
    const camera = structuredClone(this.camera());
    const center = camera.center ?? { x: 0, y: 0, z: 0 };
    const [x, y, z] = ["x", "y", "z"].map((k) => (camera.eye[k] - center[k]) / closer);
    const flat = Math.hypot(x, y);
    const [around, high] = [Math.atan2(y, x) + across, Math.max(-1.55, Math.min(1.55, Math.atan2(z, flat) + up))];
    const r = Math.hypot(flat, z);
    camera.eye = { x: center.x + r * Math.cos(high) * Math.cos(around), y: center.y + r * Math.cos(high) * Math.sin(around), z: center.z + r * Math.sin(high) };
    if (this.body.view.dimension === 3) camera.up = { x: 0, y: 0, z: 1 };
    return Plotly.relayout(this.plot, { "scene.camera": camera });
  }

  reset() {
    return Plotly.relayout(this.plot, { "scene.camera": structuredClone(this.home) });
  }
}

function lines(name, x, ends, color, width) {
  const count = ends.length / 2;
  const axis = (k) => {
    const found = new Array(3 * count);
    for (let i = 0; i < count; i++) {
      found[3 * i] = x[3 * ends[2 * i] + k];
      found[3 * i + 1] = x[3 * ends[2 * i + 1] + k];
      found[3 * i + 2] = null;
    }
    return found;
  };
  return { type: "scatter3d", mode: "lines", meta: name, x: axis(0), y: axis(1), z: axis(2), showlegend: false, hoverinfo: "skip", line: { width, color } };
}

function surface(x, triangles, color, opacity) {
  const axis = (k) => Array.from({ length: x.length / 3 }, (_, p) => x[3 * p + k]);
  const corner = (k) => Array.from({ length: triangles.length / 3 }, (_, t) => triangles[3 * t + k]);
  return { type: "mesh3d", meta: "surface", x: axis(0), y: axis(1), z: axis(2), i: corner(0), j: corner(1), k: corner(2), color, opacity, flatshading: true, hoverinfo: "skip", showlegend: false, lighting: { ambient: 0.75, diffuse: 0.5, specular: 0.05 } };
}

