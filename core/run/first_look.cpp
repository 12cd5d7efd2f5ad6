// Looks at names, headers, and the pixels of one frame.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/first_look.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/text.h"
#include "core/chain/aov.h"
#include "core/formats/sequence.h"
#include "core/frame/radius.h"
#include "core/frame/settle.h"
#include "core/options/options.h"
#include "core/run/frame_files.h"
#include "core/run/memory.h"
#include "core/run/resume.h"

namespace alcove {
namespace {

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// The note on the numbers between the frames on the disk that have no file.
Notes notes_on_holes(const FramePlan& plan, const Settings& settings) {
  if (plan.holes().empty() || settings.frames.missing == Missing::skip) return {};
  return {{NoteCode::sequence_hole,
           fmt::format("{} between the frames on the disk: {} missing; --frames says which frames there are, --set "
                       "missing=skip that some may be missing",
                       plan.holes().size() == 1 ? "there is a hole" : "there are holes",
                       frames_text(plan.holes()) + (plan.holes().size() == 1 ? " is" : " are"))}};
}

/// The note on frames that others do without.
Notes notes_on_missing_around(const FramePlan& plan) {
  const std::vector<int> missing = plan.missing_around();
  if (missing.empty()) return {};
  return {{NoteCode::sequence_hole,
           fmt::format("{} of the shot {} missing: {}; those around do without, and their headers say so "
                       "(--set missing=skip)",
                       missing.size() == 1 ? "a frame" : "frames", missing.size() == 1 ? "is" : "are",
                       frames_text(missing))}};
}

/// Why the channels of the first frame are not found, whatever its camera; nothing where they are.
std::optional<Error> unfound_in(const FramePlan& plan) {
  if (plan.evidence().empty()) return std::nullopt;
  try {
    find_frame(with_some_camera(plan.at(plan.evidence().front()).input), false, plan.evidence().front());
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// The radius that is proposed for the first frame that shows a surface, and why others could not be looked at.
std::optional<double> radius_for(const FramePlan& plan, bool has_camera, std::optional<Error>& error) {
  for (const int frame : plan.evidence()) {
    try {
      const InputSettings given = plan.at(frame).input, settings = has_camera ? given : with_some_camera(given);
      FrameSource source = find_frame(settings, false, frame);
      source.open.camera = !has_camera;
      settle_by_rows(source, settings);
      if (const auto radius = proposed_radius(source.reading.camera, source.evidence->median_depth)) return radius;
    } catch (const Error& failure) {
      if (!error) error = failure;
    }
  }
  return std::nullopt;
}

/// Whether an option or the header of the first frame gives a camera. A plan without frames, of a chunk of nothing,
/// needs none.
bool has_camera(const FramePlan& plan) {
  if (plan.evidence().empty()) return true;
  const Settings first = plan.at(plan.evidence().front());
  return names_a_camera(first.input) || may_tell_camera(first.input);
}

}  // namespace

std::optional<FrameSource> settle_first(const FramePlan& plan, std::uint64_t most_bytes) {
  std::optional<FrameSource> best;
  bool is_refused = false;
  for (const int frame : plan.evidence()) {
    try {
      const Settings settings = plan.at(frame);
      FrameSource source = open_frame(settings, frame);
      settle_by_rows(source, settings.input, most_bytes);
      if (!best || source.evidence->tells) best = std::move(source);
      if (best->evidence->tells) break;
    } catch (const Error&) {
      // The frame is computed like all others, and its report says then what is wrong with it.
      is_refused = true;
    }
  }
  // A frame that shows nothing, such as one of sky, must not have others read that are refused by themselves.
  if (is_refused && best && !best->evidence->tells) return std::nullopt;
  if (best)
    for (auto& file : best->files) file.close();
  return best;
}

Notes notes_on_number(const FramePlan& plan, const Settings& settings) {
  const std::string& camera = settings.input.camera;
  if (plan.is_sequence() || camera.empty() || !lists_frames(camera)) return {};
  const std::string& input = main_input(settings.input);
  const FrameNumber found = frame_number_in(input);
  if (!found.number)
    fail(ErrorKind::usage,
         "{}: it lists cameras by frame, and {} has no clear frame number{}: say which frame it is with --frames "
         "NUMBER",
         camera, file_name(input), found.doubt.empty() ? "" : fmt::format(" ({})", found.doubt));
  try {
    require_listed(camera, *found.number);
  } catch (const Error& error) {
    fail(error.kind(), "{}; that it is frame {} say the digits {} of the name {}, and --frames says another",
         error.what(), *found.number, found.digits, file_name(input));
  }
  return {{NoteCode::frame_number,
           fmt::format("the camera is that of frame {} in {}, by the digits {} of the name; --frames says another",
                       *found.number, file_name(camera), found.digits)}};
}

Notes notes_on_names(const FramePlan& plan, const Settings& settings) {
  Notes notes = notes_on_holes(plan, settings);
  refuse_warnings(notes, settings, main_input(settings.input));
  // The settings say that frames may be missing, so that this is never an error.
  add_new(notes, notes_on_missing_around(plan));
  add_new(notes, notes_on_number(plan, settings));
  return notes;
}

Settings with_proposed_radius(const Settings& settings, Notes& notes) {
  if (!settings.estimator.radius_auto) return settings;
  const FramePlan plan(settings);
  notes_on_number(plan, settings);  // which fails before a camera is taken of which nothing tells
  std::optional<Error> error;
  const auto radius = radius_for(plan, true, error);
  if (!radius && error) throw *error;
  if (!radius)
    fail(ErrorKind::input, "{}: --radius auto finds no surface in {}: give --radius NUMBER, in scene units",
         main_input(settings.input), plan.is_sequence() ? "frames " + frames_text(plan.evidence()) : "the frame");
  Settings known = settings;
  known.estimator.radius = radius;
  known.estimator.radius_auto = false;
  notes.push_back({NoteCode::automatic_radius,
                   fmt::format("--radius auto takes {}{}", *radius, plan.is_sequence() ? " for all frames" : "")});
  return known;
}

Lacking lacking_in(const Settings& settings) {
  Lacking lacking;
  lacking.input = main_input(settings.input).empty();
  lacking.output = settings.output.output.empty();
  lacking.radius = !settings.estimator.radius && !settings.estimator.radius_auto && needs_ao(settings.output);
  lacking.camera = lacking.input && !names_a_camera(settings.input);
  const bool needs_frame = lacking.radius || !names_a_camera(settings.input);
  if (lacking.input || !(needs_frame || lacking.output)) return lacking;
  try {
    const FramePlan plan(settings);
    notes_on_number(plan, settings);  // or the command that is proposed would be refused
    if (!needs_frame) return lacking;
    lacking.camera = !has_camera(plan);
    if (lacking.camera) lacking.unfound = unfound_in(plan);
    if (lacking.radius) lacking.proposed_radius = radius_for(plan, !lacking.camera, lacking.unreadable);
  } catch (const Error& error) {
    // A name that no command could have comes first, since it would be a part of the one that is proposed.
    if (error.kind() == ErrorKind::usage) throw;
    lacking.unreadable = error;
  }
  return lacking;
}

std::vector<std::string> sentences_on(const Lacking& lacking) {
  std::vector<std::string> sentences;
  if (lacking.input)
    sentences.emplace_back("INPUT, an EXR with depth and normals, or --depth FILE, or --position FILE");
  if (lacking.output) sentences.emplace_back("-o FILE.exr, the AO");
  if (lacking.camera) sentences.push_back(fmt::format("a camera: {}", kCameraOptions));
  if (lacking.unfound) sentences.emplace_back(lacking.unfound->what());
  if (lacking.radius)
    sentences.emplace_back("--radius NUMBER, how far occluders reach in scene units, or --radius auto");
  if (lacking.unreadable) sentences.push_back(fmt::format("a frame to look at: {}", lacking.unreadable->what()));
  return sentences;
}

// What a run would do, for people.

namespace {

/// "shot.1001.exr" of one frame, "shot.1001.exr to shot.1100.exr" of several.
std::string span_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + " to " + last;
}

}  // namespace

std::string plan_text(const Settings& given) {
  check_settings(given);
  Notes notes;
  const Settings settings = with_proposed_radius(given, notes);
  const FramePlan plan(settings);
  add_new(notes, notes_on_names(plan, settings));
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += printable(fmt::format("{:<14}{}", name, value)) + "\n";
  };
  line("frames",
       plan.frames().empty() ? "none" : fmt::format("{}: {}", plan.frames().size(), frames_text(plan.frames())));
  if (!plan.missing().empty())
    line("missing", fmt::format("{}: {}, left out", plan.missing().size(), frames_text(plan.missing())));
  for (const auto& note : notes) line(level_of(note), line_of(note, ""));
  if (plan.frames().empty()) return text;
  Settings first = plan.at(plan.frames().front()), last = plan.at(plan.frames().back());
  require_endings(first.output);
  for (const auto& path : named_paths())
    if (!path.of(first).empty()) line(path.option, span_text(path.of(first), path.of(last)));

