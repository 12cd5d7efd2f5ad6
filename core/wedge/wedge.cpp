// Runs each look on planes that are read once, and takes its results as pictures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/wedge/wedge.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <list>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/warm_up.h"
#include "core/formats/sheet.h"
#include "core/frame/raw_plane.h"
#include "core/measure/report.h"
#include "core/options/options.h"
#include "core/run/first_look.h"
#include "core/run/memory.h"
#include "core/run/pipeline.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

std::string url_of(const ShownPicture& picture) {
  const auto url = picture.channels == 1 ? grey_picture : color_picture;
  return url(picture.width, picture.height, picture.pixels);
}

/// The member "scale" of a page's frame: the distances, as a picture of 255 logarithmic steps, 0 for sky.
Json scale_of(const Reading& reading, ShownPicture depth) {
  const auto is_surface = [](float z) { return z > 0 && z < kSkyDepth; };
  float near = kSkyDepth, far = 0;
  for (const float z : depth.pixels)
    if (is_surface(z)) near = std::min(near, z), far = std::max(far, z);
  const float range = std::max(1e-6f, std::log(far / near));
  for (float& z : depth.pixels) z = is_surface(z) ? (1 + 254 * std::log(z / near) / range) / 255 : 0;
  const View view = view_of(reading, reading.data);
  const double factor = reading.supersampling;
  return {{"depth", url_of(depth)},
          {"near", near},
          {"far", near * std::exp(range)},
          {"tangents", {factor * view.tangent_per_pixel.x, -factor * view.tangent_per_pixel.y}},
          {"orthographic", view.orthographic != 0}};
}

/// What says which values the planes of a frame have, beside the group Input, which all looks share.
std::vector<Words> hidden_words(const Settings& settings) {
  std::vector<Words> words;
  for (const auto& row : option_table())
    if (row.group == "Hidden surfaces") words.push_back(row.words(settings));
  return words;
}

