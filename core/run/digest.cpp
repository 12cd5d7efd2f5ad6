// The text of all settings that change the result, and its digest.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/digest.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/formats/color.h"
#include "core/frame/input_files.h"
#include "core/options/options.h"

namespace alcove {
namespace {

/// What the configuration of the display says; "" for the built-in one.
std::string display_text(const std::string& ocio) {
  const std::string file = display_config_file(ocio);
  if (file.empty()) return "";
  return read_text(file, "OpenColorIO configuration", ocio.empty() ? "the OCIO variable" : "--set ocio");
}

/// What of an option's value tells results apart; none: nothing does.
Words telling_words(const OptionRow& row, const OutputSettings& output) {
  const Words words = row.words();
  switch (row.effect) {
    case Effect::none: return {};
    case Effect::pixels: return words;
    case Effect::input: return Words(words.size(), "given");
    case Effect::pixels_or_input: return words.empty() || number_of(words.front()) ? words : Words{"given"};
    case Effect::pixels_or_picture: return words.empty() || !names_picture(words.front()) ? words : Words{"given"};
    case Effect::content:
      return words.empty() ? Words{} : Words{read_text(words.front(), row.key().c_str(), row.long_name().c_str())};
    case Effect::display: return shows_composite(output) ? Words{display_text(output.ocio)} : Words{};
  }
  return {};
}

}  // namespace

bool shows_composite(const OutputSettings& output) {
  return !output.preview.empty() && !output.composite.empty() && output.preview_style != "ao";
}

std::string options_digest(const Settings& settings) {
  RunOptions options;
  options.settings = settings;
  // The AO is the mean of all scales, in whatever order they were given.
  EstimatorSettings& estimator = options.settings.estimator;
  for (double& further : estimator.further_radii)
    if (further < *estimator.radius) std::swap(further, *estimator.radius);
  std::ranges::sort(estimator.further_radii);
  // Each word goes with its length, so that no two sets of values make one text.
  std::string text = kVersion;
  for (const auto& row : option_table(options))
    for (const auto& word : telling_words(row, settings.output))
      text += fmt::format("\n{} {} {}", row.key(), word.size(), word);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace alcove
