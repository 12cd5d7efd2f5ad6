// Finds frames by the names of their files, tells what is missing, and cuts chunks.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/plan.h"

#include <algorithm>
#include <filesystem>
#include <regex>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/formats/sequence.h"
#include "core/frame/raw_plane.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

// The most frames that are looked at for one that shows what the files do not say.
constexpr std::size_t kEvidenceFrames = 8;

/// At most so many of the frames, which lie evenly from the first to the last.
std::vector<int> evenly(const std::vector<int>& frames, std::size_t most) {
  if (frames.size() <= most) return frames;
  std::vector<int> some;
  for (std::size_t i = 0; i < most; i++) some.push_back(frames[i * (frames.size() - 1) / (most - 1)]);
  return some;
}

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// Fails where a frame's file is a folder.
void refuse_folder(const std::string& path, const std::string& option) {
  std::error_code error;
  if (fs::is_directory(path, error))
    fail(ErrorKind::input, "{}: is a folder; {} takes a file, or a pattern such as {}", path, option,
         (fs::path(path) / "shot.####.exr").string());
}

/// Fails where a name that is no file is what a shell would have taken for several.
void refuse_glob(const std::string& path, const std::string& option) {
  const std::size_t begin = path.find_first_of("*?");
  if (begin == path.npos) return;
  const std::size_t end = std::min(path.find_first_not_of("*?", begin), path.size());
  const bool counts = path.find('*', begin) >= end;  // shot.????.exr says how many digits there are
  const std::string pattern = path.substr(0, begin) + std::string(counts ? end - begin : 4, '#') + path.substr(end);
  fail(ErrorKind::usage, "{}: {} takes a sequence as one name with a pattern: write {}", path, option,
       pattern.find_first_of("*?") == pattern.npos ? pattern : "shot.####.exr");
}

/// Fails where a name that is no file has a token of another program.
void refuse_foreign_pattern(const std::string& path, const std::string& option) {
  if (const std::string why = foreign_pattern_in(path); !why.empty())
    fail(ErrorKind::usage, "{}: {} ({})", path, why, option);
}

/// Whether a name has a place for a frame number that no name has by chance, as one with a lone # may: ## or more, %d
/// or %04d.
bool has_clear_place(const std::string& name) {
  static const std::regex place("##|%[0-9]*d");
  return std::regex_search(name, place);
}

}  // namespace

FramePlan::FramePlan(const Settings& settings) : settings_(settings) {
  find_patterns(FileRole::input);
  is_sequence_ = !settings_.frames.frames.empty() || !patterns_.empty();
  find_patterns(FileRole::output);
  all_ = all_frames();
  refuse_shared_files();
  find_evidence();
  find_inputs(chunk_of(all_, settings.frames.chunk, settings.frames.chunks));
  if (settings.frames.frames.empty()) holes_ = holes_in(all_);
  // The first chunk tells of them.
  if (settings.frames.chunk == 1) missing_.insert(missing_.end(), holes_.begin(), holes_.end());
  std::ranges::sort(missing_);
  find_shot();
  refuse_missing_around();
}

void FramePlan::find_patterns(FileRole role) {
  const bool are_inputs = role == FileRole::input;
  for (const auto& row : file_rows()) {
    if (row.role != role || !row.is_of_frame) continue;
    const Words words = row.words(settings_);
    for (std::size_t i = 0; i < words.size(); i++) {
      const std::string& text = words[i];
      if (row.is_file && !row.is_file(text)) continue;
      if (are_inputs) refuse_folder(text, row.long_name());
      if (are_inputs ? exists(text) : !is_sequence_ && !has_clear_place(text)) continue;
      if (are_inputs) refuse_glob(text, row.long_name());
      if (const auto name = frame_pattern(text))
        patterns_.push_back({&row, i, text, *name});
      else if (are_inputs)
        refuse_foreign_pattern(text, row.long_name());
    }
  }
}

const FramePlan::Pattern* FramePlan::first_input() const {
  const auto found = std::ranges::find_if(patterns_, &Pattern::is_input);
  return found == patterns_.end() ? nullptr : &*found;
}

std::vector<int> FramePlan::on_disk() const {
  const Pattern* input = first_input();
  try {
    return input ? frames_on_disk(input->name, input->option().c_str()) : std::vector<int>();
  } catch (const Error&) {  // a chunk without frames needs none
    return {};
  }
}

