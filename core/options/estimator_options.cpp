// Options of the estimate of ambient occlusion.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/options/options.h"

namespace alcove {
namespace {

void read_radii(const Words& words, const Range& reach, EstimatorSettings& settings) {
  std::vector<double> radii;
  for (const auto& text : words) {
    const auto radius = number_of(text);
    if (!radius || !std::isfinite(*radius)) fail(ErrorKind::usage, "--radius: {} is not a finite number", text);
    if (!reach.holds(*radius)) fail(ErrorKind::usage, "--radius: {} is not {}", text, reach.text);
    radii.push_back(*radius);
  }
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
}

Words words_of_radii(const EstimatorSettings& settings) {
  Words words;
  if (settings.radius) words.push_back(fmt::format("{}", *settings.radius));
  for (const double radius : settings.further_radii) words.push_back(fmt::format("{}", radius));
  return words;
}

bool read_thickness(const std::string& text, EstimatorSettings& settings) {
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
      fail(ErrorKind::usage, "--denoise-kernel: {} is no weight of 0 or more", word);
    weights.push_back(*weight);
  }
  if (weights.size() < 2 || weights.size() > 9)
    fail(ErrorKind::usage, "--denoise-kernel: {} has {} weights, not 2 to 9", text, weights.size());
  if (weights.front() == 0) fail(ErrorKind::usage, "--denoise-kernel: {} has no weight at the centre", text);
  kernel = weights;
}

void add_radius_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.choice("--estimator", s.estimator,
                "gtao: horizons; bitmask: what is blocked between front and back of every occluder; hbao: horizons, "
                "not cosine weighted; crytek: samples in the hemisphere");
  const Range reach = above_to(0, 1e18);
  pixels
      .add(
          {"--radius", "NUMBER", "scene units", reach.text,
           "how far occluders reach; must be given, here or in a preset. May repeat: the AO is the mean of all "
           "scales, see ao-scales"},
          [&s] { return words_of_radii(s); }, [&s, reach](const Words& words) { read_radii(words, reach, s); })
      .repeats = true;
  pixels.choice("--falloff", s.falloff, "how a hit's weight fades towards the radius; none: all within it block fully");
  pixels.number("--falloff-start", s.falloff_start, "of the radius", below_and_at_least(0, 1),
                "where the falloff begins");
  pixels.number("--falloff-end", s.falloff_end, "of the radius", above_to(0, 1),
                "where the falloff ends: nothing beyond blocks");
}

void add_search_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.number("--slices", s.slices, "per pixel", between(1, 64), "directions that are searched");
  pixels.number("--steps", s.steps, "per side", between(1, 4096), "samples to each side of a slice");
  pixels.choice("--search", s.search,
                "gtao's search along a slice; steps: as many samples as --steps; exact: all pixels, by the outlines of "
                "surfaces; every-pixel: the same one by one, slowly");
  pixels.number("--tolerance", s.tolerance, "", between(0, 1),
                "RMS error of gtao's AO by its search: as many directions of an exact search, tile by tile, as that "
                "takes, without a denoiser; 0: as many as --slices");
  pixels.number("--samples", s.samples, "per pixel", between(4, 64), "crytek's samples in the hemisphere");
  pixels.number("--bias", s.bias, "", between(0, 1e18),
                "keeps a surface from blocking itself; crytek: scene units of depth; others: sine of the elevation "
                "above the surface, below 1");
  pixels.choice("--elevation", s.elevation,
                "for hbao; view: the horizon's less the surface's, above the plane across the view ray; surface: the "
                "horizon's above the surface");
  pixels.choice("--sample-kernel", s.sample_kernel,
                "for crytek; clustered: more samples near the receiver; uniform: even in volume");
  pixels.choice("--range-check", s.range_check,
                "for crytek, by the depth dz between receiver and hit; none: every hit counts fully; ratio: "
                "smoothstep(0, 1, radius / dz); smoothstep: 1 - smoothstep(0, radius, dz)");
  pixels.own(
      {"--thickness", "auto|infinite|NUMBER", "scene units", "",
       "how far an occluder goes on behind what is seen of it; auto: as deep as it is wide; in an exact search with "
       "--complete all half as deep, since less is left for thickness to stand for"},
      [&s] { return text_of_thickness(s); }, [&s](const std::string& text) { return read_thickness(text, s); },
      "is neither auto nor infinite nor a length above 0");
  pixels.choice(
      "--complete", s.complete,
      "for gtao and bitmask, where surfaces go on straight although the frame does not show it; none: nowhere; "
      "border: beyond the picture's border; all: also behind what is nearer. hbao and crytek complete nothing");
}

