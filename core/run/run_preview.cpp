// Finds a run's frames, opens the first of them where that is needed, and describes the run.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/run_preview.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/outputs.h"
#include "core/formats/color.h"
#include "core/formats/sequence.h"
#include "core/frame/pixels/radius.h"
#include "core/frame/settle/settle.h"
#include "core/options/options.h"
#include "core/run/frame_files.h"
#include "core/run/memory.h"
#include "core/run/resume.h"
#include "core/run/run_files.h"
#include "core/run/tiles.h"

namespace alcove {
namespace {

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// The note on the numbers between the frames on the disk that have no file.
Notes notes_on_holes(const FramePlan& plan) {
  if (plan.holes().empty() || plan.settings().frames.missing == Missing::skip) return {};
  return {
      {NoteCode::sequence_hole,
       fmt::format(
           "{} between the frames on the disk: {} missing; --frames lists the frames, --set missing=skip accepts gaps",
           plan.holes().size() == 1 ? "there is a hole" : "there are holes",
           frames_text(plan.holes()) + (plan.holes().size() == 1 ? " is" : " are"))}};
}

/// The note on frames that others do without.
Notes notes_on_missing_around(const FramePlan& plan) {
  const std::vector<int> missing = plan.missing_around();
  if (missing.empty()) return {};
  return {{NoteCode::sequence_hole,
           fmt::format(
               "{} of the shot {} missing: {}; their neighbours do without, as their headers say (--set missing=skip)",
               missing.size() == 1 ? "a frame" : "frames", missing.size() == 1 ? "is" : "are", frames_text(missing))}};
}

/// The note on files of one frame whose names have another frame's number. Peels and cameras are counted otherwise.
Notes notes_on_other_frames(const FramePlan& plan) {
  const Settings& settings = plan.settings();
  const auto number = plan.is_sequence() ? plan.all().front() : frame_number_in(main_input(settings.input)).number;
  if (plan.all().size() != 1 || !number) return {};
  Notes notes;
  for (const auto& row : file_rows()) {
    const bool is_picture = row.group == "Input" || row.name == "INPUT";
    if (!is_picture || !row.is_of_frame || row.key() == "camera") continue;
    for (const auto& [option, path] : row.files(plan.at(*number), FileRole::input))
      if (const FrameNumber other = frame_number_in(path); other.number && other.number != number)
        notes.push_back({NoteCode::other_frame,
                         fmt::format("{} {}: by the digits {} of its name it belongs to frame {}, and the frame is {}",
                                     option, path, other.digits, *other.number, *number)});
  }
  return notes;
}

/// Names tell these: numbers that are left out, frames that others do without, and the number of a single frame.
Notes notes_on_names(const FramePlan& plan) {
  Notes notes = notes_on_holes(plan);
  add_new(notes, notes_on_other_frames(plan));
  refuse_warnings(notes, plan.settings(), main_input(plan.settings().input));
  // The settings say that frames may be missing, so that this is never an error.
  add_new(notes, notes_on_missing_around(plan));
  add_new(notes, notes_on_number(plan));
  return notes;
}

}  // namespace

Notes notes_on_number(const FramePlan& plan) {
  const InputSettings& settings = plan.settings().input;
  const std::string& camera = settings.camera;
  if (plan.is_sequence() || camera.empty() || !lists_frames(camera)) return {};
  const std::string& input = main_input(settings);
  std::error_code none;
  if (!std::filesystem::exists(input, none)) return {};  // opening it says so
  const FrameNumber found = frame_number_in(input);
  if (!found.number)
    fail(ErrorKind::usage,
         "{}: it lists cameras by frame, and {} has no clear frame number{}: give it with --frames NUMBER", camera,
         file_name(input), found.doubt.empty() ? "" : fmt::format(" ({})", found.doubt));
  try {
    require_listed(camera, *found.number);
  } catch (const Error& error) {
    fail(error.kind(), "{}; it is frame {} by the digits {} of the name {}, and --frames chooses another", error.what(),
         *found.number, found.digits, file_name(input));
  }
  return {{NoteCode::frame_number,
           fmt::format("the camera is that of frame {} in {}, by the digits {} of the name; --frames says another",
                       *found.number, file_name(camera), found.digits)}};
}

const FramePlan& RunPreview::plan() {
  if (!plan_) plan_.emplace(settings_);
  return *plan_;
}

FrameSource& RunPreview::opened(int frame) {
  const auto found = opened_.find(frame);
  if (found != opened_.end()) return found->second;
  return opened_.emplace(frame, open_frame(plan().at(frame), frame)).first->second;
}

/// Opens a frame for all that its depth tells, whatever its outputs need.
FrameSource RunPreview::with(const StandIns& stand_ins, int frame) {
  InputSettings input = plan().at(frame).input;
  if (stand_ins.normals) input.normal = "none";
  FrameSource source = find_frame(stand_ins.camera ? with_some_camera(input) : input, false, frame);
  source.open.camera = stand_ins.camera;
  return source;
}

FrameSource RunPreview::open(const Settings& settings, int frame) {
  const auto found = opened_.find(frame);
  if (found == opened_.end()) return open_frame(settings, frame);
  FrameSource source = std::move(found->second);
  opened_.erase(found);
  source.rows_read = 0;  // a look is no part of the frame's reading
  return source;
}

/// Whether an option or the header of the first frame gives a camera. A plan without frames, of a chunk of nothing,
/// needs none.
bool RunPreview::has_camera(std::string& why_not) {
  if (names_a_camera(settings_.input) || plan().evidence().empty()) return true;
  const int frame = plan().evidence().front();
  try {
    opened(frame);
    return true;
  } catch (const NoCamera& error) {
    why_not = error.why;
    return false;
  } catch (const Error&) {
    return may_tell_camera(plan().at(frame).input);
  }
}

/// The radii that a frame tells, of those settings; none where all is sky. Depth and camera alone decide: a fault of
/// the beauty or of an output is found when the frame is computed.
std::vector<double> RunPreview::radii_of(int frame, const EstimatorSettings& estimator, const StandIns& stand_ins) {
  const auto told_by = [&](FrameSource& source) {
    if (!source.evidence) settle_by_rows(source, plan().at(frame).input);
    return radii_by_depth(estimator, source.reading.camera, source.evidence->median_depth);
  };
  if (!stand_ins.any()) try {
      return told_by(opened(frame));
    } catch (const Error&) {
      opened_.erase(frame);  // which may be settled in part
    }
  FrameSource source = with(stand_ins, frame);
  return told_by(source);
}

RunPreview::DepthRadii RunPreview::radii_of_first(const EstimatorSettings& estimator, const StandIns& stand_ins) {
  DepthRadii found;
  for (const int frame : plan().evidence()) {
    try {
      found.radii = radii_of(frame, estimator, stand_ins);
      if (!found.radii.empty()) return found;
    } catch (const Error& failure) {
      if (dynamic_cast<const NoWorldToCamera*>(&failure)) found.lacks_matrix = true;
      if (!found.error) found.error = failure;
    }
  }
  return found;
}

/// Opens the first frame for what its channels need of a camera.
void RunPreview::look_at_first(MissingOptions& missing) {
  if (plan().evidence().empty()) return;
  const int frame = plan().evidence().front();
  try {
    const FrameSource source = missing.camera ? with({.camera = true}, frame) : open_frame(plan().at(frame), frame);
    missing.turns_normals = missing.camera && expects_world_normals(source, settings_.input);
  } catch (const NoWorldToCamera&) {
    missing.lacks_matrix = true;
  } catch (const Error& error) {
    if (missing.camera) missing.no_channels = error;
  }
}

/// Finds the radius that is proposed where none is given.
void RunPreview::propose_radius(MissingOptions& missing) {
  EstimatorSettings automatic;
  automatic.radius_auto = true;
  DepthRadii found = radii_of_first(automatic, {missing.camera, missing.lacks_matrix});
  if (found.lacks_matrix) {  // by the pixels
    missing.lacks_matrix = true;
    found = radii_of_first(automatic, {missing.camera, missing.lacks_matrix});
  }
  missing.unreadable = found.error;
  if (!found.radii.empty()) missing.proposed_radius = found.radii.front();
}

MissingOptions RunPreview::missing_options() {
  MissingOptions missing;
  const bool has_option = names_a_camera(settings_.input);
  missing.input = main_input(settings_.input).empty();
  missing.output = settings_.output.output.empty();
  missing.radius = !settings_.estimator.radius && !settings_.estimator.radius_auto && needs_radius(settings_.output);
  missing.camera = missing.input && !has_option;
  if (missing.input || !(missing.radius || missing.output || !has_option)) return missing;
  try {
    notes_on_number(plan());  // or the command that is proposed would be refused
    missing.camera = !has_camera(missing.no_camera);
    look_at_first(missing);
    if (missing.radius) propose_radius(missing);
  } catch (const Error& error) {
    // A name that no command could have comes first, since it would be a part of the one that is proposed.
    std::error_code none;
    if (error.kind() == ErrorKind::usage || std::filesystem::is_directory(main_input(settings_.input), none)) throw;
    missing.unreadable = error;
  }
  return missing;
}

std::vector<std::string> MissingOptions::sentences() const {
  std::vector<std::string> sentences;
  if (input) sentences.emplace_back("INPUT, an EXR with depth and normals, or --depth FILE, or --position FILE");
  if (output) sentences.emplace_back("-o FILE.exr, the AO");
  const std::string why = no_camera.empty() ? "" : no_camera + "; ";
  if (camera) sentences.push_back("a camera: " + why + (turns_normals ? kWorldCameraOptions : kCameraOptions));
  if (lacks_matrix)
    sentences.emplace_back(
        "world_to_camera, for normals in world space: --camera FILE.json with it, or --normal none to reconstruct "
        "normals from depth");
  if (no_channels) sentences.emplace_back(no_channels->what());
  if (radius) sentences.emplace_back("--radius NUMBER, how far occluders reach in scene units, or --radius auto");
  const bool is_said = unreadable && no_channels && std::string(unreadable->what()) == no_channels->what();
  if (unreadable && !is_said) sentences.push_back(fmt::format("a frame to look at: {}", unreadable->what()));
  return sentences;
}

void RunPreview::take_radii_of_depth(Notes& notes) {
  const FramePlan& frames = plan();
  notes_on_number(frames);  // fails early if the frame number is ambiguous
  const auto& [radii, error, lacks_matrix] = radii_of_first(settings_.estimator, {});
  if (radii.empty() && error) throw *error;
  const EstimatorSettings& said = settings_.estimator;
  const std::string option = said.radius_auto ? "--radius auto" : fmt::format("--radius {:.4g}%", 100 * *said.radius);
  if (radii.empty())
    fail(ErrorKind::input, "{}: {} finds no surface in {}: give --radius NUMBER, in scene units",
         main_input(settings_.input), option,
         frames.is_sequence() ? "frames " + frames_text(frames.evidence()) : "the frame");
  plan_->set_radii(radii);
  notes.push_back(
      {NoteCode::automatic_radius,
       fmt::format("{} takes {}{}{}", option, fmt::join(radii, " "),
                   said.radius_auto ? "" : fmt::format(", of a median depth of {:.4g}", radii.front() / *said.radius),
                   frames.is_sequence() ? " for all frames" : "")});
}

void RunPreview::take_lights(Notes& notes) {
  refuse_overwriting(plan());  // which says more than that an output is no lights file
  const auto lights = read_lights(settings_.output.lights, settings_.estimator);
  lights->require_frames(plan().frames());
  std::vector<std::string> names;
  for (const auto& light : lights->lights) names.push_back(light.name);
  for (const auto& [name, layer] : shadow_layers_of(settings_.input))
    if (std::ranges::find(names, name) == names.end())
      fail(ErrorKind::usage, "--set shadow-layers={}:{}: {} has no light \"{}\"{}", name, layer, lights->path, name,
           suggestion(name, names));
  for (const auto& name : lights->below_horizon(plan().frames())) {
    const bool is_turned = lights->elevation && name == lights->lights[lights->sun].name;
    notes.push_back(
        {NoteCode::dark_light,
         is_turned ? fmt::format("the sun \"{}\" is below the horizon, by --set sun-elevation", name)
                   : fmt::format("the sun \"{}\" is below the horizon: \"direction\" is the way to it, and \"up\" "
                                 "the world's, {} (--lights)",
                                 name, lights->is_y_up ? "y" : "z"),
         lights->path});
  }
  plan_->set_lights(lights);
  require_distinct_channels(plan().settings());
}

Notes RunPreview::prepare() {
  check_settings(settings_);
  Notes notes;
  if (!settings_.output.lights.empty()) take_lights(notes);
  if (depends_on_depth(settings_.estimator)) take_radii_of_depth(notes);
  add_new(notes, notes_on_names(plan()));
  return notes;
}

std::optional<FrameSource> RunPreview::settle(std::uint64_t most_bytes) {
  std::optional<int> best;
  bool is_refused = false;
  for (const int frame : plan().evidence()) {
    try {
      FrameSource& source = opened(frame);
      if (!source.evidence) settle_by_rows(source, plan().at(frame).input, most_bytes);
      if (!best || source.evidence->tells) best = frame;
      if (source.evidence->tells) break;
    } catch (const Error&) {
      // The frame is computed like all others, and its report says then what is wrong with it.
      opened_.erase(frame);
      is_refused = true;
    }
  }
  std::optional<FrameSource> settled;
  // A frame that shows nothing, such as one of sky, must not have others read that are refused by themselves.
  if (best && (!is_refused || opened(*best).evidence->tells)) settled = std::move(opened(*best));
  if (settled)
    for (auto& file : settled->files) file.close();
  opened_.clear();
  return settled;
}

// What a run would do, for people.

namespace {

/// "shot.1001.exr" of one frame, "shot.1001.exr to shot.1100.exr" of several.
std::string span_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + " to " + last;
}

/// The frames that a CPU computes at once, and why no more.
std::string at_once_text(const MemoryBudget& memory, const FramePlan& plan, const FrameSource& source,
                         const Settings& settings, std::span<const int> wanted) {
  const int threads = threads_of(settings.device),
            count = wanted.size() < 2 ? 1 : frames_at_once(memory, plan, source, settings, wanted, threads);
  if (wanted.size() <= std::size_t(count)) return fmt::format("{} at once, since there are no more", count);
  if (count == threads) return fmt::format("{} at once on a CPU, one per thread (--threads)", count);
  return fmt::format("{} at once, for which there is room (--memory)", count);
}

/// The number of tiles, and what they cost; "in tiles" where the depth is unreadable.
std::string tiles_text(FrameSource& source, const Settings& settings, const WindowLimits& limits) {
  try {
    const MemoryNeeds cut = tiles_within(source, settings, limits);
    return fmt::format("in {} tiles per frame, with the pixels of {:.2g} frames", cut.parts, cut.factor);
  } catch (const Error&) {
    return "in tiles";  // the frame fails by itself, and others of a sequence may not
  }
}

/// The needs of a frame; nothing where its depth is unreadable, with which it fails by itself, and others of a sequence
/// may not.
std::optional<MemoryNeeds> needs_of(FrameSource& source, const Settings& settings, const WindowLimits& limits) {
  try {
    return memory_needs(source, settings, limits);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The least that --memory may be, with its cost, and what computes a frame at once. Fails as the run does where a
/// single frame has less.
std::string needs_text(const FrameSource& source, const MemoryNeeds& needs, const WindowLimits& limits,
                       bool is_sequence) {
  const bool is_enough = needs.least <= limits.budget.bytes;
  if (!is_enough && !is_sequence)
    limits.refuse(fmt::format("{}: there is no room for it: give a smaller --radius", source.depth_path()), needs);
  const std::string at_once = limits.option_for(needs.at_once) + " computes a frame at once";
  std::string text = at_once + ", and nothing less is enough";
  if (limits.option_for(needs.least) != limits.option_for(needs.at_once))
    text = fmt::format("{}, {} is the least: {}", at_once, limits.option_for(needs.least), needs.cost());
  return text + (is_enough ? "" : "; frames such as the first have no room");
}

/// "28 reads for 10 frames, 2.8 for each".
std::string per_frame(std::size_t count, const char* what, std::size_t frames) {
  return fmt::format("{} for {}, {:.2g} for each", counted(count, what), counted(frames, "frame"),
                     double(count) / double(frames));
}

}  // namespace

std::string plan_text(RunPreview& look, bool is_wedge) {
  const Notes notes = look.prepare();
  const FramePlan& plan = look.plan();
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += printable(fmt::format("{:<14}{}", name, value)) + "\n";
  };
  line("frames",
       plan.frames().empty() ? "none" : fmt::format("{}: {}", plan.frames().size(), frames_text(plan.frames())));
  if (!plan.missing().empty())
    line("missing", fmt::format("{}: {}, left out", plan.missing().size(), frames_text(plan.missing())));
  for (const auto& note : notes) line(level_of(note), line_of(note, ""));
  for (const auto& file : plan.settings().preset_files) line("--preset", file);
  if (!is_wedge) refuse_overwriting(plan);
  if (plan.frames().empty()) return text;
  Settings first = plan.at(plan.frames().front()), last = plan.at(plan.frames().back());
  require_endings(first.output);
  if (shows_composite(first.output))
    DisplayTransform(first.output.ocio, first.output.display, first.output.view_transform);
  for (const auto& row : file_rows()) {
    if (!row.is_of_frame || (is_wedge && row.role != FileRole::input)) continue;
    const auto of_first = row.files(first, row.role), of_last = row.files(last, row.role);
    for (std::size_t i = 0; i < of_first.size(); i++)
      line(of_first[i].option, span_text(of_first[i].path, of_last[i].path));
  }

  // As a run does: codecs take memory for each thread, and as much as they may.
  set_exr_threads(threads_of(first.device));
  set_exr_memory(memory_of_host(first).bytes / kCodecPart);
  FrameSource source = look.open(first, plan.frames().front());
  if (first.output.read_lights) first.output.read_lights->in_view(source.reading.camera, plan.frames().front());
  // Frames of a sequence are read as one of them that shows enough.
  if (!plan.is_sequence() && !source.evidence) settle_by_rows(source, first.input, memory_of_host(first).bytes);
  std::vector<std::string> channels;
  for (const auto& plane : source.channels.entries)
    for (const auto& channel : plane) channels.push_back(channel.channel);
  line("channels", fmt::format("{}", fmt::join(channels, ", ")));
  const Camera& camera = source.reading.camera;
  line("camera", fmt::format("{}, {:.6g} x {:.6g} px {}", camera.orthographic ? "orthographic" : "perspective",
                             camera.fx, camera.fy, camera.orthographic ? "per scene unit" : "focal length"));
  if (first.input.roi && !first.output.lights.empty() && !first.estimator.shadow_reach)
    line("lights", "--roi takes the whole frame, of which anything may block: --set shadow-reach bounds that");
  const FrameMemory frame = memory_with_others(plan, source, first);
  const std::uint64_t bytes = frame.of(source.reading.data).host;
  InputIdentities identities(plan);
  const auto [wanted, resumed] = frames_to_compute(plan, options_digest(first), identities);
  const MemoryBudget host = memory_of_host(first);
  require_room_for_others(host, plan, source, first, wanted);
  const MemoryBudget of_frames = without_shared_frames(host, plan, source, first, wanted, 1);
  const std::uint64_t memory = of_frames.bytes;
  line("size", to_string(written_picture(source)));
  const WindowLimits limits{frame, of_frames};
  std::optional<MemoryNeeds> needs = needs_of(source, first, limits);
  if (needs && is_wedge && !source.region) needs->at_once += raw_bytes_of(source);  // kept for all looks
  const std::string reason = why_whole(first, is_wedge);
  const bool is_too_little = needs && !reason.empty() && needs->at_once > memory;
  if (is_too_little && (is_wedge || !plan.is_sequence()))
    limits.refuse(fmt::format("{}: a frame this large is computed in tiles, and {}", source.depth_path(), reason),
                  MemoryNeeds{needs->at_once, needs->at_once});
  const std::string at_once = is_too_little                        ? "too little, and " + reason
                              : bytes <= memory || !reason.empty() ? at_once_text(host, plan, source, first, wanted)
                                                                   : tiles_text(source, first, limits);
  line("memory", fmt::format("{} MiB per frame, {} MiB for frames: {}", bytes >> 20, memory >> 20, at_once));
  if (needs && !is_wedge) line("--memory", needs_text(source, *needs, limits, plan.is_sequence()));
  const bool computes = !wanted.empty();
  const auto line_of_shared = [&](const char* name, std::size_t count, const char* kind, std::uint64_t shared,
                                  const std::string& cost) {
    line(name,
         fmt::format("up to {} of the {} of the shot: {} MiB of {} for each at once, beside what it takes "
                     "itself{}",
                     count, counted(plan.shot().size(), "frame"), shared >> 20, kind, computes ? "; " + cost : ""));
  };
  const SharedCounts counts = shared_counts(plan, wanted);
  if (around_of(first.input) > 0)
    line_of_shared("around", most_others(plan, source, first.input), "prepared frames",
                   bytes_of_shot(plan, source, first.input, 1),
                   per_frame(std::max(wanted.size(), counts.estimated) + counts.prepared, "read", wanted.size()));
  if (first.input.accumulate > 0)
    line_of_shared("accumulate", std::min(plan.shot().size(), std::size_t(plan.turns())), "estimates",
                   bytes_of_estimates(plan, source, first, wanted, 1),
                   per_frame(counts.estimated, "estimate", wanted.size()));
  if (wanted.size() < plan.frames().size())
    line("kept", fmt::format("{}: whole, by an earlier run", plan.frames().size() - wanted.size()));
  for (const auto& note : resumed) line(level_of(note), line_of(note, ""));
  return text;
}

}  // namespace alcove
