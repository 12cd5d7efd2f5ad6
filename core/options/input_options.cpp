// Options of what is read and how it is understood, and of what lies behind the first surface.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/error.h"
#include "core/base/note.h"
#include "core/base/text.h"
#include "core/frame/camera/camera.h"
#include "core/frame/find/input_rules.h"
#include "core/frame/raw_plane.h"
#include "core/options/options.h"

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

bool read_roi(const std::string& text, std::optional<Window>& roi) {
  std::vector<std::optional<int>> numbers;
  std::ranges::transform(split(text), std::back_inserter(numbers), whole_number_of);
  const bool are_four = numbers.size() == 4 && std::ranges::count(numbers, std::optional<int>()) == 0;
  if (!are_four || *numbers[2] <= 0 || *numbers[3] <= 0) return false;
  roi = Window{*numbers[0], *numbers[1], *numbers[2], *numbers[3]};
  return true;
}

/// Reads --flip-normal: axes, each once at most.
bool read_flips(const std::string& given, NormalFlips& flips) {
  const std::string text = lower_case(given);
  const auto flips_once = [&](char axis) { return std::ranges::count(text, axis) == 1; };
  const NormalFlips read{flips_once('x'), flips_once('y'), flips_once('z')};
  if (std::size_t(read.x + read.y + read.z) != text.size()) return false;
  flips = read;
  return true;
}

/// Reads codes of warnings, with commas.
bool read_allowed(InputSettings& settings, const std::string& text) {
  std::vector<std::string> codes;
  for (const auto& facts : note_table())
    if (facts.is_warning) codes.emplace_back(facts.name);
  for (const auto& code : split(text))
    if (std::ranges::find(codes, code) == codes.end())
      fail(ErrorKind::usage, "{} is no code of a warning{}", visible(code), suggestion(code, codes));
  settings.allow = text;
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

/// A row of a text that is a file, or else names objects.
SettingRow& file_or_objects(std::vector<SettingRow>& rows, const char* option, std::string InputSettings::*file,
                            std::string InputSettings::*objects, const char* help) {
  return OptionGroup(rows, "Input", Effect::pixels, &Settings::input)
      .own(
          {option, "FILE|NAME[,NAME...]", "", "", help},
          [=](const InputSettings& s) { return (s.*file).empty() ? s.*objects : s.*file; },
          [=](InputSettings& s, const std::string& text) {
            s.*file = names_picture(text) ? text : "";
            s.*objects = names_picture(text) ? "" : text;
            return true;
          })
      .names(FileRole::input, names_picture);
}

void add_occluder_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  file_or_objects(rows, "occluders", &S::occluders, &S::occluder_objects,
                  "only these block: a picture of coverage, or objects as in --matte-object");
  file_or_objects(rows, "ignore", &S::ignore, &S::ignored_objects,
                  "these do not block; surfaces of --behind or --deep behind them do; values as for occluders");
  auto objects = OptionGroup(rows, "Input", Effect::pixels, &Settings::input).others_idle(unless_objects);
  objects.text("objects", &S::objects, "FILE", "the file of the objects of occluders and ignore; else INPUT")
      .names(FileRole::input);
  objects.text("object-channel", &S::object_channel, "NAME", "their channel of numbers, or the Cryptomatte's layer");
}

void add_file_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  OptionGroup inputs(rows, "Input", Effect::pixels, &Settings::input);
  const auto file = [&](const char* name, std::string S::*path, const char* sentence) -> SettingRow& {
    return inputs.text(name, path, "FILE", sentence).names(FileRole::input);
  };
  file("--depth", &S::depth, "depth in a file of its own: EXR, DDS, NumPy, PNG of 16 bits, TIFF").is_common = true;
  file("--position", &S::position, "positions, instead of depth");
  inputs
      .text("--normal", &S::normal, "FILE|none",
            "normals in a file of their own: EXR, DDS, NumPy, TIFF or PNG; none: from depth")
      .names(FileRole::input, [](const std::string& text) { return lower_case(text) != "none"; })
      .is_common = true;
  SettingRow& beauty = file("--beauty", &S::beauty, "the beauty and its light passes");
  beauty.is_common = true;
  beauty.idle(unless_beauty_serves);
  file("material-ao", &S::material_ao, "the materials' own AO; multiplies the result");
  file("--matte", &S::matte, "the pixels that get AO, as coverage from 0 to 1");
  add_occluder_rows(rows);
  OptionGroup(rows, "Input", Effect::pixels, &Settings::input, true)
      .own(
          {"albedo", "FILE|NUMBER", "", "0 to 1",
           "the diffuse colour, of all surfaces or in a picture; else the beauty's"},
          [](const S& s) { return s.albedo_value ? fmt::format("{}", *s.albedo_value) : s.albedo; },
          [](S& s, const std::string& text) { return read_albedo(text, s); },
          "is neither a file nor a number from 0 to 1")
      .names(FileRole::input, [](const std::string& text) { return !number_of(text); })
      .idle(unless_multi_bounce);
}

