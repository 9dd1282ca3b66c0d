// What the reader chooses in the view, and what is picked.

const COLORS = [["constant", "spring constant"], ["displacement", "displacement"], ["error", "error against finite elements"]];
const LAYERS = [["rest", "undeformed"], ["fem", "finite elements"], ["network", "springs"], ["points", "points"], ["axes", "axes"]];

class Controls {
  constructor(body, state) {
    Object.assign(this, { body, state, form: byId("controls") });
    this.view = new View(body, state, (picked) => this.pick(picked));
  }

  async start() {
    this.build();
    await this.view.start();
    byId("view").addEventListener("keydown", (event) => this.key(event));
    byId("view").addEventListener("pointerdown", () => this.turning(true), true);
    addEventListener("pointerup", () => this.turning(false));
    byId("view").addEventListener("wheel", () => this.turningForAWhile(), { capture: true, passive: true });
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.say();
  }

  build() {
    const { body, state } = this;
    const networks = body.view.networks;
    const network = chooser("network", "Network", networks.map((network, i) => [i, network.name]), (value) => { state.network = Number(value); state.picked = null; this.show(); });
    const load = chooser("load", "Load", body.cases.map((own, i) => [i, own.name]), (value) => this.choose(Number(value)));
    const color = chooser("color", "Springs coloured by", body.cases.length ? COLORS : COLORS.slice(0, 1), (value) => { state.color = value; this.show(); });
    const layers = LAYERS.filter(([name]) => (name !== "points" || body.count <= MOST_DOTS) && (name !== "network" || networks.length > 0)).map(([name, text]) => {
      const box = element("input", { type: "checkbox", id: `layer-${name}`, checked: state.layers[name], onchange: () => { state.layers[name] = box.checked; this.show(); } });
      return element("label", { for: `layer-${name}`, class: `layer ${name}` }, box, text);
    });
    this.slider = element("input", { type: "range", id: "deformation", min: 0, max: 150, value: 100, oninput: () => this.deform(), onchange: () => this.settle() });
    this.factor = element("output", { for: "deformation" });
    const deformation = element("label", { class: "field", for: "deformation" }, element("span", {}, "Deformation ", this.factor), this.slider);
    const motion = body.view.motion;
    this.time = element("input", { type: "range", id: "time", min: 0, max: Math.max(0, (motion?.times.length ?? 1) - 1), value: this.state.time, oninput: () => { this.stop(); this.state.fresh = false; this.seek(Number(this.time.value)); }, onchange: () => this.settle() });
    this.clock = element("output", { for: "time" });
    this.button = element("button", { type: "button", id: "play", onclick: () => this.play() }, "▶ Play");
    this.motion = element("div", { class: "motion" }, element("label", { class: "field", for: "time" }, element("span", {}, "Time ", this.clock), this.time), this.button);
    const number = (id, title, most, act) => {
      const input = element("input", { type: "number", id, min: 0, step: 1, inputmode: "numeric", onchange: () => { if (input.value !== "") act(Number(input.value)); } });
      return element("label", { class: "field small", for: id }, element("span", {}, title), input);
    };
    this.info = element("dl", { id: "picked", "aria-live": "polite" });
    const find = element("fieldset", {}, element("legend", {}, "Numbers"),
      element("div", { class: "pair" },
        networks.length > 0 ? number("find-spring", "Spring", 0, (value) => this.find("spring", value)) : null,
        number("find-point", "Point", 0, (value) => this.find("point", value))), this.info);
    const reset = element("button", { type: "button", id: "reset", onclick: () => this.view.reset() }, "Reset view");
    this.form.append(...[
      networks.length > 0 ? network.field : null,
      body.cases.length > 0 ? load.field : null,
      networks.length > 0 ? color.field : null,
      element("fieldset", { class: "layers" }, element("legend", {}, "Shown"), ...layers),
      body.cases.length > 0 ? deformation : null,
      motion ? this.motion : null,
      find, reset].filter(Boolean));
    this.mark();
    this.pick(null, false);
  }

  show() {
    this.mark();
    if (this.state.picked) this.pick(this.state.picked, false);
    return this.view.draw().then(() => this.say());
  }

  /** What the controls say of the state. */
  mark() {
    const { body, state } = this;
    const own = body.cases[state.case];
    this.factor.textContent = `× ${short(state.factor)}`;
    this.motion.hidden = !own?.isMotion;
    if (own?.isMotion) this.clock.textContent = withUnit(body.view.motion.times[state.time], "s");
  }

  /** What a reader of the picture must know. */
  say() {
    const { body, state, view } = this;
    const own = body.cases[state.case];
    const network = body.view.networks[state.network];
    const words = [];
    if (!network) words.push("The run has no network.");
    else if (own && body.displacement(own, state.network, state.time) === null) words.push(`${network.name} has no displacements ${own.isMotion ? "at this time" : "under this load"}: it is shown undeformed.`);
    if (network && !network.constants.length) words.push("No spring of this network joins two points.");
    if (network && view.drawn && view.drawn.length < network.constants.length ) words.push(`While it moves, ${view.drawn.length} of ${network.constants.length} springs are drawn.`);
    if (!own) words.push("The run has no load, so nothing is deformed.");
    byId("view-state").textContent = words.join(" ");
  }

