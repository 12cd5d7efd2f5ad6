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

using S = EstimatorSettings;
using EstimatorGroup = OptionGroup<Settings, S Settings::*>;

/// The range of a radius.
Range reach() { return above_to(0, 1e18); }

/// The part that a text such as "5%" says.
double percent_in(const Range& range, const std::string& text) {
  return number_in(range, text.substr(0, text.size() - 1)) / 100;
}

void read_radii(const Words& words, EstimatorSettings& settings) {
  settings.radius_auto = words.size() == 1 && lower_case(words.front()) == "auto";
  settings.radius_in_medians = false;
  settings.radius.reset();
  settings.further_radii.clear();
  if (settings.radius_auto) return;
  std::vector<double> radii;
  std::size_t percents = 0;
  for (const auto& word : words)
    for (const auto& text : split(word)) {
      percents += text.ends_with('%');
      radii.push_back(text.ends_with('%') ? percent_in(reach(), text) : number_in(reach(), text));
    }
  if (percents > 0 && percents < radii.size())
    fail(ErrorKind::usage, "some radii are in percent of the median depth and others in scene units: give one kind");
  settings.radius_in_medians = percents > 0;
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
}

Words words_of_radii(const EstimatorSettings& settings) {
  if (settings.radius_auto) return {"auto"};
  const auto word = [&](double radius) {
    return settings.radius_in_medians ? fmt::format("{:.12g}%", 100 * radius) : fmt::format("{}", radius);
  };
  Words words;
  if (settings.radius) words.push_back(word(*settings.radius));
  for (const double radius : settings.further_radii) words.push_back(word(radius));
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
      fail(ErrorKind::usage, "{} is no weight of 0 or more", visible(word));
    weights.push_back(*weight);
  }
  if (weights.size() < 2 || weights.size() > 9)
    fail(ErrorKind::usage, "{} has {} weights, not 2 to 9", text, weights.size());
  if (weights.front() == 0) fail(ErrorKind::usage, "{} has no weight at the centre", text);
  kernel = weights;
}

/// An estimate by steps along slices, which fades hits by their distance.
std::string unless_fading(const Settings& all) {
  return asks_for_confidence(all) ? "" : first_of({unless_slices(all), if_exact(all)});
}

std::string if_exact_alone(const Settings& all) { return asks_for_confidence(all) ? "" : if_exact(all); }
std::string if_unsampled(const Settings& all) { return asks_for_shadows(all) ? "" : if_exact_alone(all); }
std::string if_by_error_alone(const Settings& all) { return asks_for_confidence(all) ? "" : if_by_error(all); }
std::string if_undenoised(const Settings& all) { return asks_for_shadows(all) ? "" : if_by_error_alone(all); }
std::string unless_slices_anywhere(const Settings& all) { return asks_for_confidence(all) ? "" : unless_slices(all); }

void add_radius_rows(EstimatorGroup& pixels) {
  pixels.choice("--estimator", &S::estimator, "gtao: horizons; bitmask: sectors; hbao, crytek: as in older renderers");
  SettingRow& radius = pixels.add(
      {"--radius", "auto|NUMBER[%][,NUMBER[%]...]", "scene units", reach().text,
       "the reach of occluders; auto: as inspect proposes; 5%: of the median depth; several: the AO is their mean"},
      [](const S& s) { return words_of_radii(s); }, [](S& s, const Words& words) { read_radii(words, s); });
  radius.repeats = radius.is_common = true;
  pixels.choice("--falloff", &S::falloff, "how a hit's weight fades towards the radius").others_idle(unless_fading);
  pixels
      .number("falloff-start", &S::falloff_start, "of the radius", Range{0, 1, false, true, "at least 0 and below 1"},
              "where the falloff begins")
      .others_idle(unless_fading)
      .idle([](const Settings& all) { return all.estimator.falloff == Falloff::none ? "--falloff is none" : ""; });
  pixels
      .number("falloff-end", &S::falloff_end, "of the radius", above_to(0, 1),
              "where the falloff ends: nothing beyond blocks")
      .others_idle(unless_slices_anywhere);
}