  FrameSource source = open_frame(first, plan.frames().front());
  // Frames of a sequence are read as one of them that shows enough.
  if (!plan.is_sequence()) settle_by_rows(source, first.input, memory_of_host(first.device).host_bytes);
  std::vector<std::string> channels;
  for (const auto& plane : source.channels.planes.entries)
    for (const auto& channel : plane) channels.push_back(channel.channel);
  line("channels", fmt::format("{}", fmt::join(channels, ", ")));
  line("camera",
       fmt::format("{}, {:.6g} x {:.6g} px {}", source.reading.camera.orthographic ? "orthographic" : "perspective",
                   source.reading.camera.fx, source.reading.camera.fy,
                   source.reading.camera.orthographic ? "per scene unit" : "focal length"));
  const FrameMemory frame = memory_with_others(plan, source, first);
  const std::uint64_t bytes = frame.of(source.reading.data).host;
  const auto wanted = frames_to_compute(plan, settings);
  require_room_for_others(memory_of_host(first.device), plan, source, first, wanted);
  const RunMemory run = beside_shot(memory_of_host(first.device), plan, source, first, wanted, 1);
  const std::uint64_t memory = run.host_bytes;
  line("size", to_string(written_picture(source)));
  const std::string at_once =
      bytes > memory ? "in tiles" : fmt::format("up to {} at once", frames_in(run, frame, source.reading.data));
  line("memory", fmt::format("{} MiB per frame, {} MiB for frames: {}", bytes >> 20, memory >> 20, at_once));
  if (around_of(first.input) > 0)
    line("around",
         fmt::format("up to {} of the {} frames of the shot: {} MiB of prepared frames for each at once, beside "
                     "what it takes itself",
                     most_others(plan, source, first.input), plan.shot().size(),
                     bytes_of_shot(plan, source, first.input, 1) >> 20));
  if (first.input.accumulate > 0)
    line("accumulate",
         fmt::format("up to {} of the {} frames of the shot: {} MiB of estimates for each at once, beside "
                     "what it takes itself",
                     std::min(plan.shot().size(), std::size_t(plan.turns())), plan.shot().size(),
                     bytes_of_estimates(plan, source, first, wanted, 1) >> 20));
  if (wanted.size() < plan.frames().size())
    line("kept", fmt::format("{}: whole, by an earlier run", plan.frames().size() - wanted.size()));
  return text;
}

}  // namespace alcove