std::vector<int> FramePlan::all_frames() const {
  if (!settings_.frames.frames.empty()) return parse_frames(settings_.frames.frames);
  if (const Pattern* input = first_input()) return frames_on_disk(input->name, input->option().c_str());
  // The number of a single frame is that in its name.
  const std::string& input = main_input(settings_.input);
  const auto number = frame_number_in(input).number;
  if (!number && !patterns_.empty())
    fail(ErrorKind::usage,
         "{} {}: its name has a place for a frame number, and {} has no clear number: give --frames NUMBER",
         patterns_.front().option(), patterns_.front().text, input);
  return {number.value_or(0)};
}

bool FramePlan::has_contact_sheet() const {
  const auto is_preview = [](const Pattern& pattern) { return pattern.row->key() == "preview"; };
  return all_.size() > 1 && !settings_.output.preview.empty() && std::ranges::none_of(patterns_, is_preview);
}

/// Frames that differ in nothing but their number would be the same one, and files without one the last frame's.
void FramePlan::refuse_shared_files() const {
  if (all_.size() < 2) return;
  constexpr const char* kMend = "put a place for the frame number into its name, such as %04d";
  if (!first_input())
    fail(ErrorKind::usage, "{}: all {} frames would be computed from it: {}", main_input(settings_.input), all_.size(),
         kMend);
  const FrameSettings& frames = settings_.frames;
  const char* const part = frames.chunks > 1 ? "--chunk" : frames.resume && !frames.overwrite ? "--resume" : nullptr;
  for (const auto& row : file_rows()) {
    const auto files = row.files(settings_, FileRole::output);
    if (!row.is_of_frame || files.empty() || std::ranges::count(patterns_, &row, &Pattern::row) > 0) continue;
    const auto& [option, path] = files.front();
    if (row.key() != "preview")
      fail(ErrorKind::usage, "{} {}: all {} frames would be written to it: {}", option, path, all_.size(), kMend);
    if (part)
      fail(ErrorKind::usage, "{} {}: a contact sheet shows all {} frames, and {} leaves some out: {}", option, path,
           all_.size(), part, kMend);
  }
}

/// Takes frames from the beginning to the end, since a sequence may begin with nothing but sky. All frames are looked
/// for only where one of these is missing.
void FramePlan::find_evidence() {
  evidence_ = evenly(all_, kEvidenceFrames);
  const auto is_there = [&](int frame) { return !is_sequence_ || has_inputs(frame); };
  if (std::ranges::all_of(evidence_, is_there)) return;
  std::vector<int> there;
  std::ranges::copy_if(all_, std::back_inserter(there), is_there);
  evidence_ = evenly(there, kEvidenceFrames);
}

bool FramePlan::has_inputs(int frame) const {
  return std::ranges::all_of(
      patterns_, [&](const Pattern& pattern) { return !pattern.is_input() || exists(pattern.name.path(frame)); });
}

void FramePlan::find_inputs(const std::vector<int>& own) {
  // A chunk without frames of its own fails as all others do where no frame is there.
  const std::vector<int>& chunk = own.empty() && evidence_.empty() ? all_ : own;
  if (const std::string& input = main_input(settings_.input); own.empty() && !is_sequence_ && !exists(input))
    fail(ErrorKind::input, "{}: file not found ({})", input, main_option(settings_.input));
  std::string complaint;
  for (const auto& pattern : patterns_) {
    if (!pattern.is_input()) continue;
    std::vector<int> absent;
    std::ranges::copy_if(chunk, std::back_inserter(absent),
                         [&](int frame) { return !exists(pattern.name.path(frame)); });
    if (absent.empty()) continue;
    complaint += fmt::format("{}{}: {} of {} {} missing: {} ({}{})", complaint.empty() ? "" : "; ", pattern.option(),
                             absent.size(), counted(chunk.size(), "frame"), absent.size() == 1 ? "is" : "are",
                             frames_text(absent), pattern.name.path(absent.front()),
                             absent.size() == chunk.size() ? why_no_frames(pattern.name) : "");
  }
  if (!complaint.empty() && settings_.frames.missing == Missing::error)
    fail(ErrorKind::input, "{}; --set missing=skip leaves them out, --frames chooses frames", complaint);
  for (const int frame : chunk) (has_inputs(frame) ? frames_ : missing_).push_back(frame);
  if (!chunk.empty() && frames_.empty()) fail(ErrorKind::input, "{}; there is nothing to compute", complaint);
}

