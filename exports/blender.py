"""A springfit network in Blender (pip install bpy numpy, or Blender itself).

    python run.py            one second of motion, written to network.blend
    python run.py 2          two seconds
    python run.py --load N   any of these under the load N of the scene as well
    python run.py --rest F   comes to rest and writes the positions to the file F
    blender --python run.py -- 2   the same in Blender, which stays open

What was converted: the object "springs" is a mesh with a vertex for each point and an edge for each spring. Attributes of its edges are
constant (N/m), rest (m) and damping (kg/s), those of its vertices mass (kg) and fixed. The object "surface" has the triangles of the
boundary over the same vertices. Blender's soft bodies have one stiffness for all edges, so that they do not take these attributes: this
script moves the network by symplectic Euler at half the longest stable step, with the springs on volumes, and both objects get the
motion as shape keys, one for each frame. Geometry nodes read the attributes by their names. Blender counts in 32 bits.
Cells that are inside out at the end are counted and printed; the program then ends with 1, as it does where the body does not come
to rest.
"""
import sys
from pathlib import Path

import bpy
import numpy as np
from settle import judge, keep_rest, seconds, settle, taken

folder = Path(__file__).parent
net = np.load(folder / "network.npz")
points, masses, springs, k, rest, damper = (net[name] for name in ["points", "masses", "springs", "k", "rest", "damper"])
volumes, k_volume, rest_volume = (net[name] for name in ["volumes", "k_volume", "rest_volume"])
step = 0.5 * float(net["dt_max"])  # s
free = np.isnan(net["held"])
rate = 24  # frames per second


def gathered(corners, forces):
    """The sum of the forces [springs, 3] on each point of `corners`."""
    return np.stack([np.bincount(corners, forces[:, axis], len(points)) for axis in range(3)], axis=1)


def force(x, v, applied=0.0):
    """The force on each point, N: `applied`, springs with dampers, springs on volumes, weight, and damping of the masses."""
    i, j = springs.T
    r = x[j] - x[i]
    length = np.maximum(np.linalg.norm(r, axis=1), 1e-300)
    along = np.sum(r * (v[j] - v[i]), axis=1) / length
    pull = ((k * (length - rest) + damper * along) / length)[:, None] * r
    total = applied + gathered(i, pull) - gathered(j, pull) + masses[:, None] * (net["gravity"] - float(net["damping"]) * v)
    if len(volumes):
        edges = (x[volumes[:, 1:]] - x[volumes[:, :1]]).transpose(0, 2, 1)
        volume = np.linalg.det(edges) / 6
        slopes = volume[:, None, None] * np.linalg.inv(edges)
        slopes = np.concatenate([-slopes.sum(1, keepdims=True), slopes], axis=1)
        pull = (k_volume * (volume - rest_volume))[:, None, None] * slopes
        for a in range(4):
            total -= gathered(volumes[:, a], pull[:, a])
    return total


def advance(x, v, applied=0.0):
    v = np.where(free, v + step * force(x, v, applied) / masses[:, None], 0.0)
    return x + step * v, v


def move(duration, applied=0.0):
    """The positions at each frame."""
    x, v = points, np.zeros_like(points)
    frames, count = [points], 0
    for frame in range(1, round(duration * rate) + 1):
        while count * step < frame / rate:
            x, v = advance(x, v, applied)
            count += 1
        if not np.all(np.isfinite(x)):
            sys.exit("the motion has diverged")
        frames.append(x)
    return frames


def come_to_rest(applied=0.0):
    """Positions at rest."""
    body = {"x": points, "v": np.zeros_like(points)}

    def step_on():
        body["x"], body["v"] = advance(**body, applied=applied)

    def damp(factor):
        body["v"] = body["v"] * factor

    settle(step_on, lambda: float(masses @ np.sum(body["v"] ** 2, axis=1)), damp, 120)
    return body["x"]


def objects():
    """The objects of the network, in a collection of their own."""
    collection = bpy.data.collections.new("springfit")
    bpy.context.scene.collection.children.link(collection)
    made = []
    for name, edges, faces in [("springs", springs.tolist(), []), ("surface", [], net["surface"].tolist())]:
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points.tolist(), edges, faces)
        of_points = [("mass", "FLOAT", masses), ("fixed", "BOOLEAN", ~free.any(axis=1))]
        of_edges = [("constant", "FLOAT", k), ("rest", "FLOAT", rest), ("damping", "FLOAT", damper)]
        for domain, attributes in [("POINT", of_points), ("EDGE", of_edges if edges else [])]:
            for attribute, kind, values in attributes:
                values = values.astype(np.float32 if kind == "FLOAT" else bool)
                mesh.attributes.new(attribute, kind, domain).data.foreach_set("value", values)
        made.append(bpy.data.objects.new(name, mesh))
        collection.objects.link(made[-1])
    return made


def keep(made, frames):
    """The positions of the frames as absolute shape keys: the key n is the shape at frame n + 1."""
    for body in made:
        for n, x in enumerate(frames):
            key = body.shape_key_add(name=f"frame {n + 1}", from_mix=False)
            key.interpolation = "KEY_LINEAR"
            key.data.foreach_set("co", x.astype(np.float32).ravel())
        keys = body.data.shape_keys
        keys.use_relative = False
        for n in range(len(frames)):
            keys.eval_time = keys.key_blocks[n].frame
            keys.keyframe_insert("eval_time", frame=n + 1)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = rate, 1, len(frames)


def shown(body, frame):
    """The positions that Blender shows at a frame."""
    bpy.context.scene.frame_set(frame)
    mesh = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    x = np.empty(points.size, dtype=np.float32)
    mesh.vertices.foreach_get("co", x)
    return x.reshape(points.shape).astype(float)


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    applied, given = taken(net, given)
    if bpy.app.background:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    is_rest = given[:1] == ["--rest"]
    frames = [points, come_to_rest(applied)] if is_rest else move(seconds(given, 1.0), applied)
    made = objects()
    keep(made, frames)
    x = shown(made[0], len(frames))
    if is_rest:
        keep_rest(net, x, given[1])
    moved = np.linalg.norm(x - points, axis=1)
    print(f"{len(points)} points, {len(frames)} frames: the largest displacement at the last is {moved.max():.4g} m, at point {moved.argmax()}")
    if bpy.app.background:
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "network.blend"), compress=True)
    judge(net, frames[-1])
