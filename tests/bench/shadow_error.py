# Errors of the shadows of --lights against Cycles, beside those of a march over depth as engines have it. Runs within Blender.
# SPDX-License-Identifier: BSD-3-Clause
"""blender -b --python tests/bench/shadow_error.py -- FRAMES FOLDER PROGRAM [SCENE ...]

FRAMES is the folder of the rendered test scenes; FOLDER keeps truth and results, PROGRAM is alcove. Each scene has a hard
sun, a soft one, and a hard lamp above the floor. Truth is Cycles' Shadow pass at the pixels' centres; the distance to the
caster is a ray's. A row has the share of pixels, in percent, whose visibility errs by more than .25: of those that are lit,
and of those whose caster is within .5, .5 to 1, 1 to 4 and more radii. Pixels that face away from the light do not count.
"""
import json
import math
import os
import subprocess
import sys

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

sys.dont_write_bytecode = True
FRAMES, FOLDER, PROGRAM, *WANTED = sys.argv[sys.argv.index("--") + 1:]
sys.path[:0] = [os.path.join(FRAMES, "make"), os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support")]
import scenes  # noqa: E402
from exr import read_exr  # noqa: E402

# The way to the sun, and the pixel below the lamp, which hangs a radius above the surface.
SCENES = {"monkeys": ((-0.5, -0.6, 0.8), (600, 485)), "colonnade": ((0.75, -0.35, 0.75), (557, 475)), "foliage": ((-0.6, -0.2, 0.75), (480, 486)),
          "machine": ((-0.5, -0.5, 0.8), (480, 335)), "interior": ((0.35, 0.9, 0.55), (670, 486)), "street": ((0.5, -0.3, 0.8), (480, 486))}
LIGHTS = ("sun", "soft", "lamp")
SOFT, SOFT_SAMPLES = 5.0, 32    # degrees; rays per pixel
BANDS = (0, 0.5, 1, 4, np.inf)  # radii
WRONG = 0.25
THICKNESSES = (0.1, 0.3, 1.0)  # radii: of the march, which has the best of them
MARCH_REACH = 4.0              # radii
REPEATS = 3                    # of which the median counts


class View:
    """A frame's camera and surfaces, in the world."""

    def __init__(self, name):
        with open(f"{FRAMES}/{name}.camera.json", encoding="utf-8") as file:
            self.json = json.load(file)
        self.radius = self.json["ao_radii"]["R"]
        self.to_world = np.array(self.json["camera_to_world"])
        width, height = self.json["resolution"]
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        tangents = np.stack([(x - self.json["cx"]) / self.json["fx"], (self.json["cy"] - y) / self.json["fy"], -np.ones_like(x)], -1)
        self.ways = tangents @ self.to_world[:3, :3].T

    def places(self, depth):
        return self.to_world[:3, 3] + self.ways * np.minimum(depth, 1e6)[..., None]


def prepare(view):
    """Cycles, at the centre of each pixel; a tree of all triangles."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = view.json["resolution"]
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.light_sampling_threshold = 0  # else Cycles leaves dim light out by chance
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, scene.cycles.max_bounces = "BLACKMAN_HARRIS", 0.01, 0
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    layer.material_override = bpy.data.materials.new("plain")
    for name in [name for name in dir(layer) if name.startswith("use_pass_")]:
        setattr(layer, name, name in ("use_pass_z", "use_pass_normal", "use_pass_shadow"))
    settings = scene.render.image_settings
    settings.file_format, settings.exr_codec, settings.color_depth = "OPEN_EXR_MULTILAYER", "NONE", "32"
    vertices, faces = [], []
    for thing in [thing for thing in scene.objects if thing.type == "MESH"]:
        mesh, first = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh(), len(vertices)
        vertices += [thing.matrix_world @ vertex.co for vertex in mesh.vertices]
        mesh.calc_loop_triangles()  # as Cycles divides them
        faces += [[first + i for i in face.vertices] for face in mesh.loop_triangles]
    for light in [thing for thing in scene.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(light)
    return BVHTree.FromPolygons(vertices, faces)


def render(name, light, kind, size, path):
    """The part of a light that each pixel sees, and the depth and normal of all."""
    data = bpy.data.lights.new(name, kind)
    data.cycles.use_multiple_importance_sampling = False
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    if kind == "SUN":
        data.angle, thing.rotation_mode, thing.rotation_quaternion = math.radians(size), "QUATERNION", Vector(light).to_track_quat("Z", "Y")
    else:
        data.shadow_soft_size, thing.location = size, light
    bpy.context.scene.cycles.samples = SOFT_SAMPLES if size else 1
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    bpy.data.objects.remove(thing)
    planes = {key.split(".", 1)[1]: value for key, value in read_exr(path).items()}
    return planes["Shadow.R"], planes["Depth.Z"], np.stack([planes["Normal." + axis] for axis in "XYZ"], -1)


def caster_distance(tree, place, way, far, size):
    """To the first surface on the way to a light: on the way to its middle, else the nearest of some within its disc."""
    found = tree.ray_cast(place, way, far)[3]
    if found is None and size:
        x = way.orthogonal().normalized()
        y, spread = way.cross(x), math.tan(math.radians(size / 2))
        ways = [way + spread * math.sqrt((k + 0.5) / 24) * (math.cos(2.4 * k) * x + math.sin(2.4 * k) * y) for k in range(24)]
        found = min((hit for hit in (tree.ray_cast(place, one, far)[3] for one in ways) if hit is not None), default=None)
    return 1e30 if found is None else found


def truth(name, view):
    path = f"{FOLDER}/{name}.npz"
    if os.path.exists(path):
        return dict(np.load(path))
    scenes.build(name)
    tree, eye = prepare(view), Vector(view.to_world[:3, 3])
    sun, (x, y) = SCENES[name]
    at, normal = tree.ray_cast(eye, Vector(view.ways[y, x]))[:2]
    lamp = at + math.copysign(view.radius, -normal.dot(view.ways[y, x])) * normal
    result = {"lights": np.array([sun, sun, lamp]), "seen": [], "caster": [], "facing": []}
    geometric = None
    for light, kind, size in zip(result["lights"], ("SUN", "SUN", "POINT"), (0, SOFT, 0)):
        seen, depth, shading = render(name, light, kind, size, f"{FOLDER}/{name}.{len(result['seen'])}.exr")
        places, surface = view.places(depth), depth < 1e9
        if geometric is None:
            geometric = np.zeros_like(places)
            for i, j in zip(*np.nonzero(surface)):
                hit = tree.ray_cast(eye, Vector(view.ways[i, j]))[1]
                geometric[i, j] = (0, 0, 0) if hit is None else hit if hit.dot(view.ways[i, j]) < 0 else -hit
        ways = light - places if kind == "POINT" else np.broadcast_to(light, places.shape)
        far = np.linalg.norm(ways, axis=-1) if kind == "POINT" else np.full(depth.shape, 1e6)
        ways = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
        least = math.sin(math.radians(size / 2))  # so that all of the light is above the surface
        facing = surface & ((geometric * ways).sum(-1) > least) & ((shading * ways).sum(-1) > least)
        starts, caster = places + 1e-5 * depth[..., None] * geometric, np.full(depth.shape, 1e30)
        for i, j in zip(*np.nonzero(facing & (seen < 0.999))):
            caster[i, j] = caster_distance(tree, Vector(starts[i, j]), Vector(ways[i, j]), far[i, j], size)
        for key, value in (("seen", seen), ("caster", caster), ("facing", facing)):
            result[key].append(value)
        result.update(depth=depth, normal=shading)
    np.savez_compressed(path, **result)
    return {key: np.array(value) for key, value in result.items()}


def alcove(name, view, lights, wanted, *options):
    """The visibilities by the program, and its report."""
    listed = [{"name": light, "kind": "point" if light == "lamp" else "sun", "position" if light == "lamp" else "direction": list(lights[LIGHTS.index(light)]),
               **({"angular_diameter": SOFT} if light == "soft" else {})} for light in wanted]
    made, stats, path = f"{FOLDER}/{name}.exr", f"{FOLDER}/{name}.stats.json", f"{FOLDER}/{name}.lights.json"
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"lights": listed}, file)
    words = ["run", f"{FRAMES}/{name}.gbuffer.exr", "--camera", f"{FRAMES}/{name}.camera.json", "--radius", str(view.radius), "-o", made, "--lights", path]
    subprocess.run([PROGRAM, *words, "--aov", "ao,shadow", "--set", "compression=none", "--stats", stats, "-q", *options], check=True,
                   env=dict(os.environ, LP_NUM_THREADS="1"))
    planes = read_exr(made)
    with open(stats, encoding="utf-8") as file:
        return [planes[f"shadow-{light}.Y"].astype(np.float32) for light in wanted], json.load(file)["frames"][0]["passes"]


def peels_of(name):
    """Options for the second and the third surface of each pixel."""
    folder = FRAMES if os.path.exists(f"{FRAMES}/{name}.peel2.exr") else FOLDER
    if not os.path.exists(f"{folder}/{name}.peel2.exr"):
        subprocess.run([bpy.app.binary_path, "-b", "-P", f"{FRAMES}/make/render.py", "--", name, FOLDER, "peel:2", "peel:3"], check=True,
                       stdout=subprocess.DEVNULL)
    return ["--behind", f"{folder}/{name}.peel2.exr", "--behind", f"{folder}/{name}.peel3.exr"]


def cost(name, view, lights, light):
    """The time of a light's shadow by the time of all else, which is `standard`."""
    passes, costs = ("nearest", "shadow", "denoise"), []
    for _ in range(REPEATS):
        times = [(one["name"] in passes, one["ms"]) for one in alcove(name, view, lights, [light])[1]]
        costs.append(sum(ms for ours, ms in times if ours) / sum(ms for ours, ms in times if not ours))
    return sorted(costs)[REPEATS // 2]


def march(view, facts, number, steps):
    """Even steps over depth, which begin at a different place in each pixel, with surfaces of each thickness."""
    at, depth, camera, light = facts["facing"][number], facts["depth"], view.json, facts["lights"][number]
    places, to_view = view.places(depth)[at], np.array(camera["world_to_camera"])
    is_lamp = LIGHTS[number] == "lamp"
    ways = light - places if is_lamp else np.broadcast_to(light, places.shape)
    length = np.linalg.norm(ways, axis=-1, keepdims=True)
    step = ways / length * np.minimum(MARCH_REACH * view.radius, length if is_lamp else np.inf) / steps @ to_view[:3, :3].T
    start = (places + 2 * depth[at][:, None] / camera["fx"] * facts["normal"][at]) @ to_view[:3, :3].T + to_view[:3, 3]  # 2 px off
    y, x = np.nonzero(at)
    noise = 52.9829189 * (0.06711056 * x + 0.00583715 * y) % 1
    seen = np.ones((len(THICKNESSES), *depth.shape), np.float32)
    for k in range(steps):
        place = start + step * (k + noise)[:, None]
        z = np.maximum(-place[:, 2], 1e-9)
        column = np.floor(camera["cx"] + camera["fx"] * place[:, 0] / z).astype(int)
        row = np.floor(camera["cy"] - camera["fy"] * place[:, 1] / z).astype(int)
        inside = (column >= 0) & (row >= 0) & (column < depth.shape[1]) & (row < depth.shape[0])
        behind = np.where(inside, z - depth[np.where(inside, row, 0), np.where(inside, column, 0)], -1)
        for one, thickness in zip(seen, THICKNESSES):
            one[at] *= (behind <= 0) | (behind >= thickness * view.radius)
    return seen


def counts(view, facts, number, seen):
    """Wrong pixels and all, of those that are lit, of every band, and together."""
    at, wrong = facts["facing"][number], np.abs(seen - facts["seen"][number]) > WRONG
    lit, distance = facts["seen"][number] >= 0.999, facts["caster"][number] / view.radius
    parts = [lit] + [~lit & (distance >= least) & (distance < most) for least, most in zip(BANDS, BANDS[1:])] + [at]
    return np.array([(np.count_nonzero(at & part & wrong), np.count_nonzero(at & part)) for part in parts])


def row(*words, parts):
    print("|", " | ".join(words), "|", " | ".join(f"{100 * wrong / all:.1f}" if all else "-" for wrong, all in parts), "|", flush=True)


def main():
    print("| scene | light | by | lit | < .5 R | to 1 R | to 4 R | farther | all |\n|" + "---|" * 9)
    totals, costs = {}, []
    for name in WANTED or SCENES:
        view = View(name)
        facts = truth(name, view)
        results = {"one surface": alcove(name, view, facts["lights"], LIGHTS)[0],
                   "two peels": alcove(name, view, facts["lights"], LIGHTS, *peels_of(name))[0]}
        for number, light in enumerate(LIGHTS):
            tables = {by: counts(view, facts, number, seen[number]) for by, seen in results.items()}
            for steps in (16, 60) if light != "soft" else ():
                tried = [counts(view, facts, number, seen) for seen in march(view, facts, number, steps)]
                tables[f"{steps} steps"] = min(tried, key=lambda parts: parts[:4, 0].sum())  # within reach
            for by, parts in tables.items():
                row(name, light, by, parts=parts)
                for scene in (name, "all scenes") if light != "soft" else ():
                    totals[scene, by] = totals.get((scene, by), 0) + parts
        costs.append(f"| {name} | " + " | ".join(f"{cost(name, view, facts['lights'], light):.2f}" for light in LIGHTS) + " |")
    for (scene, by), parts in totals.items():
        row(scene, "both hard", by, parts=parts)
    print("| time by standard's | " + " | ".join(LIGHTS) + " |\n|" + "---|" * 4 + "\n" + "\n".join(costs))


main()
