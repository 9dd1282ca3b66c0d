// The body in a state: where its points are, and what its springs show. No drawing.

class Body {
  constructor(view) {
    this.view = view;
    this.count = view.points.length / 3;
    this.box = bounds(view.points);
    this.size = Math.max(...this.box.map(([a, b]) => b - a)) || 1;
    this.cases = view.loads.map((load, i) => ({ name: load.name, load: i }));
    if (view.motion) this.cases.push({ name: "motion", isMotion: true });
    this.cases.forEach((own) => { own.largest = this.largest(own); });
  }

  /** The displacements of a model, `null` for the finite elements, in a case and state; null where there are none. */
  displacement(own, network, state) {
    if (!own) return null;
    if (!own.isMotion) return network === null ? this.view.loads[own.load].displacement : this.view.networks[network].displacements[own.load] ?? null;
    return this.view.motion.models.find((model) => model.network === network)?.states[state] ?? null;
  }

  /** The largest displacement of a case in all its states. */
  largest(own) {
    const reference = own.isMotion ? this.view.motion.models[0].states : [this.view.loads[own.load].displacement];
    return Math.max(0, ...reference.map((u) => { let most = 0; for (let p = 0; p < this.count; p++) most = Math.max(most, length(u, p)); return most; }));
  }

  /** The factor by which the largest displacement is drawn a sixth of the body; 1 where it is larger. */
  factor(own) {
    if (!own || !(own.largest > 0)) return 1;
    return Math.max(1, Number((this.size / 6 / own.largest).toPrecision(2)));
  }

  moved(u, factor) {
    const x = this.view.points;
    if (!u || factor === 0) return x;
    const found = new Float32Array(x.length);
    for (let i = 0; i < x.length; i++) found[i] = x[i] + factor * u[i];
    return found;
  }

  /** What each spring of a network shows: `constant`, `displacement` or `error`. */
  values(what, network, own, state) {
    const net = this.view.networks[network];
    if (what === "constant") return net.constants;
    const ends = this.view.meshes[net.mesh].ends;
    const u = this.displacement(own, network, state);
    const v = this.displacement(own, null, state);
    const found = new Float32Array(net.constants.length).fill(NaN);
    if (!u || (what === "error" && !v)) return found;
    const at = (p) => what === "displacement" ? length(u, p) : 100 * distance(u, v, p) / own.largest;
    for (let s = 0; s < found.length; s++) found[s] = (at(ends[2 * s]) + at(ends[2 * s + 1])) / 2;
    return found;
  }
}

function length(u, p) {
  return Math.hypot(u[3 * p], u[3 * p + 1], u[3 * p + 2]);
}

function distance(u, v, p) {
  return Math.hypot(u[3 * p] - v[3 * p], u[3 * p + 1] - v[3 * p + 1], u[3 * p + 2] - v[3 * p + 2]);
}

/** Least and largest coordinate along each axis. */
function bounds(x) {
  const found = [0, 1, 2].map(() => [Infinity, -Infinity]);
  for (let i = 0; i < x.length; i++) {
    const own = found[i % 3];
    if (x[i] < own[0]) own[0] = x[i];
    if (x[i] > own[1]) own[1] = x[i];
  }
  return found;
}

