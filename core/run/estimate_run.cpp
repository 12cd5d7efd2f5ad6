// Estimates frames for those around them: each is read and estimated, whole or in tiles, but neither filtered nor
// written.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/estimator_facts.h"
#include "core/base/text.h"
#include "core/base/windows.h"
#include "core/chain/chain.h"
#include "core/chain/estimate.h"
#include "core/frame/settle.h"
#include "core/run/cut.h"
#include "core/run/frame_tally.h"
#include "core/run/shot.h"
#include "core/run/shot_memory.h"

namespace alcove {
namespace {

/// The settings of a frame that hands out its estimate alone: all of it, whatever is wanted of the frame itself.
Settings of_estimate(Settings settings) {
  InputSettings& input = settings.input;
  for (std::string* file :
       {&input.matte, &input.matte_channel, &input.matte_object, &input.material_ao, &input.material_ao_channel})
    file->clear();
  input.roi.reset();
  settings.output.composite.clear();
  settings.output.debug.clear();
  settings.estimator.noise = Noise::animated;
  return settings;
}

/// Estimates one frame for others, whole or in tiles.
class EstimateRun {
 public:
  EstimateRun(const EstimateRoom& where, const FramePlan& plan, const Settings& settings, FrameSource& source,
              const Others& others, PreparedOthers& took, EstimatedFrame& result)
      : where_(where),
        turn_(plan.turn_of(result.frame)),
        settings_(settings),
        source_(source),
        others_(others),
        took_(took),
        result_(result),
        tally_(result.report) {
    wanted_.only_own = true;
    wanted_.visibility = true;
  }

  /// Gives what was read.
  ReadPlanes run(const WindowLimits& limits) {
    if (limits.allow(source_.data))
      compute(source_.file_data);
    else
      compute_tiles(limits.in_parts(source_));
    for (const auto* planes : {&scales_, &bent_})
      result_.values.insert(result_.values.end(), planes->begin(), planes->end());
    return std::move(read_);
  }

 private:
  void compute_tiles(const WindowLimits& limits) {
    read_ = read_whole(source_);
    if (!source_.settled)
      settle_by_planes(source_, settings_.input, read_[RawPlane::depth], read_[RawPlane::normal],
                       limits.room.bytes - limits.kept);
    Surroundings surroundings(source_, settings_, read_[RawPlane::depth]);
    for (const auto& row : tiles_of(source_.file_data, surroundings, limits, source_))
      for (const auto& tile : row) {
        source_.data = surroundings.around(tile);
        compute(tile);
      }
  }

  void compute(const Window& part) {
    if (where_.begin) where_.begin(source_.data);
    FrameInputs inputs = load_frame(where_.gpu, source_, settings_, turn_, &read_);
    inputs.others = others_.seen;
    inputs.turn = turn_;
    if (part == source_.file_data) read_ = kept_planes(inputs);
    const FrameOutputs outputs = run_chain(where_.gpu, inputs, settings_.estimator, wanted_);
    where_.gpu.run();
    const auto& passes = where_.gpu.passes();
    took_.passes.insert(took_.passes.end(), passes.begin(), passes.end());
    tally_.add_outputs(outputs, source_.data, false);
    const OwnEstimate& own = outputs.own.value();
    result_.depth_precision = own.gbuffer.depth_precision;
    put(own.gbuffer.depth, part, result_.depth);
    put(own.gbuffer.normal, part, result_.normal);
    put(own.visibility.ao, part, result_.values);
    put(own.visibility.scales, part, scales_);
    put(own.visibility.bent, part, bent_);
  }

  /// Copies a part of the planes that were computed into those of the whole frame.
  template <class T>
  void put(const gpu::Buffer* planes, const Window& part, std::vector<T>& all) const {
    if (planes) put_in(planes->as<const T>(), source_.data, part, source_.file_data, all);
  }

  const EstimateRoom& where_;
  const int turn_;
  const Settings& settings_;
  FrameSource& source_;
  const Others& others_;
  PreparedOthers& took_;
  EstimatedFrame& result_;
  FrameTally tally_;
  Wanted wanted_{settings_.output};
  ReadPlanes read_;
  std::vector<float> scales_, bent_;  // over the whole frame
};

}  // namespace

const EstimatedFrame& TakenEstimates::own(int frame) const {
  return **std::ranges::find_if(of, [&](const auto& estimated) { return estimated->frame == frame; });
}

std::string text_of(const TakenEstimates& taken) {
  if (taken.of.empty()) return "";
  std::vector<int> frames;
  for (const auto& estimated : taken.of) frames.push_back(estimated->frame);
  std::ranges::sort(frames);
  const std::string missing = taken.missing.empty() ? "" : "; missing " + frames_text(taken.missing);
  return "frames " + frames_text(frames) + missing;
}

TakenEstimates SharedFrames::estimates_of(const EstimateRoom& where, int frame, PreparedOthers& took) {
  const FramesAround window = plan_.accumulated(frame);
  TakenEstimates taken{
      {}, estimated_.of(window.there, [&](int other) { return estimate(where, other, took); }), window.missing};
  {
    const std::lock_guard lock(mutex_);
    if (auto read = read_.extract(frame)) taken.read = std::move(read.mapped());
  }
  const EstimatedFrame& own = taken.own(frame);
  std::erase_if(taken.of, [&](const auto& other) { return other->frame != frame && is_cut_between(own, *other); });
  return taken;
}

EstimatedFrame SharedFrames::estimate(const EstimateRoom& where, int frame, PreparedOthers& took) {
  const Settings settings = of_estimate(plan_.at(frame));
  FrameSource source = open_frame(settings, frame);
  if (settled_) settle_like(source, *settled_);
  require_place(source, frame, "--accumulate");
  EstimatedFrame result;
  result.frame = frame;
  result.others = others_of(where.gpu, source, frame, took);
  ReadPlanes read =
      EstimateRun(where, plan_, settings, source, result.others, took, result)
          .run({memory_with_others(plan_, source, settings), where.room, longest_side(settings.estimator)});
  result.others.seen.clear();
  result.camera = source.camera;
  result.view = view_of(source.camera, source.file_data, source.display);
  const auto moving = moving_by_vectors(where.gpu, frame, took, 0);
  for (std::size_t i = 0; moving && i < moving->size(); i++) {
    if (!(*moving)[i]) continue;
    result.depth[i] = -result.depth[i];
    result.has_moving = true;
  }
  took.rows_read += source.rows_read;
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(left_, frame) != left_.end()) read_.insert_or_assign(frame, std::move(read));
  return result;
}

}  // namespace alcove
