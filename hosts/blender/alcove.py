# Alcove in Blender: renders depth and normals, computes their ambient occlusion, and loads it into the compositor.
# SPDX-License-Identifier: BSD-3-Clause
#
# Install this one file by Edit > Preferences > Add-ons > Install. Tested with Blender 3.4.1; written for 3.4 to 5.
"""Ambient occlusion of the rendered frame, or of the whole animation, by the program `alcove`."""

import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import threading

import bpy
import mathutils

bl_info = {
    "name": "Alcove",
    "author": "Alcove",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Output > Alcove",
    "description": "Ambient occlusion from depth and normals, by the program alcove",
    "category": "Render",
}

PASSES = ("use_pass_z", "use_pass_normal", "use_pass_position")
FOR_COMPOSITE = ("use_pass_diffuse_color", "use_pass_diffuse_indirect")
NODE_LABEL = "Alcove"
FRAME_LABEL = "Ambient Occlusion"
RELIGHT = "Relight by a Sky"
HASHES = "####"  # of a frame's number in names


class Failure(Exception):
    """A failure with a message for the user."""


FAILURES = (Failure, OSError, RuntimeError)  # Blender's operators fail with the last one


# ---- the camera ----


def camera_of(scene, depsgraph):
    """The camera of the scene's frame as fields of a camera file: with shift, sensor fit, parents, constraints and pixel
    aspect; the scale of its parents is ignored."""
    if scene.camera is None:
        raise Failure("The scene has no camera")
    camera = scene.camera.evaluated_get(depsgraph)
    if camera.data.type == "PANO":
        raise Failure("Alcove takes no panoramas: %s is one" % scene.camera.name)
    render = scene.render
    width = render.resolution_x * render.resolution_percentage // 100
    height = render.resolution_y * render.resolution_percentage // 100
    projection = camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    is_orthographic = camera.data.type == "ORTHO"
    shift = (projection[0][3], projection[1][3]) if is_orthographic else (-projection[0][2], -projection[1][2])
    return {
        "resolution": [width, height],
        "projection": "orthographic" if is_orthographic else "perspective",
        "fx": projection[0][0] * width / 2,
        "fy": projection[1][1] * height / 2,
        "cx": (1 + shift[0]) * width / 2,
        "cy": (1 - shift[1]) * height / 2,
        "world_to_camera": [list(row) for row in camera.matrix_world.normalized().inverted()],
        "depth": "planar",
        "normal_space": "world",
    }


class Cameras:
    """The cameras of frames, taken when each frame is set, since markers, drivers and constraints have then acted. A renderer
    evaluates the scene by itself, so the window may still show another frame."""

    def __init__(self):
        self.frames = {}
        self.failure = None

    def take(self, scene, depsgraph=None):
        try:
            self.frames[scene.frame_current] = camera_of(scene, depsgraph or bpy.context.evaluated_depsgraph_get())
        except Failure as failure:
            self.failure = failure

    def write(self, path):
        if self.failure:
            raise self.failure
        frames = [dict(frame=frame, **fields) for frame, fields in sorted(self.frames.items())]
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"frames": frames}, file, indent=1)


# ---- the radius ----


def depths_of(scene, depsgraph, fields):
    """How far away the surfaces are that the camera sees, by a grid of rays: no frame is rendered for it."""
    width, height = fields["resolution"]
    view = mathutils.Matrix(fields["world_to_camera"])
    world = view.inverted()
    depths = []
    for row in range(18):
        for column in range(32):
            x = ((column + 0.5) / 32 * width - fields["cx"]) / fields["fx"]
            y = (fields["cy"] - (row + 0.5) / 18 * height) / fields["fy"]
            is_orthographic = fields["projection"] == "orthographic"
            start = world @ mathutils.Vector((x, y, 0) if is_orthographic else (0, 0, 0))
            way = world.to_3x3() @ mathutils.Vector((0, 0, -1) if is_orthographic else (x, y, -1))
            is_hit, place = scene.ray_cast(depsgraph, start, way.normalized())[:2]
            if is_hit:
                depths.append(-(view @ place).z)
    return depths


