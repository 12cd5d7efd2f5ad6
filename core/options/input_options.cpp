// Options of what is read and how it is understood.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/frame/chan_file.h"
#include "core/frame/input_files.h"
#include "core/frame/input_rules.h"
#include "core/options/options.h"

namespace alcove {
namespace {

/// Reads --albedo: a number is the albedo of all surfaces, anything else is a file.
bool read_albedo(const std::string& text, InputSettings& settings) {
  const auto value = number_of(text);
  if (value && !(*value >= 0 && *value <= 1)) return false;
  settings.albedo = value ? "" : text;
  settings.albedo_value = value;
  return true;
}

/// Reads --far: a distance, or inf.
bool read_far(const std::string& text, std::optional<double>& far) {
  const auto value = number_of(text);
  if (!value || !(*value > 0)) return false;
  far = value;
  return true;
}

bool read_roi(const std::string& text, std::optional<Region>& roi) {
  const auto words = split(text);
  std::array<int, 4> numbers{};
  if (words.size() != numbers.size()) return false;
  for (std::size_t i = 0; i < numbers.size(); i++) {
    const auto number = whole_number_of(words[i]);
    if (!number) return false;
    numbers[i] = *number;
  }
  const Region region{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (region.width <= 0 || region.height <= 0) return false;
  roi = region;
  return true;
}

/// Reads --flip-normal: axes, each once at most.
bool read_flips(const std::string& given, NormalFlips& flips) {
  const std::string text = lower_case(given);
  NormalFlips read;
  for (const char axis : text) {
    if (axis < 'x' || axis > 'z') return false;
    bool& flip = *std::array{&read.x, &read.y, &read.z}[std::size_t(axis - 'x')];
    if (flip) return false;
    flip = true;
  }
  flips = read;
  return true;
}

std::string text_of(const NormalFlips& flips) {
  return std::string(flips.x ? "x" : "") + (flips.y ? "y" : "") + (flips.z ? "z" : "");
}

Condition with_multi_bounce() {
  return with_output("with --multi-bounce", "there is none",
                     [](const OutputSettings& output) { return output.multi_bounce; });
}

Condition with_normals() {
  return {"to frames with normals",
          [](const Settings& all) { return wants_normals(all.input) ? "" : "--normal none leaves them out"; }};
}

Condition with_chan_file() {
  return {"with --camera FILE.chan",
          [](const Settings& all) { return is_chan_file(all.input.camera) ? "" : "--camera names none"; }};
}

/// Beauty and its file are for a composite; the file's diffuse colour also for --multi-bounce.
Condition for_beauty() {
  return {"with a --composite or with --multi-bounce without --albedo",
          [](const Settings& all) {
            const bool has_albedo = all.input.albedo_value || !all.input.albedo.empty();
            const bool serves = !all.output.composite.empty() || (all.output.multi_bounce && !has_albedo);
            return serves ? "" : "there is none";
          },
          true};
}

Condition with_objects() {
  return with_option("names or numbers for --occluders or --ignore", [](const Settings& all) {
    return !all.input.occluder_objects.empty() || !all.input.ignored_objects.empty();
  });
}

Condition with_matte() {
  return with_option("--matte, --matte-channel or --matte-object",
                     [](const Settings& all) { return wants_matte(all.input); });
}

/// A row of a text that is a file, or else names objects.
OptionRow& file_or_objects(OptionGroup& group, const char* option, std::string& file, std::string& objects,
                           const char* help) {
  return group.own(
      {option, "FILE|NAME[,NAME...]", "", "", help}, [&] { return file.empty() ? objects : file; },
      [&](const std::string& text) {
        file = names_picture(text) ? text : "";
        objects = names_picture(text) ? "" : text;
        return true;
      },
      "");
}

void add_occluder_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup choice(rows, "Input", Effect::pixels_or_picture);
  const char* reason = "what they show behind an object may be the object itself";
  file_or_objects(
      choice, "--occluders", s.occluders, s.occluder_objects,
      "only these block: as coverage from 0 to 1, an EXR or another picture; or objects, as in --matte-object")
      .contradicts({"--ignore"}, "each says what blocks")
      .contradicts({"--around", "--other-views"}, reason);
  file_or_objects(
      choice, "--ignore", s.ignore, s.ignored_objects,
      "these do not block, and what is behind them does where --behind or --deep show it; else as --occluders")
      .contradicts({"--around", "--other-views"}, reason);
  OptionGroup inputs(rows, "Input", Effect::input);
  inputs
      .text("--objects", s.objects, "FILE",
            "an EXR whose Cryptomatte or numbers tell the objects of --occluders and --ignore; else INPUT")
      .applies(with_objects());
  OptionGroup pixels(rows, "Input", Effect::pixels);
  pixels
      .text("--object-channel", s.object_channel, "NAME",
            "the channel of their numbers, else found by its usual names; or the layer of a Cryptomatte")
      .applies(with_objects());
}

void add_file_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup inputs(rows, "Input", Effect::input);
  inputs.text("--depth", s.depth, "FILE", "an EXR, DDS or TIFF of the depth alone; else it is in INPUT").is_common =
      true;
  inputs
      .text("--normal", s.normal, "FILE|none",
            "an EXR, DDS, TIFF or PNG of the normals alone; none: they are left out, and reconstructed from depth")
      .is_common = true;
  inputs.text("--position", s.position, "FILE", "an EXR of the positions, instead of a depth")
      .contradicts({"--depth", "--depth-channel"}, "both say how far away surfaces are");
  OptionRow& beauty =
      inputs.text("--beauty", s.beauty, "FILE", "an EXR of the beauty, and of the indirect diffuse light");
  beauty.applies(for_beauty()).is_common = true;
  inputs.text("--material-ao", s.material_ao, "FILE", "an EXR of the materials' own AO, multiplied in");
  inputs.text("--matte", s.matte, "FILE",
              "where AO is wanted, as coverage from 0 to 1, an EXR or another picture; nothing is estimated elsewhere");
  add_occluder_rows(rows, s);
  OptionGroup(rows, "Input", Effect::pixels_or_input)
      .own(
          {"--albedo", "FILE|NUMBER", "", "0 to 1",
           "an EXR of the diffuse colour, or one number; else it is in the beauty's file"},
          [&s] { return s.albedo_value ? fmt::format("{}", *s.albedo_value) : s.albedo; },
          [&s](const std::string& text) { return read_albedo(text, s); }, "is neither a file nor a number from 0 to 1")
      .applies(with_multi_bounce());
}

void add_channel_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels);
  pixels.text("--depth-channel", s.depth_channel, "NAME", "the depth channel; else found by its usual names")
      .applies(to_depth({DepthKind::planar, DepthKind::ray, DepthKind::inverse, DepthKind::device,
                         DepthKind::normalized, DepthKind::log}))
      .contradicts({"--position-channels"}, "depth is read from one of them");
  pixels
      .text("--normal-channels", s.normal_channels, "LAYER|X,Y[,Z]",
            "the normal's layer, or its channels; of two, z is rebuilt")
      .applies(with_normals());
  pixels.text("--position-channels", s.position_channels, "LAYER|X,Y,Z",
              "the position's layer, or its three channels, instead of a depth");
  pixels.text("--beauty-channels", s.beauty_channels, "LAYER|R,G,B[,A]", "the beauty's layer, or its channels")
      .applies(with_composite());
  pixels
      .text("--ambient", s.ambient, "LIGHT[*LAYER][*NUMBER],...",
            "layers of the beauty's file, which alone AO dims, each by that much, 0 to 1; else its indirect diffuse "
            "light, "
            "else the whole beauty")
      .applies(with_composite());
  pixels.text("--material-ao-channel", s.material_ao_channel, "NAME",
              "the material AO's channel, of --material-ao or else of INPUT");
  pixels.text("--albedo-channels", s.albedo_channels, "LAYER|R,G,B", "the diffuse colour's layer, or its channels")
      .applies(with_multi_bounce())
      .applies({"without a number for --albedo", [](const Settings& all) {
                  return all.input.albedo_value ? fmt::format("--albedo is {}", *all.input.albedo_value) : "";
                }});
  pixels.text("--matte-channel", s.matte_channel, "NAME",
              "the matte's channel, of --matte or else of INPUT; or the layer of a Cryptomatte");
  pixels.text(
      "--matte-object", s.matte_object, "NAME[,NAME...]",
      "the matte is what these objects of a Cryptomatte cover, by names, in which * and ? stand for others where "
      "no object has exactly that name, and a backslash takes a comma, a blank, * or ? as it is; or by the "
      "numbers of the matte's channel");
  pixels.number("--matte-outside", s.matte_outside, "", between(0, 1), "the AO where the matte is 0")
      .applies(with_matte());
  pixels.text("--layer", s.layer, "NAME", "look only at this layer or part");
  pixels.text("--view", s.view, "NAME", "the view of a stereo file; else its default view");
  const auto say_roi = [&roi = s.roi] {
    return roi ? fmt::format("{},{},{},{}", roi->x, roi->y, roi->width, roi->height) : std::string();
  };
  pixels.own(
      {"--roi", "X,Y,WIDTH,HEIGHT", "px of the display window", "",
       "compute and write only this region; its surroundings are computed as far as occluders reach"},
      say_roi, [&s](const std::string& text) { return read_roi(text, s.roi); },
      "is not X,Y,WIDTH,HEIGHT in whole pixels");
  pixels.word(
      "--supersampling", s.supersampling, {"auto", "1", "2", "3", "4"},
      "what is written has so many times fewer pixels than depth and normals, in x and in y, each filtered from "
      "theirs: see --filter; auto: as many as the beauty has");
  pixels.word("--source", s.source, source_names(),
              "the program that wrote the frame, of presets/input; auto: by its header and channels");
}

