// Runs each look on planes that are read once, and takes its results as pictures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/wedge/wedge.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/warm_up.h"
#include "core/formats/sheet.h"
#include "core/frame/raw_plane.h"
#include "core/measure/report.h"
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

/// The looks of one frame after the other.
class WedgeMaker {
 public:
  WedgeMaker(std::vector<WedgeLook>& looks, bool has_page) : looks_(looks), has_page_(has_page) {
    for (auto& look : looks_) {
      Settings settings = look.settings;
      settings.output.aovs = "ao,depth";
      firsts_.emplace_back(settings);
      add_new(look.notes, firsts_.back().prepare());
    }
    set_exr_threads(core_count());
    set_exr_memory(memory_.host_bytes / kCodecPart);
  }

  std::size_t frames() { return plan().frames().size(); }

  /// `sheet` may be null.
  void make(Sheet* sheet) {
    settled_ = firsts_.front().settle(memory_.host_bytes);
    for (const int frame : plan().frames()) {
      const std::string file = std::filesystem::path(main_input(looks_.front().settings.input)).filename().string();
      planes_ = {};
      frames_.push_back({{"name", plan().is_sequence() ? std::to_string(frame) : file}, {"scale", nullptr}});
      for (std::size_t i = 0; i < looks_.size(); i++, cell_++) {
        const auto shown = looks_[i].error ? std::vector<ShownPicture>() : make_look(looks_[i], firsts_[i], frame);
        if (!sheet) continue;
        const std::string number = plan().is_sequence() ? fmt::format("{}  ", frame) : "";
        const std::string end = looks_[i].error ? "failed" : fmt::format("{:.0f} ms", rows_.back()["ms"].get<double>());
        sheet->put(cell_, fmt::format("{}{}  {}", number, looks_[i].name, end), shown);
      }
      if (beauty_.width) images_.push_back(image_of("beauty", beauty_, "beauty"));
      beauty_ = {};
    }
    if (rows_.empty()) throw *looks_.front().error;
  }

  std::string page() {
    Json candidates = Json::array();
    for (const auto& look : looks_) {
      Json notes = Json::array();
      for (const auto& note : look.notes) notes.push_back(fmt::format("{}: {}", level_of(note), note.text));
      candidates.push_back({{"name", look.name},
                            {"settings", look.command},
                            {"radius", radii_of(look.settings.estimator).back()},
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
  const FramePlan& plan() { return firsts_.front().plan(); }

  /// An image of the page and of this frame, whose picture has that name.
  Json image_of(const std::string& candidate, const ShownPicture& picture, const char* name) const {
    return {{"frame", frames_.back()["name"]},
            {"candidate", candidate},
            {"width", picture.width},
            {"height", picture.height},
            {name, url_of(picture)}};
  }

  /// Gives the AO and the composite, if there is one; nothing where the look fails.
  std::vector<ShownPicture> make_look(WedgeLook& look, FirstLook& first, int frame) {
    const FramePlan& frames = first.plan();
    const FrameSource* const like = settled_ ? &*settled_ : nullptr;
    const InputSettings& input = frames.settings().input;
    const bool takes_means = input.accumulate > 0;
    std::optional<SharedFrames> shot;
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
      const OutputSettings& output = look.settings.output;
      shown.push_back(shown_plane(source, window, *outputs.ao));
      if (outputs.composite) {
        const DisplayTransform transform(output.ocio, output.display, output.view_transform);
        shown.push_back(shown_colors(source, window, outputs.composite, &transform));
        if (has_page_ && !beauty_.width) beauty_ = shown_colors(source, window, nullptr, &transform);
      }
      Json& scale = frames_.back()["scale"];
      if (has_page_ && scale.is_null()) scale = scale_of(source.reading, shown_plane(source, window, *outputs.depth));
    };
    const auto take = [&](FrameReport&& report) {
      look.ms += report.compute_ms;
      look.error = report.error;
      add_new(look.notes, report.notes);
      if (report.error) return;
      rows_.push_back({{"frame", frames_.back()["name"]}, {"candidate", look.name}, {"ms", report.compute_ms}});
      if (!has_page_) return;
      images_.push_back(image_of(look.name, shown[0], "result"));
      if (shown.size() > 1) images_.back()["composite"] = url_of(shown[1]);
    };
    run_pipeline(lanes_, run, room_of_lane(memory_, 1, lanes_.device().info()), std::span(&frame, 1), take, {});
    return shown;
  }

  std::vector<WedgeLook>& looks_;
  const bool has_page_;
  const DeviceSettings& device_ = looks_.front().settings.device;
  Lanes lanes_{{device_.device, device_.require_gpu, device_.validate, !device_.no_pipeline_cache}, 1};
  const RunMemory memory_ = memory_for_frames(looks_.front().settings, lanes_.device().info());
  std::deque<FirstLook> firsts_;        // of each look
  std::optional<FrameSource> settled_;  // as which all are read
  ReadPlanes planes_;                   // of the frame
  std::size_t cell_ = 0;                // of the sheet
  ShownPicture beauty_;                 // of the frame, where there are composites
  Json rows_ = Json::array(), images_ = Json::array(), frames_ = Json::array();
};

}  // namespace

void make_wedge(std::vector<WedgeLook>& looks, const std::string& page, const std::string& sheet) {
  WedgeMaker maker(looks, !page.empty());
  std::set<std::optional<double>> radii;
  for (const auto& look : looks) radii.insert(look.settings.estimator.radius);
  Sheet cells(maker.frames() * looks.size(), radii.size() < looks.size() ? radii.size() : 0);
  maker.make(sheet.empty() ? nullptr : &cells);
  if (!page.empty()) write_whole(page, maker.page());
  if (!sheet.empty()) cells.write(sheet);
}

}  // namespace alcove