std::string unless_plane_of_depth(const Settings& all) {
  return unless_depth(all, {DepthKind::planar, DepthKind::ray, DepthKind::inverse, DepthKind::device,
                            DepthKind::normalized, DepthKind::log, DepthKind::disparity});
}

void add_channel_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  OptionGroup pixels(rows, "Input", Effect::pixels, &Settings::input);
  pixels.text("--depth-channel", &S::depth_channel, "NAME", "the depth's channel; else found by its usual names")
      .idle(unless_plane_of_depth);
  pixels
      .text("--normal-channels", &S::normal_channels, "LAYER|X,Y[,Z]",
            "the normals' layer or channels; with two, z is computed")
      .idle(if_without_normals);
  pixels.text("position-channels", &S::position_channels, "LAYER|X,Y,Z",
              "the positions' layer or channels; positions instead of depth");
  auto beauty = pixels.others_idle(unless_composite);
  beauty.text("beauty-channels", &S::beauty_channels, "LAYER|R,G,B[,A]", "the beauty's layer, or its channels");
  beauty.text("ambient", &S::ambient, "LIGHT[*LAYER][*NUMBER],...",
              "the layers of the beauty's file that AO dims, with weights; beauty: all of it");
  beauty
      .text("shadow-layers", &S::shadow_layers, "NAME:LAYER,...",
            "layers of the beauty's file, each dimmed by the shadow of the light NAME of --lights")
      .idle(unless_lights);
  pixels.text("material-ao-channel", &S::material_ao_channel, "NAME",
              "the material AO's channel, in its file or INPUT");
  pixels.text("albedo-channels", &S::albedo_channels, "LAYER|R,G,B", "the diffuse colour's layer, or its channels")
      .idle(unless_multi_bounce)
      .idle([](const Settings& all) { return all.input.albedo_value ? "albedo is a number" : ""; });
  pixels.text("matte-channel", &S::matte_channel, "NAME",
              "the matte's channel, in its file or INPUT, or a Cryptomatte's layer");
  pixels.text("--matte-object", &S::matte_object, "NAME[,NAME...]",
              "objects of the matte, by Cryptomatte or number; * and ? stand for other characters");
  OptionGroup(rows, "Input", Effect::pixels, &Settings::input, true)
      .number("--matte-outside", &S::matte_outside, "", between(0, 1), "the AO where the matte is 0")
      .idle([](const Settings& all) { return unless_given(wants_matte(all.input), "--matte and no --matte-object"); });
  pixels.text("--layer", &S::layer, "NAME", "read only this layer or part");
  pixels.text("--view", &S::view, "NAME", "the view of a stereo file; else its default view");
  const auto say_roi = [](const S& s) {
    const auto& roi = s.roi;
    return roi ? fmt::format("{},{},{},{}", roi->x, roi->y, roi->width, roi->height) : std::string();
  };
  pixels.own(
      {"--roi", "X,Y,WIDTH,HEIGHT", "px of the display window", "", "compute and write only this region"}, say_roi,
      [](S& s, const std::string& text) { return read_roi(text, s.roi); }, "is not X,Y,WIDTH,HEIGHT in whole pixels");
  pixels.word("supersampling", &S::supersampling, {"auto", "1", "2", "3", "4"},
              "pixels of depth per output pixel, in x and in y; auto: 1");
  pixels.word("--source", &S::source, source_names(), "the program that wrote the frame; auto: by header and channels");
}

