// Options of what is written.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "core/base/text.h"
#include "core/chain/aov.h"
#include "core/chain/debug_view.h"
#include "core/options/options.h"

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

Condition with_shown_composite() {
  return with_output("with a --preview of a --composite", "there is none",
                     [](const OutputSettings& output) { return !output.preview.empty() && !output.composite.empty(); });
}

/// Reads --tint: three numbers from 0 to 1.
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
      .number("--fog-density", s.look.fog_density, "1 / scene units", between(0, 1e30),
              "of exponential fog in the beauty, which hides the AO of what lies behind it")
      .applies(with_composite())
      .harmless = {"0"};
  pixels.number("--gain", s.look.gain, "", between(0, 100), "factor on the occlusion in the composite")
      .applies(with_composite())
      .harmless = {"1"};
  pixels
      .own(
          {"--tint", "R,G,B", "", "0 to 1", "what occlusion makes of white light in the composite"},
          [&s] {
            const auto& tint = s.look.tint;
            return tint == std::array<double, 3>{} ? "" : fmt::format("{}", fmt::join(tint, ","));
          },
          [&s](const std::string& text) { return read_tint(text, s.look.tint); }, "is not three numbers from 0 to 1")
      .applies(with_composite())
      .harmless = {"0,0,0"};
  pixels.number("--mix", s.look.mix, "", between(0, 1), "of the composite and the beauty; 0: the beauty")
      .applies(with_composite())
      .harmless = {"1"};
  pixels
      .word("--composite-layers", s.composite_layers, {"all", "rgba"},
            "all: every channel, part and attribute of the beauty's file, with another beauty in it; rgba: R, G, B, A "
            "alone")
      .applies(with_composite())
      .harmless = {"all"};
  pixels
      .word("--composite-compression", s.composite_compression,
            {"keep", "none", "rle", "zips", "zip", "piz", "dwaa", "dwab"},
            "of the beauty's part in the composite; keep: as its file has it, or zip if that would lose bits again")
      .applies(with_composite())
      .harmless = {"keep"};
  pixels.text("--append-ao", s.append_ao, "LAYER[.CHANNEL]", "the AO as one more channel of the composite: AO is AO.Y")
      .applies(with_composite());
}

/// Whether depth and normals may be larger than what is written is seen from their files.
Condition with_supersampling() {
  return {"with --supersampling, or a beauty that is smaller than the depth", [](const Settings& all) {
            const std::string& factor = all.input.supersampling;
            if (factor == "1") return "--supersampling is 1";
            return factor == "auto" && all.output.composite.empty() ? "there is neither" : "";
          }};
}

}  // namespace

void add_output_rows(std::vector<OptionRow>& rows, OutputSettings& s) {
  OptionGroup pixels(rows, "Output", Effect::pixels);
  OptionGroup files(rows, "Output", Effect::none);  // Whether a file is there is looked at when a run is resumed.
  files.text("-o,--output", s.output, "FILE.exr", "the AO, 1 = open, and what else --aov names").is_common = true;
  word_list(pixels, "--aov", s.aovs, fmt::format("what OUTPUT holds, with commas: {}", fmt::join(aov_names(), ", ")))
      .is_common = true;
  pixels.choice("--ao-channels", s.ao_channels, "mono: Y; rgb: R, G, B").applies(with_aovs({"ao"})).harmless = {"mono"};
  pixels
      .text("--ao-name", s.ao_name, "NAME",
            "of the AO in OUTPUT: its channel instead of Y; with rgb its layer: NAME.R ...")
      .applies(with_aovs({"ao"}));
  pixels
      .choice("--filter", s.filter.kind,
              "how pixels of depth and normals make one that is written; blackman-harris as Blender has it")
      .applies(with_supersampling())
      .harmless = {"blackman-harris"};
  pixels
      .number("--filter-width", s.filter.width, "px of what is written", between(1, 16),
              "from one end to the other; else box 1, gaussian 2, blackman-harris 3, which Blender calls 1.5")
      .applies(with_supersampling());
  pixels
      .choice("--aov-space", s.aov_space,
              "the space of the normals in OUTPUT; auto: world where the camera has world_to_camera, else view")
      .applies(with_aovs({"normal", "bent-normal"}))
      .harmless = {"auto"};
  pixels
      .flag("--multi-bounce", s.multi_bounce,
            "light between coloured surfaces brightens the rgb AO and the composite's indirect light; needs a diffuse "
            "colour")
      .applies(
          with_output("with --ao-channels rgb or a --composite", "there is neither", [](const OutputSettings& output) {
            return !output.composite.empty() || wants(output, &FrameOutputs::color_ao);
          }));
  files
      .text("--composite", s.composite, "FILE.exr",
            "the beauty with AO in its ambient light, or in all of it where the parts are missing")
      .is_common = true;
  add_composite_rows(rows, s);
  files
      .text("--preview", s.preview, "FILE.png",
            "a picture of the composite, or of the AO where there is none; see --preview-style")
      .is_common = true;
  word_list(files, "--debug", s.debug,
            fmt::format("pictures beside OUTPUT, ao.exr -> ao.VIEW.png, with commas: {}",
                        fmt::join(debug_view_names(), ", ")));
  pixels.choice("--type", s.type, "sample type of OUTPUT; depth is always float");
  files.word("--compression", s.compression, {"none", "rle", "zips", "zip", "piz"},
             "of OUTPUT; see --composite-compression");
  files.flag("--no-mkdir", s.no_mkdir, "a folder of an output that is not there is an error; else it is made");
  OptionGroup(rows, "Output", Effect::display)
      .text("--ocio", s.ocio, "FILE",
            "OpenColorIO configuration for the preview; else the OCIO variable, else linear Rec.709 to sRGB")
      .applies(with_shown_composite());
  pixels.text("--display", s.display, "NAME", "of the OpenColorIO configuration, for the preview; else its default one")
      .applies(with_shown_composite());
  pixels
      .text("--view-transform", s.view_transform, "NAME",
            "the view of the display, for the preview; else the display's default one")
      .applies(with_shown_composite());
  pixels
      .word("--preview-style", s.preview_style, {"auto", "ao", "composite", "split"},
            "auto: the composite, or the AO where there is none; split: the beauty, and the composite to its right")
      .applies(with_shown_composite())
      .harmless = {"auto", "ao"};
}

}  // namespace alcove
