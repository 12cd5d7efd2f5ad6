// Values are tried together, by which the table tells what has no effect; then settings that contradict each other are
// found, and the option that mends each is named.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/base/toml.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/frame/raw_plane.h"
#include "core/frame/reading.h"
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
const SettingRow& row_of(const FlatEntry& entry) {
  const SettingRow& row = row_of_key(entry.key);
  if (entry.values.empty()) fail(ErrorKind::usage, "{}: the list is empty", entry.key);
  if (entry.values.size() > 1 && !row.repeats)
    fail(ErrorKind::usage, "{} takes one value, and the list has {}", entry.key, entry.values.size());
  return row;
}

}  // namespace

std::vector<OptionValue> preset_values(const std::string& preset, const std::string& text, bool builds_on_others) {
  std::vector<OptionValue> values;
  try {
    for (const auto& entry : settings_in(text))
      if (!builds_on_others || entry.key != "preset") values.push_back({&row_of(entry), entry.values, preset});
  } catch (const Error& error) {
    fail(error.kind(), "{} (--preset): {}", preset, error.what());
  }
  return values;
}

// Values from several places.

namespace {

using Values = std::vector<OptionValue>;

/// Names --set in a sentence about a value that --set gave, and not the option that it is too.
std::string as_given(const OptionValue& value, const std::string& sentence) {
  const std::string option = value.row->long_name();
  return value.by_set && sentence.starts_with(option) ? "--set " + value.row->key() + sentence.substr(option.size())
                                                      : sentence;
}

/// Reads a value, and names its preset in the sentence on a text that is none.
void read_value(Settings& settings, const OptionValue& value) {
  try {
    value.row->read(settings, value.words);
  } catch (const Error& error) {
    if (value.is_typed()) fail(error.kind(), "{}", as_given(value, error.what()));
    fail(error.kind(), "{} (--preset): {}", value.preset, error.what());
  }
}

/// The settings with the values that count.
Settings with_some(Settings settings, const Values& values, const std::vector<bool>& counts) {
  for (std::size_t i = 0; i < values.size(); i++)
    if (counts[i]) read_value(settings, values[i]);
  return settings;
}

/// The settings of a run that writes all outputs.
Settings with_all_outputs(Settings settings) {
  settings.output.composite = settings.output.preview = "all";
  settings.output.multi_bounce = true;
  // But for confidence, which would give an effect to what no estimate of the AO takes.
  for (const auto& name : aov_names())
    if (name != "confidence") settings.output.aovs += "," + std::string(name);
  return settings;
}

/// Tells which values have no effect beside others.
struct Trial {
  const Settings& initial;
  const Values& values;
  Reader reader;

  /// The objection to each value that counts, "" where there is none, beside the others that count.
  Words objections(const std::vector<bool>& counts) const {
    Settings settings = with_some(initial, values, counts);
    if (reader == Reader::inspect) settings = with_all_outputs(settings);
    Words objections(values.size());
    for (std::size_t i = 0; i < values.size(); i++)
      if (counts[i]) objections[i] = objection(*values[i].row, settings);
    return objections;
  }

  /// The same beside no other value than these two.
  Words objections(std::size_t i, std::size_t j) const {
    std::vector<bool> counts(values.size());
    counts[i] = counts[j] = true;
    return objections(counts);
  }
};

/// Says which of two values of a preset take each other's effect; "" where none do.
std::string contradiction(const Trial& trial, const std::string& preset) {
  std::vector<bool> counts;
  for (const auto& value : trial.values) counts.push_back(value.preset == preset);
  const Words objections = trial.objections(counts);
  for (std::size_t j = 0; j < objections.size(); j++)
    for (std::size_t i = 0; i < j; i++) {
      if (objections[i].empty() || objections[j].empty()) continue;
      const Words of_both = trial.objections(i, j);
      const bool have_none = !of_both[i].empty() && !of_both[j].empty();
      if (have_none && trial.objections(i, i)[i].empty() && trial.objections(j, j)[j].empty()) return of_both[i];
    }
  return "";
}

/// Leaves out values of presets without effect, one after the other. A value that is left out may be the one beside
/// which another had no effect, so that those get a second chance. Gives which values count.
std::vector<bool> with_effects(const Trial& trial) {
  const std::size_t size = trial.values.size();
  std::vector<bool> counts(size, true);
  while (true) {
    const Words objections = trial.objections(counts);
    std::size_t idle = 0;
    while (idle < size && (trial.values[idle].is_typed() || objections[idle].empty())) idle++;
    if (idle == size) break;
    counts[idle] = false;
  }
  const auto objection_count = [&] { return size - std::size_t(std::ranges::count(trial.objections(counts), "")); };
  for (std::size_t i = 0; i < size; i++) {
    if (counts[i]) continue;
    const std::size_t before = objection_count();
    counts[i] = true;
    counts[i] = objection_count() <= before;
  }
  return counts;
}

}  // namespace

