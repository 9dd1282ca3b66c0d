// Beware: 17 of 412 cells are inside out at rest under gravity and the load "shear".
// A springfit network in Jolt (npm install jolt-physics).
//
//   node run.mjs               two seconds of motion, then where the points are
//   node run.mjs 5             five seconds
//   node run.mjs --rest F      comes to rest and writes the positions to the file F, as JSON
//   node run.mjs --load N      any of these under the load N of the scene as well
//   --step S, --substeps N, --gravity "X Y Z"   in place of those in network.json
//   import { softBody } from "./run.mjs"   the same body in a script of your own
//
// What was converted: a spring of constant k is an edge constraint of compliance 1/k with its rest length. A spring of constant K on the
// volume V of a tetrahedron is a volume constraint of compliance 36/K, because Jolt measures 6 V. A point that is held has no inverse
// mass. Jolt moves positions by XPBD in float32, with the substeps of the setting in each of its steps: fewer make the body softer.
// Jolt calls them iterations. Its linear damping stays zero, because it would weaken gravity where the body rests.
import fs from "node:fs";
import { fileURLToPath } from "node:url";
import initJolt from "jolt-physics";

export const net = JSON.parse(fs.readFileSync(new URL("network.json", import.meta.url)));
export const setting = { ...net.setting };

/** The world and the body in it, with `substeps` of each step that the world is advanced by. */
export async function softBody(substeps = setting.substeps, gravity = net.gravity) {
  const Jolt = await initJolt();
  const settings = new Jolt.JoltSettings();
  const pairs = new Jolt.ObjectLayerPairFilterTable(1);
  const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
  const world = new Jolt.JoltInterface(settings);
  const physics = world.GetPhysicsSystem();
  physics.SetGravity(new Jolt.Vec3(...gravity));

  const shared = new Jolt.SoftBodySharedSettings();
  const held = new Set(net.held);
  for (const [p, x] of net.points.entries()) {
    const vertex = new Jolt.SoftBodySharedSettingsVertex();
    vertex.mPosition = new Jolt.Float3(...x);
    vertex.mInvMass = held.has(p) ? 0 : 1 / net.masses[p];
    shared.mVertices.push_back(vertex);
  }
  for (const [i, j, k, rest] of net.edges) {
    const edge = new Jolt.SoftBodySharedSettingsEdge(i, j, 1 / k);
    edge.mRestLength = rest;
    shared.mEdgeConstraints.push_back(edge);
  }
  for (const [corners, k, rest] of net.volumes) {
    const volume = new Jolt.SoftBodySharedSettingsVolume(...corners, 36 / k);
    volume.mSixRestVolume = 6 * rest;
    shared.mVolumeConstraints.push_back(volume);
  }
  for (const corners of net.surface) shared.AddFace(new Jolt.SoftBodySharedSettingsFace(...corners, 0));
  shared.Optimize();
  if (net.sweep && !isSweepOfFit(shared)) {
    console.error("Beware: this version of Jolt takes the constraints in another order than that of the fit; the body has another stiffness");
  }
  const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1), 0);
  creation.mNumIterations = substeps;
  creation.mLinearDamping = 0;
  creation.mUpdatePosition = false;
  creation.mMakeRotationIdentity = false;
  creation.mAllowSleeping = false;
  const body = physics.GetBodyInterface().CreateSoftBody(creation);
  physics.GetBodyInterface().AddBody(body.GetID(), Jolt.EActivation_Activate);
  const vertices = () => Jolt.castObject(body.GetMotionProperties(), Jolt.SoftBodyMotionProperties).GetVertices();
  const positions = () => {
    const origin = body.GetCenterOfMassPosition();
    const shift = [origin.GetX(), origin.GetY(), origin.GetZ()];
    return net.points.map((_, p) => {
      const x = vertices().at(p).mPosition;
      return [x.GetX() + shift[0], x.GetY() + shift[1], x.GetZ() + shift[2]];
    });
  };
  return { world, positions, vertices };
}

