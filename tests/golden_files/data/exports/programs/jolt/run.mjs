// A springfit network in Jolt (npm install jolt-physics).
//
//   node run.mjs               two seconds of motion, then where the points are
//   node run.mjs 5             five seconds
//   node run.mjs --rest F      comes to rest and writes the positions to the file F, as JSON
//   import { softBody } from "./run.mjs"   the same body in a script of your own
//
// What was converted: a spring of constant k is an edge constraint of compliance 1/k with its rest length. A spring of constant K on the
// volume V of a tetrahedron is a volume constraint of compliance 36/K, because Jolt measures 6 V. A point that is held has no inverse
// mass. Jolt moves positions by XPBD in float32, with `iterations` substeps of a step of 1/60 s: fewer make the body softer.
import fs from "node:fs";
import { fileURLToPath } from "node:url";
import initJolt from "jolt-physics";

export const net = JSON.parse(fs.readFileSync(new URL("network.json", import.meta.url)));
const step = 1 / 60;
const iterations = 50;

/** The world and the body in it; `substeps` of each step and the rate in 1/s by which velocities are damped. */
export async function softBody(substeps = iterations, damping = 0) {
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
  physics.SetGravity(new Jolt.Vec3(...net.gravity));

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
  const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1), 0);
  creation.mNumIterations = substeps;
  creation.mLinearDamping = damping;
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

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const isRest = process.argv[2] === "--rest";
  const { world, positions } = await softBody(iterations, isRest ? 10 : 0);
  const seconds = isRest ? 20 : Number(process.argv[2] ?? 2);
  for (let i = 0; i < Math.round(seconds / step); i++) world.Step(step, 1);
  const found = positions();
  if (isRest) {
    fs.writeFileSync(process.argv[3], JSON.stringify(found));
  } else {
    const moved = found.map((x, p) => Math.hypot(...x.map((x, k) => x - net.points[p][k])));
    const largest = Math.max(...moved);
    console.log(`${moved.length} points, ${seconds} s: the largest displacement is ${largest.toPrecision(4)} m, at point ${moved.indexOf(largest)}`);
  }
}
