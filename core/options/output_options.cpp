// Options of what is written.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "core/base/text.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/options/options.h"

namespace alcove {
namespace {

using OutputGroup = OptionGroup<Settings, OutputSettings Settings::*>;

/// A list of words of a table, which may be typed in any case.
SettingRow& word_list(OutputGroup& group, const char* name, std::string OutputSettings::*list,
                      const std::string& sentence) {
  return group.own(
      {name, "LIST", "", "", sentence}, [=](const OutputSettings& s) { return s.*list; },
      [=](OutputSettings& s, const std::string& text) {
        s.*list = lower_case(text);
        return true;
      });
}

std::string unless_shown_composite(const Settings& all) {
  return first_of({unless_given(!all.output.preview.empty(), "--preview"), unless_composite(all)});
}

/// Reads tint: three numbers from 0 to 1.
bool read_tint(const std::string& text, std::array<double, 3>& tint) {
  std::vector<double> values;
  for (const auto& word : split(text)) values.push_back(number_of(word).value_or(-1));
  const auto is_part = [](double x) { return x >= 0 && x <= 1; };
  if (values.size() != tint.size() || !std::ranges::all_of(values, is_part)) return false;
  std::ranges::copy(values, tint.begin());
  return true;
}

/// The pictures of the debug views.
Words debug_files(const Settings& all) {
  Words files;
  for (const auto* view : debug_views_of(all.output)) files.push_back(debug_path(all.output, *view));
  return files;
}

void add_composite_rows(std::vector<SettingRow>& rows) {
  using S = OutputSettings;
  auto pixels = OptionGroup(rows, "Output", Effect::pixels, &Settings::output).others_idle(unless_composite);
  pixels.number("fog-density", within(&S::look, &CompositeLook::fog_density), "1 / scene units", between(0, 1e30),
                "density of exponential fog in the beauty, which hides AO");
  pixels.number("gain", within(&S::look, &CompositeLook::gain), "", between(0, 100),
                "factor on the occlusion in the composite");
  pixels.own(
      {"tint", "R,G,B", "", "0 to 1", "the colour of fully occluded white light in the composite"},
      [](const S& s) {
        const auto& tint = s.look.tint;
        return tint == std::array<double, 3>{} ? "" : fmt::format("{}", fmt::join(tint, ","));
      },
      [](S& s, const std::string& text) { return read_tint(text, s.look.tint); }, "is not three numbers from 0 to 1");
  pixels.number("mix", within(&S::look, &CompositeLook::mix), "", between(0, 1),
                "share of the composite; 0: the beauty");
  pixels.word("composite-layers", &S::composite_layers, {"all", "rgba"},
              "all: every channel, part and attribute of the beauty's file; rgba: R, G, B, A alone");
  pixels.word("composite-compression", &S::composite_compression,
              {"keep", "none", "rle", "zips", "zip", "piz", "dwaa", "dwab"},
              "compression of the beauty's part in the composite; keep: the file's, but zip for a lossy one");
  pixels.text("append-ao", &S::append_ao, "LAYER[.CHANNEL]", "add the AO to the composite as this channel: AO is AO.Y");
}

std::string unless_supersampled(const Settings& all) {
  const std::string& factor = all.input.supersampling;
  return factor == "1" ? "supersampling is 1" : unless_given(factor != "auto", "--set supersampling");
}

void add_preview_rows(std::vector<SettingRow>& rows) {
  using S = OutputSettings;
  // What it says is known by its bytes, whether the variable names it or the option.
  OptionGroup(rows, "Output", Effect::none, &Settings::output)
      .others_idle(unless_shown_composite)
      .text("ocio", &S::ocio, "FILE", "OpenColorIO configuration of the preview; else of the variable OCIO, else sRGB")
      .names(FileRole::input)
      .is_of_frame = false;
  OptionGroup pixels(rows, "Output", Effect::pixels, &Settings::output);
  auto shown = pixels.others_idle(unless_shown_composite);
  shown.text("display", &S::display, "NAME", "the display of the OpenColorIO configuration; else its default");
  shown.text("view-transform", &S::view_transform, "NAME", "the view of the display; else its default");
  pixels
      .word("preview-style", &S::preview_style, {"auto", "ao", "composite", "split"},
            "auto: the composite, or AO, or the first light's shadow; split: beauty left, composite right")
      .idle([](const Settings& all) {
        const std::string& style = all.output.preview_style;
        return style == "auto" || style == "ao" ? "" : unless_shown_composite(all);
      });
}

}  // namespace

void add_output_rows(std::vector<SettingRow>& rows) {
  using S = OutputSettings;
  OptionGroup pixels(rows, "Output", Effect::pixels, &Settings::output),
      results(rows, "Output", Effect::pixels, &Settings::output, true);
  OptionGroup files(rows, "Output", Effect::none,
                    &Settings::output);  // Whether a file is there is looked at when a run is resumed.
  files.text("-o,--output", &S::output, "FILE.exr", "the AO, 1 = open, and the AOVs of --aov")
      .names(FileRole::output)
      .is_common = true;
  word_list(results, "--aov", &S::aovs, fmt::format("results in OUTPUT: {}", fmt::join(aov_names(), ", "))).is_common =
      true;
  pixels.text("--environment", &S::environment, "SKY.exr|.hdr", "lat-long light for the AOVs relight and relight-open")
      .names(FileRole::input);
  pixels
      .text("--lights", &S::lights, "FILE.json",
            "suns and lamps: OUTPUT holds the shadow of each, 1 = lit; see docs/inputs.md")
      .names(FileRole::input)
      .is_of_frame = false;
  results.choice("ao-channels", &S::ao_channels, "mono: Y; rgb: R, G, B").others_idle([](const Settings& all) {
    return unless_aov(all, {"ao"});
  });
  pixels.text("ao-name", &S::ao_name, "NAME", "the AO's channel instead of Y; with rgb its layer: NAME.R ...")
      .idle([](const Settings& all) { return unless_aov(all, {"ao"}); });
  pixels
      .choice("filter", within(&S::filter, &PixelFilter::kind),
              "the filter of supersampling; blackman-harris: Blender's")
      .others_idle(unless_supersampled);
  pixels
      .number("filter-width", within(&S::filter, &PixelFilter::width), "output pixels", between(1, 16),
              "full width of the filter")
      .idle(unless_supersampled);
  results
      .choice("aov-space", &S::aov_space, "space of the normals in OUTPUT; auto: world if the camera has it, else view")
      .others_idle([](const Settings& all) {
        return unless_aov(all, {"normal", "bent-normal", "transfer"});
      });
  results
      .flag("multi-bounce", &S::multi_bounce,
            "light between coloured surfaces brightens rgb AO and the composite's indirect light")
      .idle([](const Settings& all) {
        const bool is_seen = !all.output.composite.empty() || wants(all.output, &FrameOutputs::color_ao);
        return unless_given(is_seen, "--composite and no --set ao-channels=rgb");
      });
  files.text("--composite", &S::composite, "FILE.exr", "the beauty with AO in its ambient light, or in all of it")
      .names(FileRole::output)
      .is_common = true;
  add_composite_rows(rows);
  files
      .text("--preview", &S::preview, "FILE.png",
            "picture of the composite, else of the AO; a name without a number: one sheet of all frames")
      .names(FileRole::output)
      .is_common = true;
  word_list(files, "debug", &S::debug,
            fmt::format("pictures beside OUTPUT, ao.VIEW.png: {}", fmt::join(debug_view_names(), ", ")))
      .implies(FileRole::output, debug_files);
  pixels.choice("--type", &S::type, "sample type of OUTPUT; depth is always float");
  files.word("compression", &S::compression, {"none", "rle", "zips", "zip", "piz"}, "compression of OUTPUT");
  files.flag("no-mkdir", &S::no_mkdir, "a missing folder of an output is an error; else it is made");
  add_preview_rows(rows);
}

}  // namespace alcove
