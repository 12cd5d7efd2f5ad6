// JSON and the summary.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/run_report.h"

#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

#include "core/base/system.h"
#include "core/base/text.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Notes& notes) {
  Json json = Json::array();
  for (const auto& note : notes)
    json.push_back({{"code", facts_of(note.code).name}, {"level", level_of(note)}, {"text", note.text}});
  return json;
}

Json json_of(const FrameReport& frame) {
  Json passes = Json::array();
  for (const auto& pass : frame.passes)
    passes.push_back(
        {{"name", pass.name}, {"ms", pass.ms}, {"bytes_read", pass.bytes_read}, {"bytes_written", pass.bytes_written}});
  Json json = {
      {"frame", frame.frame},
      {"state", name_of(frame.state)},
      {"input", frame.input},
      {"output", frame.output},
      {"ms",
       {{"read", frame.read_ms}, {"compute", frame.compute_ms}, {"write", frame.write_ms}, {"total", frame.total_ms}}},
      {"passes", passes},
      {"pixels", frame.pixels},
      {"sky_pixels", frame.sky_pixels},
      {"rows_read", frame.rows_read},
      {"parts", frame.parts},
      {"tiles",
       {{"total", frame.tiles.sky + frame.tiles.kept + frame.tiles.computed},
        {"sky", frame.tiles.sky},
        {"proved", 0},  // stays for readers of version 1
        {"kept", frame.tiles.kept},
        {"computed", frame.tiles.computed}}},
      {"samples_per_pixel", frame.samples_per_pixel},
      {"repaired_pixels", frame.repaired_pixels},
      {"notes", json_of(frame.notes)}};
  if (!frame.search.empty()) json["search"] = frame.search;
  if (frame.estimates) {
    Json estimates = {{"total", std::accumulate(frame.estimates->begin(), frame.estimates->end(), 0ull)}};
    for (std::size_t k = 0; k < kLattices; k++) estimates[fmt::format("one_of_{}", 16 >> k)] = (*frame.estimates)[k];
    json["estimates"] = estimates;
  }
  if (frame.hidden) json["hidden"] = {{"surfaces", frame.hidden->surfaces}, {"dropped", frame.hidden->dropped}};
  if (frame.frames_around) {
    json["frames_around"] = *frame.frames_around;
    json["moved"] = frame.moved;
    json["unconfirmed"] = frame.unconfirmed;
  }
  if (frame.accumulated > 0) json["frames_per_pixel"] = frame.accumulated / double(frame.pixels);
  if (frame.error_pixels > 0) json["error_estimate"] = std::sqrt(frame.error_squares / frame.error_pixels);
  if (frame.occlusion) json["completed"] = frame.occlusion->completed_share();
  if (frame.error) json["error"] = frame.error->what();
  return json;
}

double peak_memory_mib() { return double(peak_memory_bytes()) / (1 << 20); }

}  // namespace

const char* name_of(FrameState state) {
  switch (state) {
    case FrameState::done: return "done";
    case FrameState::failed: return "failed";
    case FrameState::kept: return "kept";
    case FrameState::dropped: break;
  }
  return "dropped";
}

std::string stats_json(const RunReport& report) {
  Json frames = Json::array();
  for (const auto& frame : report.frames) frames.push_back(json_of(frame));
  const Json totals = {{"frames", report.done + report.failed + report.kept},
                       {"failed", report.failed},
                       {"warned", report.warned},
                       {"kept", report.kept},
                       {"dropped", report.dropped},
                       {"missing", report.missing},
                       {"at_once", report.at_once},
                       {"wall_s", report.wall_s},
                       {"cpu_s", cpu_seconds()},
                       {"peak_rss_mb", peak_memory_mib()}};
  const Json json = {{"device", report.device},        {"options", report.options}, {"presets", report.presets},
                     {"notes", json_of(report.notes)}, {"frames", frames},          {"totals", totals}};
  return json_text(json, 1) + "\n";
}

std::string frame_json(const FrameReport& frame) { return json_text(json_of(frame)); }

std::string notes_json(const Notes& notes) { return json_text(json_of(notes)); }

std::string summary_of(const RunReport& report) {
  std::string text = counted(std::size_t(report.done), "frame") + " done";
  if (report.kept) text += fmt::format(", {} kept", report.kept);
  if (!report.missing.empty())
    text += fmt::format(", {} missing ({})", report.missing.size(), frames_text(report.missing));
  if (report.failed) text += fmt::format(", {} failed ({})", report.failed, frames_text(report.failed_frames));
  if (report.warned) text += fmt::format(", {} with warnings", report.warned);
  if (report.dropped) text += fmt::format(", {} not begun or dropped", report.dropped);
  text += fmt::format(", in {:.1f} s", report.wall_s);
  if (!report.device.empty()) text += fmt::format(" on {}, {} at once", report.device, report.at_once);
  return text + fmt::format(", peak memory {:.0f} MiB", peak_memory_mib());
}

}  // namespace alcove
