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

}  // namespace

void add_output_rows(std::vector<OptionRow>& rows, OutputSettings& s) {
  OptionGroup pixels(rows, "Output", Effect::pixels);
  OptionGroup files(rows, "Output", Effect::none);  // Whether a file is there is looked at when a run is resumed.
  files.text("-o,--output", s.output, "FILE.exr", "the AO, 1 = open, and what else --aov names").is_common = true;
  word_list(pixels, "--aov", s.aovs, fmt::format("what OUTPUT holds, with commas: {}", fmt::join(aov_names(), ", ")))
      .is_common = true;
  pixels.choice("--ao-channels", s.ao_channels, "mono: Y; rgb: R, G, B").applies(with_aovs({"ao"})).harmless = {"mono"};
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
  pixels
      .number("--fog-density", s.fog_density, "1 / scene units", between(0, 1e30),
              "of exponential fog in the beauty, which hides the AO of what lies behind it")
      .applies(with_composite())
      .harmless = {"0"};
  files.text("--preview", s.preview, "FILE.png", "a picture of the composite, or of the AO where there is none")
      .is_common = true;
  word_list(files, "--debug", s.debug,
            fmt::format("pictures beside OUTPUT, ao.exr -> ao.VIEW.png, with commas: {}",
                        fmt::join(debug_view_names(), ", ")));
  pixels.choice("--type", s.type, "sample type of OUTPUT; depth is always float");
  files.word("--compression", s.compression, {"none", "rle", "zips", "zip", "piz"},
             "of the AO file; a composite keeps OpenEXR's zip");
  files.flag("--no-mkdir", s.no_mkdir, "a folder of an output that is not there is an error; else it is made");
  OptionGroup(rows, "Output", Effect::display)
      .text("--ocio", s.ocio, "FILE",
            "OpenColorIO configuration for the preview; else the OCIO variable, else linear Rec.709 to sRGB")
      .applies(with_output("with a --preview of a --composite", "there is none", [](const OutputSettings& output) {
        return !output.preview.empty() && !output.composite.empty();
      }));
}

}  // namespace alcove