/** Whether each point has its constraints in the order of the fit. Where constraints share no point, their order changes nothing. */
function isSweepOfFit(shared) {
  const name = (points) => [...points].sort((a, b) => a - b).join(" ");
  const byPoint = (constraints) => {
    const lists = net.points.map(() => []);
    for (const points of constraints) for (const p of points) lists[p].push(name(points));
    return JSON.stringify(lists);
  };
  const found = (list, corners) => Array.from({ length: list.size() }, (_, i) => Array.from({ length: corners }, (_, c) => list.at(i).get_mVertex(c)));
  const edges = net.sweep.edges.map((i) => net.edges[i].slice(0, 2));
  const volumes = net.sweep.volumes.map((i) => net.volumes[i][0]);
  return byPoint(found(shared.mEdgeConstraints, 2)) === byPoint(edges) && byPoint(found(shared.mVolumeConstraints, 4)) === byPoint(volumes);
}

/** The body in motion, with `forces` on its points, [points][3] in N, or null. */
export async function motion(forces = null, gravity = net.gravity) {
  const { step, substeps } = setting;
  const body = await softBody(forces ? 1 : substeps, gravity);
  const vertices = body.vertices();
  const held = new Set(net.held);
  const free = net.points.map((_, p) => p).filter((p) => !held.has(p));
  const scaled = (p, factor, added) => {
    const v = vertices.at(p).mVelocity;
    v.Set(...[v.GetX(), v.GetY(), v.GetZ()].map((v, k) => factor * v + (added ? added[k] : 0)));
  };
  const kicks = forces && net.points.map((_, p) => forces[p].map((f) => (f * step) / substeps / net.masses[p]));
  const loaded = forces ? free.filter((p) => forces[p].some((f) => f !== 0)) : [];
  return {
    ...body,
    /** A step. Where there are forces, each substep is a step of its own, before which they enter the velocities as gravity does: without
     * contact both are the same motion. */
    advance() {
      if (!forces) return body.world.Step(step, 1);
      for (let n = 0; n < substeps; n++) {
        for (const p of loaded) scaled(p, 1, kicks[p]);
        body.world.Step(step / substeps, 1);
      }
    },
    damp(factor) {
      for (const p of free) scaled(p, factor);
    },
    /** Twice the kinetic energy, J. */
    energy() {
      const square = (v) => v.GetX() ** 2 + v.GetY() ** 2 + v.GetZ() ** 2;
      return free.reduce((sum, p) => sum + net.masses[p] * square(vertices.at(p).mVelocity), 0);
    },
  };
}

/** Advances until a body is at rest. The first maximum of the kinetic energy is after a quarter of the slowest motion; from then on all
 * velocities are multiplied so that this motion hardly swings, for 120 quarters. Ends with 1 where the kinetic energy is then above a
 * ten-thousandth of that maximum and above that of points which move by a few of their last digits in a substep. Returns the mean of the
 * positions in the last ten quarters: last digits make points swing by up to a hundredth of the displacements of a small body. */
function settle(body) {
  const mean = net.points.map(() => [0, 0, 0]);
  let highest = 0;
  let quarter = 0;
  let moving = 0;
  for (let count = 1; !quarter || count <= 120 * quarter; count++) {
    body.advance();
    moving = body.energy();
    if (!Number.isFinite(moving)) fail("the motion has diverged");
    if (!quarter && moving >= highest && moving > 0) {
      highest = moving;
      continue;
    }
    quarter ||= Math.max(count, 3);
    body.damp(Math.exp(-Math.PI / quarter));
    if (count > 110 * quarter) body.positions().forEach((x, p) => x.forEach((x, k) => (mean[p][k] += x / (10 * quarter))));
  }
  const digit = (4 * 2 ** -23 * setting.substeps) / setting.step;
  const least = net.points.reduce((sum, x, p) => sum + net.masses[p] * (digit * Math.hypot(...x)) ** 2, 0);
  if (moving > 1e-4 * highest + least) fail(`the body has not come to rest: its kinetic energy is still ${(moving / highest).toPrecision(2)} of the highest`);
  return mean;
}

