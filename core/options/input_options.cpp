// Options of what is read and how it is understood.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/frame/camera/camera.h"
#include "core/frame/input_rules.h"
#include "core/frame/raw_plane.h"
#include "core/options/options.h"
#include "core/options/reasons.h"

namespace alcove {
namespace {

/// Reads albedo: a number is the albedo of all surfaces, anything else is a file.
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

std::string unless_multi_bounce(const Settings& all) {
  return unless_given(all.output.multi_bounce, "--set multi-bounce=true");
}

std::string if_without_normals(const Settings& all) {
  return wants_normals(all.input) ? "" : "--normal none leaves normals out";
}

/// Beauty and its file are for a composite; the file's diffuse colour also for multi-bounce.
std::string unless_beauty_serves(const Settings& all) {
  const bool has_albedo = all.input.albedo_value || !all.input.albedo.empty();
  if (all.output.multi_bounce && !has_albedo) return "";
  return unless_composite(all);
}

std::string unless_objects(const Settings& all) {
  const bool has_objects = !all.input.occluder_objects.empty() || !all.input.ignored_objects.empty();
  return has_objects ? "" : "neither --set occluders nor --set ignore names objects";
}

/// Occluders are chosen in one way, and other frames and views do not tell them apart.
std::string if_choice_is_in_the_way(const InputSettings& input, const std::string& other, const char* option) {
  const char* const why = "what it shows behind an object may be the object itself";
  return first_of({if_given(!other.empty(), option, "each says what blocks"),
                   if_given(input.around > 0 || input.around_all, "--around", why),
                   if_given(input.other_views, "--set other-views", why)});
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
  file_or_objects(choice, "occluders", s.occluders, s.occluder_objects,
                  "only these block: a picture of coverage, or objects as in --matte-object")
      .why_without_effect = [](const Settings& all) {
    return if_choice_is_in_the_way(all.input, all.input.ignore + all.input.ignored_objects, "--set ignore");
  };
  file_or_objects(choice, "ignore", s.ignore, s.ignored_objects,
                  "these do not block, but what --behind or --deep show behind them; as occluders")
      .why_without_effect = [](const Settings& all) {
    return if_choice_is_in_the_way(all.input, all.input.occluders + all.input.occluder_objects, "--set occluders");
  };
  OptionGroup(rows, "Input", Effect::input)
      .text("objects", s.objects, "FILE", "an EXR that tells the objects of occluders and ignore; else INPUT")
      .why_without_effect = unless_objects;
  OptionGroup(rows, "Input", Effect::pixels)
      .text("object-channel", s.object_channel, "NAME", "the channel of their numbers, or the layer of a Cryptomatte")
      .why_without_effect = unless_objects;
}

void add_file_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup inputs(rows, "Input", Effect::input);
  const char* const why = "both say how far away surfaces are";
  OptionRow& depth = inputs.text("--depth", s.depth, "FILE", "of the depth alone: EXR, DDS or TIFF");
  depth.is_common = true;
  depth.why_without_effect = [why](const Settings& all) {
    return if_given(!all.input.position.empty(), "--position", why);
  };
  inputs.text("--normal", s.normal, "FILE|none", "of the normals alone: EXR, DDS, TIFF or PNG; none: made from depth")
      .is_common = true;
  inputs.text("--position", s.position, "FILE", "an EXR of the positions, instead of a depth").why_without_effect =
      [why](const Settings& all) {
        return first_of({if_given(!all.input.depth.empty(), "--depth", why),
                         if_given(!all.input.depth_channel.empty(), "--depth-channel", why)});
      };
  OptionRow& beauty = inputs.text("--beauty", s.beauty, "FILE", "an EXR of the beauty, and of its parts of light");
  beauty.is_common = true;
  beauty.why_without_effect = unless_beauty_serves;
  inputs.text("material-ao", s.material_ao, "FILE", "an EXR of the materials' own AO, multiplied in");
  inputs.text("--matte", s.matte, "FILE", "where AO is wanted, as coverage from 0 to 1");
  add_occluder_rows(rows, s);
  OptionGroup(rows, "Input", Effect::pixels_or_input, true)
      .own(
          {"albedo", "FILE|NUMBER", "", "0 to 1",
           "the diffuse colour, of all surfaces or in an EXR; else the beauty's"},
          [&s] { return s.albedo_value ? fmt::format("{}", *s.albedo_value) : s.albedo; },
          [&s](const std::string& text) { return read_albedo(text, s); }, "is neither a file nor a number from 0 to 1")
      .why_without_effect = unless_multi_bounce;
}

void add_channel_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels);
  const char* const why = "depth is read from one of them";
  pixels.text("--depth-channel", s.depth_channel, "NAME", "of the depth; else found by its usual names")
      .why_without_effect = [why](const Settings& all) {
    return first_of({if_given(!all.input.position.empty(), "--position", why),
                     if_given(!all.input.position_channels.empty(), "--position-channels", why),
                     unless_depth(all, {DepthKind::planar, DepthKind::ray, DepthKind::inverse, DepthKind::device,
                                        DepthKind::normalized, DepthKind::log})});
  };
  pixels.text("--normal-channels", s.normal_channels, "LAYER|X,Y[,Z]", "of the normals; of two, z is rebuilt")
      .why_without_effect = if_without_normals;
  pixels.text("--position-channels", s.position_channels, "LAYER|X,Y,Z", "of the positions, instead of a depth")
      .why_without_effect = [why](const Settings& all) {
    return if_given(!all.input.depth_channel.empty(), "--depth-channel", why);
  };
  pixels.text("beauty-channels", s.beauty_channels, "LAYER|R,G,B[,A]", "the beauty's layer, or its channels")
      .why_without_effect = unless_composite;
  pixels
      .text("ambient", s.ambient, "LIGHT[*LAYER][*NUMBER],...",
            "layers of the beauty's file which alone AO dims, each by that much, 0 to 1")
      .why_without_effect = unless_composite;
  pixels.text("material-ao-channel", s.material_ao_channel, "NAME", "of the materials' AO, in its file or INPUT");
  pixels.text("albedo-channels", s.albedo_channels, "LAYER|R,G,B", "the diffuse colour's layer, or its channels")
      .why_without_effect = [](const Settings& all) {
    return first_of({unless_multi_bounce(all), all.input.albedo_value ? "albedo is a number" : ""});
  };
  pixels.text("matte-channel", s.matte_channel, "NAME", "of the matte, in its file or INPUT; or a Cryptomatte's layer");
  pixels.text("--matte-object", s.matte_object, "NAME[,NAME...]",
              "the matte is these objects of a Cryptomatte or of numbers; * and ? stand for others");
  OptionGroup(rows, "Input", Effect::pixels, true)
      .number("--matte-outside", s.matte_outside, "", between(0, 1), "the AO where the matte is 0")
      .why_without_effect = [](const Settings& all) {
    return unless_given(wants_matte(all.input), "--matte and no --matte-object");
  };
  pixels.text("--layer", s.layer, "NAME", "look only at this layer or part");
  pixels.text("--view", s.view, "NAME", "of a stereo file; else its default view");
  const auto say_roi = [&roi = s.roi] {
    return roi ? fmt::format("{},{},{},{}", roi->x, roi->y, roi->width, roi->height) : std::string();
  };
  pixels.own(
      {"--roi", "X,Y,WIDTH,HEIGHT", "px of the display window", "", "compute and write only this region"}, say_roi,
      [&s](const std::string& text) { return read_roi(text, s.roi); }, "is not X,Y,WIDTH,HEIGHT in whole pixels");
  pixels.word("supersampling", s.supersampling, {"auto", "1", "2", "3", "4"},
              "pixels of depth for one that is written, in x and in y; auto: by the beauty");
  pixels.word("--source", s.source, source_names(), "the program that wrote the frame; auto: by header and channels");
}

