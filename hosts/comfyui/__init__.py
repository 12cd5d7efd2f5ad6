# Alcove for ComfyUI: a node that makes ambient occlusion of a picture's depth, by the wheel.
# SPDX-License-Identifier: BSD-3-Clause
"""Put this folder into ComfyUI's custom_nodes, and install the wheel with ComfyUI's Python: `pip install alcove-*.whl`.

Pictures are tensors of (frames, height, width, channels) from 0 to 1, as ComfyUI has them. One picture of an input serves all
frames of the depth."""

import warnings

import alcove
import numpy

# What a depth picture says of the distance, with the options of Alcove that read it so.
KINDS = {
    "disparity, 1 = near": {"depth_kind": "device", "reversed_z": True},  # of networks, scaled to 0 to 1
    "distance, 1 = far": {"depth_kind": "normalized"},
    "distance, 1 = near": {"depth_kind": "normalized", "reversed_z": True},
    "planar depth, scene units": {"depth_kind": "planar"},
    "distance from the eye, scene units": {"depth_kind": "ray"},
}


def _frames(name, pictures, count, channels):
    """The frames of an input as (height, width, channels), one for each of the depth's; None for no input."""
    if pictures is None:
        return [None] * count
    array = numpy.asarray(pictures.cpu().numpy() if hasattr(pictures, "cpu") else pictures, numpy.float32)
    if array.ndim == 3:  # a mask
        array = array[..., None]
    if array.shape[0] not in (1, count):
        raise ValueError(f"Alcove: {name} has {array.shape[0]} pictures, and depth has {count}")
    if array.shape[-1] < channels:
        raise ValueError(f"Alcove: {name} has {array.shape[-1]} channels, and {channels} are needed")
    return [array[i if array.shape[0] == count else 0][..., :channels] for i in range(count)]


def _tensor(pictures, like):
    """Pictures of (height, width) or (height, width, 3) as a tensor with three channels."""
    array = numpy.stack([picture if picture.ndim == 3 else numpy.repeat(picture[..., None], 3, -1) for picture in pictures])
    if not hasattr(like, "cpu"):
        return array
    import torch  # ComfyUI has it
    return torch.from_numpy(array)


class AlcoveAO:
    """Ambient occlusion from depth, with the normals that it was computed with, and the picture with AO multiplied in."""

    CATEGORY = "image/lighting"
    FUNCTION = "compute"
    RETURN_TYPES = ("IMAGE", "IMAGE", "IMAGE", "STRING")
    RETURN_NAMES = ("ao", "normals", "composite", "notes")

    @classmethod
    def INPUT_TYPES(cls):
        number = {"default": 1.0, "min": 0.0, "max": 1e9, "step": 0.01}
        return {
            "required": {
                "depth": ("IMAGE",),
                "kind": (list(KINDS),),
                "near": ("FLOAT", {**number, "tooltip": "scene units at the near end of disparity and distances from 0 to 1"}),
                "far": ("FLOAT", {**number, "default": 10.0, "tooltip": "the same at the far end"}),
                "fov": ("FLOAT", {**number, "default": 50.0, "max": 179.0, "tooltip": "horizontal field of view, degrees"}),
                "radius": ("FLOAT", {**number, "default": 0.0, "tooltip": "how far occluders reach, scene units; 0: by the depth"}),
                "intensity": ("FLOAT", {**number, "max": 8.0, "step": 0.05}),
                "preset": (["standard", "draft", "production", "reference"],),
            },
            "optional": {
                "image": ("IMAGE", {"tooltip": "the picture for the composite"}),
                "normals": ("IMAGE", {"tooltip": "view space, y up, as 0.5 + 0.5 n; else reconstructed from depth"}),
            },
        }

    def compute(self, depth, kind, near, far, fov, radius, intensity, preset, image=None, normals=None):
        options = {**KINDS[kind], "fov": fov, "radius": radius or "auto", "intensity": intensity, "preset": preset}
        if options["depth_kind"] in ("device", "normalized"):
            options.update(near=near, far=far)
        count = len(depth)
        made, notes = [], []
        for z, n, picture in zip(_frames("depth", depth, count, 1), _frames("normals", normals, count, 3),
                                 _frames("image", image, count, 3)):
            if n is not None:
                options.update(normal_space="view", normal_encoding="unorm")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # they are among the notes
                results = alcove.compute(z[..., 0], n, aov=["ao", "normal"], aov_space="view", **options)
            ao = results["ao"]
            if picture is not None and picture.shape[:2] != ao.shape:
                raise ValueError(f"Alcove: image is {picture.shape[1]}x{picture.shape[0]}, and depth {ao.shape[1]}x{ao.shape[0]}")
            made.append((ao, 0.5 + 0.5 * results["normal"], ao if picture is None else picture * ao[..., None]))
            notes += [note for note in results["stats"]["notes"] if note not in notes]
        return (*(_tensor(pictures, depth) for pictures in zip(*made)), "\n".join(notes))


NODE_CLASS_MAPPINGS = {"AlcoveAO": AlcoveAO}
NODE_DISPLAY_NAME_MAPPINGS = {"AlcoveAO": "Ambient Occlusion (Alcove)"}
