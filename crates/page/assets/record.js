// The record of the run. Arrays are bytes in base64, little-endian.

function bytes(text) {
  const raw = atob(text);
  const found = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) found[i] = raw.charCodeAt(i);
  return found;
}

const floats = (text) => new Float32Array(bytes(text).buffer);
const places = (text) => new Uint32Array(bytes(text).buffer);

function readRecord() {
  const record = JSON.parse(byId("record").textContent);
  const view = record.view;
  view.points = floats(view.points);
  view.numbers = places(view.numbers);
  view.edges = places(view.edges);
  view.triangles = places(view.triangles);
  for (const load of view.loads) load.displacement = floats(load.displacement);
  for (const mesh of view.meshes) {
    mesh.ends = places(mesh.ends);
    mesh.numbers = places(mesh.numbers);
  }
  for (const network of view.networks) {
    network.constants = floats(network.constants);
    network.rests = floats(network.rests);
    network.displacements = network.displacements.map((values) => values === null ? null : floats(values));
  }
  for (const model of view.motion?.models ?? []) model.states = model.states.map(floats);
  return record;
}