void add_depth_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels);
  DepthRange& range = s.depth_range;
  const Condition between_planes = to_depth({DepthKind::device, DepthKind::normalized, DepthKind::log});
  pixels
      .choice("--depth-kind", s.depth_kind,
              "planar: along the optical axis; ray: to the eye; inverse: 1/planar; others: see docs/inputs.md; "
              "auto: what the camera file says, else what fits the frame")
      .applies(where_depth_is_read())
      .harmless = {"auto"};
  pixels.number("--near", range.near, "file units", at_least(0), "the near plane; else the camera file's")
      .applies(to_depth({DepthKind::device, DepthKind::normalized}));
  pixels
      .own(
          {"--far", "NUMBER|inf", "file units", "above 0", "the far plane; else the camera file's"},
          [&range] { return range.far ? fmt::format("{}", *range.far) : std::string(); },
          [&range](const std::string& text) { return read_far(text, range.far); },
          "is neither a distance above 0 nor inf")
      .applies(between_planes);
  pixels.flag("--reversed-z", range.reversed, "depth is largest at the near plane").applies(between_planes);
  pixels
      .choice("--device-range", range.device,
              "of the depth between the planes; -1..1: OpenGL's normalized device coordinates")
      .applies(to_depth({DepthKind::device}));
  pixels.number("--log-constant", range.log_constant, "1 / file units", above(0), "C of z = ((1 + C far)^d - 1) / C")
      .applies(to_depth({DepthKind::log}));
  pixels.number("--depth-scale", s.depth_scale, "", above(0), "scene units per unit of the depth channel");
  pixels.number("--sky", s.sky, "file units", above(0), "depth at or beyond it is sky, as are 0, infinity and NaN");
}

