// Reading -> the terms of kernels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/base/frame_inputs.h"

#include "core/chain/base/planes.h"

namespace alcove {
namespace {

uint normal_form_of(const Reading& reading, std::size_t components) {
  if (components == 0) return kNormalNone;
  if (reading.normal_encoding == NormalEncoding::octahedral) return kNormalOctahedral;
  if (reading.normal_encoding == NormalEncoding::spheremap) return kNormalSpheremap;
  return components < 3 ? kNormalXy : kNormalVector;
}

DepthTerms depth_terms(const DepthMap& map) {
  DepthTerms terms{};
  terms.axis = to_vec3(map.axis);
  terms.along_ray = map.along_ray ? 1 : 0;
  terms.origin = float(map.origin);
  terms.base = float(map.base);
  terms.slope = float(map.slope);
  terms.sky_below = float(map.sky_below);
  terms.sky_above = float(map.sky_above);
  terms.sky_depth = float(map.sky_depth);
  return terms;
}

/// The terms of a plane behind the first surface.
LayerTerms layer_terms(const Reading& reading, const BehindPlane& plane) {
  const DepthMap map = behind_map_of(reading, plane);
  return {map.form, plane.kind, depth_terms(map)};
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
  params.depth = depth_terms(map);
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
  inputs.hidden_precision = hidden_precision_of(reading);
  inputs.prepare = prepare_params(reading, inputs.depth_map, inputs.view, normal != nullptr);
  inputs.normal_form = normal_form_of(reading, normal ? planes_in(*normal, inputs.view) : 0);
  for (const auto& plane : reading.behind) inputs.behind.push_back(layer_terms(reading, plane));
  inputs.behind_lists_all = list_all(reading.behind);
  inputs.supersampling = reading.supersampling;
  inputs.matte = reading.matte;
  inputs.occluders = reading.occluders;
  inputs.ambient = reading.ambient;
  inputs.is_sky = is_all_sky(inputs.depth_map, planes[RawPlane::depth]->as<const float>());
  return inputs;
}

}  // namespace alcove
