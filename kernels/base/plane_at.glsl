// The planes of the pixels that a kernel reads. To be included after likeness.glsl and normal.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel has declared kReadsNormals and the buffers `depth` and `normal`.

/// A pixel outside the image is as sky. Without normals there are depth and scale alone.
Plane plane_at(View view, ivec2 pixel) {
  const ivec2 nearest = clamp(pixel, ivec2(0), view.size - 1);
  const int index = index_of(view, nearest);
  const float z = pixel == nearest ? depth[index] : kSkyDepth;
  return plane_of(view, nearest, z, kReadsNormals ? unpack_normal(normal[index]) : vec3(0));
}