function fail(words, code = 1) {
  console.error(words);
  process.exit(code);
}

/** The forces of the load of this name, [points][3] in N, or null. */
function forcesOf(name) {
  if (name === undefined) return null;
  const load = net.loads.find((load) => load.name === name);
  const names = net.loads.map((load) => `"${load.name}"`).join(" ") || "none";
  if (!load) fail(`--load: expected one of ${names}, found "${name}"`, 2);
  if (load.moves) fail('--load: expected a load of forces, found "one that moves points"; move them in a script of your own', 2);
  const forces = net.points.map(() => [0, 0, 0]);
  for (const [point, ...force] of load.forces) force.forEach((f, k) => (forces[point][k] += f));
  return forces;
}

/** The words after the options, by their names; seconds stand alone. */
function taken(words) {
  const given = {};
  for (let i = 0; i < words.length; i++) {
    const isOption = ["--rest", "--load", "--step", "--substeps", "--gravity"].includes(words[i]);
    if (!isOption && words[i].startsWith("--")) {
      fail(`${words[i]}: expected --rest, --load, --step, --substeps or --gravity; the first lines of run.mjs list them`, 2);
    }
    if (isOption && i + 1 === words.length) fail(`${words[i]}: expected a word after it, found none; the first lines of run.mjs list them`, 2);
    given[isOption ? words[i].slice(2) : "seconds"] = isOption ? words[++i] : words[i];
  }
  return given;
}

/** Puts the numbers that are asked for into the setting, and says where the constants were fitted for others. */
function changeSetting(given) {
  for (const [name, expected] of [["step", "a time in s"], ["substeps", "a whole number"]]) {
    if (given[name] === undefined) continue;
    const value = Number(given[name]);
    if (!(value > 0 && Number.isFinite(value)) || (name === "substeps" && !Number.isInteger(value))) {
      fail(`--${name}: expected ${expected} above zero, found "${given[name]}"; network.json has ${net.setting[name]}`, 2);
    }
    setting[name] = value;
  }
  const { step, substeps } = net.setting;
  if (net.fitted && (setting.step !== step || setting.substeps !== substeps)) {
    const seconds = (step) => `${Number(step.toPrecision(6))} s`;
    console.error(
      `Beware: the constants were fitted for ${substeps} substeps in ${seconds(step)}; with ${setting.substeps} in ${seconds(setting.step)} the body has another stiffness`,
    );
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const given = taken(process.argv.slice(2));
  changeSetting(given);
  const gravity = given.gravity === undefined ? net.gravity : given.gravity.split(/[ ,]+/).filter(Boolean).map(Number);
  if (gravity.length !== 3 || !gravity.every(Number.isFinite)) {
    fail(`--gravity: expected three numbers in m/s², such as "0 0 -9.81", found "${given.gravity}"`, 2);
  }
  const seconds = Number(given.seconds ?? 2);
  if (!(seconds > 0 && Number.isFinite(seconds))) fail(`SECONDS: expected a time above 0 s, found "${given.seconds}"; 2 s are usual`, 2);
  const body = await motion(forcesOf(given.load), gravity);
  if (!given.rest) for (let i = 0; i < Math.round(seconds / setting.step); i++) body.advance();
  const found = given.rest ? settle(body) : body.positions();
  if (!found.flat().every(Number.isFinite)) fail("the motion has diverged");
  if (given.rest) {
    fs.writeFileSync(given.rest, JSON.stringify(found));
  } else {
    const moved = found.map((x, p) => Math.hypot(...x.map((x, k) => x - net.points[p][k])));
    const largest = Math.max(...moved);
    console.log(`${moved.length} points, ${seconds} s: the largest displacement is ${largest.toPrecision(4)} m, at point ${moved.indexOf(largest)}`);
  }
}
