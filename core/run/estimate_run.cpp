// The steps of an estimate, and the samples of it that other frames take.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/estimate_run.h"

#include <algorithm>
#include <span>

#include "core/base/estimator_facts.h"
#include "core/chain/chain.h"
#include "core/chain/estimate.h"
#include "core/frame/settle.h"
#include "core/run/frame_files.h"
#include "core/run/frame_tally.h"
#include "core/run/shot_memory.h"
#include "core/run/tiles.h"

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

/// Copies planes over a window into those of the whole frame, in which it lies, within a part of it.
template <class T>
void put_in(std::span<const T> planes, const Window& window, const Window& part, const Window& whole,
            std::vector<T>& all) {
  const std::size_t count = planes.size() / window.pixels(), width = std::size_t(part.width);
  all.resize(count * whole.pixels());
  for (std::size_t k = 0; k < count; k++)
    for (int y = part.y; y < part.y + part.height; y++) {
      const auto place = [&](const Window& of) {
        return k * of.pixels() + std::size_t(y - of.y) * std::size_t(of.width) + std::size_t(part.x - of.x);
      };
      std::ranges::copy(planes.subspan(place(window), width), all.begin() + std::ptrdiff_t(place(whole)));
    }
}

/// One frame on its way.
class EstimateRun {
 public:
  EstimateRun(const EstimateRoom& where, const FramePlan& plan, const FrameSource* settled, int frame)
      : where_(where),
        plan_(plan),
        settled_(settled),
        frame_(frame),
        settings_(of_estimate(plan.at(frame))),
        source_(open_frame(settings_, frame)),
        tally_(result_.report) {
    wanted_.only_own = true;
    wanted_.visibility = true;
  }

  EstimatedFrame run(SharedFrames* shot, PreparedOthers& took, ReadPlanes& read) {
    if (settled_) settle_like(source_, *settled_);
    require_place(source_, frame_, "--accumulate");
    if (shot) others_ = shot->others_of(where_.gpu, source_, frame_, took);
    result_.frame = frame_;
    const WindowLimits limits{memory_with_others(plan_, source_, settings_), where_.room,
                              longest_side(settings_.estimator)};
    if (limits.allow(source_.data))
      compute(source_.file_data, took);
    else
      compute_tiles(limits.in_parts(source_), took);
    read = std::move(read_);
    result_.view = view_of(source_.camera, source_.file_data, source_.display);
    result_.values = std::move(values_);
    for (const auto* planes : {&scales_, &bent_})
      result_.values.insert(result_.values.end(), planes->begin(), planes->end());
    const auto moving = shot ? shot->moving_by_vectors(where_.gpu, frame_, took) : std::nullopt;
    for (std::size_t i = 0; moving && i < moving->size(); i++) {
      if (!(*moving)[i]) continue;
      result_.depth[i] = -result_.depth[i];
      result_.has_moving = true;
    }
    result_.camera = source_.camera;
    result_.others = std::move(others_);
    result_.others.seen.clear();
    took.rows_read += source_.rows_read;
    return std::move(result_);
  }

 private:
  void compute(const Window& part, PreparedOthers& took) {
    if (where_.begin) where_.begin(source_.data);
    FrameInputs inputs = load_frame(where_.gpu, source_, settings_, plan_.turn_of(frame_), &read_);
    inputs.others = others_.seen;
    if (part == source_.file_data) read_ = kept_planes(inputs);
    inputs.turn = plan_.turn_of(frame_);
    const FrameOutputs outputs = run_chain(where_.gpu, inputs, settings_.estimator, wanted_);
    where_.gpu.run();
    const auto& passes = where_.gpu.passes();
    took.passes.insert(took.passes.end(), passes.begin(), passes.end());
    tally_.add_outputs(outputs, source_.data, false);
    const OwnEstimate& own = outputs.own.value();
    result_.depth_precision = own.gbuffer.depth_precision;
    put(*own.gbuffer.depth, part, result_.depth);
    put(*own.gbuffer.normal, part, result_.normal);
    put(*own.visibility.ao, part, values_);
    if (own.visibility.scales) put(*own.visibility.scales, part, scales_);
    if (own.visibility.bent) put(*own.visibility.bent, part, bent_);
  }

  void compute_tiles(const WindowLimits& limits, PreparedOthers& took) {
    read_ = read_whole(source_);
    if (!source_.settled)
      settle_by_planes(source_, settings_.input, read_[RawPlane::depth], read_[RawPlane::normal],
                       limits.room.bytes - limits.kept);
    Surroundings surroundings(source_, settings_, read_[RawPlane::depth]);
    for (const auto& row : tiles_of(source_.file_data, surroundings, limits, source_))
      for (const auto& tile : row) {
        source_.data = surroundings.around(tile);
        compute(tile, took);
      }
  }

  template <class T>
  void put(const gpu::Buffer& planes, const Window& part, std::vector<T>& all) const {
    put_in(planes.as<const T>(), source_.data, part, source_.file_data, all);
  }

  const EstimateRoom& where_;
  const FramePlan& plan_;
  const FrameSource* settled_;
  int frame_;
  Settings settings_;
  FrameSource source_;
  Others others_;
  EstimatedFrame result_;
  FrameTally tally_;
  Wanted wanted_{settings_.output};
  ReadPlanes read_;
  std::vector<float> values_, scales_, bent_;  // over the whole frame
};

}  // namespace

EstimatedFrame estimate_frame(const EstimateRoom& where, const FramePlan& plan, const FrameSource* settled,
                              SharedFrames* shot, int frame, PreparedOthers& took, ReadPlanes& read) {
  return EstimateRun(where, plan, settled, frame).run(shot, took, read);
}

}  // namespace alcove
