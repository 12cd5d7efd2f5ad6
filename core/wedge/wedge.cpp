// Runs each look on planes that are read once, and takes its results as pictures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/wedge/wedge.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/chain/compute.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/outputs.h"
#include "core/formats/sheet.h"
#include "core/frame/raw_plane.h"
#include "core/measure/report.h"
#include "core/options/options.h"
#include "core/run/frame_run.h"
#include "core/run/memory.h"
#include "core/run/run_preview.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

std::string url_of(const ShownPicture& picture) {
  return picture_url(picture.width, picture.height, picture.channels, picture.pixels);
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

/// The values that a run takes of its estimate, but for what shapes the visibility: looks with the same share one.
std::string estimate_of(Settings settings) {
  EstimatorSettings& estimator = settings.estimator;
  const EstimatorSettings plain;
  estimator.intensity = plain.intensity;
  estimator.power = plain.power;
  estimator.least = plain.least;
  estimator.fade_start = plain.fade_start;
  estimator.fade_end = plain.fade_end;
  estimator.sun_azimuth = estimator.sun_elevation = {};
  settings.output.look = {};
  std::string text;
  for (const auto& row : option_table())
    if (row.words) text += fmt::format("{} {}\n", row.name, fmt::join(row.words(settings), "\n"));
  return text;
}

/// Looks by their numbers, those together that have one estimate.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<WedgeLook>& looks) {
  std::map<std::string, std::size_t> known;
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < looks.size(); i++) {
    const auto [group, is_new] = known.emplace(estimate_of(looks[i].settings), groups.size());
    if (is_new) groups.emplace_back();
    groups[group->second].push_back(i);
  }
  return groups;
}

/// The settings of a look that is computed for a page, which also takes its depth.
Settings with_planes_of_page(Settings settings) {
  settings.output.aovs = "ao,depth";
  if (!shows_lights(settings)) settings.output.lights.clear();  // which a preset may name
  return settings;
}

/// The looks of one frame after the other.
class WedgeMaker {
 public:
  WedgeMaker(std::vector<WedgeLook>& looks, bool has_page) : looks_(looks), has_page_(has_page) {
    for (auto& look : looks_) {
      firsts_.emplace_back(with_planes_of_page(look.settings));
      add_new(look.notes, firsts_.back().prepare());
    }
    memory_ = memory_for_frames(plan().settings(), lanes_.device().info());
    set_exr_threads(core_count());
    set_exr_memory(memory_.bytes / kCodecPart);
  }

  std::size_t frames() { return plan().frames().size(); }

