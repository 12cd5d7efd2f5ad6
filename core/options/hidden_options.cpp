// Options of what lies behind the first surface: where it is known from, and what of it is kept.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/input_files.h"
#include "core/options/options.h"

namespace alcove {
namespace {

constexpr int kMostAround = 32;  // frames to each side: more than any surface stays near
constexpr int kMostKept = 3;     // surfaces behind the first

void read_files(const char* option, const Words& words, FileList& files) {
  if (words.size() > files.size())
    fail(ErrorKind::usage, "{}: there are {} files; a run takes at most {}", option, words.size(), files.size());
  files = {};
  std::ranges::copy(words, files.begin());
}

Words words_of(const FileList& files) {
  Words words;
  std::ranges::copy_if(files, std::back_inserter(words), [](const auto& file) { return !file.empty(); });
  return words;
}

/// The words of a repeated option, of which each may hold several with commas.
Words split_all(const Words& words) {
  Words all;
  for (const auto& word : words) std::ranges::copy(split(word), std::back_inserter(all));
  return all;
}

void read_kinds(const Words& words, std::vector<BehindKind>& kinds) {
  const auto& names = names_of<BehindKind>();
  Words known;
  for (const auto& [word, kind] : names) known.push_back(word);
  std::vector<BehindKind> read;
  for (const auto& text : split_all(words)) {
    const auto kind = names.find(lower_case(text));
    if (kind == names.end())
      fail(ErrorKind::usage, "--behind-kind: {} is none of {}{}", said(text), list_of(known), suggestion(text, known));
    read.push_back(kind->second);
  }
  kinds = read;
}

Words words_of(const std::vector<BehindKind>& kinds) {
  Words words;
  for (const BehindKind kind : kinds)
    for (const auto& [word, meaning] : names_of<BehindKind>())
      if (meaning == kind) words.push_back(word);
  return words;
}

bool read_around(const std::string& text, InputSettings& settings) {
  const bool is_all = lower_case(text) == "all";
  const auto frames = whole_number_of(text);
  if (!is_all && !(frames && *frames >= 0 && *frames <= kMostAround)) return false;
  settings.around_all = is_all;
  settings.around = is_all ? 0 : *frames;
  return true;
}

bool read_separation(const std::string& text, std::optional<double>& separation) {
  const auto length = number_of(text);
  const bool is_length = length && *length >= 0 && !std::isinf(*length);
  if (lower_case(text) != "auto" && !is_length) return false;
  separation = is_length ? length : std::nullopt;
  return true;
}

/// What a list is of that stands once for all files or once for each.
Condition for_each_file(std::size_t (*count)(const InputSettings&)) {
  return {"once, or as often as --behind", [count](const Settings& all) {
            const std::size_t files = words_of(all.input.behind).size(), given = count(all.input);
            if (given <= 1 || given == files) return std::string();
            return fmt::format("there are {} for {} {}", given, files, files == 1 ? "file" : "files");
          }};
}

Condition with_hidden_sources() {
  return {"with --behind, --deep, --around or --other-views",
          [](const Settings& all) { return has_hidden_sources(all.input) ? "" : "there is none of them"; }};
}

/// Estimators that know where what lies behind a surface begins and ends.
Condition to_estimators_of_layers() { return to_estimators({Estimator::gtao, Estimator::bitmask}); }

Condition with_other_frames() {
  return {"with --around or --accumulate", [](const Settings& all) {
            const InputSettings& input = all.input;
            const bool takes_frames = input.around > 0 || input.around_all || input.accumulate > 0;
            return takes_frames ? "" : "there is neither";
          }};
}

Condition with_motion() {
  return {"with --motion", [](const Settings& all) { return all.input.motion.empty() ? "there is none" : ""; }};
}

void add_behind_rows(OptionGroup& files, OptionGroup& pixels, InputSettings& s) {
  files
      .add(
          {"--behind", "FILE", "", "up to 8 times",
           "the depth of surfaces behind the first, in any order: a peel, back faces, another element of the shot; may "
           "be INPUT, with a channel of its own"},
          [&s] { return words_of(s.behind); }, [&s](const Words& words) { read_files("--behind", words, s.behind); })
      .applies(to_estimators_of_layers())
      .repeats = true;
  const auto with_behind =
      with_option("--behind", [](const Settings& all) { return !words_of(all.input.behind).empty(); });
  pixels
      .add(
          {"--behind-channel", "NAME", "", "", "the depth channel of --behind; else found by its usual names"},
          [&s] { return s.behind_channels; }, [&s](const Words& words) { s.behind_channels = split_all(words); })
      .applies(with_behind)
      .applies(for_each_file([](const InputSettings& input) { return input.behind_channels.size(); }))
      .repeats = true;
  OptionRow& kinds = pixels.add(
      {"--behind-kind", "surfaces|fronts|backs|thickness", "", "",
       "what --behind holds: surfaces of all faces; fronts: only those seen from outside, as culled peels and other "
       "elements have them; backs: those seen from inside, where what is before them ends; thickness: how deep what is "
       "seen goes on"},
      [&s] { return words_of(s.behind_kinds); }, [&s](const Words& words) { read_kinds(words, s.behind_kinds); });
  kinds.applies(with_behind).applies(for_each_file([](const InputSettings& input) {
    return input.behind_kinds.size();
  }));
  kinds.repeats = true;
  kinds.default_text = "surfaces";
}

void add_deep_rows(OptionGroup& files, OptionGroup& pixels, InputSettings& s) {
  files
      .add(
          {"--deep", "FILE", "", "up to 8 times",
           "a deep EXR of the frame, for what its samples show behind the first surface; the samples of several, and "
           "of "
           "a deep INPUT, count together, as of elements that were rendered apart"},
          [&s] { return words_of(s.deep); }, [&s](const Words& words) { read_files("--deep", words, s.deep); })
      .repeats = true;
  pixels.number("--deep-opacity", s.deep_opacity, "", between(0, 1), "of a deep sample, from which it is a surface")
      .applies(with_option("--deep", [](const Settings& all) { return has_deep(all.input); }));
}

void add_view_rows(OptionGroup& files, OptionGroup& pixels, InputSettings& s) {
  pixels.flag("--other-views", s.other_views, "of a stereo file: what its other views see of the same instant")
      .applies(to_estimators_of_layers());
  pixels
      .own(
          {"--around", "NUMBER|all", "frames to each side", fmt::format("0 to {}", kMostAround),
           "of a sequence: what other frames see of what stands still; needs the camera of each; all: of the whole "
           "shot"},
          [&s] { return s.around_all ? std::string("all") : fmt::format("{}", s.around); },
          [&s](const std::string& text) { return read_around(text, s); },
          fmt::format("is neither all nor a whole number from 0 to {}", kMostAround))
      .applies(to_estimators_of_layers())
      .harmless = {"0"};
  files
      .text("--motion", s.motion, "FILE",
            "an EXR of motion vectors, in pixels, which tell what moves; else other frames tell")
      .applies(with_other_frames());
  pixels
      .text("--motion-channels", s.motion_channels, "LAYER|X,Y",
            "the layer of the motion vectors, or their channels; else found by their usual names")
      .applies(with_motion());
  pixels
      .choice("--motion-kind", s.motion_kind,
              "where the vectors point: to the place in the previous frame or in the next one; auto: as most pixels "
              "move by the cameras")
      .applies(with_motion())
      .harmless = {"auto"};
}

}  // namespace

void add_hidden_rows(std::vector<OptionRow>& rows, Settings& settings) {
  OptionGroup files(rows, "Hidden surfaces", Effect::input), pixels(rows, "Hidden surfaces", Effect::pixels);
  InputSettings& input = settings.input;
  EstimatorSettings& estimator = settings.estimator;
  add_behind_rows(files, pixels, input);
  add_deep_rows(files, pixels, input);
  add_view_rows(files, pixels, input);
  pixels
      .number("--hidden", estimator.hidden, "surfaces of a pixel", between(0, kMostKept),
              "kept behind the first, the nearest ones; 0: none")
      .applies(with_hidden_sources())
      .harmless = {"0"};
  pixels
      .own(
          {"--separation", "auto|NUMBER", "scene units", "0 or more",
           "surfaces closer to each other are one; auto: by the depth's precision and the slope that a pixel may have"},
          [&estimator] {
            return estimator.separation ? fmt::format("{}", *estimator.separation) : std::string("auto");
          },
          [&estimator](const std::string& text) { return read_separation(text, estimator.separation); },
          "is neither auto nor a length of 0 or more")
      .applies(with_hidden_sources())
      .harmless = {"auto"};
}

}  // namespace alcove