  choose(place) {
    const { body, state } = this;
    this.stop();
    state.case = place;
    state.time = 0;
    this.time.value = 0;
    state.factor = body.cases[place].factor;
    this.slider.value = 100;
    state.fresh = true;
    if (body.cases[place].isMotion) this.seek(body.cases[place].peak); else this.show();
  }

  deform() {
    const own = this.body.cases[this.state.case];
    this.state.factor = own.factor * Number(this.slider.value) / 100;
    this.state.moving = true;
    this.show();
  }

  /** All springs again, after something moved. */
  settle() {
    this.state.moving = false;
    return this.show();
  }

  seek(place) {
    this.state.time = place;
    this.time.value = place;
    this.time.setAttribute("aria-valuetext", withUnit(this.body.view.motion.times[place], "s"));
    return this.show();
  }

  /** While the body is turned where drawing is slow, it has fewer springs. */
  turning(begins) {
    const { body, state, view } = this;
    const network = body.view.networks[state.network];
    if (!view.isSlow || this.playing || begins === state.moving || !(network?.constants.length > MOST_MOVING)) return;
    state.moving = begins;
    view.draw().then(() => this.say());
  }

  turningForAWhile() {
    this.turning(true);
    clearTimeout(this.pause);
    this.pause = setTimeout(() => this.turning(false), 400);
  }

  stop() {
    this.playing = false;
    this.button.textContent = "▶ Play";
  }

  /** Once through, from the start where the reader has not chosen a time; in ten seconds or as long as it takes; */
  async play() {
    if (this.playing) { this.stop(); return this.settle(); }
    const last = this.body.view.motion.times.length - 1;
    const start = this.state.time >= last || this.state.fresh ? 0 : this.state.time;
    this.state.fresh = false;
    const span = 10000 * (last - start) / Math.max(1, last);
    this.playing = this.state.moving = true;
    this.button.textContent = "❚❚ Pause";
    const began = performance.now();
    while (this.playing) {
      const place = Math.min(last, start + Math.floor((last - start) * (performance.now() - began) / span));
      await this.seek(place);
      if (place >= last) break;
      await new Promise(requestAnimationFrame);
    }
    this.stop();
    await this.settle();
  }

  find(kind, value) {
    const { body, state } = this;
    const network = body.view.networks[state.network];
    const place = kind === "spring" ? body.view.meshes[network?.mesh]?.numbers.indexOf(value) ?? -1 : body.view.numbers.indexOf(value);
    if (place < 0) {
      this.info.replaceChildren(element("dt", {}, kind), element("dd", {}, `${value} is not among those that are drawn`));
      return;
    }
    this.pick({ [kind]: place });
  }

  pick(picked, draws = true) {
    const { body, state } = this;
    state.picked = picked;
    const own = body.cases[state.case] ?? null;
    const network = body.view.networks[state.network];
    const rows = [];
    const vector = (values, p) => Array.from({ length: body.view.dimension }, (_, k) => short(values[3 * p + k], 4)).join(", ");
    if (picked === null) rows.push(["none", "click a spring or a point, or give its number"]);
    else if (picked.spring !== undefined) {
      const s = picked.spring;
      const mesh = body.view.meshes[network.mesh];
      const ends = [mesh.ends[2 * s], mesh.ends[2 * s + 1]];
      const value = (what) => body.values(what, state.network, own, state.time)[s];
      rows.push(["spring", mesh.numbers[s]], ["points", ends.map((p) => body.view.numbers[p]).join(", ")], ["k", withUnit(network.constants[s], "N/m", 4)], ["rest", withUnit(network.rests[s], "m", 4)]);
      if (own) rows.push(["|u|, mean", withUnit(value("displacement"), "m")], ["error", `${short(value("error"))} %`]);
    } else {
      const p = picked.point;
      const [u, v] = [body.displacement(own, state.network, state.time), body.displacement(own, null, state.time)];
      rows.push(["point", body.view.numbers[p]], ["at, m", vector(body.view.points, p)]);
      if (v) rows.push(["u finite elements, m", vector(v, p)]);
      if (u) rows.push(["u springs, m", vector(u, p)]);
      if (u && v) rows.push(["error", `${short(100 * distance(u, v, p) / own.largest)} %`]);
    }
    this.info.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
    if (draws) this.view.draw();
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = 0.12;
    const acts = {
      ArrowLeft: () => this.view.turn(-step, 0), ArrowRight: () => this.view.turn(step, 0), ArrowUp: () => this.view.turn(0, step), ArrowDown: () => this.view.turn(0, -step),
      "+": () => this.view.turn(0, 0, 1.15), "=": () => this.view.turn(0, 0, 1.15), "-": () => this.view.turn(0, 0, 1 / 1.15), 0: () => this.view.reset(),
      " ": () => this.body.cases[this.state.case]?.isMotion ? this.play() : null,
    };
    const act = acts[event.key];
    if (!act) return;
    event.preventDefault();
    if (event.key !== " ") this.turningForAWhile();
    act();
  }
}

