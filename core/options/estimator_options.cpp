// Options of the estimate of ambient occlusion.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/options/options.h"

namespace alcove {
namespace {

void read_radii(const Words& words, const Range& reach, EstimatorSettings& settings) {
  settings.radius_auto = words.size() == 1 && lower_case(words.front()) == "auto";
  settings.radius.reset();
  settings.further_radii.clear();
  if (settings.radius_auto) return;
  std::vector<double> radii;
  for (const auto& word : words)
    for (const auto& text : split(word)) radii.push_back(number_in(reach, "--radius", text));
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
}

Words words_of_radii(const EstimatorSettings& settings) {
  if (settings.radius_auto) return {"auto"};
  Words words;
  if (settings.radius) words.push_back(fmt::format("{}", *settings.radius));
  for (const double radius : settings.further_radii) words.push_back(fmt::format("{}", radius));
  return words;
}

bool read_thickness(const std::string& given, EstimatorSettings& settings) {
  const std::string text = lower_case(given);
  if (text == "auto" || text == "infinite") {
    settings.thickness = text == "auto" ? ThicknessKind::automatic : ThicknessKind::infinite;
    return true;
  }
  const auto length = number_of(text);
  if (!length || !(*length > 0) || std::isinf(*length)) return false;
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = *length;
  return true;
}

std::string text_of_thickness(const EstimatorSettings& settings) {
  if (settings.thickness == ThicknessKind::automatic) return "auto";
  if (settings.thickness == ThicknessKind::infinite) return "infinite";
  return fmt::format("{}", settings.thickness_length);
}

void read_kernel(const std::string& text, std::vector<double>& kernel) {
  std::vector<double> weights;
  for (const auto& word : split(text)) {
    const auto weight = number_of(word);
    if (!weight || !(*weight >= 0) || std::isinf(*weight))
      fail(ErrorKind::usage, "--denoise-kernel: {} is no weight of 0 or more", said(word));
    weights.push_back(*weight);
  }
  if (weights.size() < 2 || weights.size() > 9)
    fail(ErrorKind::usage, "--denoise-kernel: {} has {} weights, not 2 to 9", text, weights.size());
  if (weights.front() == 0) fail(ErrorKind::usage, "--denoise-kernel: {} has no weight at the centre", text);
  kernel = weights;
}

/// The option is of estimators that search slices and fade hits by their distance.
void fades_hits(OptionRow& row) {
  row.applies(or_confidence(to_estimators({Estimator::gtao, Estimator::bitmask, Estimator::hbao})))
      .applies(or_confidence(to_steps()));
}

void add_radius_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.choice("--estimator", s.estimator,
                "gtao: horizons; bitmask: what is blocked between front and back of every occluder; hbao: horizons, "
                "not cosine weighted; crytek: samples in the hemisphere");
  const Range reach = above_to(0, 1e18);
  OptionRow& radius = pixels.add(
      {"--radius", "auto|NUMBER[,NUMBER...]", "scene units", reach.text,
       "how far occluders reach; must be given, here or in a preset; auto: what inspect proposes, one number for all "
       "frames. Of several the AO is the mean, see ao-scales"},
      [&s] { return words_of_radii(s); }, [&s, reach](const Words& words) { read_radii(words, reach, s); });
  radius.repeats = radius.is_common = true;
  OptionRow& falloff = pixels.choice("--falloff", s.falloff,
                                     "how a hit's weight fades towards the radius; none: all within it block fully");
  fades_hits(falloff);
  falloff.harmless = {"none"};
  OptionRow& start = pixels.number("--falloff-start", s.falloff_start, "of the radius", below_and_at_least(0, 1),
                                   "where the falloff begins");
  fades_hits(start);
  start.applies(with_falloff()).harmless = {"0"};
  pixels
      .number("--falloff-end", s.falloff_end, "of the radius", above_to(0, 1),
              "where the falloff ends: nothing beyond blocks")
      .applies(or_confidence(to_estimators({Estimator::gtao, Estimator::bitmask, Estimator::hbao})))
      .harmless = {"1"};
}

void add_search_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  const Condition of_slices = to_estimators({Estimator::gtao, Estimator::bitmask, Estimator::hbao});
  const Condition of_ranges = to_estimators({Estimator::gtao, Estimator::bitmask});
  const Condition of_crytek = to_estimators({Estimator::crytek});
  pixels.number("--slices", s.slices, "per pixel", between(1, 64), "directions that are searched")
      .applies(or_confidence(of_slices))
      .applies(or_confidence(without_tolerance()));
  pixels.number("--steps", s.steps, "per side", between(1, 4096), "samples to each side of a slice")
      .applies(or_confidence(of_slices))
      .applies(or_confidence(to_steps()));
  pixels
      .choice("--search", s.search,
              "the search along a slice; steps: as many samples as --steps; exact: all pixels, by the outlines of "
              "surfaces; every-pixel: the same one by one, slowly")
      .applies(as_search({SliceSearch::exact, SliceSearch::every_pixel}, to_estimators({Estimator::gtao})))
      .applies(as_search({SliceSearch::steps}, without_tolerance()));
  pixels
      .number("--tolerance", s.tolerance, "", between(0, 1),
              "RMS error of the AO by its search: as many directions of an exact search, tile by tile, as that "
              "takes, without a denoiser; 0: as many as --slices")
      .applies(to_estimators({Estimator::gtao}))
      .contradicts({"--resolution"}, "the error is that of every pixel, at --resolution full")
      .harmless = {"0"};
  pixels.number("--samples", s.samples, "per pixel", between(4, 64), "samples in the hemisphere").applies(of_crytek);
  pixels.number("--bias", s.bias, "", between(0, 1e18),
                "keeps a surface from blocking itself; crytek: scene units of depth; others: sine of the elevation "
                "above the surface, below 1");
  pixels
      .choice("--elevation", s.elevation,
              "view: the horizon's less the surface's, above the plane across the view ray; surface: the horizon's "
              "above the surface")
      .applies(to_estimators({Estimator::hbao}));
  pixels
      .choice("--sample-kernel", s.sample_kernel, "clustered: more samples near the receiver; uniform: even in volume")
      .applies(of_crytek);
  pixels
      .choice("--range-check", s.range_check,
              "by the depth dz between receiver and hit; none: every hit counts fully; ratio: smoothstep(0, 1, radius "
              "/ dz); smoothstep: 1 - smoothstep(0, radius, dz)")
      .applies(of_crytek);
  OptionRow& thickness = pixels.own(
      {"--thickness", "auto|infinite|NUMBER", "scene units", "",
       "how far an occluder goes on behind what is seen of it; auto: as deep as it is wide; in an exact search with "
       "--complete all half as deep, since less is left for thickness to stand for"},
      [&s] { return text_of_thickness(s); }, [&s](const std::string& text) { return read_thickness(text, s); },
      "is neither auto nor infinite nor a length above 0");
  thickness.applies(of_ranges).harmless = {"auto"};
  pixels
      .choice("--complete", s.complete,
              "where surfaces go on straight although the frame does not show it; none: nowhere; border: beyond the "
              "picture's border; all: also behind what is nearer")
      .applies(of_ranges)
      .harmless = {"none"};
}