void add_search_rows(EstimatorGroup& pixels) {
  const auto unless_crytek = [](const Settings& all) { return unless_estimator(all, {Estimator::crytek}); };
  pixels.number("--slices", &S::slices, "per pixel", between(1, 64), "directions of the search, and to a soft light")
      .idle(unless_slices_anywhere)
      .idle(if_by_error_alone);
  pixels.number("--steps", &S::steps, "per side", between(1, 4096), "samples to each side of a slice")
      .idle(unless_slices_anywhere)
      .idle(if_exact_alone);
  pixels
      .choice("--search", &S::search,
              "pixels of a slice; steps: --steps samples; quick: the same by fewer rules; exact: all pixels")
      .idle([](const Settings& all) {
        const SliceSearch search = all.estimator.search;
        const std::string why = search == SliceSearch::steps ? "" : unless_estimator(all, {Estimator::gtao});
        return first_of({why, search == SliceSearch::steps || search == SliceSearch::quick ? if_by_error(all) : ""});
      });
  pixels
      .number("--tolerance", &S::tolerance, "", between(0, 1),
              "stop an exact search at this RMS error; 0: use --slices")
      .others_idle([](const Settings& all) { return unless_estimator(all, {Estimator::gtao}); });
  pixels.number("--samples", &S::samples, "per pixel", between(4, 64), "samples in the hemisphere").idle(unless_crytek);
  pixels.number("bias", &S::bias, "", between(0, 1e18),
                "sine of an elevation that blocks nothing, below 1; crytek: scene units of depth");
  auto lights = pixels.others_idle(unless_lights);
  lights.number("shadow-reach", &S::shadow_reach, "scene units", above_to(0, 1e15),
                "the farthest blocker of a light; else anywhere in the frame");
  lights.number("sun-azimuth", &S::sun_azimuth, "degrees", between(-360, 360),
                "a sun's azimuth, counterclockwise from x, seen from above");
  lights.number("sun-elevation", &S::sun_elevation, "degrees", between(-90, 90), "a sun's elevation above the ground");
  pixels.text("sun", &S::sun, "NAME", "the sun of --lights that these two turn; else its only one")
      .idle([](const Settings& all) {
        const auto& e = all.estimator;
        return unless_given(e.sun_azimuth || e.sun_elevation, "--set sun-azimuth and no --set sun-elevation");
      });
  pixels
      .choice("elevation", &S::elevation,
              "a horizon's elevation; view: above the plane across the view ray; surface: above the surface")
      .idle([](const Settings& all) { return unless_estimator(all, {Estimator::hbao}); });
  pixels
      .choice("sample-kernel", &S::sample_kernel, "clustered: more samples near the receiver; uniform: even in volume")
      .idle(unless_crytek);
  pixels.choice("range-check", &S::range_check, "a hit's weight by its depth; docs/settings.md has the formulas")
      .idle(unless_crytek);
  pixels
      .own(
          {"--thickness", "auto|infinite|NUMBER", "scene units", "",
           "the depth of occluders; auto: by their visible sides, else their width"},
          [](const S& s) { return text_of_thickness(s); },
          [](S& s, const std::string& text) { return read_thickness(text, s); },
          "is neither auto nor infinite nor a length above 0")
      .others_idle(unless_ranges_anywhere);
  pixels
      .choice("complete", &S::complete,
              "guess hidden parts of surfaces; border: beyond the picture; all: behind nearer surfaces too")
      .idle([](const Settings& all) {
        return all.estimator.complete == Completion::none ? "" : unless_ranges_anywhere(all);
      });
}

void add_filter_rows(EstimatorGroup& pixels) {
  pixels.choice("--resolution", &S::resolution,
                "resolution of the estimate; half, quarter: by the nearest surface of 2 x 2, 4 x 4 pixels");
  pixels
      .choice("density", &S::density,
              "estimates per pixel; uniform: one in every stride pixels; adaptive: more on small surfaces; edges: also "
              "more "
              "beside edges of depth")
      .idle([](const Settings& all) { return asks_for_confidence(all) ? "" : unless_ranges(all); })
      .idle(if_exact_alone)
      .idle(unless_shared_estimates);
  pixels
      .own(
          {"stride", "auto|1|2|4|8|16", "", "", "pixels per estimate; the denoiser fills the others"},
          [](const S& s) { return s.stride == 0 ? std::string("auto") : fmt::format("{}", s.stride); },
          [](S& s, const std::string& text) {
            const std::vector<std::string> strides = {"1", "2", "4", "8", "16"};
            const bool is_auto = lower_case(text) == "auto";
            const auto found = std::ranges::find(strides, text);
            if (!is_auto && found == strides.end()) return false;
            s.stride = is_auto ? 0 : 1 << (found - strides.begin());
            return true;
          },
          "is none of auto, 1, 2, 4, 8, 16")
      .idle([](const Settings& all) {
        return all.estimator.stride <= 1 ? ""
                                         : first_of({if_exact_alone(all), unless_denoised(all, {Denoise::bilateral})});
      });
}