void add_depth_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  OptionGroup pixels(rows, "Input", Effect::pixels, &Settings::input, true);
  const auto unless_between_planes = [](const Settings& all) {
    return unless_depth(all, {DepthKind::device, DepthKind::normalized, DepthKind::log});
  };
  pixels
      .choice("--depth-kind", &S::depth_kind,
              "planar: along the axis; ray: to the eye; inverse: 1/planar; disparity: a/planar + b; auto: detected")
      .idle([](const Settings& all) -> std::string {
        const InputSettings& input = all.input;
        if (input.depth_kind == DepthKind::automatic || input.depth_kind == DepthKind::position) return "";
        return first_of(
            {if_given(!input.position.empty(), "--position", "there is no depth to be read then"),
             if_given(!input.position_channels.empty(), "--set position-channels", "there is no depth then")});
      });
  pixels
      .number("--near", within(&S::depth_range, &DepthRange::near), "file units", at_least(0),
              "the near plane; else the camera's")
      .idle([](const Settings& all) {
        return unless_depth(all, {DepthKind::device, DepthKind::normalized, DepthKind::disparity});
      });
  pixels
      .own(
          {"--far", "NUMBER|inf", "file units", "above 0", "the far plane; else the camera's"},
          [](const S& s) { return s.depth_range.far ? fmt::format("{}", *s.depth_range.far) : std::string(); },
          [](S& s, const std::string& text) { return read_far(text, s.depth_range.far); },
          "is neither a distance above 0 nor inf")
      .idle([](const Settings& all) {
        return unless_depth(all, {DepthKind::device, DepthKind::normalized, DepthKind::log, DepthKind::disparity});
      });
  pixels.flag("--reversed-z", within(&S::depth_range, &DepthRange::reversed), "depth is largest at the near plane")
      .idle(unless_between_planes);
  pixels
      .choice("device-range", within(&S::depth_range, &DepthRange::device),
              "device depth at the near and far planes; -1..1: OpenGL's; auto: 0..1")
      .idle([](const Settings& all) { return unless_depth(all, {DepthKind::device}); });
  pixels
      .number("log-constant", within(&S::depth_range, &DepthRange::log_constant), "1 / file units", above(0),
              "C of z = ((1 + C far)^d - 1) / C")
      .idle([](const Settings& all) { return unless_depth(all, {DepthKind::log}); });
  auto disparity = pixels.others_idle([](const Settings& all) { return unless_depth(all, {DepthKind::disparity}); });
  disparity.number("disparity-scale", within(&S::depth_range, &DepthRange::disparity_scale), "", above(0),
                   "a of disparity = a / z + b; without it there are no scene units, and --radius is in percent");
  disparity.number("disparity-shift", within(&S::depth_range, &DepthRange::disparity_shift), "", between(-1e18, 1e18),
                   "b of disparity = a / z + b, the value at infinity; else found by the normals");
  pixels.number("--depth-scale", &S::depth_scale, "", above(0), "scene units per unit of the depth channel");
  pixels
      .word("ramps", &S::ramps, {"cut", "keep"},
            "depth blurred across outlines; cut: assign the blurred pixels to the surfaces on both sides")
      .others_idle(unless_plane_of_depth);
  pixels.number("--sky", &S::sky, "file units", above(0), "the least depth of sky; 0, infinity and NaN are sky too");
}

void add_direction_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  OptionGroup pixels(rows, "Input", Effect::pixels, &Settings::input, true);
  auto normals = pixels.others_idle(if_without_normals);
  normals.choice("--normal-space", &S::normal_space, "auto: by the camera file, else by the pixels");
  normals.choice("--normal-encoding", &S::normal_encoding, "unorm: 0.5 + 0.5 n; auto: by the values");
  normals.own(
      {"--flip-normal", "xyz", "", "", "axes of the normals to negate, in their own space"},
      [](const S& s) { return text_of(s.flip_normal); },
      [](S& s, const std::string& text) { return read_flips(text, s.flip_normal); },
      "is none of x, y, z, xy, xz, yz, xyz");
  pixels.choice("position-space", &S::position_space, "auto: the space that puts positions onto their pixels")
      .others_idle([](const Settings& all) { return unless_depth(all, {DepthKind::position}); });
}