Settings with_values(const Settings& initial, std::vector<OptionValue> values, Reader reader) {
  const Trial trial{initial, values, reader};
  std::set<std::string> presets;
  for (const auto& value : values)
    if (!value.is_typed()) presets.insert(value.preset);
  for (const auto& preset : presets)
    if (const std::string why = contradiction(trial, preset); !why.empty())
      fail(ErrorKind::usage, "{} (--preset): {}", preset, why);
  const std::vector<bool> counts = with_effects(trial);
  const Words objections = trial.objections(counts);
  std::set<const SettingRow*> typed;
  for (std::size_t i = 0; i < values.size(); i++) {
    if (!values[i].is_typed()) continue;
    if (!objections[i].empty()) fail(ErrorKind::usage, "{}", as_given(values[i], objections[i]));
    typed.insert(values[i].row);
  }
  Settings settings = with_some(initial, values, counts);
  settings.input.from_presets.clear();
  for (std::size_t i = 0; i < values.size(); i++)
    if (counts[i] && !typed.contains(values[i].row))
      settings.input.from_presets[values[i].row->long_name()] = values[i].preset;
  return settings;
}

namespace {

/// The settings that are no defaults.
Values given_values(const Settings& settings) {
  Values values;
  for (const auto& row : option_table())
    if (row.is_key() && row.is_given(settings)) values.push_back({&row, row.words(settings)});
  return values;
}

/// Whether one preset may have all that is set, with no effect lost but those of `idle` values.
bool is_one_preset(const Settings& settings, std::size_t idle) {
  const Settings initial;
  const Values values = given_values(settings);
  const Trial trial{initial, values, Reader::run};
  const Words objections = trial.objections(std::vector<bool>(values.size(), true));
  const std::size_t without_effect = values.size() - std::size_t(std::ranges::count(objections, ""));
  return without_effect <= idle && contradiction(trial, "").empty();
}

}  // namespace

Settings with_idle_values(const Settings& settings, const std::vector<OptionValue>& values) {
  Settings whole = settings;
  std::set<const SettingRow*> known;
  std::size_t idle = 0;
  for (auto at = values.rbegin(); at != values.rend(); at++) {
    const OptionValue& value = *at;
    if (!known.insert(value.row).second || value.row->is_given(whole)) continue;
    Settings more = whole;
    value.row->read(more, value.words);
    if (!value.row->is_given(more) || !is_one_preset(more, idle + 1)) continue;
    whole = more;
    idle++;
  }
  return whole;
}

// Contradictions.

namespace {

/// Fails with ErrorKind::usage where a setting that is not the usual one has no effect.
void require_effects(const Settings& settings) {
  for (const auto& row : option_table())
    if (row.is_key() && row.is_given(settings))
      if (const std::string why = objection(row, settings); !why.empty()) fail(ErrorKind::usage, "{}", why);
}

// Each scale costs a search and a plane of its own.
constexpr std::size_t kMostRadii = 8;

/// Outputs that a search does not make.
void check_search(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.tolerance == 0 && wants(settings.output, &FrameOutputs::error))
    fail(ErrorKind::usage, "--aov error: only an estimate with a --tolerance knows its error");
  if (shows(settings.output, DebugSource::tiles) && (searches_exactly(e) || e.search == SliceSearch::quick))
    fail(ErrorKind::usage, "--set debug=tiles: {} search leaves out none; --search steps does",
         searches_exactly(e) ? "an exact" : "a quick");
}

/// Shapes are made of the surfaces that block, those of receivers among them.
void check_curvature(const Settings& settings) {
  const InputSettings& input = settings.input;
  const bool has_all = (input.occluders + input.occluder_objects + input.ignore + input.ignored_objects).empty();
  for (const Aov& aov : aovs_of(settings.output))
    if (is_of_curvature(aov) && !has_all)
      fail(ErrorKind::usage,
           "--aov {}: it is the shape of all surfaces, and --set occluders and --set ignore leave some out: make it in "
           "a run of its own",
           aov.name);
}

/// A view of completed surfaces needs some.
void check_completion(const Settings& settings) {
  const auto& e = settings.estimator;
  if (!shows(settings.output, DebugSource::completed)) return;
  if (e.search == SliceSearch::quick)
    fail(ErrorKind::usage, "--set debug=completed: a quick search completes no surfaces; --search steps does");
  if (completes_anywhere(e)) return;
  if (e.complete == Completion::none)
    fail(ErrorKind::usage, "--set debug=completed: --set complete=none completes no surfaces; border and all do");
  fail(ErrorKind::usage, "--set debug=completed: --estimator {} completes no surfaces; gtao and bitmask do",
       e.estimator == Estimator::hbao ? "hbao" : "crytek");
}

/// Whether a view shows how one frame is estimated.
bool is_of_estimate(DebugSource source) {
  return source == DebugSource::tiles || source == DebugSource::completed || source == DebugSource::sites ||
         source == DebugSource::raw_ao || source == DebugSource::denoised_ao;
}

