# Runs within Blender: uses the add-on as its operators, on a scene made here. blender_test.py starts it and looks at what is left.
# SPDX-License-Identifier: BSD-3-Clause
"""blender -b --factory-startup --python blender_scene.py -- ADDON PAGE FOLDER"""

import importlib.util
import json
import math
import os
import re
import subprocess
import sys

import bpy

sys.dont_write_bytecode = True  # beside the add-on
addon_path, page, folder = sys.argv[sys.argv.index("--") + 1:]
spec = importlib.util.spec_from_file_location("alcove", addon_path)
alcove = importlib.util.module_from_spec(spec)
sys.modules["alcove"] = alcove
spec.loader.exec_module(alcove)
alcove.register()
facts = {}


def make_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    scene.render.resolution_percentage = 50
    bpy.ops.mesh.primitive_plane_add(size=20)
    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1))
    bpy.ops.mesh.primitive_cube_add(location=(2, 1, 1), rotation=(0, 0, 0.4))
    bpy.ops.object.light_add(type="SUN", rotation=(0.5, 0.3, 0))
    rig = bpy.data.objects.new("Rig", None)
    rig.scale = (2, 2, 2)  # a parent's scale must not reach the camera's matrix
    rig.rotation_euler = (0, 0, 0.3)
    scene.collection.objects.link(rig)
    for name, place, lens in (("First", (0.8, -3.5, 1.5), 30), ("Second", (-2, -3, 2), 45)):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.parent = rig
        camera.location = place
        camera.data.lens = lens
        scene.collection.objects.link(camera)
        aim = camera.constraints.new("TRACK_TO")
        aim.target = bpy.data.objects["Suzanne"]
        aim.track_axis, aim.up_axis = "TRACK_NEGATIVE_Z", "UP_Y"
    first, second = bpy.data.objects["First"], bpy.data.objects["Second"]
    first.data.shift_x, first.data.shift_y = 0.12, -0.07
    second.data.sensor_fit = "VERTICAL"
    scene.camera = first
    for frame, camera in ((1, first), (4, second)):
        scene.timeline_markers.new(camera.name, frame=frame).camera = camera
    first.keyframe_insert("location", frame=1)
    first.location = (1.6, -3.2, 1.7)
    first.keyframe_insert("location", frame=3)
    scene.frame_start, scene.frame_end = 1, 5
    scene.alcove.folder = folder
    scene.alcove.radius = 0.5
    return scene


def boxes_of(tree):
    """Corner and size of all nodes but frames."""
    return {node.name: (*alcove.place_of(node), node.width, alcove.height_of(node)) for node in tree.nodes
            if node.bl_idname != "NodeFrame"}


def on_top(tree):
    """The pairs of nodes that cover each other."""
    boxes = sorted(boxes_of(tree).items())
    return [(one, other) for i, (one, (x, y, w, h)) in enumerate(boxes) for other, (u, v, s, t) in boxes[:i]
            if x < u + s and u < x + w and y - h < v and v - t < y]


def nodes_of(scene):
    return [node for node in scene.node_tree.nodes if node.label == alcove.NODE_LABEL]


scene = make_scene()
scene.frame_set(2)
areas = [area for window in bpy.context.window_manager.windows for area in window.screen.areas]
if areas:
    areas[0].type = "IMAGE_EDITOR"
facts["has an editor"] = bool(areas)
facts["proposed radius"] = alcove.proposed_radius(scene, bpy.context.evaluated_depsgraph_get())
facts["shown radius"] = alcove.Proposal.of(bpy.context)
before = (scene.render.filepath, scene.render.image_settings.file_format)
facts["still"] = sorted(bpy.ops.alcove.compute(animation=False))
facts["output is the user's"] = before == (scene.render.filepath, scene.render.image_settings.file_format)
facts["image of the still"] = [(node.image.filepath, node.image.source, node.image.has_data or node.image.size[0] > 0)
                               for node in nodes_of(scene)]
facts["wired"] = [link.from_node.bl_idname for link in scene.node_tree.links
                  if link.to_node.bl_idname == "CompositorNodeComposite"]
facts["on top of each other"] = on_top(scene.node_tree)
facts["in the frame"] = sorted(node.bl_idname for node in scene.node_tree.nodes if node.parent and node.parent.label == alcove.FRAME_LABEL)
facts["shown"] = [area.spaces.active.image.filepath for area in areas[:1] if area.spaces.active.image]
facts["active"] = scene.node_tree.nodes.active.label
facts["handlers"] = len(bpy.app.handlers.frame_change_post)

facts["animation"] = sorted(bpy.ops.alcove.compute(animation=True))
os.replace(os.path.join(folder, "cameras.json"), os.path.join(folder, "animation.json"))
facts["images of the animation"] = [(node.image.source, node.frame_start, node.frame_duration) for node in nodes_of(scene)]
scene.alcove.output = "COMPOSITE"
scene.frame_set(5)
links = len(scene.node_tree.links)
facts["composite"] = sorted(bpy.ops.alcove.compute(animation=False))
facts["the compositor that was there stays"] = links == len(scene.node_tree.links) and len(nodes_of(scene)) == 1
bpy.ops.alcove.write_cameras(filepath=os.path.join(folder, "written.json"))
facts["frame stays"] = scene.frame_current

