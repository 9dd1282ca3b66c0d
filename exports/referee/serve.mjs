// A body in Jolt, for `springfit referee`: the requests and answers of serve.py.
//
// Jolt divides a step of 1/60 s into substeps. Here each substep is a step of its own, before which the load enters the velocities as
// gravity does, and after which they are damped: without contact both are the same motion.
import fs from "node:fs";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const answer = (words) => fs.writeSync(1, JSON.stringify(words) + "\n");
// What a program prints goes to standard error.
console.log = console.error;

let version;
try {
  await import("jolt-physics");
  version = JSON.parse(fs.readFileSync(new URL("../package.json", import.meta.resolve("jolt-physics")))).version;
} catch (error) {
  answer({ missing: String(error.message).split("\n")[0] });
  process.exit(0);
}
answer({ version });

let script, body, forces, step, factor;
for await (const line of createInterface({ input: process.stdin })) {
  const asked = JSON.parse(line);
  if (asked.open) {
    script = await import(pathToFileURL(`${asked.open.folder}/run.mjs`));
    step = 1 / 60 / parseInt(asked.open.solver);
    factor = Math.exp(-asked.open.damping * step);
    answer({ step });
  } else if (asked.load) {
    forces = asked.load;
    body = await script.softBody(1);
    answer({});
  } else {
    const vertices = body.vertices();
    const held = new Set(script.net.held);
    for (let n = 0; n < asked.advance; n++) {
      for (let p = 0; p < forces.length; p++) {
        if (held.has(p)) continue;
        const v = vertices.at(p).mVelocity;
        const kick = step / script.net.masses[p];
        v.Set(...[v.GetX(), v.GetY(), v.GetZ()].map((v, k) => v + forces[p][k] * kick));
      }
      body.world.Step(step, 1);
      for (let p = 0; p < forces.length; p++) {
        const v = vertices.at(p).mVelocity;
        v.Set(v.GetX() * factor, v.GetY() * factor, v.GetZ() * factor);
      }
    }
    const found = body.positions();
    answer({ positions: found.flat().every(Number.isFinite) ? found : null, warnings: [] });
  }
}