/// A mean of many frames has no tiles, sites or guesses of one, and one frame is no mean.
void check_accumulation(const Settings& settings) {
  const bool is_mean = settings.input.accumulate > 0;
  if (!is_mean && shows(settings.output, DebugSource::count))
    fail(ErrorKind::usage, "--set debug=count: each frame has one estimate; only --accumulate has more");
  for (const auto* view : debug_views_of(settings.output))
    if (is_mean && is_of_estimate(view->source))
      fail(ErrorKind::usage,
           "--set debug={}: it shows the estimate of one frame, and with --accumulate the AO is the mean of many: "
           "leave one of them out",
           view->name);
}

/// Outputs of hidden surfaces need some that are kept.
void check_hidden(const Settings& settings) {
  const bool is_aov = wants(settings.output, &FrameOutputs::hidden);
  if (!is_aov && !shows(settings.output, DebugSource::hidden)) return;
  const char* const option = is_aov ? "--aov " : "--set debug=";
  if (settings.estimator.hidden == 0) fail(ErrorKind::usage, "{}hidden: with --set hidden=0 nothing is kept", option);
  if (!has_hidden_sources(settings.input))
    fail(ErrorKind::usage,
         "{}hidden: there are no hidden surfaces: give --behind, --deep, --around or --set other-views", option);
}

/// Several radii make sense once each; bent normals and transfer need an estimator that finds open directions.
void check_scales(const Settings& settings) {
  const auto& e = settings.estimator;
  for (const Aov& aov : aovs_of(settings.output))
    if (aov.source >= AovSource::open_directions && aov.planes != &FrameOutputs::specular_occlusion &&
        !searches_slices(e))
      fail(ErrorKind::usage, "--aov {}: --estimator {} finds no open directions; gtao and bitmask do", aov.name,
           e.estimator == Estimator::hbao ? "hbao" : "crytek");
  for (const char* name : {"relight", "relight-open"})
    if (settings.output.environment.empty() && std::ranges::count(split(settings.output.aovs), name) > 0)
      fail(ErrorKind::usage, "--aov {}: it is the light of a sky: give --environment", name);
  if (settings.output.lights.empty() && wants(settings.output, &FrameOutputs::shadow))
    fail(ErrorKind::usage, "--aov shadow needs lights: give --lights FILE.json");
  require_distinct_channels(settings);
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
    fail(ErrorKind::usage, "--set bias={}: for all estimators but crytek it is the sine of an elevation, below 1",
         e.bias);
  if (e.falloff_end <= e.falloff_start)
    fail(ErrorKind::usage, "--set falloff-end={} is not above --set falloff-start={}", e.falloff_end, e.falloff_start);
}

/// Two numbers say all of a disparity. Without its scale there are neither scene units nor the file's.
void check_disparity(const Settings& settings) {
  const InputSettings& input = settings.input;
  const DepthRange& range = input.depth_range;
  if (input.depth_kind != DepthKind::disparity) return;
  if (int(range.near.has_value()) + int(range.far.has_value()) + int(range.disparity_scale.has_value()) +
          int(range.disparity_shift.has_value()) >
      2)
    fail(ErrorKind::usage,
         "--near, --far, --set disparity-scale and --set disparity-shift: two of them turn disparity into depth; leave "
         "the others out");
  const Disparity said = disparity_of(range);
  if ((input.around > 0 || input.around_all || input.accumulate > 0) && !(said.scale && said.shift))
    fail(ErrorKind::usage,
         "{}: disparities of several frames do not fit together by themselves: give the scale and the shift of all, by "
         "--near and --far, or --set disparity-scale and --set disparity-shift",
         input.accumulate > 0 ? "--accumulate" : "--around");
  if (range.disparity_scale || range.near || range.far) return;
  for (const auto& row : option_table()) {
    const bool is_length = row.unit.ends_with("scene units") || row.key() == "sky" || row.key() == "depth-scale";
    if (!is_length || !row.is_key() || !row.is_given(settings) || !number_of(row.words(settings).front())) continue;
    fail(ErrorKind::usage,
         "{}: this disparity has no scene units, since its scale is unknown: give {}--set disparity-scale, or --near "
         "or --far, the distance of the value 1 or 0",
         row.long_name(), row.key() == "radius" ? "--radius in percent of the median depth, as 5%, or " : "");
  }
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (main_input(settings.input).empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.estimator.radius && !settings.estimator.radius_auto && needs_radius(settings.output))
    fail(ErrorKind::usage, "no radius: give --radius, the reach of occluders in scene units");
  require_effects(settings);
  check_search(settings);
  check_curvature(settings);
  check_completion(settings);
  check_accumulation(settings);
  check_hidden(settings);
  check_scales(settings);
  check_numbers(settings.estimator);
  check_disparity(settings);
}

}  // namespace alcove