void add_camera_rows(std::vector<SettingRow>& rows) {
  using S = InputSettings;
  OptionGroup(rows, "Input", Effect::none, &Settings::input)
      .flag("--strict", &S::strict, "guesses and warnings are errors");
  OptionGroup(rows, "Input", Effect::none, &Settings::input)
      .own(
          {"allow", "CODE,...", "", "", "warnings that --strict accepts; normals-disagree: most normals may disagree"},
          [](const S& s) { return s.allow; }, read_allowed);
  OptionGroup(rows, "Input", Effect::pixels, &Settings::input)
      .text("--camera", &S::camera, "FILE.json|.chan", "the camera; see docs/inputs.md")
      .names(FileRole::input)
      .is_common = true;
  OptionGroup(rows, "Input", Effect::pixels, &Settings::input)
      .word("--chan-rotation", &S::chan_rotation, {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
            "order of the camera's turns in a .chan file; zxy: Nuke's, xyz: Blender's and Maya's")
      .others_idle(
          [](const Settings& all) { return unless_given(is_chan_file(all.input.camera), "--camera FILE.chan"); });
  OptionGroup pixels(rows, "Input", Effect::pixels, &Settings::input, true);
  pixels.number("--fov", &S::fov, "degrees", strictly_between(0, 180), "field of view over the width").is_common = true;
  pixels.number("--vertical-fov", &S::vertical_fov, "degrees", strictly_between(0, 180),
                "field of view over the height, as in Unity, Godot and glTF");
  pixels.number("--focal-px", &S::focal_px, "px", above(0),
                "focal length in pixels of the display window, as networks give it");
  pixels.number("--focal", &S::focal, "mm", above(0), "focal length").idle([](const Settings& all) {
    return unless_given(all.input.aperture.has_value(), "--aperture: add it, the film back's width in mm");
  });
  pixels.number("--aperture", &S::aperture, "mm", above(0), "width of the film back").idle([](const Settings& all) {
    return unless_given(all.input.focal.has_value(), "--focal: add it, the focal length in mm");
  });
  pixels.number("--ortho-width", &S::ortho_width, "scene units", above(0), "width of an orthographic view");
}

}  // namespace

void add_input_rows(std::vector<SettingRow>& rows) {
  add_file_rows(rows);
  add_channel_rows(rows);
  add_depth_rows(rows);
  add_direction_rows(rows);
  add_camera_rows(rows);
}

// Hidden surfaces: where they are known from, and what of them is kept.