  /// `sheet` may be null.
  void make(Sheet* sheet) {
    settled_ = firsts_.front().settle(memory_.bytes);
    for (const int frame : plan().frames()) {
      const std::string file = std::filesystem::path(main_input(looks_.front().settings.input)).filename().string();
      planes_ = {};
      frames_.push_back({{"name", plan().is_sequence() ? std::to_string(frame) : file}, {"scale", nullptr}});
      std::vector<PageCell> cells(looks_.size());
      for (const auto& group : groups_) make_group(group, frame, cells, sheet);
      first_cell_ += looks_.size();
      for (const auto& [row, image] : cells) {
        if (!row.is_null()) rows_.push_back(row);
        if (!image.is_null()) images_.push_back(image);
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
  /// What the page has of a look of a frame; null: the look has failed, or there is no page.
  struct PageCell {
    Json row, image;
  };

  const FramePlan& plan() { return firsts_.front().plan(); }

  /// An image of the page and of this frame, whose picture has that name.
  Json image_of(const std::string& candidate, const ShownPicture& picture, const char* name) const {
    return {{"frame", frames_.back()["name"]},
            {"candidate", candidate},
            {"width", picture.width},
            {"height", picture.height},
            {name, url_of(picture)}};
  }

  /// Computes the looks of one estimate, unless they have failed in a frame before.
  void make_group(const std::vector<std::size_t>& group, int frame, std::vector<PageCell>& cells, Sheet* sheet) {
    if (!looks_[group.front()].error) run_group(group, frame, cells, sheet);
    for (const std::size_t look : group) {
      if (!looks_[look].error) continue;
      cells[look] = {};
      if (sheet) sheet->put(first_cell_ + look, label_of(look, frame, "failed"), {});
    }
  }

  void run_group(const std::vector<std::size_t>& group, int frame, std::vector<PageCell>& cells, Sheet* sheet) {
    RunPreview& first = firsts_[group.front()];
    const FramePlan& frames = first.plan();
    const FrameSource* const like = settled_ ? &*settled_ : nullptr;
    const InputSettings& input = frames.settings().input;
    const bool takes_means = input.accumulate > 0;
    std::optional<SharedFrames> shot;
    if (takes_means || takes_others(input)) shot.emplace(frames, like, std::span(&frame, 1));
    InputIdentities identities(frames);
    RunContext run{first, frames, identities, like, nullptr, shot ? &*shot : nullptr, takes_means, {}};
    run.planes = &planes_;
    for (const std::size_t look : group) {
      run.looks.push_back(firsts_[look].plan().at(frame));
      // The driver compiles a kernel at its first use, which is no part of the look's time.
      gpu::Recorder small(lanes_.device());
      record_small_frame(small, run.looks.back().estimator, run.looks.back().output);
      small.run();
    }
    std::vector<double> ms(group.size());
    run.take_look = [&](std::size_t i, FrameSource& source, const Window& window, const FrameOutputs& outputs,
                        const LookTime& time) {
      ms[i] = time.estimate_ms + time.own_ms;
      const std::vector<ShownPicture> shown = pictures_of(source, window, outputs, run.looks[i]);
      put_into_page(looks_[group[i]], shown, cells[group[i]]);
      cells[group[i]].row["ms"] = ms[i];
      cells[group[i]].row["estimate_ms"] = time.estimate_ms;
      const std::string label = label_of(group[i], frame, fmt::format("{:.0f} ms", ms[i]));
      if (sheet) sheet->put(first_cell_ + group[i], label, shown);
    };
    const auto take = [&](FrameReport&& report) {
      for (std::size_t i = 0; i < group.size(); i++) {
        WedgeLook& look = looks_[group[i]];
        look.ms += report.error ? 0 : ms[i];
        look.error = report.error;
        add_new(look.notes, report.notes);
      }
    };
    run_pipeline(lanes_, run, memory_, std::span(&frame, 1), take, {});
  }

  /// The AO, or the shadow of the sun that looks turn, and the composite, if there is one.
  std::vector<ShownPicture> pictures_of(FrameSource& source, const Window& window, const FrameOutputs& outputs,
                                        const Settings& look) {
    const OutputSettings& output = look.output;
    std::vector<ShownPicture> shown{turns_sun(look.estimator)
                                        ? shown_plane(source, window, *outputs.shadow, output.read_lights->sun)
                                        : shown_plane(source, window, *outputs.ao)};
    Json& scale = frames_.back()["scale"];
    if (has_page_ && scale.is_null()) scale = scale_of(source.reading, shown_plane(source, window, *outputs.depth));
    if (!outputs.composite) return shown;
    const DisplayTransform transform(output.ocio, output.display, output.view_transform);
    shown.push_back(shown_colors(source, window, outputs.composite, &transform));
    if (has_page_ && !beauty_.width) beauty_ = shown_colors(source, window, nullptr, &transform);
    return shown;
  }

  void put_into_page(const WedgeLook& look, const std::vector<ShownPicture>& shown, PageCell& cell) const {
    cell.row = {{"frame", frames_.back()["name"]}, {"candidate", look.name}};
    if (!has_page_) return;
    cell.image = image_of(look.name, shown[0], "result");
    if (shown.size() > 1) cell.image["composite"] = url_of(shown[1]);
  }

  std::string label_of(std::size_t look, int frame, const std::string& end) {
    const std::string number = plan().is_sequence() ? fmt::format("{}  ", frame) : "";
    return fmt::format("{}{}  {}", number, looks_[look].name, end);
  }

  std::vector<WedgeLook>& looks_;
  const bool has_page_;
  const DeviceSettings& device_ = looks_.front().settings.device;
  Lanes lanes_{{device_.device, device_.require_gpu, device_.validate}, 1};
  const std::vector<std::vector<std::size_t>> groups_ = groups_of(looks_);
  std::deque<RunPreview> firsts_;  // of each look
  MemoryBudget memory_;
  std::optional<FrameSource> settled_;  // as which all are read
  ReadPlanes planes_;                   // of the frame
  std::size_t first_cell_ = 0;          // of the sheet, of the frame
  ShownPicture beauty_;                 // of the frame, where there are composites
  Json rows_ = Json::array(), images_ = Json::array(), frames_ = Json::array();
};

}  // namespace

bool shows_lights(const Settings& settings) {
  return turns_sun(settings.estimator) || !settings.input.shadow_layers.empty();
}

void make_wedge(std::vector<WedgeLook>& looks, const std::string& page, const std::string& sheet) {
  WedgeMaker maker(looks, !page.empty());
  std::set<std::optional<double>> radii;
  for (const auto& look : looks) radii.insert(look.settings.estimator.radius);
  const bool has_rows = radii.size() > 1 && radii.size() < looks.size();
  Sheet cells(maker.frames() * looks.size(), has_rows ? radii.size() : 0);
  maker.make(sheet.empty() ? nullptr : &cells);
  if (!page.empty()) write_whole(page, maker.page());
  if (!sheet.empty()) cells.write(sheet);
}

std::string wedge_text(const std::vector<WedgeLook>& looks) {
  const std::size_t estimates = groups_of(looks).size();
  const InputSettings& input = looks.front().settings.input;
  const bool takes_from_others = input.accumulate > 0 || takes_others(input);
  std::string text;
  for (const auto& look : looks) try {
      RunPreview preview(with_planes_of_page(look.settings));
      const std::string of_look = plan_text(preview, true);
      if (text.empty()) text = of_look;
    } catch (const Error& error) {
      if (text.empty()) throw;
      fail(error.kind(), "look {}: {}", look.name, error.what());
    }
  text += fmt::format(
      "{:<14}{} of each frame, by {}{}\n", "looks", looks.size(), counted(std::size_t(estimates), "estimate"),
      takes_from_others && estimates > 1 ? ", each with its own pass over the neighbouring frames" : "");
  for (const auto& look : looks) text += fmt::format("{:<14}{}\n", "", printable(look.name));
  return text;
}

}  // namespace alcove