void FramePlan::find_shot() {
  const char* const option = shot_option(settings_.input);
  if (!option) return;
  const Pattern* const input = first_input();
  if (!input) {
    const std::string &file = main_input(settings_.input), pattern = pattern_for(file);
    fail(ErrorKind::usage,
         "{}: {} takes other frames of a sequence, and this is one file: give a pattern such as {}, with --frames for "
         "this frame alone, or leave {} out",
         file, option, pattern.empty() ? "shot.####.exr" : pattern, option);
  }
  const std::string& motion = settings_.input.motion;
  const auto is_motion = [](const Pattern& pattern) { return pattern.row->key() == "motion"; };
  if (!motion.empty() && std::ranges::none_of(patterns_, is_motion)) {
    const std::string pattern = pattern_for(motion);
    fail(ErrorKind::usage, "--motion {}: these are the vectors of one frame: give a pattern such as {}", motion,
         pattern.empty() ? "motion.####.exr" : pattern);
  }
  shot_ = frames_on_disk(input->name, input->option().c_str());
  const std::vector<int> holes = holes_in(shot_);
  shot_.insert(shot_.end(), holes.begin(), holes.end());
  std::ranges::sort(shot_);
  std::ranges::copy_if(shot_, std::inserter(absent_, absent_.end()), [&](int frame) { return !has_inputs(frame); });
}

FramesAround FramePlan::within(const Span& span) const {
  FramesAround found;
  std::for_each(shot_.begin() + span.first, shot_.begin() + span.last,
                [&](int frame) { (absent_.contains(frame) ? found.missing : found.there).push_back(frame); });
  return found;
}

FramesAround FramePlan::around(int frame, int count) const {
  const auto here = place_of(frame), size = std::ptrdiff_t(shot_.size());
  const auto behind = here < size && shot_[std::size_t(here)] == frame ? here + 1 : here;
  FramesAround found = within({std::max<std::ptrdiff_t>(0, here - count), std::min(size, behind + count)});
  std::erase(found.there, frame);
  std::erase(found.missing, frame);
  return found;
}

std::vector<int> FramePlan::nearest(int frame, int count) const {
  std::vector<int> found = within(nearest_places(frame, count)).there;
  std::erase(found, frame);
  return found;
}

std::ptrdiff_t FramePlan::place_of(int frame) const { return std::ranges::lower_bound(shot_, frame) - shot_.begin(); }

FramePlan::Span FramePlan::nearest_places(int frame, int count) const {
  const auto size = std::ptrdiff_t(shot_.size()), reach = std::min<std::ptrdiff_t>(count, size);
  const auto first =
      std::clamp<std::ptrdiff_t>(place_of(frame) - reach, 0, std::max<std::ptrdiff_t>(0, size - 2 * reach - 1));
  return {first, std::min(size, first + 2 * reach + 1)};
}

FramesAround FramePlan::accumulated(int frame) const {
  if (settings_.input.accumulate == 0) return {};
  return within(nearest_places(frame, settings_.input.accumulate));
}

bool FramePlan::is_accumulated(int other, int frame) const {
  const auto [first, last] = nearest_places(frame, settings_.input.accumulate);
  return place_of(other) >= first && place_of(other) < last;
}

int FramePlan::slot_of(int frame) const { return int(place_of(frame) % turns()); }

std::vector<int> FramePlan::missing_around() const {
  std::set<int> missing;
  for (const int frame : frames_) {
    if (absent_.empty()) break;
    for (const auto& window : {around(frame, around_of(settings_.input)), accumulated(frame)})
      missing.insert(window.missing.begin(), window.missing.end());
  }
  return {missing.begin(), missing.end()};
}

void FramePlan::refuse_missing_around() const {
  if (settings_.frames.missing == Missing::skip) return;
  const std::vector<int> absent = missing_around();
  if (absent.empty()) return;
  const auto path = std::ranges::find_if(patterns_, [&](const Pattern& pattern) {
    return pattern.is_input() && !exists(pattern.name.path(absent.front()));
  });
  fail(ErrorKind::input, "{}: {} needs {} of the shot that {} missing: {}; --set missing=skip does without",
       path->name.path(absent.front()), shot_option(settings_.input), absent.size() == 1 ? "a frame" : "frames",
       absent.size() == 1 ? "is" : "are", frames_text(absent));
}

const char* shot_option(const InputSettings& settings) {
  if (around_of(settings) > 0) return "--around";
  return settings.accumulate > 0 ? "--accumulate" : nullptr;
}

int around_of(const InputSettings& settings) { return settings.around_all ? kWholeShot : settings.around; }

Settings FramePlan::at(int frame) const {
  Settings settings = settings_;
  for (const auto& [row, word, text, name] : patterns_) {
    Words words = row->words(settings);
    words[word] = name.path(row->role == FileRole::input ? frame : frame + settings_.frames.output_offset);
    row->read(settings, words);
  }
  return settings;
}

void FramePlan::set_radii(const std::vector<double>& radii) { take_radii(settings_.estimator, radii); }

