// Options of what is written.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "core/base/text.h"
#include "core/chain/results/debug.h"
#include "core/chain/results/outputs.h"
#include "core/options/options.h"
#include "core/options/reasons.h"

namespace alcove {
namespace {

/// A list of words of a table, which may be typed in any case.
OptionRow& word_list(OptionGroup& group, const std::string& name, std::string& value, const std::string& sentence) {
  return group.own(
      {name, "LIST", "", "", sentence}, [&value] { return value; },
      [&value](const std::string& text) {
        value = lower_case(text);
        return true;
      },
      "");
}

std::string unless_shown_composite(const Settings& all) {
  return first_of({unless_given(!all.output.preview.empty(), "--preview"), unless_composite(all)});
}

/// Reads tint: three numbers from 0 to 1.
bool read_tint(const std::string& text, std::array<double, 3>& tint) {
  const auto words = split(text);
  std::array<double, 3> values{};
  if (words.size() != values.size()) return false;
  for (std::size_t c = 0; c < values.size(); c++) {
    const auto value = number_of(words[c]);
    if (!value || !(*value >= 0 && *value <= 1)) return false;
    values[c] = *value;
  }
  tint = values;
  return true;
}

void add_composite_rows(std::vector<OptionRow>& rows, OutputSettings& s) {
  OptionGroup pixels(rows, "Output", Effect::pixels);
  pixels
      .number("fog-density", s.look.fog_density, "1 / scene units", between(0, 1e30),
              "of exponential fog in the beauty, which hides the AO behind it")
      .why_without_effect = [](const Settings& all) {
    return all.output.look.fog_density == 0 ? "" : unless_composite(all);
  };
  pixels.number("gain", s.look.gain, "", between(0, 100), "factor on the occlusion in the composite")
      .why_without_effect = [](const Settings& all) { return all.output.look.gain == 1 ? "" : unless_composite(all); };
  pixels
      .own(
          {"tint", "R,G,B", "", "0 to 1", "what occlusion makes of white light in the composite"},
          [&s] {
            const auto& tint = s.look.tint;
            return tint == std::array<double, 3>{} ? "" : fmt::format("{}", fmt::join(tint, ","));
          },
          [&s](const std::string& text) { return read_tint(text, s.look.tint); }, "is not three numbers from 0 to 1")
      .why_without_effect = [](const Settings& all) {
    return all.output.look.tint == std::array<double, 3>{} ? "" : unless_composite(all);
  };
  pixels.number("mix", s.look.mix, "", between(0, 1), "of the composite and the beauty; 0: the beauty")
      .why_without_effect = [](const Settings& all) { return all.output.look.mix == 1 ? "" : unless_composite(all); };
  pixels
      .word("composite-layers", s.composite_layers, {"all", "rgba"},
            "all: every channel, part and attribute of the beauty's file; rgba: R, G, B, A alone")
      .why_without_effect = [](const Settings& all) {
    return all.output.composite_layers == "all" ? "" : unless_composite(all);
  };
  pixels
      .word("composite-compression", s.composite_compression,
            {"keep", "none", "rle", "zips", "zip", "piz", "dwaa", "dwab"},
            "of the beauty's part in the composite; keep: the file's, or zip where that loses bits again")
      .why_without_effect = [](const Settings& all) {
    return all.output.composite_compression == "keep" ? "" : unless_composite(all);
  };
  pixels.text("append-ao", s.append_ao, "LAYER[.CHANNEL]", "the AO as one more channel of the composite: AO is AO.Y")
      .why_without_effect = unless_composite;
}

/// Whether depth and normals may be larger than what is written is seen from their files.
std::string unless_supersampled(const Settings& all) {
  const std::string& factor = all.input.supersampling;
  if (factor == "1") return "supersampling is 1";
  return unless_given(factor != "auto" || !all.output.composite.empty(),
                      "--set supersampling, and no beauty that is smaller than the depth");
}

void add_preview_rows(std::vector<OptionRow>& rows, OutputSettings& s) {
  OptionGroup pixels(rows, "Output", Effect::pixels);
  OptionGroup(rows, "Output", Effect::display)
      .text("ocio", s.ocio, "FILE", "OpenColorIO configuration for the preview; else that of OCIO, else sRGB")
      .why_without_effect = unless_shown_composite;
  pixels.text("display", s.display, "NAME", "of the OpenColorIO configuration; else its default one")
      .why_without_effect = unless_shown_composite;
  pixels.text("view-transform", s.view_transform, "NAME", "the view of the display; else its default one")
      .why_without_effect = unless_shown_composite;
  pixels
      .word("preview-style", s.preview_style, {"auto", "ao", "composite", "split"},
            "auto: the composite, or the AO without one; split: beauty left, composite right")
      .why_without_effect = [](const Settings& all) {
    const std::string& style = all.output.preview_style;
    return style == "auto" || style == "ao" ? "" : unless_shown_composite(all);
  };
}

}  // namespace

void add_output_rows(std::vector<OptionRow>& rows, OutputSettings& s) {
  OptionGroup pixels(rows, "Output", Effect::pixels), results(rows, "Output", Effect::pixels, true);
  OptionGroup files(rows, "Output", Effect::none);  // Whether a file is there is looked at when a run is resumed.
  files.text("-o,--output", s.output, "FILE.exr", "the AO, 1 = open, and what else --aov names").is_common = true;
  word_list(results, "--aov", s.aovs, fmt::format("what OUTPUT holds: {}", fmt::join(aov_names(), ", "))).is_common =
      true;
  results.choice("ao-channels", s.ao_channels, "mono: Y; rgb: R, G, B").why_without_effect = [](const Settings& all) {
    return all.output.ao_channels == AoChannels::mono ? "" : unless_aov(all, {"ao"});
  };
  pixels.text("ao-name", s.ao_name, "NAME", "of the AO's channel instead of Y; with rgb of its layer: NAME.R ...")
      .why_without_effect = [](const Settings& all) { return unless_aov(all, {"ao"}); };
  pixels.choice("filter", s.filter.kind, "how pixels of depth make one that is written; blackman-harris: as Blender")
      .why_without_effect = [](const Settings& all) {
    return all.output.filter.kind == PixelFilterKind::blackman_harris ? "" : unless_supersampled(all);
  };
  pixels.number("filter-width", s.filter.width, "px of what is written", between(1, 16), "from one end to the other")
      .why_without_effect = unless_supersampled;
  results.choice("aov-space", s.aov_space, "of the normals in OUTPUT; auto: world where the camera tells it, else view")
      .why_without_effect = [](const Settings& all) {
    return all.output.aov_space == NormalSpace::automatic ? "" : unless_aov(all, {"normal", "bent-normal"});
  };
  results
      .flag("multi-bounce", s.multi_bounce,
            "light between coloured surfaces brightens rgb AO and the composite's indirect light")
      .why_without_effect = [](const Settings& all) {
    const bool is_seen = !all.output.composite.empty() || wants(all.output, &FrameOutputs::color_ao);
    return unless_given(is_seen, "--composite and no --set ao-channels=rgb");
  };
  files.text("--composite", s.composite, "FILE.exr", "the beauty with AO in its ambient light, or in all of it")
      .is_common = true;
  add_composite_rows(rows, s);
  files.text("--preview", s.preview, "FILE.png", "a picture of the composite, or of the AO").is_common = true;
  word_list(files, "debug", s.debug,
            fmt::format("pictures beside OUTPUT, ao.VIEW.png: {}", fmt::join(debug_view_names(), ", ")));
  pixels.choice("--type", s.type, "sample type of OUTPUT; depth is always float");
  files.word("compression", s.compression, {"none", "rle", "zips", "zip", "piz"}, "of OUTPUT");
  files.flag("no-mkdir", s.no_mkdir, "a missing folder of an output is an error; else it is made");
  add_preview_rows(rows, s);
}

}  // namespace alcove