void add_depth_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels, true);
  DepthRange& range = s.depth_range;
  const auto unless_between_planes = [](const Settings& all) {
    return unless_depth(all, {DepthKind::device, DepthKind::normalized, DepthKind::log});
  };
  pixels
      .choice("--depth-kind", s.depth_kind,
              "planar: along the axis; ray: to the eye; inverse: 1/planar; auto: by facts")
      .why_without_effect = [](const Settings& all) -> std::string {
    const InputSettings& input = all.input;
    if (input.depth_kind == DepthKind::automatic || input.depth_kind == DepthKind::position) return "";
    return first_of({if_given(!input.position.empty(), "--position", "there is no depth to be read then"),
                     if_given(!input.position_channels.empty(), "--position-channels", "there is no depth then")});
  };
  pixels.number("--near", range.near, "file units", at_least(0), "the near plane; else the camera's")
      .why_without_effect = [](const Settings& all) {
    return unless_depth(all, {DepthKind::device, DepthKind::normalized});
  };
  pixels
      .own(
          {"--far", "NUMBER|inf", "file units", "above 0", "the far plane; else the camera's"},
          [&range] { return range.far ? fmt::format("{}", *range.far) : std::string(); },
          [&range](const std::string& text) { return read_far(text, range.far); },
          "is neither a distance above 0 nor inf")
      .why_without_effect = unless_between_planes;
  pixels.flag("--reversed-z", range.reversed, "depth is largest at the near plane").why_without_effect =
      unless_between_planes;
  pixels.choice("device-range", range.device, "of the depth between the planes; -1..1: as OpenGL has it")
      .why_without_effect = [](const Settings& all) { return unless_depth(all, {DepthKind::device}); };
  pixels.number("log-constant", range.log_constant, "1 / file units", above(0), "C of z = ((1 + C far)^d - 1) / C")
      .why_without_effect = [](const Settings& all) { return unless_depth(all, {DepthKind::log}); };
  pixels.number("--depth-scale", s.depth_scale, "", above(0), "scene units per unit of the depth channel");
  pixels.number("--sky", s.sky, "file units", above(0), "from this depth on it is sky, as are 0, infinity and NaN");
}