void add_filter_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels
      .choice("--resolution", s.resolution,
              "of the estimate; a half or a quarter takes the nearest surface of every 2 x 2 or 4 x 4 pixels")
      .harmless = {"full"};
  pixels
      .choice("--density", s.density,
              "where pixels have an estimate of their own; uniform: one of --stride, evenly, so that surfaces of few "
              "pixels may get none; adaptive: one of --stride at least, and more where a surface shows few pixels")
      .applies(or_confidence(to_estimators({Estimator::gtao, Estimator::bitmask})))
      .applies(or_confidence(to_steps()))
      .applies(with_shared_estimates());
  OptionRow& stride = pixels.own(
      {"--stride", "auto|1|2|4|8|16", "", "",
       "estimate one pixel of so many, and let the bilateral denoiser give the others theirs; auto: 1, but at full "
       "resolution with the bilateral denoiser 16 with --density adaptive, or 2 from 5 slices on, and 4 with 1 or 2 "
       "slices for gtao with --density uniform"},
      [&s] { return s.stride == 0 ? std::string("auto") : fmt::format("{}", s.stride); },
      [&s](const std::string& text) {
        const std::vector<std::string> strides = {"1", "2", "4", "8", "16"};
        const bool is_auto = lower_case(text) == "auto";
        const auto found = std::ranges::find(strides, text);
        if (!is_auto && found == strides.end()) return false;
        s.stride = is_auto ? 0 : 1 << (found - strides.begin());
        return true;
      },
      "is none of auto, 1, 2, 4, 8, 16");
  stride.applies(or_confidence(to_steps())).applies(with_denoise({Denoise::bilateral})).harmless = {"auto", "1"};
}

