// Finds the planes of a frame, the rules of its program, its camera, and the meaning of depth and normals.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/frame_source.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/camera/camera.h"
#include "core/frame/camera/resection.h"
#include "core/frame/find/behind.h"
#include "core/frame/find/matte.h"
#include "core/frame/find/position_pass.h"

namespace alcove {

namespace {

// The parts of a beauty that AO may dim, or a shadow: a list of layers, colours and weights.

/// A light, as the user typed it.
struct TypedLight {
  std::string light, color;  // color: empty: nothing is said
  double weight = 1;
};

/// Blender's passes of light without colour, and the colour that belongs to them.
struct Pass {
  const char *light, *color;
};
constexpr std::array kBlenderPasses{Pass{"diffdir", "DiffCol"},
                                    Pass{"diffind", "DiffCol"},
                                    Pass{"glossdir", "GlossCol"},
                                    Pass{"glossind", "GlossCol"},
                                    Pass{"transdir", "TransCol"},
                                    Pass{"transind", "TransCol"},
                                    Pass{"diffuse direct", "Diffuse Color"},
                                    Pass{"diffuse indirect", "Diffuse Color"},
                                    Pass{"glossy direct", "Glossy Color"},
                                    Pass{"glossy indirect", "Glossy Color"},
                                    Pass{"transmission direct", "Transmission Color"},
                                    Pass{"transmission indirect", "Transmission Color"}};

[[noreturn]] void refuse(const std::string& text, const char* why) {
  fail(ErrorKind::usage,
       "--set ambient={}: {}: it takes LIGHT, LIGHT*LAYER, LIGHT*NUMBER or LIGHT*LAYER*NUMBER, several with commas",
       text, why);
}

TypedLight typed_light(const std::string& text) {
  TypedLight typed;
  std::size_t from = 0;
  bool has_weight = false;
  for (std::size_t to = 0; to != text.npos; from = to + 1) {
    to = text.find('*', from);
    const std::string word = text.substr(from, to == text.npos ? to : to - from);
    if (word.empty()) refuse(text, "a name is missing");
    const auto weight = from > 0 ? number_in(word) : std::optional<float>();
    if (has_weight) refuse(text, "nothing follows the number");
    if (weight && !(*weight >= 0 && *weight <= 1)) refuse(text, "a weight is from 0 to 1");
    if (!weight && from > 0 && !typed.color.empty()) refuse(text, "two layers multiply the light");
    if (weight)
      typed.weight = double(*weight);
    else
      (from == 0 ? typed.light : typed.color) = word;
    has_weight = weight.has_value();
  }
  return typed;
}

/// The last part of the layer that a channel lies in, in lower case: "ViewLayer.DiffInd.R" gives "diffind".
std::string layer_of(const std::string& channel) {
  const std::string lower = lower_case(channel.substr(0, channel.rfind('.')));
  return lower.substr(lower.rfind('.') + 1);
}

/// The layer of the colour that a light is without; empty: it holds its colour.
std::string color_of(const ChannelRef& light) {
  for (const auto& pass : kBlenderPasses)
    if (layer_of(light.channel) == pass.light) return pass.color;
  return "";
}

void add_light(FrameSource& source, const ChannelSearch& search, const std::vector<ChannelRef>& light,
               const std::string& said_color, std::optional<double> weight) {
  const std::string color = said_color.empty() ? color_of(light.front()) : said_color;
  auto& colors = source.channels[RawPlane::diffuse_color];
  source.reading.ambient.push_back({weight, color.empty() ? -1 : int(colors.size() / 3)});
  std::ranges::copy(light, std::back_inserter(source.channels[RawPlane::indirect]));
  if (!color.empty())
    std::ranges::move(search.find(light.front().file, kLightNames, color, false), std::back_inserter(colors));
}

/// The indirect diffuse light; Blender's only with its colour, without which the part of the beauty is unknown.
void find_usual(FrameSource& source, const ChannelSearch& search, std::size_t file) {
  const auto light = search.find(file, kIndirectNames, "", false);
  if (light.empty()) return;
  const bool lacks_color = !color_of(light.front()).empty();
  const auto color = lacks_color ? search.find(file, kDiffuseColorNames, "", false) : std::vector<ChannelRef>();
  if (lacks_color && color.empty()) return;
  source.channels[RawPlane::indirect] = light;
  source.channels[RawPlane::diffuse_color] = color;
  source.reading.ambient = {{1, lacks_color ? 0 : -1}};
}

/// Finds the lights in the beauty's file. `settings.ambient` lists them with commas, each LIGHT[*LAYER][*NUMBER]: a
/// layer, one that multiplies it, and how much of it AO dims, 0 to 1. Without, it is the indirect diffuse light, where
/// that is found; else there is none, as with the word beauty: AO dims all of it.
///
/// Blender's light passes are without the surface's colour. It is taken from the pass beside them (DiffInd x DiffCol,
/// GlossDir x GlossCol) where nothing else is said. Fails with ErrorKind::usage on a text that is no such list, and
/// with ErrorKind::input where a layer is missing.
void find_ambient(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  if (settings.ambient == "beauty") return;
  const auto lights = settings.ambient.empty() ? std::vector<std::string>() : split(settings.ambient);
  if (lights.size() > kMostAmbientLights)
    fail(ErrorKind::usage, "--set ambient: it takes at most {} lights, and there are {}", kMostAmbientLights,
         lights.size());
  for (const auto& light : lights) {
    const TypedLight typed = typed_light(light);
    add_light(source, search, search.find(file, kLightNames, typed.light, false), typed.color, typed.weight);
  }
  if (lights.empty()) find_usual(source, search, file);
}

/// Finds the layers that shadows dim; one that AO dims, too, is there once. Fails as find_ambient() does.
void find_shadowed(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  AovNames names = kLightNames;
  names.channel_option = "--set shadow-layers";
  auto& lights = source.reading.ambient;
  for (const auto& [name, layer] : shadow_layers_of(settings)) {
    const auto light = search.find(file, names, layer, false);
    if (light.front() == source.channels[RawPlane::beauty].front())
      fail(ErrorKind::usage, "--set shadow-layers: {} is the whole beauty: name the layer of the light {} alone", layer,
           name);
    std::size_t at = 0;
    while (at < lights.size() && source.channels[RawPlane::indirect][3 * at] != light.front()) at++;
    if (at == lights.size()) add_light(source, search, light, "", std::nullopt);
    if (lights[at].shadow == name) fail(ErrorKind::usage, "--set shadow-layers: {}:{} is there twice", name, layer);
    if (!lights[at].shadow.empty())
      fail(ErrorKind::usage,
           "--set shadow-layers: the layer {} is there twice: name it for one light; lights that share it need a layer "
           "each, rendered as light groups",
           layer);
    lights[at].shadow = name;
  }
  if (lights.size() > kMostAmbientLights)
    fail(ErrorKind::usage, "--set shadow-layers and ambient: they take at most {} layers, and there are {}",
         kMostAmbientLights, lights.size());
}

// A picture of colours, normals or positions, told from depth where the depth channel is one of three.

constexpr int kColourRows = 24;       // of the picture that are looked at
constexpr double kGrey = 0.02;        // relative difference of R, G and B that lossy compression makes of grey
constexpr double kDark = 0.01;        // of the median, below which noise is no colour
constexpr double kColoured = 0.005;   // share of the pixels from which a picture is no grey one
constexpr double kUnitLength = 0.05;  // of a length that is taken for 1
constexpr double kAreNormals = 0.95;  // share of unit vectors

/// A channel and the two that make a colour or a vector of it.
using Three = std::array<ChannelRef, 3>;

std::optional<Three> three_of(const ChannelSearch& search, const ChannelRef& depth, const char* second,
                              const char* third) {
  const auto other = search.beside(depth, second), last = search.beside(depth, third);
  return other && last ? std::optional<Three>({depth, *other, *last}) : std::nullopt;
}

/// The values of some rows.
std::array<std::vector<float>, 3> sample_of(FrameSource& source, const Three& three) {
  const Window& data = source.part_of(three[0]).data;
  const int rows = std::min(kColourRows, data.height);
  const auto width = std::size_t(data.width);
  std::array<std::vector<float>, 3> planes;
  for (auto& plane : planes) plane.resize(std::size_t(rows) * width);
  for (int i = 0; i < rows; i++) {
    std::vector<ExrRead> reads;
    for (std::size_t c = 0; c < 3; c++)
      reads.push_back({three[c].part, three[c].channel, planes[c].data() + std::size_t(i) * width});
    source.file_of(three[0]).read(reads, int((std::int64_t(2 * i + 1) * data.height) / (2 * rows)), 1);
  }
  return planes;
}

bool varies(const std::vector<float>& plane) {
  return std::ranges::any_of(plane, [&](float value) { return value != plane.front(); });
}

/// Whether the second and the third channel are there for more than to be equal to the first.
bool are_colours(const std::array<std::vector<float>, 3>& planes) {
  if (!varies(planes[1]) && !varies(planes[2])) return false;
  std::vector<double> sizes;
  for (const float value : planes[0])
    if (std::isfinite(value) && value != 0) sizes.push_back(std::abs(value));
  const double dark = sizes.empty() ? 0 : kDark * median_of(std::move(sizes));
  std::size_t pixels = 0, coloured = 0;
  for (std::size_t i = 0; i < planes[0].size(); i++) {
    const std::array<double, 3> c{planes[0][i], planes[1][i], planes[2][i]};
    if (!std::ranges::all_of(c, [](double value) { return std::isfinite(value); })) continue;
    const auto [least, most] = std::ranges::minmax(c);
    pixels++;
    coloured += most - least > kGrey * std::max({std::abs(least), std::abs(most), dark});
  }
  return double(coloured) > kColoured * double(pixels);
}

bool are_normals(const std::array<std::vector<float>, 3>& planes) {
  std::size_t vectors = 0, units = 0;
  for (std::size_t i = 0; i < planes[0].size(); i++) {
    const double length = std::hypot(planes[0][i], planes[1][i], planes[2][i]);
    vectors += length > 0;
    units += std::abs(length - 1) < kUnitLength;
  }
  return vectors > 0 && double(units) > kAreNormals * double(vectors);
}

/// Looks at the two channels beside a depth channel that was found by a usual name and not by the user's. R is depth
/// where R, G and B are a grey picture, or G and B are empty. Fails with ErrorKind::input where they are a picture of
/// colours; adds a suspicious note where they are one in a layer that is called depth, and where the depth is the Z of
/// X, Y and Z. Reads a few rows where there are two such channels, and nothing else.
void doubt_depth_of_three(FrameSource& source, const ChannelSearch& search, const ChannelRef& depth) {
  const std::string word = lower_case(depth.channel.substr(depth.channel.rfind('.') + 1));
  const std::string& path = source.file_of(depth).path();
  const std::string layer = depth.channel.substr(0, depth.channel.size() - word.size());
  if (word == "y" && search.find_beside(depth, "ry") && search.find_beside(depth, "by"))
    fail(ErrorKind::input,
         "{}: {}Y with RY and BY is the brightness of a picture of colours, and no depth: give the file of the depth "
         "with --depth, or name its channel with --depth-channel",
         path, layer);
  const bool is_vector = word == "z";
  auto three = is_vector       ? three_of(search, depth, "x", "y")
               : word == "red" ? three_of(search, depth, "green", "blue")
               : word == "r"   ? three_of(search, depth, "g", "b")
                               : std::nullopt;
  if (!three) return;
  const auto planes = sample_of(source, *three);
  if (is_vector && are_normals(planes))
    fail(
        ErrorKind::input,
        "{}: {}X, Y and Z are vectors of length 1, which are normals and no depth: give the file to --normal, and that "
        "of the depth to --depth; --depth-channel {} takes Z as depth",
        path, layer, depth.channel);
  if (is_vector) {
    source.suspicious.push_back(
        {NoteCode::said_otherwise,
         fmt::format("{} is taken as depth, and stands beside X and Y: if the three are positions, give the file to "
                     "--position instead; --depth-channel {} confirms the depth",
                     depth.channel, depth.channel),
         source.note_file(RawPlane::depth)});
    return;
  }
  if (!are_colours(planes)) return;
  const std::string text = fmt::format(
      "R, G and B of {} differ, as in colours, normals or positions, not in depth: give the file of the depth with "
      "--depth, or name its channel with --depth-channel; --position takes positions; --depth-channel {} takes this "
      "one as depth",
      layer.empty() ? "the file" : "layer " + layer.substr(0, layer.size() - 1), depth.channel);
  if (layer.empty()) fail(ErrorKind::input, "{}: {}", path, text);
  source.suspicious.push_back({NoteCode::said_otherwise, text, source.note_file(RawPlane::depth)});
}

// The frame.

void find_beauty(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  source.channels[RawPlane::beauty] = search.with_alpha(
      search.require(file, kBeautyNames, settings.beauty_channels, !settings.beauty.empty(), "Combined.R"));
  find_ambient(source, search, file, settings);
  find_shadowed(source, search, file, settings);
  source.reading.supersampling = supersampling_of(source, settings, &source.channels[RawPlane::beauty][0]);
  for (const auto* aov : {&source.channels[RawPlane::beauty], &source.channels[RawPlane::indirect],
                          &source.channels[RawPlane::diffuse_color]})
    require_common_window(source, *aov, "beauty", "--beauty",
                          "the composite is as large as the beauty, and unchanged where there is no depth");
  const auto window_of = [&](const ChannelRef& channel) { return source.part_of(channel).data; };
  const auto& beauty = source.channels[RawPlane::beauty];
  const auto other = std::ranges::find_if(
      beauty, [&](const ChannelRef& channel) { return window_of(channel) != window_of(beauty[0]); });
  if (other != beauty.end())
    fail(ErrorKind::input, "{}: the beauty's channel {} is {}, and {} is {}: all must cover the same pixels (--beauty)",
         source.file_of(*other).path(), other->channel, to_string(window_of(*other)), beauty[0].channel,
         to_string(window_of(beauty[0])));
}

/// Finds the AO of materials, if the settings name a file or a channel of it.
void find_material(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (settings.material_ao.empty() && settings.material_ao_channel.empty()) return;
  const std::size_t file =
      search.open(settings.material_ao.empty() ? settings.input : settings.material_ao, "--set material-ao");
  source.channels[RawPlane::material_ao] =
      search.require(file, kMaterialNames, settings.material_ao_channel, !settings.material_ao.empty(), "AO");
  require_common_window(source, source.channels[RawPlane::material_ao], "material AO", "--set material-ao",
                        "where it has no pixels it counts as 1");
}

/// The colour that light takes at the surfaces.
void find_albedo(FrameSource& source, ChannelSearch& search, const std::string& beauty_path,
                 const InputSettings& settings) {
  const std::size_t file = search.open(settings.albedo.empty() ? beauty_path : settings.albedo, "--set albedo");
  source.channels[RawPlane::albedo] =
      search.find(file, kAlbedoNames, settings.albedo_channels, !settings.albedo.empty());
  if (source.channels[RawPlane::albedo].empty())
    fail(ErrorKind::input,
         "{}: no diffuse colour found for --set multi-bounce: name its channels with --set albedo-channels, or give "
         "--set albedo a "
         "file or a number",
         source.files[file].path());
  require_common_window(source, source.channels[RawPlane::albedo], "diffuse colour", "--set albedo",
                        "where it has no pixels it counts as black");
}

/// The rules that the settings name, or those of the file.
void find_rules(FrameSource& source, const ExrFile& file, const InputSettings& settings) {
  const bool detects = settings.source.empty() || settings.source == "auto";
  const DetectedRules found =
      detects ? detect_rules(file) : DetectedRules{&input_rules(settings.source), Program::kByOption};
  source.program.rules = found.rules;
  source.program.by = found.by;
}

/// The depth channel; the position's where the settings say so, or where there is no depth.
std::vector<ChannelRef> find_depth(FrameSource& source, const ChannelSearch& search, std::size_t file,
                                   const InputSettings& settings, bool by_position) {
  source.program.depth_kind =
      source.program.rules->depth_kind != DepthKind::automatic ? source.program.rules->depth_kind : DepthKind::planar;
  if (by_position) {
    const auto found =
        search.find_by_rules(file, kPositionNames, settings.position_channels, source.program.rules->position);
    return found.candidate ? found.channels
                           : search.require(file, kPositionNames, settings.position_channels,
                                            !settings.position.empty(), "Position.X");
  }
  if (auto [found, candidate] =
          search.find_by_rules(file, kDepthNames, settings.depth_channel, source.program.rules->depth);
      candidate) {
    if (candidate->kind != DepthKind::automatic) source.program.depth_kind = candidate->kind;
    return found;
  }
  if (settings.depth_kind == DepthKind::automatic && settings.depth_channel.empty() &&
      search.find(file, kDepthNames, "", !settings.depth.empty()).empty())
    if (auto position = search.find(file, kPositionNames, "", false); !position.empty()) return position;
  AovNames names = kDepthNames;
  const bool is_disparity = settings.depth_kind == DepthKind::disparity;
  if (is_disparity) {
    names.layers.push_back("disparity");
    names.bare.push_back({"disparity"});
  }
  // Networks write their disparity alone, as INPUT.
  auto depth = search.require(file, names, settings.depth_channel, is_disparity || !settings.depth.empty(), "Depth.Z");
  if (settings.depth_channel.empty()) doubt_depth_of_three(source, search, depth.front());
  return depth;
}

/// Finds the normals, if there are any, and the space that the rules give them.
std::vector<ChannelRef> find_normal(FrameSource& source, const ChannelSearch& search, std::size_t file,
                                    const InputSettings& settings) {
  if (source.program.rules->normal_space != NormalSpace::automatic)
    source.program.normal_space = source.program.rules->normal_space;
  const std::string depth_layer = source.layer_of(source.channels[RawPlane::depth].front());
  if (auto [found, candidate] =
          search.find_by_rules(file, kNormalNames, settings.normal_channels, source.program.rules->normal, depth_layer);
      candidate) {
    if (candidate->space != NormalSpace::automatic) source.program.normal_space = candidate->space;
    return found;
  }
  if (!settings.normal.empty()) return search.require(file, kNormalNames, settings.normal_channels, true, "Normal.X");
  auto found = search.find(file, kNormalNames, settings.normal_channels, false);
  const bool of_two =
      settings.normal_encoding == NormalEncoding::octahedral || settings.normal_encoding == NormalEncoding::spheremap;
  if (!found.empty() || !of_two) return found;
  AovNames two = kNormalNames;
  two.in_layer = {{"x", "y"}, {"r", "g"}};
  return search.find(file, two, "", false);
}

/// Notes a camera, by a file or by the header, whose pixels have another shape than the file of the frame says: no
/// pixel shows which is right. Who crops a picture may keep the header of the whole.
void note_pixel_aspect(FrameSource& source, const std::string& camera) {
  constexpr double kSame = 0.01;  // focal lengths are rounded
  const double aspect = source.reading.camera.fy / source.reading.camera.fx;
  if (std::abs(aspect / source.reading.pixel_aspect - 1) < kSame) return;
  source.notes.push_back(
      {NoteCode::said_otherwise,
       fmt::format("by fx {:.6g} and fy {:.6g} of {} a pixel is {:.4g} times as wide as high, and "
                   "by the pixelAspectRatio of the frame {:.4g} times: one of them may be wrong; if the picture was "
                   "cropped, give the camera of the crop (--camera)",
                   source.reading.camera.fx, source.reading.camera.fy, camera, aspect, source.reading.pixel_aspect)});
}

/// Notes a camera file for another resolution of the same shape, which is a proxy's as well as a crop's.
void note_scaled_camera(FrameSource& source, const std::string& camera) {
  const auto [width, height] = source.reading.camera.scaled_from;
  if (width == 0) return;
  source.notes.push_back(
      {NoteCode::camera_scaled,
       fmt::format("the camera of {} is for {}x{} pixels and was scaled to the frame's {}x{}, as for a proxy: a "
                   "cropped picture needs the camera of the crop (--camera)",
                   camera, width, height, source.reading.camera.width, source.reading.camera.height)});
}

/// The positions of a frame that has a camera. Where two layers hold some, none of them is needed.
std::vector<ChannelRef> positions_beside(const ChannelSearch& search, const FrameSource& source,
                                         const InputSettings& settings) {
  try {
    return find_positions(search, source, settings);
  } catch (const Error&) {
    return {};
  }
}

/// Takes the camera that the positions tell. Returns false where there are none.
bool take_camera_of_positions(FrameSource& source, const ChannelSearch& search, const InputSettings& settings) {
  source.channels.positions = find_positions(search, source, settings);
  if (source.channels.positions.empty()) return false;
  const ExrFile& file = source.file_of(source.channels.positions.front());
  const auto points = points_of(source, settings.sky, kManyBands);
  const auto found = resection_of(points, file.display());
  std::string why = fault_of_positions(points, file, found);
  if (const auto* none = std::get_if<NoResection>(&found); none && why.empty()) why = none->why;
  if (!why.empty()) throw NoCamera(source.depth_path(), "its positions tell none, since " + why);
  source.reading.camera = std::get<Resection>(found).camera;
  const bool looks_around = settings.around > 0 || settings.around_all;
  if (source.reading.camera.orthographic && looks_around && source.channels[RawPlane::depth].size() == 1)
    throw NoCamera(source.depth_path(),
                   "--around needs the distance of an orthographic camera, which positions do not show");
  source.camera_from = kByPositions;
  note_pixel_aspect(source, kByPositions);
  return true;
}

/// The settings' camera, or else the header's, or else that of the positions. Options that give no more than a
/// projection leave the camera where the header says that it stands.
void find_camera(FrameSource& source, const ChannelSearch& search, const InputSettings& settings, int frame) {
  const ChannelRef& depth = source.channels[RawPlane::depth].front();
  const ExrFile& file = source.file_of(depth);
  Reading& reading = source.reading;
  const auto attributes = file.attribute_texts(depth.part);
  const std::string layer = source.layer_of(depth);
  require_no_panorama(attributes, file.path());
  if (!names_a_camera(settings)) {
    if (auto found = header_camera(attributes, reading.display, reading.data, reading.pixel_aspect, layer)) {
      reading.camera = found->camera;
      source.camera_from = "the header's " + found->from;
      source.channels.positions = positions_beside(search, source, settings);
      return note_pixel_aspect(source, source.camera_from);
    }
    if (take_camera_of_positions(source, search, settings)) return;
    if (const std::string why = why_no_header_camera(attributes, layer); !why.empty()) throw NoCamera(file.path(), why);
  }
  source.channels.positions = positions_beside(search, source, settings);
  reading.camera = camera_for(settings, reading.display, reading.pixel_aspect, frame, source.channels.view);
  if (settings.camera.empty())
    return place_by_header(reading.camera, attributes, reading.display, reading.pixel_aspect, layer);
  note_pixel_aspect(source, settings.camera);
  note_scaled_camera(source, settings.camera);
}

/// The range of depth by settings, else by the camera, else by rules. The planes of a matrix that is not reversed are
/// those of the range that the settings say.
DepthRange range_of(const DepthRange& said, const Camera& camera, const DepthRange& of_rules) {
  DepthRange range = said;
  range.reversed = said.reversed || camera.reversed_z || of_rules.reversed;
  const bool takes_matrix = camera.matrix_far && said.device != DeviceRange::automatic && !range.reversed;
  const auto first = [](auto one, auto other) { return one ? one : other; };
  if (takes_matrix) {
    const bool is_opengl = said.device == DeviceRange::minus_one_to_one;
    range.near = first(range.near, first(camera.near, is_opengl ? camera.matrix_near_opengl : camera.matrix_near));
    range.far = first(range.far, first(camera.far, camera.matrix_far));
  }
  range.near = first(range.near, first(camera.near, of_rules.near));
  range.far = first(range.far, first(camera.far, of_rules.far));
  return range;
}

/// Takes the meaning of depth and normals from settings, camera and rules; the rest is open.
void find_meaning(FrameSource& source, const InputSettings& settings) {
  const InputRules& rules = *source.program.rules;
  const auto decided = [](auto setting, auto from_camera, auto otherwise) {
    using Kind = decltype(setting);
    return setting != Kind::automatic ? setting : from_camera != Kind::automatic ? from_camera : otherwise;
  };
  const auto is_open = [&](auto setting, auto from_camera, bool in_rules) {
    using Kind = decltype(setting);
    return setting == Kind::automatic && from_camera == Kind::automatic && !(source.program.is_said() && in_rules);
  };
  source.open.depth_kind =
      is_open(settings.depth_kind, source.reading.camera.depth_kind, rules.depth_kind != DepthKind::automatic);
  source.open.normal_space =
      is_open(settings.normal_space, source.reading.camera.normal_space, rules.normal_space != NormalSpace::automatic);
  source.open.normal_encoding = is_open(settings.normal_encoding, source.reading.camera.normal_encoding,
                                        rules.normal_encoding != NormalEncoding::automatic);
  source.reading.depth_kind =
      source.channels[RawPlane::depth].size() == 3
          ? DepthKind::position
          : decided(settings.depth_kind, source.reading.camera.depth_kind, source.program.depth_kind);
  source.reading.depth_range = range_of(settings.depth_range, source.reading.camera, rules.depth_range);
  source.reading.position_space = settings.position_space != PositionSpace::automatic ? settings.position_space
                                  : source.reading.camera.view_from_world             ? PositionSpace::world
                                                                                      : PositionSpace::view;
  const bool has_encoding = source.program.is_said() && rules.normal_encoding != NormalEncoding::automatic;
  source.reading.normal_encoding = decided(settings.normal_encoding, source.reading.camera.normal_encoding,
                                           has_encoding ? rules.normal_encoding : NormalEncoding::signed_float);
  source.reading.flip_normal = settings.flip_normal;
  source.reading.normal_space =
      decided(settings.normal_space, source.reading.camera.normal_space, source.program.normal_space);
}

/// Notes an INPUT that gives nothing although the frame has no normals: perhaps it holds them.
void note_unused_input(FrameSource& source, const InputSettings& settings) {
  if (settings.input.empty() || !source.channels[RawPlane::normal].empty() || !wants_normals(settings)) return;
  const auto is_of_input = [&](const ChannelRef& ref) { return source.file_of(ref).path() == settings.input; };
  const auto is_used = [&](const std::vector<ChannelRef>& plane) { return std::ranges::any_of(plane, is_of_input); };
  if (std::ranges::any_of(source.channels.entries, is_used)) return;
  source.notes.push_back({NoteCode::unused_input, fmt::format("no channel of {} is used: if it holds the normals, give "
                                                              "it to --normal, or name them with --normal-channels",
                                                              settings.input)});
}

/// Notes the view that nobody chose, and a choice that chooses nothing.
void note_views(FrameSource& source, const InputSettings& settings) {
  const auto views = views_of(source.file_of(source.channels[RawPlane::depth][0]));
  if (settings.view.empty() && views.size() > 1)
    source.notes.push_back({NoteCode::default_view,
                            fmt::format("of the views {} this is {} (--view)", list_of(views), source.channels.view)});
  const auto has_views = [](const ExrFile& file) { return !views_of(file).empty(); };
  if (!settings.view.empty() && std::ranges::none_of(source.files, has_views))
    source.notes.push_back({NoteCode::said_otherwise,
                            fmt::format("--view {} chooses nothing: the frame's files name no views", settings.view)});
}

/// Opens the file of the depth, or of the positions, and finds them in it.
void find_depth_file(FrameSource& source, ChannelSearch& search, const std::string& path,
                     const InputSettings& settings) {
  const bool wants_position = !settings.position.empty() || !settings.position_channels.empty();
  const bool by_position = wants_position || settings.depth_kind == DepthKind::position;
  const bool is_deep = std::ranges::count(settings.deep, path) > 0;
  const std::size_t file = by_position && !settings.position.empty()
                               ? search.open(settings.position, "--position")
                               : search.open(path, is_deep ? "--deep" : "--depth");
  source.channels.view = search.view();
  find_rules(source, source.files[file], settings);
  auto& depth = source.channels[RawPlane::depth];
  if (!by_position) depth = find_deep_depth(source, search, file, settings);
  if (depth.empty()) depth = find_depth(source, search, file, settings, by_position);
}

/// Takes the windows of the depth and what the settings say of its pixels.
void describe_pixels(FrameSource& source, const InputSettings& settings) {
  const ChannelRef& depth = source.channels[RawPlane::depth][0];
  const ExrPart& part = source.part_of(depth);
  Reading& reading = source.reading;
  reading.data = part.deep ? source.channels.deep->data : part.data;
  reading.display = source.file_of(depth).display();
  reading.pixel_aspect = source.file_of(depth).pixel_aspect();
  reading.supersampling = supersampling_of(source, settings);
  reading.depth_is_half = source.is_half(depth) || (source.channels.deep && source.channels.deep->depth_is_half);
  reading.depth_scale = settings.depth_scale;
  reading.sky = settings.sky;
  reading.cuts_ramps = settings.ramps == "cut";
}

}  // namespace

FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo) {
  FrameSource source;
  source.main_file = main_input(settings);
  ChannelSearch search(settings, source.files);
  const std::string& depth_path = settings.depth.empty() ? main_input(settings) : settings.depth;
  const auto path_of = [&](const std::string& own) -> const std::string& {
    return !own.empty() ? own : settings.input.empty() ? depth_path : settings.input;
  };
  find_depth_file(source, search, depth_path, settings);
  describe_pixels(source, settings);
  if (wants_normals(settings)) {
    source.channels[RawPlane::normal] =
        find_normal(source, search, search.open(path_of(settings.normal), "--normal"), settings);
    require_same_picture(source, source.channels[RawPlane::normal], "normal", "--normal");
  }
  if (with_beauty) find_beauty(source, search, search.open(path_of(settings.beauty), "--beauty"), settings);
  if (with_albedo) find_albedo(source, search, path_of(settings.beauty), settings);
  find_material(source, search, settings);
  find_matte(source, search, settings);
  find_occluders(source, search, settings);
  find_behind(source, search, settings);
  find_deep(source, search, settings);
  note_unused_input(source, settings);
  note_views(source, settings);
  find_camera(source, search, settings, frame);
  find_meaning(source, settings);
  take_deep(source, settings);
  if (!source.channels[RawPlane::normal].empty() && source.reading.normal_space == NormalSpace::world &&
      !source.open.normal_space && !source.reading.camera.view_from_world)
    throw NoWorldToCamera(source.path_of(RawPlane::normal));
  return source;
}

