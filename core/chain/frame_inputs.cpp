// Reading -> the terms of kernels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/frame_inputs.h"

#include "core/chain/pass_common.h"

namespace alcove {
namespace {

uint normal_form_of(const Reading& reading, std::size_t components) {
  if (components == 0) return kNormalNone;
  if (reading.normal_encoding == NormalEncoding::octahedral) return kNormalOctahedral;
  if (reading.normal_encoding == NormalEncoding::spheremap) return kNormalSpheremap;
  return components < 3 ? kNormalXy : kNormalVector;
}

PrepareParams prepare_params(const Reading& reading, const DepthMap& map, const View& view, bool has_normals) {
  PrepareParams params{};
  params.view = view;
  if (has_normals) {
    const Matrix3 rotation = view_from_normal(reading.camera, reading.normal_space, reading.flip_normal);
    params.view_from_normal_x = to_vec3(rotation[0]);
    params.view_from_normal_y = to_vec3(rotation[1]);
    params.view_from_normal_z = to_vec3(rotation[2]);
  }
  params.depth_axis = to_vec3(map.axis);
  params.along_ray = map.along_ray ? 1 : 0;
  params.origin = float(map.origin);
  params.base = float(map.base);
  params.slope = float(map.slope);
  params.sky_below = float(map.sky_below);
  params.sky_above = float(map.sky_above);
  params.sky_depth = float(map.sky_depth);
  params.normal_unorm = reading.normal_unorm ? 1 : 0;
  return params;
}

}  // namespace

FrameInputs inputs_of(const Reading& reading, const RawPlaneArray<gpu::Buffer*>& planes, int frame) {
  const gpu::Buffer* normal = planes[RawPlane::normal];
  FrameInputs inputs;
  inputs.planes = planes;
  inputs.view = view_of(reading.camera, reading.data, reading.display);
  inputs.noise_origin = {reading.data.x - reading.display.x, reading.data.y - reading.display.y};
  inputs.frame = frame;
  inputs.depth_map = depth_map_of(reading);
  inputs.depth_precision = depth_precision_of(reading);
  inputs.prepare = prepare_params(reading, inputs.depth_map, inputs.view, normal != nullptr);
  inputs.normal_form = normal_form_of(reading, normal ? planes_in(*normal, inputs.view) : 0);
  inputs.is_sky = is_all_sky(inputs.depth_map, planes[RawPlane::depth]->as<const float>());
  return inputs;
}

void upload(gpu::Recorder& gpu, const FrameInputs& frame) {
  for (const auto* plane : frame.planes.entries)
    if (plane) gpu.upload(*plane);
}

}  // namespace alcove