namespace {

using InputGroup = OptionGroup<Settings, InputSettings Settings::*>;

constexpr int kMostAround = 32;  // frames to each side: more than any surface stays near
constexpr int kMostKept = 3;     // surfaces behind the first

void read_files(const Words& words, FileList& files) {
  if (words.size() > files.size())
    fail(ErrorKind::usage, "there are {} files; a run takes at most {}", words.size(), files.size());
  files = {};
  std::ranges::copy(words, files.begin());
}

Words words_of(const FileList& files) {
  Words words;
  std::ranges::copy_if(files, std::back_inserter(words), [](const auto& file) { return !file.empty(); });
  return words;
}

/// The words of a repeated option, of which each may hold several with commas.
Words split_all(const Words& words) {
  Words all;
  for (const auto& word : words) std::ranges::copy(split(word), std::back_inserter(all));
  return all;
}

void read_kinds(const Words& words, std::vector<BehindKind>& kinds) {
  constexpr auto& kKinds = kWordsOf<BehindKind>;
  Words known;
  for (const auto& [word, kind] : kKinds) known.push_back(word);
  std::vector<BehindKind> read;
  for (const auto& text : split_all(words)) {
    const auto* kind = std::ranges::find(kKinds, lower_case(text), &Word<BehindKind>::first);
    if (kind == std::end(kKinds))
      fail(ErrorKind::usage, "{} is none of {}{}", visible(text), list_of(known), suggestion(text, known));
    read.push_back(kind->second);
  }
  kinds = read;
}

Words words_of(const std::vector<BehindKind>& kinds) {
  Words words;
  for (const BehindKind kind : kinds) words.push_back(word_of(kind));
  return words;
}

bool read_around(const std::string& text, InputSettings& settings) {
  const bool is_all = lower_case(text) == "all";
  const auto frames = whole_number_of(text);
  if (!is_all && !(frames && *frames >= 0 && *frames <= kMostAround)) return false;
  settings.around_all = is_all;
  settings.around = is_all ? 0 : *frames;
  return true;
}

bool read_separation(const std::string& text, std::optional<double>& separation) {
  const auto length = number_of(text);
  const bool is_length = length && *length >= 0 && !std::isinf(*length);
  if (lower_case(text) != "auto" && !is_length) return false;
  separation = is_length ? length : std::nullopt;
  return true;
}

/// A list stands once for all files of --behind, or once for each.
std::string unless_for_each_file(const InputSettings& input, std::size_t given) {
  const std::size_t files = words_of(input.behind).size();
  if (files == 0) return "there is no --behind";
  return given <= 1 || given == files ? "" : fmt::format("there are {} for {} of --behind", given, files);
}

std::string unless_hidden_sources(const Settings& all) {
  return unless_given(has_hidden_sources(all.input), "--behind, --deep, --around or --set other-views");
}

std::string unless_motion(const Settings& all) { return unless_given(!all.input.motion.empty(), "--motion"); }

void add_behind_rows(InputGroup& pixels) {
  using S = InputSettings;
  SettingRow& behind = pixels.add(
      {"--behind", "FILE", "", "up to 8 times", "depth behind the first surface: peels, back faces, other elements"},
      [](const S& s) { return words_of(s.behind); }, [](S& s, const Words& words) { read_files(words, s.behind); });
  behind.repeats = true;
  behind.names(FileRole::input);
  behind.idle(unless_ranges_anywhere);
  SettingRow& channels = pixels.add(
      {"behind-channel", "NAME[,NAME...]", "", "",
       "the depth channel of the --behind files: one for all, or one for each"},
      [](const S& s) { return s.behind_channels; },
      [](S& s, const Words& words) { s.behind_channels = split_all(words); });
  channels.repeats = true;
  channels.idle([](const Settings& all) { return unless_for_each_file(all.input, all.input.behind_channels.size()); });
  SettingRow& kinds = pixels.add(
      {"--behind-kind", "surfaces|fronts|backs|thickness[,...]", "", "",
       "the kind of the --behind files: one for all, or one for each; backs: back faces; thickness: of solids"},
      [](const S& s) { return words_of(s.behind_kinds); },
      [](S& s, const Words& words) { read_kinds(words, s.behind_kinds); });
  kinds.repeats = kinds.in_library = true;
  kinds.default_text = "surfaces";
  kinds.idle([](const Settings& all) { return unless_for_each_file(all.input, all.input.behind_kinds.size()); });
}

void add_deep_rows(InputGroup& pixels) {
  using S = InputSettings;
  pixels
      .add(
          {"--deep", "FILE", "", "up to 8 times", "a deep EXR, for hidden surfaces"},
          [](const S& s) { return words_of(s.deep); }, [](S& s, const Words& words) { read_files(words, s.deep); })
      .names(FileRole::input)
      .repeats = true;
  pixels.number("deep-opacity", &S::deep_opacity, "", between(0, 1), "the least opacity of a deep surface")
      .idle([](const Settings& all) { return unless_given(has_deep(all.input), "--deep"); });
}

void add_view_rows(InputGroup& pixels) {
  using S = InputSettings;
  pixels.flag("other-views", &S::other_views, "add hidden surfaces from a stereo file's other views")
      .idle(unless_ranges_anywhere);
  pixels
      .own(
          {"--around", "NUMBER|all", "frames to each side", fmt::format("0 to {}", kMostAround),
           "add static hidden surfaces from other frames; needs each frame's camera"},
          [](const S& s) { return s.around_all ? std::string("all") : fmt::format("{}", s.around); },
          [](S& s, const std::string& text) { return read_around(text, s); },
          fmt::format("is neither all nor a whole number from 0 to {}", kMostAround))
      .others_idle(unless_ranges_anywhere);
  pixels.text("--motion", &S::motion, "FILE", "motion vectors, in pixels, to find moving surfaces")
      .names(FileRole::input)
      .idle([](const Settings& all) {
        const InputSettings& input = all.input;
        const bool takes_frames = input.around > 0 || input.around_all || input.accumulate > 0;
        return unless_given(takes_frames, "--around and no --accumulate");
      });
  pixels
      .text("motion-channels", &S::motion_channels, "LAYER|X,Y",
            "the vectors' layer or channels; else found by their usual names")
      .idle(unless_motion);
  pixels.choice("motion-kind", &S::motion_kind, "the frame that vectors point to; auto: by the cameras")
      .others_idle(unless_motion);
}

}  // namespace

void add_hidden_rows(std::vector<SettingRow>& rows) {
  OptionGroup pixels(rows, "Hidden surfaces", Effect::pixels, &Settings::input);
  add_behind_rows(pixels);
  add_deep_rows(pixels);
  add_view_rows(pixels);
  OptionGroup kept(rows, "Hidden surfaces", Effect::pixels, &Settings::estimator, true);
  kept.number("hidden", &EstimatorSettings::hidden, "surfaces of a pixel", between(0, kMostKept),
              "hidden surfaces kept behind the first one, nearest first; 0: none")
      .idle([](const Settings& all) { return all.estimator.hidden == 0 ? "" : unless_hidden_sources(all); });
  kept.own(
          {"separation", "auto|NUMBER", "scene units", "0 or more",
           "surfaces closer to each other are one; auto: by the depth's precision and slope"},
          [](const EstimatorSettings& s) {
            return s.separation ? fmt::format("{}", *s.separation) : std::string("auto");
          },
          [](EstimatorSettings& s, const std::string& text) { return read_separation(text, s.separation); },
          "is neither auto nor a length of 0 or more")
      .others_idle(unless_hidden_sources);
}

}  // namespace alcove
