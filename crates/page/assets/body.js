// The body in a state: where its points are, and what its springs show. No drawing.

/** The slider goes to so many times the factor by which the largest displacement is a sixth of the body. */
const MOST_FACTOR = 1.5;

class Body {
  constructor(view) {
    this.view = view;
    this.count = view.points.length / 3;
    this.box = bounds(view.points);
    this.size = Math.max(...this.box.map(([a, b]) => b - a)) || 1;
    this.cases = view.loads.map((load, i) => ({ name: load.name, load: i }));
    if (view.motion) this.cases.push({ name: "motion", isMotion: true });
    for (const own of this.cases) {
      [own.largest, own.peak] = this.largest(own);
      own.factor = own.largest > 0 ? Math.max(1, Number((this.size / 6 / own.largest).toPrecision(2))) : 1;
      own.room = this.reach(own);
    }
  }

  /** The box around the body at rest and in a case as far as the slider goes; a network that flies away may leave it. */
  reach(own) {
    const found = this.box.map((range) => [...range]);
    const margin = 0.04 * this.size;
    const states = own?.isMotion ? this.view.motion.times.keys() : own ? [0] : [];
    for (const state of states) {
      for (const network of [null, ...this.view.networks.keys()]) {
        const u = this.displacement(own, network, state);
        if (!u || !(longest(u) <= 2 * own.largest)) continue;
        bounds(this.moved(u, MOST_FACTOR * own.factor)).forEach(([a, b], k) => { found[k] = [Math.min(found[k][0], a), Math.max(found[k][1], b)]; });
      }
    }
    return found.map(([a, b]) => [a - margin, b + margin]);
  }

  /** The displacements of a model, `null` for the finite elements, in a case and state; null where there are none. */
  displacement(own, network, state) {
    if (!own) return null;
    if (!own.isMotion) return network === null ? this.view.loads[own.load].displacement : this.view.networks[network].displacements[own.load] ?? null;
    return this.view.motion.models.find((model) => model.network === network)?.states[state] ?? null;
  }

  /** The largest displacement of the finite elements in a case, and the state that has it; of the first model where they do not move. */
  largest(own) {
    const states = own.isMotion ? this.view.motion.models[0].states : [this.view.loads[own.load].displacement];
    const found = states.map(longest);
    const most = found.filter(Number.isFinite).reduce((a, b) => Math.max(a, b), 0);
    return [most, Math.max(0, found.indexOf(most))];
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

/** The largest of the vectors. */
function longest(u) {
  let most = 0;
  for (let p = 0; p < u.length / 3; p++) most = Math.max(most, length(u, p));
  return most;
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

