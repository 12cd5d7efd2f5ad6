// Prepares frames and views for those that use their surfaces, and finds the pixels that move.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/neighbours.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/hidden/hidden.h"
#include "core/frame/find/channels.h"
#include "core/frame/find/motion.h"
#include "core/frame/settle/settle.h"
#include "core/run/frame_files.h"
#include "kernels/base/reprojection.h"

namespace alcove {
namespace {

bool has_deep_depth(const FrameSource& source) {
  const ChannelRef& depth = source.channels[RawPlane::depth][0];
  return source.part_of(depth).deep.has_value();
}

/// Of a frame that others take only what its first surface shows. `settled`: another one of the shot, or null.
InputSettings of_first_surface(InputSettings input, const FrameSource* settled) {
  input.behind = {};
  input.behind_channels.clear();
  input.behind_kinds.clear();
  if (settled && !has_deep_depth(*settled)) input.deep = {};
  input.material_ao.clear();
  input.material_ao_channel.clear();
  for (std::string* matte : {&input.matte, &input.matte_channel, &input.matte_object, &input.occluders,
                             &input.occluder_objects, &input.ignore, &input.ignored_objects})
    matte->clear();
  input.roi.reset();
  return input;
}

/// The same of a frame that was found: samples hold more than the first surface.
void leave_out_hidden(FrameSource& source) {
  source.channels[RawPlane::behind].clear();
  source.reading.behind.clear();
  if (!has_deep_depth(source)) source.channels.deep.reset();
}

/// The views of a file beside the one that is looked at.
std::vector<std::string> other_views_of(const FrameSource& source) {
  std::vector<std::string> views = views_of(source.files[source.channels[RawPlane::depth][0].file]);
  if (views.size() < 2)
    fail(ErrorKind::input, "{}: it has no other view for --set other-views: leave that out", source.depth_path());
  std::erase_if(views, [&](const std::string& view) { return same_name(view, source.channels.view); });
  return views;
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& values, std::uint64_t seed = 0) {
  return XXH3_64bits_withSeed(values.data(), values.size() * sizeof(T), seed);
}

Movement movement(std::vector<std::uint32_t> flags) {
  const std::uint64_t hash = hash_of(flags);
  return {std::move(flags), hash};
}

/// Puts what was seen into upload buffers, the `place`-th of the frame that is computed.
OtherView filled(gpu::Recorder& gpu, const NeighbourView& seen, const Movement& moving, const Camera& here,
                 std::size_t place) {
  const auto plane = [&](const char* name, const auto& values) -> const gpu::Buffer* {
    return values.empty() ? nullptr : &uploaded(gpu, fmt::format("other {} {}", place, name), values);
  };
  OtherView view;
  view.view = seen.view;
  const ViewMap map = view_from_view(here, seen.camera);
  for (std::size_t row = 0; row < 3; row++)
    std::ranges::transform(map[row], view.to_here[row].begin(), [](double x) { return float(x); });
  view.depth_precision = seen.depth_precision;
  view.depth = plane("depth", seen.depth);
  view.normal = plane("normal", seen.normal);
  view.moving = plane("moving", moving.flags);
  view.content = XXH3_64bits_withSeed(&moving.hash, sizeof(moving.hash), seen.hash);
  return view;
}

/// What moves as the witnesses tell, or cannot stand for its surface.
std::vector<std::uint32_t> judged(gpu::Recorder& gpu, const NeighbourView& seen,
                                  const std::vector<std::shared_ptr<const NeighbourView>>& witnesses,
                                  PreparationCost& cost) {
  FrameInputs inputs;
  for (const auto& witness : witnesses)
    inputs.others.push_back(filled(gpu, *witness, {}, seen.camera, inputs.others.size()));
  const std::vector<OtherView> by = inputs.others;
  const OtherView view = inputs.others.emplace_back(filled(gpu, seen, {}, seen.camera, by.size()));
  const gpu::Buffer& moving = gpu.buffer("other moves", seen.depth.size() * sizeof(std::uint32_t));
  surfels(gpu, view, by, moving);
  gpu.download(moving);
  gpu.run();
  cost.passes.insert(cost.passes.end(), gpu.passes().begin(), gpu.passes().end());
  const auto values = moving.as<const std::uint32_t>();
  return {values.begin(), values.end()};
}

bool is_same_place(const Camera& a, const Camera& b) {
  return a.view_from_world == b.view_from_world && a.view_from_world_offset == b.view_from_world_offset;
}

}  // namespace

void require_place(const FrameSource& source, int frame, const char* option) {
  if (!source.reading.camera.view_from_world)
    fail(ErrorKind::input,
         "{}: {} needs the place of frame {}'s camera, which has no world_to_camera: give a --camera file with it",
         source.depth_path(), option, frame);
}

std::string text_of(const Neighbours& others) {
  std::vector<std::string> parts;
  if (!others.frames.empty()) parts.push_back("frames " + frames_text(others.frames));
  if (!others.missing.empty()) parts.push_back("missing " + frames_text(others.missing));
  if (!others.views.empty()) parts.push_back("views " + list_of(others.views));
  return fmt::format("{}", fmt::join(parts, "; "));
}

NeighbourView NeighbourViews::prepare(gpu::Recorder& gpu, const InputSettings& input, int frame, const char* option,
                                      PreparationCost& cost) const {
  Settings settings;
  settings.input = input;
  FrameSource source = find_frame(input, false, frame);
  leave_out_hidden(source);
  require_place(source, frame, option);
  if (settled_) settle_like(source, *settled_);
  const FrameInputs inputs = load_frame(gpu, source, source.reading.data, settings, frame);
  const GBuffer gbuffer = reconstruct(gpu, alcove::prepare(gpu, inputs, "other "));
  gpu.download(*gbuffer.depth);
  gpu.download(*gbuffer.normal);
  gpu.run();
  cost.rows_read += source.rows_read;
  cost.passes.insert(cost.passes.end(), gpu.passes().begin(), gpu.passes().end());
  const auto depth = gbuffer.depth->as<const float>();
  const auto normal = gbuffer.normal->as<const std::uint32_t>();
  NeighbourView seen{source.reading.camera,   source.reading.data,          source.reading.display,        gbuffer.view,
                     gbuffer.depth_precision, {depth.begin(), depth.end()}, {normal.begin(), normal.end()}};
  seen.hash = hash_of(seen.normal, hash_of(seen.depth));
  return seen;
}

std::vector<NeighbourViews::SharedView> NeighbourViews::seen(gpu::Recorder& gpu, const std::vector<int>& frames,
                                                             PreparationCost& cost) {
  return seen_.of(frames, [&](int frame) {
    const InputSettings input = of_first_surface(plan_.at(frame).input, settled_);
    return prepare(gpu, input, frame, shot_option(input), cost);
  });
}

Movement NeighbourViews::movement_of(gpu::Recorder& gpu, int frame, PreparationCost& cost) {
  const SharedView here = seen(gpu, {frame}, cost)[0];
  const auto vectors = moving_by_vectors(gpu, frame, cost, 1);
  std::vector<std::uint32_t> moving = judged(gpu, *here, seen(gpu, witnesses_of(plan_, frame), cost), cost);
  // Vectors tell of one step: what another frame sees through has moved later or before. Who else has seen it does not
  // matter then.
  for (std::size_t i = 0; vectors && i < moving.size(); i++)
    if (moving[i] == 0 || moving[i] == kFlagUnconfirmed) moving[i] = (*vectors)[i] != 0 ? kFlagMoves : 0;
  return movement(std::move(moving));
}

std::optional<std::vector<std::uint8_t>> NeighbourViews::moving_by_vectors(gpu::Recorder& gpu, int frame,
                                                                           PreparationCost& cost, int around) {
  const InputSettings input = plan_.at(frame).input;
  if (input.motion.empty()) return std::nullopt;
  const SharedView here = seen(gpu, {frame}, cost)[0];
  MotionFrame motion{here->depth, here->view, {}, {}};
  for (const int other : plan_.around(frame, 1).there) {
    const SharedView beside = seen(gpu, {other}, cost)[0];
    std::optional<FromThere>& there = other < frame ? motion.previous : motion.next;
    there.emplace(
        FromThere{view_from_view(beside->camera, here->camera), view_of(beside->camera, here->data, here->display)});
  }
  const MotionPlanes planes = read_motion(input, here->data);
  if (const auto reading = best_motion_reading(planes, motion, input.motion_kind))
    return moving_by(planes, *reading, motion, around);
  // At the ends of the shot the frame that the vectors lead to may not be there.
  const bool has_both = motion.previous && motion.next;
  const bool has_own = input.motion_kind == MotionKind::previous ? motion.previous.has_value()
                       : input.motion_kind == MotionKind::next   ? motion.next.has_value()
                                                                 : has_both;
  if (!has_own) return std::nullopt;
  fail(ErrorKind::input,
       "{}: in no interpretation do the motion vectors match the cameras around frame {}: give other --set "
       "motion-channels or another --set motion-kind, or leave out --motion",
       planes.path, frame);
}

std::vector<NeighbourViews::ViewWithMovement> NeighbourViews::frames_around(gpu::Recorder& gpu,
                                                                            const FrameSource& target, int frame,
                                                                            Neighbours& others, PreparationCost& cost) {
  const int count = around_of(plan_.at(frame).input);
  const FramesAround around = plan_.around(frame, count);
  others.frames = around.there;
  others.missing = around.missing;
  require_place(target, frame, "--around");
  seen(gpu, seen_around(plan_, frame), cost);
  const std::vector<SharedView> frames = seen(gpu, around.there, cost);
  const auto moving = moving_.of(around.there, [&](int other) { return movement_of(gpu, other, cost); });
  std::vector<ViewWithMovement> found;
  for (std::size_t i = 0; i < frames.size(); i++) {
    found.push_back({frames[i], moving[i]});
    const auto projection = [](const Camera& camera) { return camera.orthographic ? "orthographic" : "perspective"; };
    const char *here = projection(target.reading.camera), *there = projection(found.back().seen->camera);
    if (std::string_view(here) != there)
      fail(ErrorKind::input,
           "{}: frame {} is {}, and frame {} is {}: --around needs one projection in all frames: give another --camera "
           "file",
           target.depth_path(), frame, here, around.there[i], there);
  }
  return found;
}

std::vector<NeighbourViews::ViewWithMovement> NeighbourViews::other_views(gpu::Recorder& gpu, const FrameSource& target,
                                                                          int frame, Neighbours& others,
                                                                          PreparationCost& cost) const {
  InputSettings input = of_first_surface(plan_.at(frame).input, settled_);
  others.views = other_views_of(target);
  require_place(target, frame, "--set other-views");
  std::vector<ViewWithMovement> found;
  for (const auto& view : others.views) {
    input.view = view;
    const auto other = std::make_shared<const NeighbourView>(prepare(gpu, input, frame, "--set other-views", cost));
    if (is_same_place(other->camera, target.reading.camera))
      fail(ErrorKind::input,
           "{}: its views have one camera, and --set other-views needs one for each: give a --camera file with "
           "\"views\"",
           target.depth_path());
    found.push_back({other, std::make_shared<const Movement>(movement(judged(gpu, *other, {}, cost)))});
  }
  return found;
}

Neighbours NeighbourViews::of(gpu::Recorder& gpu, const FrameSource& target, int frame, PreparationCost& cost) {
  const InputSettings input = plan_.at(frame).input;
  Neighbours others;
  std::vector<ViewWithMovement> found;
  if (around_of(input) > 0) found = frames_around(gpu, target, frame, others, cost);
  if (input.other_views) std::ranges::move(other_views(gpu, target, frame, others, cost), std::back_inserter(found));
  for (const auto& [seen, moving] : found)
    others.seen.push_back(filled(gpu, *seen, *moving, target.reading.camera, others.seen.size()));
  return others;
}

void NeighbourViews::keep(const std::function<bool(int)>& is_kept) {
  seen_.keep(is_kept);
  moving_.keep(is_kept);
}

}  // namespace alcove