void add_denoise_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  const Condition denoises = or_confidence(without_tolerance());
  pixels
      .choice("--denoise", s.denoise,
              "smooths each surface: bilateral: by a Gaussian or --denoise-kernel, and where pixels share estimates by "
              "a line fitted to those in reach; box: by an even 4 x 4")
      .applies(denoises)
      .harmless = {"none"};
  OptionRow& radius = pixels.own(
      {"--denoise-radius", "auto|NUMBER", "pixels of the estimate", "1 to 8",
       "how far the bilateral denoiser reaches to each side; auto: 8 where pixels share estimates, 4 where each has "
       "its "
       "own"},
      [&s] { return s.denoise_radius == 0 ? std::string("auto") : fmt::format("{}", s.denoise_radius); },
      [&s](const std::string& text) {
        const bool is_digit = text.size() == 1 && text >= "1" && text <= "8";
        if (lower_case(text) != "auto" && !is_digit) return false;
        s.denoise_radius = is_digit ? text.front() - '0' : 0;
        return true;
      },
      "is neither auto nor a whole number from 1 to 8");
  radius.applies(with_denoise({Denoise::bilateral})).applies(denoises).harmless = {"auto"};
  OptionRow& kernel = pixels.add(
      {"--denoise-kernel", "W0,W1,...", "", "2 to 9 weights",
       "from the centre outwards, of any sum; they set the denoiser's radius"},
      [&s] { return s.denoise_kernel.empty() ? Words{} : Words{fmt::format("{}", fmt::join(s.denoise_kernel, ","))}; },
      [&s](const Words& words) { read_kernel(words.front(), s.denoise_kernel); });
  kernel.applies(with_denoise({Denoise::bilateral}))
      .applies(denoises)
      .contradicts({"--denoise-radius"}, "as many weights as there are make the radius");
  pixels
      .number("--denoise-depth-sigma", s.denoise_depth_sigma, "of the depth", between(0, 100),
              "pixels that far apart weigh 1/e: exp(-|dz| / (SIGMA z)), z the nearer; 0: weighs by the distance from "
              "each other's plane")
      .applies(with_denoise({Denoise::bilateral, Denoise::box}))
      .applies(denoises)
      .harmless = {"0"};
}

void add_shape_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.number("--intensity", s.intensity, "", between(0, 100), "factor on the occlusion");
  pixels.number("--power", s.power, "", above_to(0, 100), "exponent of the visibility");
  pixels.number("--fade-start", s.fade_start, "scene units", between(0, 1e30), "depth where the AO begins to fade to 1")
      .applies(with_option("--fade-end", [](const Settings& all) { return all.estimator.fade_end.has_value(); }));
  pixels.number("--fade-end", s.fade_end, "scene units", above_to(0, 1e30), "depth from which the AO is 1")
      .applies(with_option("--fade-start", [](const Settings& all) { return all.estimator.fade_start.has_value(); }));
  pixels.number("--roughness", s.roughness, "", between(0, 1), "of all surfaces")
      .applies(with_aovs({"specular-occlusion"}));
  pixels
      .choice("--noise", s.noise,
              "fixed: every frame has the same pattern of sample noise, so that what stands still does not flicker; "
              "animated: each frame has its own")
      .applies(or_confidence(to_steps()))
      .contradicts({"--accumulate"}, "a mean of many frames gains nothing where all have the same noise", {"fixed"})
      .harmless = {"fixed"};
  pixels.number("--seed", s.seed, "", between(0, 4294967295.0), "shifts the sample noise")
      .applies(or_confidence(to_steps()))
      .harmless = {"0"};
  OptionGroup(rows, "Estimator", Effect::none)
      .flag("--no-skip", s.no_skip, "estimate sky too, and what is as in the frame before; slower, the same bits");
}

/// Of frames to each side: more are too far away to show the same.
constexpr int kMostAccumulated = 16;

bool read_accumulate(const std::string& text, int& frames) {
  if (lower_case(text) == "all")
    fail(ErrorKind::usage,
         "--accumulate all: a mean of the whole shot would make every frame wait for all others, and far ones show "
         "little "
         "of it: give a number of frames to each side, up to {}",
         kMostAccumulated);
  const auto number = whole_number_of(text);
  if (!number || *number < 0 || *number > kMostAccumulated) return false;
  frames = *number;
  return true;
}

void add_time_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup(rows, "Estimator", Effect::pixels)
      .own(
          {"--accumulate", "NUMBER", "frames to each side", fmt::format("0 to {}", kMostAccumulated),
           "of a sequence: the AO is the mean of the estimates of so many frames before and behind, of what stands "
           "still "
           "with all around it; needs the camera of each, and animates the noise"},
          [&s] { return fmt::format("{}", s.accumulate); },
          [&s](const std::string& text) { return read_accumulate(text, s.accumulate); },
          fmt::format("is no whole number from 0 to {}", kMostAccumulated))
      .contradicts({"--tolerance"}, "an estimate by its error is as exact as was asked for by itself")
      .harmless = {"0"};
}

}  // namespace

void add_estimator_rows(std::vector<OptionRow>& rows, RunOptions& options) {
  OptionRow& preset =
      OptionGroup(rows, "Estimator", Effect::none)
          .add(
              {"--preset", "NAME|FILE[,...]", "", "",
               "settings from presets; later ones win, and options win over presets"},
              [&options] { return options.presets; }, [&options](const Words& words) { options.presets = words; });
  preset.repeats = preset.is_common = true;
  preset.is_key = false;
  EstimatorSettings& settings = options.settings.estimator;
  add_radius_rows(rows, settings);
  add_search_rows(rows, settings);
  add_filter_rows(rows, settings);
  add_denoise_rows(rows, settings);
  add_shape_rows(rows, settings);
  add_time_rows(rows, options.settings.input);
}

}  // namespace alcove