void add_denoise_rows(EstimatorGroup& pixels) {
  const auto unless_bilateral = [](const Settings& all) {
    return first_of({unless_denoised(all, {Denoise::bilateral}), if_undenoised(all)});
  };
  pixels
      .choice("--denoise", &S::denoise,
              "smooth each surface; bilateral: by distance, plane and normal; box: evenly, 4 x 4")
      .idle([](const Settings& all) { return all.estimator.denoise == Denoise::none ? "" : if_undenoised(all); });
  pixels
      .own(
          {"denoise-radius", "auto|NUMBER", "pixels of the estimate", "1 to 8",
           "the bilateral denoiser's reach to each side"},
          [](const S& s) { return s.denoise_radius == 0 ? std::string("auto") : fmt::format("{}", s.denoise_radius); },
          [](S& s, const std::string& text) {
            const bool is_digit = text.size() == 1 && text >= "1" && text <= "8";
            if (lower_case(text) != "auto" && !is_digit) return false;
            s.denoise_radius = is_digit ? text.front() - '0' : 0;
            return true;
          },
          "is neither auto nor a whole number from 1 to 8")
      .others_idle(unless_bilateral);
  pixels
      .add(
          {"denoise-kernel", "W0,W1,...", "", "2 to 9 weights",
           "the denoiser's weights from the centre outwards, of any sum; their number sets its radius"},
          [](const S& s) {
            return s.denoise_kernel.empty() ? Words{} : Words{fmt::format("{}", fmt::join(s.denoise_kernel, ","))};
          },
          [](S& s, const Words& words) { read_kernel(words.front(), s.denoise_kernel); })
      .idle(unless_bilateral);
  pixels
      .number("denoise-depth-sigma", &S::denoise_depth_sigma, "of the depth", between(0, 100),
              "the difference of depth that weighs 1/e; 0: weigh by planes and normals")
      .others_idle([](const Settings& all) {
        return unless_denoised(all, {Denoise::bilateral, Denoise::box});
      })
      .idle(if_undenoised);
}

void add_shape_rows(EstimatorGroup& pixels) {
  pixels.number("--intensity", &S::intensity, "", between(0, 100), "factor on the occlusion");
  pixels.number("power", &S::power, "", above_to(0, 100), "exponent of the visibility");
  pixels.number("least", &S::least, "", between(0, 1), "the least AO, in composites too");
  pixels.number("fade-start", &S::fade_start, "scene units", between(0, 1e30), "depth where the AO begins to fade to 1")
      .idle([](const Settings& all) { return unless_given(all.estimator.fade_end.has_value(), "--set fade-end"); });
  pixels.number("fade-end", &S::fade_end, "scene units", above_to(0, 1e30), "depth from which the AO is 1")
      .idle([](const Settings& all) { return unless_given(all.estimator.fade_start.has_value(), "--set fade-start"); });
  pixels.number("--roughness", &S::roughness, "", between(0, 1), "roughness of all surfaces")
      .idle([](const Settings& all) { return unless_aov(all, {"specular-occlusion"}); });
  pixels
      .choice("--noise", &S::noise, "the pattern of samples; fixed: the same in every frame; animated: another in each")
      .idle([](const Settings& all) {
        const bool is_fixed = all.estimator.noise == Noise::fixed;
        return is_fixed ? if_given(all.input.accumulate > 0, "--accumulate", "it animates the noise")
                        : if_unsampled(all);
      });
  pixels.number("--seed", &S::seed, "", between(0, 4294967295.0), "shifts the pattern of samples")
      .others_idle(if_unsampled);
}

/// Of frames to each side: more are too far away to show the same.
constexpr int kMostAccumulated = 16;

bool read_accumulate(const std::string& text, int& frames) {
  if (lower_case(text) == "all")
    fail(ErrorKind::usage,
         "all would be a mean of the whole shot, and every frame would wait for all others: give a number of frames to "
         "each side, up to {}",
         kMostAccumulated);
  const auto number = whole_number_of(text);
  if (!number || *number < 0 || *number > kMostAccumulated) return false;
  frames = *number;
  return true;
}

void add_time_rows(std::vector<SettingRow>& rows) {
  OptionGroup(rows, "Estimator", Effect::pixels, &Settings::input)
      .own(
          {"--accumulate", "NUMBER", "frames to each side", fmt::format("0 to {}", kMostAccumulated),
           "the AO of static surfaces is the mean over these frames; needs each frame's camera"},
          [](const InputSettings& s) { return fmt::format("{}", s.accumulate); },
          [](InputSettings& s, const std::string& text) { return read_accumulate(text, s.accumulate); },
          fmt::format("is no whole number from 0 to {}", kMostAccumulated));
}

}  // namespace

void add_estimator_rows(std::vector<SettingRow>& rows) {
  OptionGroup command_line(rows, "Estimator", Effect::none, &Settings::estimator);
  const auto show = [&](const char* name, const char* value, const char* sentence) -> SettingRow& {
    SettingRow& row = command_line.show({name, value, "", "", sentence});
    row.repeats = row.is_common = true;
    return row;
  };
  show("--preset", "NAME|FILE[,...]", "settings from presets; later ones win")
      .implies(FileRole::input, [](const Settings& all) { return all.preset_files; });
  command_line.show({"--project", "", "", "", "settings from alcove.toml beside the input, or in a folder above it"});
  show("--set", "KEY=VALUE", "any setting: see docs/options.md or man alcove-run");
  OptionGroup pixels(rows, "Estimator", Effect::pixels, &Settings::estimator, true);
  add_radius_rows(pixels);
  add_search_rows(pixels);
  add_filter_rows(pixels);
  add_denoise_rows(pixels);
  add_shape_rows(pixels);
  OptionGroup(rows, "Estimator", Effect::none, &Settings::estimator, true)
      .flag("--no-skip", &EstimatorSettings::no_skip, "compute sky and unchanged tiles too; slower, the same bits");
  add_time_rows(rows);
}

}  // namespace alcove
