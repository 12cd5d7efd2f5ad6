// Values are read into settings of their own first, by which the table tells what has no effect; then settings that
// contradict each other are found, and the option that mends each is named.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/base/flat_toml.h"
#include "core/base/text.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/frame/raw_plane.h"
#include "core/options/options.h"

namespace alcove {

// Keys of presets.

namespace {

/// The settings in the text of a preset. The rules of presets/input are known to the program: such a preset is its
/// --source and no more.
std::vector<FlatEntry> settings_in(const std::string& text) {
  auto entries = parse_flat_toml(text);
  if (std::ranges::find(entries, "detect", &FlatEntry::key) != entries.end())
    std::erase_if(entries, [](const auto& entry) { return entry.key != "source"; });
  return entries;
}

/// The row that an entry is for.
const OptionRow& row_of(const FlatEntry& entry, const std::vector<OptionRow>& table) {
  const OptionRow& row = row_of_key(table, entry.key);
  if (entry.values.empty()) fail(ErrorKind::usage, "{}: the list is empty", entry.key);
  if (entry.values.size() > 1 && !row.repeats)
    fail(ErrorKind::usage, "{} takes one value, and the list has {}", entry.key, entry.values.size());
  return row;
}

}  // namespace

std::vector<Said> said_by_text(const std::string& preset, const std::string& text,
                               const std::vector<OptionRow>& table) {
  std::vector<Said> said;
  try {
    for (const auto& entry : settings_in(text))
      said.push_back({row_of(entry, table).long_name(), entry.values, preset});
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
  return said;
}

// What was said.

namespace {

const OptionRow& row_of(const std::vector<OptionRow>& table, const std::string& option) {
  const auto row = std::ranges::find(table, option, &OptionRow::long_name);
  if (row == table.end()) fail(ErrorKind::usage, "there is no option {}", option);
  return *row;
}

/// Reads a value, and names its preset in what is wrong with it.
void read_one(const std::vector<OptionRow>& table, const Said& one) {
  try {
    row_of(table, one.option).read(one.words);
  } catch (const Error& error) {
    if (one.is_typed()) throw;
    fail(error.kind(), "{} (--preset): {}", one.preset, error.what());
  }
}

RunOptions options_of(const RunOptions& initial, const std::vector<Said>& said) {
  RunOptions options = initial;
  const auto table = option_table(options);
  for (const auto& one : said) read_one(table, one);
  return options;
}

/// The options that only presets say.
Words only_in_presets(const std::vector<Said>& said) {
  Words options;
  for (const auto& one : said) {
    const bool is_typed =
        std::ranges::any_of(said, [&](const Said& other) { return other.is_typed() && other.option == one.option; });
    if (!is_typed) options.push_back(one.option);
  }
  return options;
}

/// The settings of a run that writes all that there is.
Settings with_all_outputs(Settings settings) {
  settings.output.composite = settings.output.preview = "all";
  settings.output.multi_bounce = true;
  // But for confidence, which would give what no estimate of the AO takes an effect.
  for (const auto& name : aov_names())
    if (name != "confidence") settings.output.aovs += "," + std::string(name);
  return settings;
}

/// Why each has no effect in the settings that those make of which `counts` says so; "" where it has one, or does not
/// count.
std::vector<std::string> objections_to(const RunOptions& initial, const std::vector<Said>& said,
                                       const std::vector<bool>& counts, Reader reader) {
  std::vector<Said> counted;
  for (std::size_t i = 0; i < said.size(); i++)
    if (counts[i]) counted.push_back(said[i]);
  RunOptions options = options_of(initial, counted);
  const auto table = option_table(options);
  const Settings judged = reader == Reader::run ? options.settings : with_all_outputs(options.settings);
  std::vector<std::string> objections(said.size());
  for (std::size_t i = 0; i < said.size(); i++)
    if (counts[i]) objections[i] = row_of(table, said[i].option).objection(judged);
  return objections;
}

/// Fails where two settings of a preset have an effect each, but none beside the other.
void refuse_contradictions(const RunOptions& initial, const std::vector<Said>& said, const std::string& preset,
                           Reader reader) {
  std::vector<bool> own;
  for (const auto& one : said) own.push_back(one.preset == preset);
  const auto objections = objections_to(initial, said, own, reader);
  const auto with_only = [&](std::size_t i, std::size_t j) {
    std::vector<bool> counts(said.size());
    counts[i] = counts[j] = true;
    return objections_to(initial, said, counts, reader);
  };
  for (std::size_t j = 0; j < said.size(); j++)
    for (std::size_t i = 0; i < j; i++) {
      if (objections[i].empty() || objections[j].empty()) continue;
      const auto beside = with_only(i, j);
      const bool have_none = !beside[i].empty() && !beside[j].empty();
      if (have_none && with_only(i, i)[i].empty() && with_only(j, j)[j].empty())
        fail(ErrorKind::usage, "{} (--preset): {}", preset, beside[i]);
    }
}

/// Leaves out of presets what has no effect, one after the other: what is left out may be what another one had no
/// effect beside, so that those get a second chance.
std::vector<bool> with_effects(const RunOptions& initial, const std::vector<Said>& said, Reader reader) {
  std::vector<bool> counts(said.size(), true);
  while (true) {
    const auto objections = objections_to(initial, said, counts, reader);
    std::size_t idle = 0;
    while (idle < said.size() && (said[idle].is_typed() || objections[idle].empty())) idle++;
    if (idle == said.size()) break;
    counts[idle] = false;
  }
  const auto objection_count = [&] {
    const auto objections = objections_to(initial, said, counts, reader);
    return said.size() - std::size_t(std::ranges::count(objections, ""));
  };
  for (std::size_t i = 0; i < said.size(); i++) {
    if (counts[i]) continue;
    const std::size_t before = objection_count();
    counts[i] = true;
    counts[i] = objection_count() <= before;
  }
  return counts;
}
}  // namespace

void read_said(RunOptions& options, std::vector<Said> said, Reader reader) {
  std::set<std::string> presets;
  for (const auto& one : said)
    if (!one.is_typed()) presets.insert(one.preset);
  for (const auto& preset : presets) refuse_contradictions(options, said, preset, reader);
  const std::vector<bool> counts = with_effects(options, said, reader);
  const auto objections = objections_to(options, said, counts, reader);
  for (std::size_t i = 0; i < said.size(); i++)
    if (said[i].is_typed() && !objections[i].empty()) fail(ErrorKind::usage, "{}", objections[i]);
  std::size_t place = 0;
  std::erase_if(said, [&](const Said&) { return !counts[place++]; });
  options = options_of(options, said);
  options.settings.input.from_presets = only_in_presets(said);
}

// Contradictions.

namespace {

/// Fails with ErrorKind::usage where a setting that is not the usual one has no effect.
void require_effects(const Settings& settings) {
  RunOptions defaults;
  RunOptions options;
  options.settings = settings;
  const auto table = option_table(options);
  const auto usual = option_table(defaults);
  for (std::size_t i = 0; i < table.size(); i++)
    if (table[i].words() != usual[i].words())
      if (const std::string objection = table[i].objection(settings); !objection.empty())
        fail(ErrorKind::usage, "{}", objection);
}

// Each scale costs a search and a plane of its own.
constexpr std::size_t kMostRadii = 8;

/// Only an estimate by its error knows that error.
void check_tolerance(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.tolerance == 0 && wants(settings.output, &FrameOutputs::error))
    fail(ErrorKind::usage, "--aov error: only an estimate with a --tolerance knows its error");
}

/// An exact search leaves out no tiles.
void check_search(const Settings& settings) {
  const auto& e = settings.estimator;
  if (!searches_exactly(e)) return;
  for (const auto* view : debug_views_of(settings.output))
    if (view->source == DebugSource::tiles)
      fail(ErrorKind::usage, "--set debug=tiles: an exact search leaves out none; --search steps does");
}

/// A view of what is completed needs something that is.
void check_completion(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto views = debug_views_of(settings.output);
  const bool is_shown = std::ranges::find(views, DebugSource::completed, &DebugView::source) != views.end();
  if (!is_shown || completes_anywhere(e)) return;
  if (e.complete == Completion::none)
    fail(ErrorKind::usage,
         "--set debug=completed: with --set complete=none nothing is; border and all complete surfaces");
  fail(ErrorKind::usage, "--set debug=completed: --estimator {} completes no surfaces; gtao and bitmask do",
       e.estimator == Estimator::hbao ? "hbao" : "crytek");
}

/// Whether a view shows how one frame is estimated.
bool is_of_estimate(DebugSource source) {
  return source == DebugSource::tiles || source == DebugSource::completed || source == DebugSource::sites ||
         source == DebugSource::raw_ao || source == DebugSource::denoised_ao;
}

/// A mean of many frames has no tiles, sites or guesses of one.
void check_accumulation(const Settings& settings) {
  if (settings.input.accumulate == 0) {
    for (const auto* view : debug_views_of(settings.output))
      if (view->source == DebugSource::count)
        fail(ErrorKind::usage, "--set debug=count: a frame is its own estimate; --accumulate takes those of others");
    return;
  }
  for (const auto* view : debug_views_of(settings.output))
    if (is_of_estimate(view->source))
      fail(ErrorKind::usage,
           "--set debug={}: it shows the estimate of one frame, and with --accumulate the AO is the mean of many: "
           "leave one "
           "of them out",
           view->name);
}

/// What shows hidden surfaces needs some that are kept.
void check_hidden(const Settings& settings) {
  const auto views = debug_views_of(settings.output);
  const bool is_drawn = std::ranges::find(views, DebugSource::hidden, &DebugView::source) != views.end();
  const char* const option = wants(settings.output, &FrameOutputs::hidden) ? "--aov "
                             : is_drawn                                    ? "--set debug="
                                                                           : nullptr;
  if (!option) return;
  if (settings.estimator.hidden == 0) fail(ErrorKind::usage, "{}hidden: with --set hidden=0 nothing is kept", option);
  if (!has_hidden_sources(settings.input))
    fail(ErrorKind::usage, "{}hidden: nothing says what is hidden: --behind, --deep, --around and --set other-views do",
         option);
}

/// Several radii make sense once each; bent normals need an estimator that finds open directions.
void check_scales(const Settings& settings) {
  const auto& e = settings.estimator;
  if (wants(settings.output, &FrameOutputs::bent_normal) && !searches_slices(e))
    fail(ErrorKind::usage, "--aov bent-normal: --estimator {} finds no open directions; gtao and bitmask do",
         e.estimator == Estimator::hbao ? "hbao" : "crytek");
  if (e.further_radii.empty()) return;
  const auto radii = radii_of(e);
  if (radii.size() > kMostRadii)
    fail(ErrorKind::usage, "--radius: there are {} of them; a run takes at most {}", radii.size(), kMostRadii);
  if (const auto twice = std::ranges::adjacent_find(radii); twice != radii.end())
    fail(ErrorKind::usage, "--radius {} is there twice: give each scale once", *twice);
}

/// Numbers that have an order, or a range of their own beside others.
void check_numbers(const EstimatorSettings& e) {
  if (e.fade_start && e.fade_end && *e.fade_end <= *e.fade_start)
    fail(ErrorKind::usage, "--set fade-end={} is not beyond --set fade-start={}", *e.fade_end, *e.fade_start);
  if (e.estimator != Estimator::crytek && e.bias >= 1)
    fail(ErrorKind::usage, "--set bias={}: of every estimator but crytek it is the sine of an elevation, below 1",
         e.bias);
  if (e.falloff_end <= e.falloff_start)
    fail(ErrorKind::usage, "--set falloff-end={} is not above --set falloff-start={}", e.falloff_end, e.falloff_start);
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (main_input(settings.input).empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.estimator.radius && !settings.estimator.radius_auto && needs_ao(settings.output))
    fail(ErrorKind::usage, "no radius: say with --radius how far occluders reach, in scene units");
  require_effects(settings);
  check_tolerance(settings);
  check_search(settings);
  check_completion(settings);
  check_accumulation(settings);
  check_hidden(settings);
  check_scales(settings);
  check_numbers(settings.estimator);
  if (settings.frames.chunk > settings.frames.chunks)
    fail(ErrorKind::usage, "--chunk {}/{}: there is no such chunk", settings.frames.chunk, settings.frames.chunks);
}

}  // namespace alcove