void add_filter_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.choice("--resolution", s.resolution,
                "of the estimate; a half or a quarter takes the nearest surface of every 2 x 2 or 4 x 4 pixels");
  pixels.choice("--density", s.density,
                "where pixels have an estimate of their own; uniform: one of --stride, evenly, so that surfaces of few "
                "pixels may get none; adaptive: for gtao by steps and for bitmask one of --stride at least, and more "
                "where a surface shows few pixels; other estimators and exact searches are uniform");
  pixels.own(
      {"--stride", "auto|1|2|4|8|16", "", "",
       "estimate one pixel of so many, and let the bilateral denoiser give the others theirs; auto: 1, but at full "
       "resolution with the bilateral denoiser 16 with --density adaptive, or 2 from 5 slices on, and 4 with 1 or 2 "
       "slices for gtao with --density uniform"},
      [&s] { return s.stride == 0 ? std::string("auto") : fmt::format("{}", s.stride); },
      [&s](const std::string& text) {
        const std::vector<std::string> strides = {"1", "2", "4", "8", "16"};
        const auto found = std::ranges::find(strides, text);
        if (text != "auto" && found == strides.end()) return false;
        s.stride = text == "auto" ? 0 : 1 << (found - strides.begin());
        return true;
      },
      "is none of auto, 1, 2, 4, 8, 16");
  pixels.choice(
      "--denoise", s.denoise,
      "smooths each surface: bilateral: by a Gaussian or --denoise-kernel, and where pixels share estimates by a line "
      "fitted to those in reach; box: by an even 4 x 4");
  pixels.own(
      {"--denoise-radius", "auto|NUMBER", "pixels of the estimate", "1 to 8",
       "how far the bilateral denoiser reaches to each side; auto: 8 where pixels share estimates, 4 where each has "
       "its "
       "own"},
      [&s] { return s.denoise_radius == 0 ? std::string("auto") : fmt::format("{}", s.denoise_radius); },
      [&s](const std::string& text) {
        const bool is_digit = text.size() == 1 && text >= "1" && text <= "8";
        if (text != "auto" && !is_digit) return false;
        s.denoise_radius = is_digit ? text.front() - '0' : 0;
        return true;
      },
      "is neither auto nor a whole number from 1 to 8");
  pixels.add(
      {"--denoise-kernel", "W0,W1,...", "", "2 to 9 weights",
       "of the bilateral denoiser, from the centre outwards, of any sum; they set its radius"},
      [&s] { return s.denoise_kernel.empty() ? Words{} : Words{fmt::format("{}", fmt::join(s.denoise_kernel, ","))}; },
      [&s](const Words& words) { read_kernel(words.front(), s.denoise_kernel); });
  pixels.number("--denoise-depth-sigma", s.denoise_depth_sigma, "of the depth", between(0, 100),
                "pixels that far apart weigh 1/e: exp(-|dz| / (SIGMA z)), z the nearer; 0: weighs by the distance from "
                "each other's plane");
}

void add_shape_rows(std::vector<OptionRow>& rows, EstimatorSettings& s) {
  OptionGroup pixels(rows, "Estimator", Effect::pixels);
  pixels.number("--intensity", s.intensity, "", between(0, 100), "factor on the occlusion");
  pixels.number("--power", s.power, "", above_to(0, 100), "exponent of the visibility");
  pixels.number("--fade-start", s.fade_start, "scene units", between(0, 1e30),
                "depth where the AO begins to fade to 1; with --fade-end");
  pixels.number("--fade-end", s.fade_end, "scene units", above_to(0, 1e30), "depth from which the AO is 1");
  pixels.number("--roughness", s.roughness, "", between(0, 1), "of all surfaces, for specular-occlusion");
  pixels.choice("--noise", s.noise,
                "fixed: every frame has the same pattern of sample noise, so that what stands still does not flicker; "
                "animated: each frame has its own");
  pixels.number("--seed", s.seed, "", between(0, 4294967295.0), "shifts the sample noise");
  OptionGroup(rows, "Estimator", Effect::none)
      .flag("--no-skip", s.no_skip, "estimate sky too, and tiles that are proved to be open; slower, the same bits");
  pixels.number("--skip-tolerance", s.skip_tolerance, "", between(0, 0.1),
                "for gtao and bitmask: also leave out, as open, tiles whose AO, before --intensity and --power, is "
                "proved to be at least 1 less this, whatever the noise of few samples; 0: the same bits as --no-skip");
}

}  // namespace

void add_estimator_rows(std::vector<OptionRow>& rows, RunOptions& options) {
  OptionGroup(rows, "Estimator", Effect::none)
      .add(
          {"--preset", "NAME|FILE", "", "", "settings from a preset; may repeat, later wins, options win over presets"},
          [&options] { return options.presets; }, [&options](const Words& words) { options.presets = words; })
      .is_key = false;
  EstimatorSettings& settings = options.settings.estimator;
  add_radius_rows(rows, settings);
  add_search_rows(rows, settings);
  add_filter_rows(rows, settings);
  add_shape_rows(rows, settings);
}

}  // namespace alcove