std::vector<std::string> other_depths(const FrameSource& source) {
  const ChannelRef& depth = source.channels[RawPlane::depth][0];
  std::vector<std::string> others;
  for (const ExrPart& part : source.file_of(depth).parts()) {
    if (part.deep || part.data != source.reading.data) continue;
    for (const ExrChannel& channel : part.channels) {
      const std::string name = lower_case(channel.name), word = name.substr(name.rfind('.') + 1);
      const bool is_depth = word == "z" || word == "depth" || name.ends_with("depth.v") || name.ends_with("depth.r");
      const bool is_of_vector = word == "z" && std::ranges::any_of(part.channels, [&](const ExrChannel& other) {
                                  return lower_case(other.name) == name.substr(0, name.size() - 1) + "y";
                                });
      if (is_depth && !is_of_vector && channel.name != depth.channel && !channel.subsampled)
        others.push_back(channel.name);
    }
  }
  return others;
}

NoWorldToCamera::NoWorldToCamera(const std::string& file)
    : Error(ErrorKind::input, file +
                                  ": its normals are in world space, and the camera has no world_to_camera: give a "
                                  "--camera file with it, or --normal none to reconstruct normals from depth") {}

bool may_tell_camera(const InputSettings& settings) {
  std::vector<ExrFile> files;
  ChannelSearch search(settings, files);
  const std::size_t place = search.open(settings.depth.empty() ? main_input(settings) : settings.depth,
                                        settings.depth.empty() ? main_option(settings) : "--depth");
  const ExrFile& file = files[place];
  for (std::size_t part = 0; part < file.parts().size(); part++) {
    const auto attributes = file.attribute_texts(int(part));
    if (header_camera(attributes, file.display(), file.parts()[part].data, file.pixel_aspect(), "") ||
        !why_no_header_camera(attributes, "").empty())
      return true;
  }
  FrameSource source;
  find_rules(source, file, settings);
  return !search.find_by_rules(place, kPositionNames, settings.position_channels, source.program.rules->position)
              .channels.empty() ||
         !search.find(place, kPositionNames, settings.position_channels, !settings.position.empty()).empty();
}

}  // namespace alcove