void add_direction_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup pixels(rows, "Input", Effect::pixels, true);
  pixels.choice("--normal-space", s.normal_space, "auto: as the camera file says, or what fits the frame")
      .why_without_effect = [](const Settings& all) {
    return all.input.normal_space == NormalSpace::automatic ? "" : if_without_normals(all);
  };
  pixels.choice("--normal-encoding", s.normal_encoding, "unorm: 0.5 + 0.5 n; auto: by the values").why_without_effect =
      [](const Settings& all) {
        return all.input.normal_encoding == NormalEncoding::automatic ? "" : if_without_normals(all);
      };
  pixels
      .own(
          {"--flip-normal", "xyz", "", "", "axes of the normals that point the other way, in their own space"},
          [&s] { return text_of(s.flip_normal); },
          [&s](const std::string& text) { return read_flips(text, s.flip_normal); },
          "is none of x, y, z, xy, xz, yz, xyz")
      .why_without_effect = if_without_normals;
  pixels.choice("position-space", s.position_space, "auto: the space that puts positions onto their pixels")
      .why_without_effect = [](const Settings& all) {
    return all.input.position_space == PositionSpace::automatic ? "" : unless_depth(all, {DepthKind::position});
  };
}

/// What else says what the camera sees.
std::string if_other_camera(const InputSettings& input, const std::string& own) {
  const char* const why = "each of them says what the camera sees";
  const bool has_lens = input.focal || input.aperture;
  return first_of(
      {if_given(own != "--camera" && !input.camera.empty(), "--camera", why),
       if_given(own != "--fov" && input.fov, "--fov", why),
       if_given(own != "--focal" && own != "--aperture" && has_lens, input.focal ? "--focal" : "--aperture", why),
       if_given(own != "--ortho-width" && input.ortho_width, "--ortho-width", why)});
}

void add_camera_rows(std::vector<OptionRow>& rows, InputSettings& s) {
  OptionGroup(rows, "Input", Effect::none).flag("--strict", s.strict, "guesses and warnings are errors");
  OptionRow& camera = OptionGroup(rows, "Input", Effect::content)
                          .text("--camera", s.camera, "FILE.json|.chan", "the camera; see docs/inputs.md");
  camera.is_common = true;
  camera.why_without_effect = [](const Settings& all) { return if_other_camera(all.input, "--camera"); };
  OptionGroup(rows, "Input", Effect::pixels)
      .word("--chan-rotation", s.chan_rotation, {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
            "order of the camera's turns in a .chan file; zxy: Nuke's, xyz: Blender's and Maya's")
      .why_without_effect = [](const Settings& all) {
    const bool matters = all.input.chan_rotation != "zxy" && !is_chan_file(all.input.camera);
    return unless_given(!matters, "--camera FILE.chan");
  };
  OptionGroup pixels(rows, "Input", Effect::pixels, true);
  OptionRow& fov = pixels.number("--fov", s.fov, "degrees", strictly_between(0, 180), "horizontal field of view");
  fov.is_common = true;
  fov.why_without_effect = [](const Settings& all) { return if_other_camera(all.input, "--fov"); };
  pixels.number("--focal", s.focal, "mm", above(0), "focal length").why_without_effect = [](const Settings& all) {
    return first_of(
        {unless_given(all.input.aperture.has_value(), "--aperture"), if_other_camera(all.input, "--focal")});
  };
  pixels.number("--aperture", s.aperture, "mm", above(0), "width of the film back")
      .why_without_effect = [](const Settings& all) {
    return first_of({unless_given(all.input.focal.has_value(), "--focal"), if_other_camera(all.input, "--aperture")});
  };
  pixels.number("--ortho-width", s.ortho_width, "scene units", above(0), "width of an orthographic view")
      .why_without_effect = [](const Settings& all) { return if_other_camera(all.input, "--ortho-width"); };
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