/// The looks of one frame after the other.
class WedgeMaker {
 public:
  WedgeMaker(std::span<const WedgeLook> looks, bool has_page) : looks_(looks), has_page_(has_page) {
    for (const auto& look : looks_) {
      try {
        Settings settings = look.settings;
        settings.output.aovs = "ao,depth";
        prepared_.emplace_back(settings);
        times_.push_back({look.name, 0, prepared_.back().prepare(), {}});
      } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("look {}: {}", look.name, error.what()));
      }
    }
    set_exr_threads(core_count());
    set_exr_memory(memory_.host_bytes / kCodecPart);
  }

  /// `sheet` may be null.
  std::vector<WedgeTime> make(Sheet* sheet) {
    sheet_ = sheet;
    settled_ = prepared_.front().settle(memory_.host_bytes);
    for (const int frame : plan().frames()) make_frame(frame);
    if (images_.empty()) throw *times_.front().error;
    return times_;
  }

  std::size_t frames() { return plan().frames().size(); }

  std::string page() {
    Json candidates = Json::array();
    for (std::size_t i = 0; i < looks_.size(); i++) {
      Json notes = Json::array();
      for (const auto& note : times_[i].notes) notes.push_back(fmt::format("{}: {}", level_of(note), note.text));
      const auto radii = radii_of(looks_[i].settings.estimator);
      candidates.push_back({{"name", looks_[i].name},
                            {"settings", looks_[i].command},
                            {"ms", times_[i].error ? Json(nullptr) : Json(times_[i].ms)},
                            {"ms_min", nullptr},
                            {"radius", radii.back()},
                            {"notes", notes}});
    }
    return report_page(json_text({{"title", main_input(looks_.front().settings.input)},
                                  {"kind", "wedge"},
                                  {"device", lanes_.device().info().name},
                                  {"yardstick_ms", nullptr},
                                  {"candidates", candidates},
                                  {"rows", rows_},
                                  {"images", images_},
                                  {"frames", frames_}}));
  }

 private:
  const FramePlan& plan() { return prepared_.front().plan(); }

  void make_frame(int frame) {
    const std::string name = plan().is_sequence()
                                 ? std::to_string(frame)
                                 : std::filesystem::path(main_input(looks_.front().settings.input)).filename().string();
    planes_ = {};
    frames_.push_back({{"name", name}, {"yardstick_ms", nullptr}, {"scale", nullptr}});
    auto first = prepared_.begin();
    for (std::size_t i = 0; i < looks_.size(); i++, first++) {
      if (i > 0 && hidden_words(looks_[i].settings) != hidden_words(looks_[i - 1].settings)) planes_ = {};
      if (!times_[i].error) make_look(i, *first, frame, name);
    }
  }

  void make_look(std::size_t i, FirstLook& first, int frame, const std::string& name) {
    const OutputSettings& output = looks_[i].settings.output;
    const FramePlan& frames = first.plan();
    const FrameSource* const like = settled_ ? &*settled_ : nullptr;
    std::optional<SharedFrames> shot;
    const InputSettings& input = frames.settings().input;
    const bool takes_means = input.accumulate > 0;
    if (takes_means || takes_others(input)) shot.emplace(frames, like, std::span(&frame, 1));
    InputIdentities identities(frames);
    RunContext run{first, frames, identities, like, nullptr, shot ? &*shot : nullptr, takes_means, {}};
    run.planes = &planes_;
    // The driver compiles a kernel at its first use, which is no part of the look's time.
    gpu::Recorder small(lanes_.device());
    record_small_frame(small, frames.settings().estimator, frames.settings().output);
    small.run();
    std::vector<ShownPicture> shown;
    run.take_results = [&](FrameSource& source, const Window& window, const FrameOutputs& outputs) {
      shown.push_back(shown_plane(source, window, *outputs.ao));
      if (outputs.composite) {
        const DisplayTransform transform(output.ocio, output.display, output.view_transform);
        shown.push_back(shown_colors(source, window, outputs.composite, &transform));
      }
      Json& scale = frames_.back()["scale"];
      if (has_page_ && scale.is_null()) scale = scale_of(source.reading, shown_plane(source, window, *outputs.depth));
    };
    run_pipeline(lanes_, run, room_of_lane(memory_, 1, lanes_.device().info()), std::span(&frame, 1),
                 [&](FrameReport&& report) { take(i, report, name, shown); }, {});
  }

  void take(std::size_t i, const FrameReport& report, const std::string& name, std::span<const ShownPicture> shown) {
    const std::string in_frame = plan().is_sequence() ? name + "  " : "";
    WedgeTime& time = times_[i];
    time.ms += report.compute_ms;
    add_new(time.notes, report.notes);
    if (report.error) time.error = report.error;
    const std::string end = report.error ? "failed" : fmt::format("{:.0f} ms", report.compute_ms);
    if (sheet_)
      sheet_->put((frames_.size() - 1) * looks_.size() + i, fmt::format("{}{}  {}", in_frame, time.look, end), shown);
    if (report.error) return;
    rows_.push_back({{"frame", name}, {"candidate", time.look}, {"ms", report.compute_ms}});
    images_.push_back({{"frame", name},
                       {"candidate", time.look},
                       {"width", shown[0].width},
                       {"height", shown[0].height},
                       {"result", has_page_ ? url_of(shown[0]) : ""},
                       {"truth", nullptr},
                       {"error", nullptr},
                       {"composite", has_page_ && shown.size() > 1 ? Json(url_of(shown[1])) : Json(nullptr)}});
  }

  const std::span<const WedgeLook> looks_;
  const bool has_page_;
  std::list<FirstLook> prepared_;  // of each look
  std::vector<WedgeTime> times_;   // the same
  const DeviceSettings& device_ = looks_.front().settings.device;
  Lanes lanes_{{device_.device, device_.require_gpu, device_.validate, !device_.no_pipeline_cache}, 1};
  const RunMemory memory_ = memory_for_frames(device_, lanes_.device().info());
  Sheet* sheet_ = nullptr;
  std::optional<FrameSource> settled_;  // as which all are read
  ReadPlanes planes_;                   // of the frame
  Json rows_ = Json::array(), images_ = Json::array(), frames_ = Json::array();
};

}  // namespace

std::vector<WedgeTime> make_wedge(std::span<const WedgeLook> looks, const std::string& page, const std::string& sheet,
                                  std::size_t columns) {
  WedgeMaker maker(looks, !page.empty());
  Sheet cells(maker.frames() * looks.size(), columns);
  auto times = maker.make(sheet.empty() ? nullptr : &cells);
  if (!page.empty()) write_whole(page, maker.page());
  if (!sheet.empty()) cells.write(sheet);
  return times;
}

}  // namespace alcove
