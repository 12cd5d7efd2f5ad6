// Options of what lies behind the first surface: where it is known from, and what of it is kept.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/raw_plane.h"
#include "core/options/option_conflicts.h"
#include "core/options/options.h"

namespace alcove {
namespace {

using InputGroup = OptionGroup<Settings, InputSettings Settings::*>;

constexpr int kMostAround = 32;  // frames to each side: more than any surface stays near
constexpr int kMostKept = 3;     // surfaces behind the first

void read_files(const Words& words, FileList& files) {
  if (words.size() > files.size())
    fail(ErrorKind::usage, "there are {} files; a run takes at most {}", words.size(), files.size());
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
  constexpr auto& kKinds = kWordsOf<BehindKind>;
  Words known;
  for (const auto& [word, kind] : kKinds) known.push_back(word);
  std::vector<BehindKind> read;
  for (const auto& text : split_all(words)) {
    const auto* kind = std::ranges::find(kKinds, lower_case(text), &Word<BehindKind>::first);
    if (kind == std::end(kKinds))
      fail(ErrorKind::usage, "{} is none of {}{}", visible(text), list_of(known), suggestion(text, known));
    read.push_back(kind->second);
  }
  kinds = read;
}

Words words_of(const std::vector<BehindKind>& kinds) {
  Words words;
  for (const BehindKind kind : kinds) words.push_back(word_of(kind));
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

/// A list stands once for all files of --behind, or once for each.
std::string unless_for_each_file(const InputSettings& input, std::size_t given) {
  const std::size_t files = words_of(input.behind).size();
  if (files == 0) return "there is no --behind";
  return given <= 1 || given == files ? "" : fmt::format("there are {} for {} of --behind", given, files);
}

std::string unless_hidden_sources(const Settings& all) {
  return unless_given(has_hidden_sources(all.input), "--behind, --deep, --around or --set other-views");
}

std::string unless_motion(const Settings& all) { return unless_given(!all.input.motion.empty(), "--motion"); }

void add_behind_rows(InputGroup& pixels) {
  using S = InputSettings;
  SettingRow& behind = pixels.add(
      {"--behind", "FILE", "", "up to 8 times", "depth behind the first surface: peels, back faces, other elements"},
      [](const S& s) { return words_of(s.behind); }, [](S& s, const Words& words) { read_files(words, s.behind); });
  behind.repeats = true;
  behind.names(FileRole::input);
  behind.idle(unless_ranges_anywhere);
  SettingRow& channels = pixels.add(
      {"behind-channel", "NAME[,NAME...]", "", "",
       "the depth channel of the --behind files: one for all, or one for each"},
      [](const S& s) { return s.behind_channels; },
      [](S& s, const Words& words) { s.behind_channels = split_all(words); });
  channels.repeats = true;
  channels.idle([](const Settings& all) { return unless_for_each_file(all.input, all.input.behind_channels.size()); });
  SettingRow& kinds = pixels.add(
      {"--behind-kind", "surfaces|fronts|backs|thickness[,...]", "", "",
       "the kind of the --behind files: one for all, or one for each; backs: back faces; thickness: of solids"},
      [](const S& s) { return words_of(s.behind_kinds); },
      [](S& s, const Words& words) { read_kinds(words, s.behind_kinds); });
  kinds.repeats = kinds.in_library = true;
  kinds.default_text = "surfaces";
  kinds.idle([](const Settings& all) { return unless_for_each_file(all.input, all.input.behind_kinds.size()); });
}

void add_deep_rows(InputGroup& pixels) {
  using S = InputSettings;
  pixels
      .add(
          {"--deep", "FILE", "", "up to 8 times", "a deep EXR, for hidden surfaces"},
          [](const S& s) { return words_of(s.deep); }, [](S& s, const Words& words) { read_files(words, s.deep); })
      .names(FileRole::input)
      .repeats = true;
  pixels.number("deep-opacity", &S::deep_opacity, "", between(0, 1), "the least opacity of a deep surface")
      .idle([](const Settings& all) { return unless_given(has_deep(all.input), "--deep"); });
}

void add_view_rows(InputGroup& pixels) {
  using S = InputSettings;
  pixels.flag("other-views", &S::other_views, "add hidden surfaces from a stereo file's other views")
      .idle(unless_ranges_anywhere);
  pixels
      .own(
          {"--around", "NUMBER|all", "frames to each side", fmt::format("0 to {}", kMostAround),
           "add static hidden surfaces from other frames; needs each frame's camera"},
          [](const S& s) { return s.around_all ? std::string("all") : fmt::format("{}", s.around); },
          [](S& s, const std::string& text) { return read_around(text, s); },
          fmt::format("is neither all nor a whole number from 0 to {}", kMostAround))
      .others_idle(unless_ranges_anywhere);
  pixels.text("--motion", &S::motion, "FILE", "motion vectors, in pixels, to find moving surfaces")
      .names(FileRole::input)
      .idle([](const Settings& all) {
        const InputSettings& input = all.input;
        const bool takes_frames = input.around > 0 || input.around_all || input.accumulate > 0;
        return unless_given(takes_frames, "--around and no --accumulate");
      });
  pixels
      .text("motion-channels", &S::motion_channels, "LAYER|X,Y",
            "the vectors' layer or channels; else found by their usual names")
      .idle(unless_motion);
  pixels.choice("motion-kind", &S::motion_kind, "the frame that vectors point to; auto: by the cameras")
      .others_idle(unless_motion);
}

}  // namespace

void add_hidden_rows(std::vector<SettingRow>& rows) {
  OptionGroup pixels(rows, "Hidden surfaces", Effect::pixels, &Settings::input);
  add_behind_rows(pixels);
  add_deep_rows(pixels);
  add_view_rows(pixels);
  OptionGroup kept(rows, "Hidden surfaces", Effect::pixels, &Settings::estimator, true);
  kept.number("hidden", &EstimatorSettings::hidden, "surfaces of a pixel", between(0, kMostKept),
              "hidden surfaces kept behind the first one, nearest first; 0: none")
      .idle([](const Settings& all) { return all.estimator.hidden == 0 ? "" : unless_hidden_sources(all); });
  kept.own(
          {"separation", "auto|NUMBER", "scene units", "0 or more",
           "surfaces closer to each other are one; auto: by the depth's precision and slope"},
          [](const EstimatorSettings& s) {
            return s.separation ? fmt::format("{}", *s.separation) : std::string("auto");
          },
          [](EstimatorSettings& s, const std::string& text) { return read_separation(text, s.separation); },
          "is neither auto nor a length of 0 or more")
      .others_idle(unless_hidden_sources);
}

}  // namespace alcove