# A shot that is rendered by hand, with the passes and settings that docs/getting-started.md names.
scene.cycles.samples = 16
for name in ("use_pass_z", "use_pass_normal", "use_pass_position", "use_pass_vector"):
    setattr(scene.view_layers[0], name, True)
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
scene.render.filepath, scene.render.use_compositing = os.path.join(folder, "by hand", "shot.####"), False
bpy.ops.render.render(animation=True)

# A sky lights the result through a group of nodes.
sky = bpy.data.images.new("sky", 64, 32, float_buffer=True)
sky.pixels = [value for y in range(32) for x in range(64) for value in (0.2 + y / 32, 0.5, 1 - x / 64, 1)]
sky.filepath_raw, sky.file_format = os.path.join(folder, "sky.exr"), "OPEN_EXR"
sky.save()
scene.alcove.output, scene.alcove.sky = "AO", sky.filepath_raw
scene.frame_set(3)
facts["relit"] = sorted(bpy.ops.alcove.compute(animation=False))
group = next(node for node in scene.node_tree.nodes if node.label == alcove.RELIGHT)
for link in [link for link in scene.node_tree.links if link.to_node.bl_idname == "CompositorNodeComposite"]:
    scene.node_tree.links.remove(link)
scene.node_tree.links.new(group.outputs[0], next(
    node for node in scene.node_tree.nodes if node.bl_idname == "CompositorNodeComposite").inputs["Image"])
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
scene.render.filepath, scene.render.use_compositing = os.path.join(folder, "relit.exr"), True
bpy.ops.render.render(write_still=True)
scene.alcove.sky = ""

# A sun that was added, by the lines of docs/outputs.md.
with open(os.path.join(folder, "lights.json"), "w", encoding="utf-8") as file:
    json.dump({"lights": [{"name": "key", "kind": "sun", "direction": [0.5, -0.3, 0.8]}]}, file)
shadows = os.path.join(folder, "shadows.exr")
subprocess.run([os.environ["ALCOVE"], "run", os.path.join(folder, "frame.0003.exr"), "-o", shadows, "--camera", os.path.join(folder, "written.json"),
                "--radius", "0.5", "--frames", "3", "--lights", os.path.join(folder, "lights.json"), "--aov", "ao,normal,shadow", "--set",
                "compression=none", "-q"], check=True)
image = scene.node_tree.nodes.new("CompositorNodeImage")
image.image = bpy.data.images.load(shadows)
scene.node_tree.nodes.active = image
with open(page, encoding="utf-8") as file:
    [lines] = [part for part in re.findall("```python\n(.*?)```", file.read(), re.S) if "shadow-key" in part]
made = {}
exec(compile(lines, page, "exec"), made)
made["darkened"].node.inputs[1].default_value = (0.5, 0.25, 2, 1)
end = next(node for node in scene.node_tree.nodes if node.bl_idname == "CompositorNodeComposite")
scene.render.image_settings.exr_codec = "NONE"
for name in ("relit", "darkened"):
    scene.node_tree.links.new(made[name], end.inputs["Image"])
    scene.render.filepath = os.path.join(folder, name + " by key.exr")
    bpy.ops.render.render(write_still=True)


def message_of(change):
    """What an error says where something was changed."""
    change()
    try:
        bpy.ops.alcove.compute(animation=False)
    except RuntimeError as error:
        return str(error)
    return "none"


facts["error of the program"] = message_of(lambda: setattr(scene.alcove, "output", "AO") or os.mkdir(
    os.path.join(folder, "ao.0006.exr")) or scene.frame_set(6))
facts["error without a camera"] = message_of(lambda: scene.timeline_markers.clear() or setattr(scene, "camera", None))
scene.camera = bpy.data.objects["First"]
facts["error without the program"] = message_of(lambda: os.environ.__setitem__("ALCOVE", "/nowhere/alcove"))
facts["handlers at the end"] = len(bpy.app.handlers.frame_change_post)
scene.camera.data.type = "ORTHO"
facts["orthographic"] = alcove.camera_of(scene, bpy.context.evaluated_depsgraph_get())
point = bpy.data.objects["Suzanne"].matrix_world.translation
from bpy_extras.object_utils import world_to_camera_view  # noqa: E402

facts["where Blender sees Suzanne"] = list(world_to_camera_view(scene, scene.camera, point))
facts["Suzanne"] = list(point)
alcove.unregister()
with open(os.path.join(folder, "facts.json"), "w", encoding="utf-8") as file:
    json.dump(facts, file, indent=1)
assert math.isfinite(sum(point))