def proposed_radius(scene, depsgraph):
    """What --radius auto would take, by the program's own rule: one digit of a tenth of the median depth; 0: nothing is seen."""
    fields = camera_of(scene, depsgraph)
    depths = sorted(depths_of(scene, depsgraph, fields))
    if not depths:
        return 0
    median = depths[len(depths) // 2]
    width = fields["resolution"][0] / fields["fx"]
    radius = 0.1 * width if fields["projection"] == "orthographic" else min(0.1 * median, 0.25 * width * median)
    return float("%.1g" % radius) if radius > 0 and math.isfinite(radius) else 0


class Proposal:
    """The radius that the panel shows. Rays are cast again only when the view changes, and never while a scene plays."""

    key, radius = None, 0

    @classmethod
    def of(cls, context):
        scene = context.scene
        if scene.camera is None or (context.screen and context.screen.is_animation_playing):
            return cls.radius
        key = (scene.name, scene.frame_current, len(scene.objects), scene.camera.name,
               tuple(round(x, 4) for row in scene.camera.matrix_world for x in row), scene.camera.data.angle)
        if key != cls.key:
            try:
                cls.radius = proposed_radius(scene, context.evaluated_depsgraph_get())
            except FAILURES:
                cls.radius = 0
            cls.key = key
        return cls.radius


# ---- rendering ----


def turn_on_passes(scene, with_composite):
    for layer in scene.view_layers:
        for name in PASSES + (FOR_COMPOSITE if with_composite else ()):
            if hasattr(layer, name):
                setattr(layer, name, True)


class OutputSettings:
    """Sets the scene's output as Alcove needs it; restore() brings the user's settings back."""

    def __init__(self, scene, folder):
        self.scene = scene
        render, image = scene.render, scene.render.image_settings
        names = ("filepath", "use_file_extension", "use_overwrite", "use_compositing", "use_sequencer")
        self.render = {name: getattr(render, name) for name in names}
        self.image = {name: getattr(image, name) for name in ("file_format", "color_depth", "exr_codec")}
        self.media = getattr(image, "media_type", None)  # from Blender 5 on
        if self.media:
            image.media_type = "MULTI_LAYER_IMAGE"
        image.file_format = "OPEN_EXR_MULTILAYER"
        image.color_depth = "32"
        image.exr_codec = "ZIP"
        render.use_file_extension = render.use_overwrite = True
        render.use_compositing = render.use_sequencer = False  # AO needs the rendered frame, not the comp
        render.filepath = os.path.join(folder, "frame." + HASHES + ".exr")

    def name_frame(self, frame):
        """Puts the frame number into the name, since Blender numbers animations only."""
        self.scene.render.filepath = self.scene.render.filepath.replace(HASHES, "%04d" % frame)

    def restore(self):
        image = self.scene.render.image_settings
        if self.media:
            image.media_type = self.media
        for name, value in self.image.items():
            setattr(image, name, value)
        for name, value in self.render.items():
            setattr(self.scene.render, name, value)


def folder_for(scene):
    """The output folder: beside the saved file, else one that vanishes with Blender."""
    asked = scene.alcove.folder
    if asked.startswith("//") and not bpy.data.filepath:
        return os.path.join(bpy.app.tempdir or tempfile.gettempdir(), "alcove")
    return bpy.path.abspath(asked)


# ---- the program ----


def program():
    addon = bpy.context.preferences.addons.get(__name__)
    named = addon.preferences.program if addon else ""
    found = shutil.which(bpy.path.abspath(named) if named else os.environ.get("ALCOVE", "alcove"))
    if not found:
        raise Failure("The program alcove is not found: name it in the add-on's preferences")
    return found


def command_for(scene, folder, frames):
    """The command for these frames, as a user would type it."""
    settings = scene.alcove
    name = HASHES if len(frames) > 1 else "%04d" % frames[0]
    command = [
        program(), "run", os.path.join(folder, "frame.%s.exr" % name), "-o", os.path.join(folder, "ao.%s.exr" % name),
        "--camera", os.path.join(folder, "cameras.json"), "--preset", settings.preset.lower(),
        "--radius", "auto" if settings.radius == 0 else repr(settings.radius), "--progress", "percent"]
    if len(frames) > 1:
        step = scene.frame_step
        command += ["--frames", "%d-%dx%d" % (frames[0], frames[-1], step) if step > 1 else
                    "%d-%d" % (frames[0], frames[-1])]
    else:
        command += ["--frames", str(frames[0])]
    if settings.sky:
        command += ["--aov", "ao,transfer"]
    if settings.output == "COMPOSITE":
        command += ["--composite", os.path.join(folder, "composite.%s.exr" % name)]
    return command


class Process:
    """The running program; threads read its output, so that Blender never waits for it."""

    def __init__(self, command):
        self.running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
        self.percent = 0
        self.messages = []
        self.threads = [threading.Thread(target=self.follow), threading.Thread(target=self.listen)]
        for thread in self.threads:
            thread.start()

    def follow(self):
        for line in self.running.stdout:
            number = re.search(r"(\d+)\s*%", line)
            if number:
                self.percent = int(number.group(1))

    def listen(self):
        self.messages += [line.strip() for line in self.running.stderr if line.strip()]

    def is_done(self):
        return self.running.poll() is not None

    def finish(self):
        code = self.running.wait()
        for thread in self.threads:
            thread.join()
        self.running.stdout.close()
        self.running.stderr.close()
        if code != 0:
            errors = [line for line in self.messages if "error" in line] or self.messages or ["it said nothing"]
            raise Failure("Alcove: %s (exit code %d)" % (errors[-1], code))
        return [line for line in self.messages if "warning: " in line]

    def stop(self):
        self.running.terminate()
        self.running.wait()


# ---- the compositor ----


def compositor_of(scene):
    """The scene's node tree, and True if it is new."""
    if hasattr(scene, "compositing_node_group"):  # Blender 5
        is_new = scene.compositing_node_group is None
        if is_new:
            scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        return scene.compositing_node_group, is_new
    is_new = not scene.use_nodes
    scene.use_nodes = True
    return scene.node_tree, is_new


def place_of(node):
    """A node's corner in the tree, whatever frames it lies in."""
    x, y = node.location
    while node.parent:
        node = node.parent
        x, y = x + node.location[0], y + node.location[1]
    return x, y


def height_of(node):
    """What a node takes, also before it is ever drawn: then by its sockets."""
    return max(node.dimensions[1], node.height, 150 + 25 * (len(node.inputs) + len(node.outputs)))


def free_place(tree):
    """The corner of what lies below all nodes."""
    nodes = [node for node in tree.nodes if node.bl_idname != "NodeFrame"]
    if not nodes:
        return 0, 0
    return min(place_of(node)[0] for node in nodes), min(place_of(node)[1] - height_of(node) for node in nodes) - 100


def add_node(tree, kind, beside=None):
    """A node in Alcove's own frame: below all others, or to the right of one in it."""
    place = (beside.location[0] + beside.width + 60, beside.location[1]) if beside else free_place(tree)
    node = tree.nodes.new(kind)
    frame = beside.parent if beside else tree.nodes.new("NodeFrame")
    frame.label = FRAME_LABEL
    node.parent = frame
    node.location = place
    return node


def sky_colors(path):
    """The nine colours of a lat-long picture."""
    done = subprocess.run([program(), "inspect", bpy.path.abspath(path), "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0 or "sky" not in json.loads(done.stdout or "{}"):
        raise Failure("Alcove: %s" % (done.stderr.strip() or path + " is no lat-long sky"))
    return json.loads(done.stdout)["sky"]


def relight_group(colors):
    """The group that multiplies the three layers of transfer by nine colours, which stay open to be changed within it."""
    tree = bpy.data.node_groups.get(RELIGHT)
    if tree is None:
        tree = bpy.data.node_groups.new(RELIGHT, "CompositorNodeTree")
        for name in ("transfer0", "transfer1", "transfer2", "Light"):
            way = "OUTPUT" if name == "Light" else "INPUT"
            if hasattr(tree, "interface"):  # from Blender 4 on
                tree.interface.new_socket(name=name, in_out=way, socket_type="NodeSocketColor")
            else:
                (tree.outputs if way == "OUTPUT" else tree.inputs).new("NodeSocketColor", name)
    tree.nodes.clear()

    def mixed(kind, place, first, second):
        node = tree.nodes.new("CompositorNodeMixRGB")
        node.blend_type, node.location, node.inputs[0].default_value = kind, place, 1
        tree.links.new(first, node.inputs[1])
        if isinstance(second, tuple):
            node.inputs[2].default_value = second
        else:
            tree.links.new(second, node.inputs[2])
        return node.outputs[0]

    layers, total = tree.nodes.new("NodeGroupInput"), None
    for k, color in enumerate(colors):
        if k % 3 == 0:
            parts = tree.nodes.new("CompositorNodeSeparateColor")
            parts.location = (200, -200 * k)
            tree.links.new(layers.outputs[k // 3], parts.inputs[0])
        for kind, sign in (("ADD", 1), ("SUBTRACT", -1)):  # sockets hold no colours below 0
            color_part = tuple(max(0, sign * x) for x in color)
            if total is None or any(color_part):
                product = mixed("MULTIPLY", (400, -200 * k), parts.outputs[k % 3], (*color_part, 1))
                total = product if total is None else mixed(kind, (600, -200 * k), total, product)
    end = tree.nodes.new("NodeGroupOutput")
    end.location = (1000, -1600)
    tree.links.new(mixed("LIGHTEN", (800, -1600), total, (0, 0, 0, 1)), end.inputs[0])
    return tree


def relight(tree, node, colors):
    """Puts the group behind the image node of the result."""
    group = next((n for n in tree.nodes if n.label == RELIGHT), None) or add_node(tree, "CompositorNodeGroup", node)
    group.label, group.node_tree = RELIGHT, relight_group(colors)
    for number in range(3):
        tree.links.new(node.outputs["transfer%d" % number], group.inputs[number])


def show(image, frames):
    """Shows the result in an image editor, at best in the one that shows the rendered frame. Returns whether there is one."""
    editors = [area.spaces.active for window in bpy.context.window_manager.windows for area in window.screen.areas
               if area.type == "IMAGE_EDITOR"]
    if not editors:
        return False
    editor = next((one for one in editors if one.image and one.image.type == "RENDER_RESULT"), editors[0])
    editor.image = image
    if len(frames) > 1:
        user = editor.image_user
        user.frame_start, user.frame_duration, user.frame_offset = frames[0], frames[-1] - frames[0] + 1, frames[0] - 1
        user.use_auto_refresh = True
    return True


def load_result(scene, folder, frames):
    """Loads the result into an image node, and shows it; a second run reuses the node. In a new compositor the AO darkens the
    picture; an existing node tree only gets the image node."""
    stem = "composite" if scene.alcove.output == "COMPOSITE" else "ao"
    path = os.path.join(folder, "%s.%04d.exr" % (stem, frames[0]))
    tree, is_new = compositor_of(scene)
    node = next((n for n in tree.nodes if n.bl_idname == "CompositorNodeImage" and n.label == NODE_LABEL), None)
    if node is None:
        node = add_node(tree, "CompositorNodeImage")
        node.label = NODE_LABEL
    image = bpy.data.images.load(path, check_existing=True)
    image.reload()
    if image.colorspace_settings.name != "Non-Color" and stem == "ao":
        image.colorspace_settings.name = "Non-Color"
    image.source = "SEQUENCE" if len(frames) > 1 else "FILE"
    node.image = image
    if len(frames) > 1:
        node.frame_start, node.frame_duration, node.frame_offset = frames[0], frames[-1] - frames[0] + 1, frames[0] - 1
        node.use_auto_refresh = True
    if is_new and hasattr(scene, "node_tree"):
        wire(tree, node, stem)
    if scene.alcove.sky and stem == "ao":
        relight(tree, node, sky_colors(scene.alcove.sky))
    for other in tree.nodes:
        other.select = other == node
    tree.nodes.active = node
    show(image, frames)
    return node


def wire(tree, node, stem):
    layers = next((n for n in tree.nodes if n.bl_idname == "CompositorNodeRLayers"), None)
    end = next((n for n in tree.nodes if n.bl_idname == "CompositorNodeComposite"), None)
    if layers is None or end is None:
        return
    picture = next((socket for socket in node.outputs if socket.name in ("Image", "Combined")), node.outputs[0])
    if stem == "ao":
        mix = add_node(tree, "CompositorNodeMixRGB", node)
        mix.blend_type = "MULTIPLY"
        mix.inputs[0].default_value = 1
        tree.links.new(layers.outputs["Image"], mix.inputs[1])
        tree.links.new(picture, mix.inputs[2])
        picture = mix.outputs[0]
    tree.links.new(picture, end.inputs["Image"])


# ---- operators ----


class ALCOVE_OT_compute(bpy.types.Operator):
    bl_idname = "alcove.compute"
    bl_label = "Compute Ambient Occlusion"
    bl_description = "Renders with the passes that are needed, computes ambient occlusion and loads it"
    animation: bpy.props.BoolProperty(name="Animation", description="All frames of the scene's range")

    def begin(self, context):
        scene = context.scene
        program()  # before anything is rendered
        camera_of(scene, context.evaluated_depsgraph_get())
        self.scene = scene
        self.frames = (list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step)) if self.animation else
                       [scene.frame_current])
        self.folder = folder_for(scene)
        os.makedirs(self.folder, exist_ok=True)
        turn_on_passes(scene, scene.alcove.output == "COMPOSITE")
        self.cameras = Cameras()
        self.output = OutputSettings(scene, self.folder)
        if not self.animation:
            self.output.name_frame(self.frames[0])
        self.process = None
        bpy.app.handlers.frame_change_post.append(self.cameras.take)

    def end_rendering(self):
        if self.cameras.take in bpy.app.handlers.frame_change_post:
            bpy.app.handlers.frame_change_post.remove(self.cameras.take)
        self.output.restore()

    def start(self):
        self.cameras.write(os.path.join(self.folder, "cameras.json"))
        self.process = Process(command_for(self.scene, self.folder, self.frames))

    def load(self):
        for warning in self.process.finish():
            self.report({"WARNING"}, warning)
        load_result(self.scene, self.folder, self.frames)
        self.report({"INFO"}, "Alcove: %d frame%s in %s" % (len(self.frames), "s"[:len(self.frames) > 1], self.folder))

    def execute(self, context):
        """Runs without a window, one step after the other."""
        try:
            self.begin(context)
            try:
                bpy.ops.render.render(animation=self.animation, write_still=not self.animation)
            finally:
                self.end_rendering()
            self.start()
            self.load()
        except FAILURES as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, event):
        """Runs with a window: Blender renders as usual, and the program runs beside it."""
        if bpy.app.background:
            return self.execute(context)
        try:
            self.begin(context)
        except FAILURES as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        self.rendered = self.cancelled = False
        self.handlers = [(bpy.app.handlers.render_complete, self.on_complete), (bpy.app.handlers.render_cancel, self.on_cancel)]
        for handlers, function in self.handlers:
            handlers.append(function)
        bpy.ops.render.render("INVOKE_DEFAULT", animation=self.animation, write_still=not self.animation)
        self.timer = context.window_manager.event_timer_add(0.2, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def on_complete(self, *_):
        self.rendered = True

    def on_cancel(self, *_):
        self.cancelled = True

    def leave(self, context):
        for handlers, function in self.handlers:
            if function in handlers:
                handlers.remove(function)
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def modal(self, context, event):
        if self.process and event.type == "ESC":
            self.process.stop()
            self.leave(context)
            self.report({"WARNING"}, "Alcove: stopped")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            if self.cancelled and not self.process:
                self.end_rendering()
                self.leave(context)
                return {"CANCELLED"}
            if self.rendered and not self.process:
                self.end_rendering()
                self.start()
                context.window_manager.progress_begin(0, 100)
            if not self.process:
                return {"PASS_THROUGH"}
            context.window_manager.progress_update(self.process.percent)
            context.workspace.status_text_set("Alcove: %d %% (Esc stops it)" % self.process.percent)
            if not self.process.is_done():
                return {"PASS_THROUGH"}
            self.load()
        except FAILURES as failure:
            self.leave(context)
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        self.leave(context)
        return {"FINISHED"}


class ALCOVE_OT_write_cameras(bpy.types.Operator):
    bl_idname = "alcove.write_cameras"
    bl_label = "Write Cameras"
    bl_description = "Writes the cameras of the scene's frames for --camera, for frames that are rendered elsewhere"
    filepath: bpy.props.StringProperty(subtype="FILE_PATH", default="cameras.json")

    def execute(self, context):
        scene, cameras, now = context.scene, Cameras(), context.scene.frame_current
        for frame in range(scene.frame_start, scene.frame_end + 1, scene.frame_step):
            scene.frame_set(frame)
            cameras.take(scene)
        scene.frame_set(now)
        try:
            cameras.write(bpy.path.abspath(self.filepath))
        except FAILURES as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


# ---- panels ----


class AlcoveSettings(bpy.types.PropertyGroup):
    radius: bpy.props.FloatProperty(
        name="Radius", description="Reach of occluders; 0: what stands below, as the frame proposes", default=0, min=0, soft_max=10,
        subtype="DISTANCE")
    preset: bpy.props.EnumProperty(
        name="Preset", default="STANDARD",
        items=[(name, name.capitalize(), "") for name in ("DRAFT", "STANDARD", "PRODUCTION", "REFERENCE")])
    output: bpy.props.EnumProperty(
        name="Load", default="AO",
        items=[("AO", "AO", "The ambient occlusion"),
               ("COMPOSITE", "Composite", "The picture with ambient occlusion in its indirect light")])
    sky: bpy.props.StringProperty(
        name="Relight by", description="A lat-long picture: a node group lights white surfaces by it, with its occlusion",
        subtype="FILE_PATH")
    folder: bpy.props.StringProperty(
        name="Folder", description="Folder of frames, cameras and results", default="//alcove", subtype="DIR_PATH")


class ALCOVE_PT_panel(bpy.types.Panel):
    bl_label = "Alcove"
    bl_idname = "ALCOVE_PT_panel"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "output"

    def draw(self, context):
        layout, settings = self.layout, context.scene.alcove
        layout.use_property_split = True
        for name in ("radius", "preset", "output", "sky", "folder"):
            layout.prop(settings, name)
            if name == "radius" and settings.radius == 0:
                proposed = Proposal.of(context)
                layout.label(text="Automatic radius: %s" % ("about %g" % proposed if proposed else "by the frame"), icon="INFO")
        row = layout.row()
        row.operator(ALCOVE_OT_compute.bl_idname, text="This Frame", icon="RENDER_STILL").animation = False
        row.operator(ALCOVE_OT_compute.bl_idname, text="Animation", icon="RENDER_ANIMATION").animation = True
        layout.operator(ALCOVE_OT_write_cameras.bl_idname, icon="CAMERA_DATA")


class AlcovePreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    program: bpy.props.StringProperty(
        name="Program", description="The program alcove; empty: the one on the path", subtype="FILE_PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


CLASSES = (AlcoveSettings, AlcovePreferences, ALCOVE_OT_compute, ALCOVE_OT_write_cameras, ALCOVE_PT_panel)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.alcove = bpy.props.PointerProperty(type=AlcoveSettings)


def unregister():
    del bpy.types.Scene.alcove
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