std::string pattern_for(const std::string& path) {
  const FrameNumber found = frame_number_in(path);
  if (found.digits.empty()) return "";
  const std::size_t at = path.rfind(found.digits), digits = found.digits.size();
  return path.substr(0, at) + frame_token(digits) + path.substr(at + digits);
}

int frame_number_of(const std::string& path) { return frame_number_in(path).number.value_or(0); }

bool fails_on_warnings(const Settings& settings) { return settings.frames.warnings_as_errors || settings.input.strict; }

void refuse_warnings(const Notes& notes, const Settings& settings, const std::string& file) {
  Notes warnings = warnings_of(notes);
  std::erase_if(warnings, [&](const Note& note) { return is_listed(note.code, settings.input.allow); });
  if (warnings.empty() || !fails_on_warnings(settings)) return;
  std::string text;
  for (const auto& note : warnings) text += (text.empty() ? "" : "; ") + line_of(note, text.empty() ? file : "");
  fail(ErrorKind::input, "{}: an error by {}; --set allow=CODE,... accepts the code in brackets", text,
       settings.frames.warnings_as_errors ? "--set warnings-as-errors" : "--strict");
}

std::vector<int> chunk_of(const std::vector<int>& frames, int chunk, int chunks) {
  const auto at = [&](int i) {
    return frames.begin() + std::ptrdiff_t(frames.size() * std::size_t(i) / std::size_t(chunks));
  };
  return {at(chunk - 1), at(chunk)};
}

// Frames of a shot that detect movement, are prepared and are estimated.

namespace {

/// The least number of frames on each side that detect motion in a frame. More do if more are used: a thing that rests
/// for a while is detected only by frames that see the place before it comes or after it has left.
constexpr int kLeastWitnesses = 2;

int witnesses_to_each_side(int count) { return std::max(count, kLeastWitnesses); }

}  // namespace

bool takes_frames(const InputSettings& settings) {
  const bool asks_vectors = settings.accumulate > 0 && !settings.motion.empty();
  return around_of(settings) > 0 || asks_vectors;
}

bool takes_others(const InputSettings& settings) { return takes_frames(settings) || settings.other_views; }

std::vector<int> seen_around(const FramePlan& plan, int frame) {
  const int count = around_of(plan.at(frame).input);
  const std::vector<int> around = plan.around(frame, count).there;
  if (count == kWholeShot) return around;
  std::set<int> seen(around.begin(), around.end());
  for (const int other : around)
    for (const int witness : witnesses_of(plan, other)) seen.insert(witness);
  seen.erase(frame);
  return {seen.begin(), seen.end()};
}

std::vector<int> witnesses_of(const FramePlan& plan, int frame) {
  return plan.nearest(frame, witnesses_to_each_side(around_of(plan.at(frame).input)));
}

int most_witnesses(int count) { return count == kWholeShot ? count : 2 * witnesses_to_each_side(count); }

std::vector<int> frames_seen_for(const FramePlan& plan, int frame) {
  std::vector<int> first = plan.accumulated(frame).there;
  if (first.empty()) return seen_around(plan, frame);
  const InputSettings input = plan.at(frame).input;
  std::set<int> seen(first.begin(), first.end());
  for (const int estimated : first) {
    const std::vector<int> around = seen_around(plan, estimated);
    seen.insert(around.begin(), around.end());
    // Vectors are proved by the frames beside theirs.
    if (input.motion.empty()) continue;
    const std::vector<int> beside = plan.around(estimated, 1).there;
    seen.insert(beside.begin(), beside.end());
  }
  seen.erase(frame);
  return {seen.begin(), seen.end()};
}

SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames) {
  std::set<int> prepared, estimated;
  const auto add = [](std::set<int>& all, const std::vector<int>& more) { all.insert(more.begin(), more.end()); };
  for (const int frame : frames) add(estimated, plan.accumulated(frame).there);
  const std::set<int> takers = estimated.empty() ? std::set<int>(frames.begin(), frames.end()) : estimated;
  const InputSettings& input = plan.settings().input;
  for (const int taker : takers) {
    const std::vector<int> seen = seen_around(plan, taker);
    add(prepared, seen);
    // Vectors are proved by the frames beside theirs.
    const bool takes_vectors = !estimated.empty() && !input.motion.empty();
    if (takes_vectors) add(prepared, plan.around(taker, 1).there);
    // It is a witness of the frames around it.
    if (takes_vectors || !seen.empty()) prepared.insert(taker);
  }
  return {prepared.size(), estimated.size()};
}

int farthest_seen(int count) {
  const int witnesses = witnesses_to_each_side(count);
  // At the ends of the shot they all lie on one side.
  return count == kWholeShot ? count : std::max(count + witnesses, 2 * witnesses);
}

}  // namespace alcove
