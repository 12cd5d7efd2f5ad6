# The node for ComfyUI gives what alcove.compute() gives, for pictures as ComfyUI has them; a stub stands for torch's tensors.
# Takes the library and the project's folder.
# SPDX-License-Identifier: BSD-3-Clause
import importlib
import os
import sys
import types
import unittest

import numpy

LIBRARY, PROJECT = sys.argv[1:3]
os.environ["ALCOVE_LIBRARY"] = LIBRARY
sys.dont_write_bytecode = True
sys.path[:0] = [os.path.join(PROJECT, "hosts/python"), os.path.join(PROJECT, "hosts")]


class Tensor:
    """A tensor as far as the node knows one."""

    def __init__(self, array):
        self.array = array

    def __len__(self):
        return len(self.array)

    def cpu(self):
        return self

    def numpy(self):
        return self.array


sys.modules["torch"] = types.SimpleNamespace(from_numpy=Tensor)
alcove = importlib.import_module("alcove")
node = importlib.import_module("comfyui").NODE_CLASS_MAPPINGS["AlcoveAO"]()

Z = numpy.full((48, 64), 5, numpy.float32)
Z[:, :20] = 4
FOV = 40.0


def pictures(*planes):
    return Tensor(numpy.stack([numpy.repeat(plane[..., None], 3, -1) for plane in planes]).astype(numpy.float32))


def compute(depth, kind, **more):
    words = {"near": 1.0, "far": 10.0, "fov": FOV, "radius": 1.0, "intensity": 1.0, "preset": "draft", **more}
    return node.compute(depth, kind, **words)


class Node(unittest.TestCase):
    def test_its_inputs_are_those_of_its_function(self):
        declared = node.INPUT_TYPES()
        names = [*declared["required"], *declared["optional"]]
        code = node.compute.__func__.__code__
        self.assertEqual(names, list(code.co_varnames[1:code.co_argcount]))
        self.assertEqual(len(node.RETURN_TYPES), len(node.RETURN_NAMES))

    def test_each_kind_gives_the_same_ao(self):
        disparity, distance = (1 / Z - 0.1) / 0.9, (Z - 1) / 9
        expected = alcove.ao(Z, fov=FOV, radius=1, preset="draft")
        self.assertLess(expected.min(), 0.9)
        for kind, plane in (("planar depth, scene units", Z), ("disparity, 1 = near", disparity), ("distance, 1 = far", distance),
                            ("distance, 1 = near", 1 - distance)):
            ao, normals, composite, _ = compute(pictures(plane), kind)
            self.assertEqual(ao.array.shape, (1, 48, 64, 3), kind)
            numpy.testing.assert_allclose(ao.array[0, :, :, 1], expected, atol=2e-3, err_msg=kind)
            numpy.testing.assert_array_equal(composite.array, ao.array)
            numpy.testing.assert_allclose(normals.array[0, 24, 50], [0.5, 0.5, 1], atol=0.01)

    def test_several_frames_one_picture_and_normals(self):
        flat = numpy.zeros((1, 48, 64, 3), numpy.float32) + numpy.float32([0.5, 0.5, 1])
        image = numpy.full((1, 48, 64, 3), 0.5, numpy.float32)
        ao, _, composite, notes = compute(pictures(Z, Z + 1), "planar depth, scene units", image=Tensor(image), normals=Tensor(flat))
        self.assertEqual(ao.array.shape[0], 2)
        self.assertFalse(numpy.array_equal(ao.array[0], ao.array[1]))
        numpy.testing.assert_allclose(composite.array, 0.5 * ao.array)
        self.assertIsInstance(notes, str)

    def test_what_does_not_fit_is_refused(self):
        with self.assertRaisesRegex(ValueError, "image is 32x48, and depth 64x48"):
            compute(pictures(Z), "planar depth, scene units", image=pictures(Z[:, :32]))
        with self.assertRaisesRegex(ValueError, "normals has 1 channels"):
            compute(pictures(Z), "planar depth, scene units", normals=numpy.zeros((1, 48, 64)))
        with self.assertRaisesRegex(ValueError, "2 pictures, and depth has 3"):
            compute(pictures(Z, Z, Z), "planar depth, scene units", image=pictures(Z, Z))
        with self.assertRaisesRegex(alcove.Error, "far plane"):
            compute(pictures((Z - 1) / 9), "distance, 1 = far", far=0.5)


unittest.main(argv=sys.argv[:1])
