// Rendered views of a scene, prepared as other views of a frame.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/hidden/hidden.h"
#include "kernels/hidden/hidden.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::test {

/// A map from the view space of one shot to that of another.
inline void put_map(OtherView& view, const Shot& from, const Shot& to) {
  const Vec3 axes[] = {to.right, to.up, to.back};
  for (std::size_t i = 0; i < 3; i++)
    view.to_here[i] = {float(dot(axes[i], from.right)), float(dot(axes[i], from.up)), float(dot(axes[i], from.back)),
                       float(dot(axes[i], from.eye - to.eye))};
}

/// The rendering in buffers of the recorder that begin with `name`.
inline OtherView seen_by(const Rendering& other, const Shot& here, const std::string& name) {
  const GBuffer gbuffer = prepare(recorder(), upload(recorder(), other.frame), name + " ");
  recorder().run();
  OtherView view;
  view.view = gbuffer.view;
  view.depth_precision = gbuffer.depth_precision;
  view.depth = gbuffer.depth;
  view.normal = gbuffer.normal;
  put_map(view, other.shot, here);
  return view;
}

/// Marks what moves in one of several renderings, as all the others tell.
inline const gpu::Buffer& moving_in(const std::vector<Rendering>& renderings, std::size_t which,
                                    const std::string& name) {
  std::vector<OtherView> witnesses;
  for (std::size_t i = 0; i < renderings.size(); i++)
    if (i != which) witnesses.push_back(seen_by(renderings[i], renderings[which].shot, "witness " + std::to_string(i)));
  const OtherView view = seen_by(renderings[which], renderings[which].shot, "witnessed");
  const gpu::Buffer& moving = recorder().buffer(name, view.depth->bytes(), gpu::Use::device);
  surfels(recorder(), view, witnesses, moving);
  recorder().run();
  return moving;
}

/// What lies behind the first surface.
struct Hidden {
  std::vector<float> planes;
  ViewCounts counts{};
};
inline Hidden hidden_of(const Rendering& here, const std::vector<OtherView>& others, int kept = kMostHidden) {
  FrameInputs inputs = upload(recorder(), here.frame);
  inputs.others = others;
  const Layering layering{kept, -1};
  const GBuffer warped = warp(recorder(), prepare(recorder(), inputs), inputs, layering);
  const GBuffer gbuffer = layers(recorder(), warped, inputs, layering);
  recorder().download(*gbuffer.hidden);
  recorder().download(*gbuffer.view_counts);
  recorder().run();
  const auto planes = gbuffer.hidden->as<float>();
  return {{planes.begin(), planes.end()}, gbuffer.view_counts->as<ViewCounts>()[0]};
}

}  // namespace alcove::test