void add_direction_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels);
  pixels
      .choice("--normal-space", s.normal_space,
              "the space of the normals; auto: what the camera file says, else what fits the frame")
      .applies(with_normals())
      .harmless = {"auto"};
  pixels
      .choice("--normal-encoding", s.normal_encoding,
              "unorm: 0.5 + 0.5 n; octahedral, spheremap: two channels; auto: signed or unorm by their values")
      .applies(with_normals())
      .harmless = {"auto"};
  pixels
      .own(
          {"--flip-normal", "xyz", "", "", "axes of the normals that point the other way, in the normals' own space"},
          [&s] { return text_of(s.flip_normal); },
          [&s](const std::string& text) { return read_flips(text, s.flip_normal); },
          "is none of x, y, z, xy, xz, yz, xyz")
      .applies(with_normals());
  pixels
      .choice("--position-space", s.position_space,
              "the space of the positions; auto: the one that puts them onto their pixels")
      .applies(to_depth({DepthKind::position}))
      .harmless = {"auto"};
}

void add_camera_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup(rows, "Input", Effect::none)
      .flag("--strict", s.strict, "what could only be guessed is an error, and so is a warning");
  const char* const why = "each of them says what the camera sees";
  OptionGroup(rows, "Input", Effect::content)
      .text("--camera", s.camera, "FILE.json|.chan", "the camera; see docs/inputs.md")
      .contradicts({"--fov", "--focal", "--aperture", "--ortho-width"}, why)
      .is_common = true;
  OptionGroup pixels(rows, "Input", Effect::pixels);
  pixels
      .word("--chan-rotation", s.chan_rotation, {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
            "the axes about which the camera of a .chan file is turned, the first one first; zxy: Nuke's, xyz: "
            "Blender's and Maya's")
      .applies(with_chan_file())
      .harmless = {"zxy"};
  pixels.number("--fov", s.fov, "degrees", strictly_between(0, 180), "horizontal field of view")
      .contradicts({"--focal", "--aperture", "--ortho-width"}, why)
      .is_common = true;
  pixels.number("--focal", s.focal, "mm", above(0), "focal length")
      .applies(with_option("--aperture", [](const Settings& all) { return all.input.aperture.has_value(); }))
      .contradicts({"--ortho-width"}, why);
  pixels.number("--aperture", s.aperture, "mm", above(0), "width of the film back")
      .applies(with_option("--focal", [](const Settings& all) { return all.input.focal.has_value(); }))
      .contradicts({"--ortho-width"}, why);
  pixels.number("--ortho-width", s.ortho_width, "scene units", above(0), "width of an orthographic view");
}

}  // namespace

void add_input_rows(std::vector<OptionRow>& rows, InputSettings& settings) {
  add_file_rows(rows, settings);
  add_channel_rows(rows, settings);
  add_depth_rows(rows, settings);
  add_direction_rows(rows, settings);
  add_camera_rows(rows, settings);
}

}  // namespace alcove
