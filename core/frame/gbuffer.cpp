// What a frame holds: its planes, the rules it is read by, its camera, and the meaning of depth and normals.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/gbuffer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/ambient.h"
#include "core/frame/behind.h"
#include "core/frame/colours.h"
#include "core/frame/deep.h"
#include "core/frame/header_camera.h"
#include "core/frame/input_files.h"
#include "core/frame/matte.h"
#include "core/frame/panorama.h"
#include "core/frame/plane_windows.h"
#include "core/frame/position_pass.h"
#include "core/frame/views.h"

namespace alcove {
namespace {

bool has_half_channel(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = source.part_of(ref).channels;
  const auto channel = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return channel != channels.end() && channel->type == SampleType::half_float;
}

void find_beauty(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  source[RawPlane::beauty] = search.with_alpha(
      search.require(file, kBeautyNames, settings.beauty_channels, !settings.beauty.empty(), "Combined.R"));
  find_ambient(source, search, file, settings);
  source.supersampling = supersampling_of(source, source[RawPlane::beauty][0], settings);
  if (source.supersampling > 1 && settings.supersampling == "auto")
    source.notes.push_back(
        {NoteCode::windows_differ,
         fmt::format(
             "the depth is of {} times the beauty's size: what is written is filtered to that of the beauty, {} "
             "(--set supersampling, --set filter)",
             source.supersampling, to_string(picture_of(source, source.display)))});
  for (const auto* aov : {&source[RawPlane::beauty], &source[RawPlane::indirect], &source[RawPlane::diffuse_color]})
    require_common_window(source, *aov, "beauty", "--beauty",
                          "the composite is as large as the beauty, which stays as it is where there is no depth");
  const auto window_of = [&](const ChannelRef& channel) { return source.part_of(channel).data; };
  const auto& beauty = source[RawPlane::beauty];
  const auto other = std::ranges::find_if(
      beauty, [&](const ChannelRef& channel) { return window_of(channel) != window_of(beauty[0]); });
  if (other != beauty.end())
    fail(ErrorKind::input, "{}: the beauty's channel {} is {}, and {} is {}: all must cover the same pixels (--beauty)",
         source.files[other->file].path(), other->channel, to_string(window_of(*other)), beauty[0].channel,
         to_string(window_of(beauty[0])));
}

/// What is multiplied in, where the settings name a file or a channel of it.
void find_material(FrameSource& source, ChannelSearch& search, const InputSettings& settings) {
  if (settings.material_ao.empty() && settings.material_ao_channel.empty()) return;
  const std::size_t file =
      search.open(settings.material_ao.empty() ? settings.input : settings.material_ao, "--set material-ao");
  source[RawPlane::material_ao] =
      search.require(file, kMaterialNames, settings.material_ao_channel, !settings.material_ao.empty(), "AO");
  require_common_window(source, source[RawPlane::material_ao], "material AO", "--set material-ao",
                        "where it has no pixels it counts as 1");
}

/// The colour that light takes at the surfaces.
void find_albedo(FrameSource& source, ChannelSearch& search, const std::string& beauty_path,
                 const InputSettings& settings) {
  const std::size_t file = search.open(settings.albedo.empty() ? beauty_path : settings.albedo, "--set albedo");
  source[RawPlane::albedo] = search.find(file, kAlbedoNames, settings.albedo_channels, !settings.albedo.empty());
  if (source[RawPlane::albedo].empty())
    fail(ErrorKind::input,
         "{}: no diffuse colour found for --set multi-bounce: name its channels with --set albedo-channels, or give "
         "--set albedo a "
         "file or a number",
         source.files[file].path());
  require_common_window(source, source[RawPlane::albedo], "diffuse colour", "--set albedo",
                        "where it has no pixels it counts as black");
}

/// The rules that the settings name, or those of the file.
void find_rules(FrameSource& source, const ExrFile& file, const InputSettings& settings) {
  const bool detects = settings.source.empty() || settings.source == "auto";
  const DetectedRules found = detects ? detect_rules(file) : DetectedRules{&input_rules(settings.source), "--source"};
  source.rules = found.rules;
  source.rules_by = found.by;
  source.rules_said = !detects;
}

/// The depth channel; the position's where the settings say so, or where there is no depth.
std::vector<ChannelRef> find_depth(FrameSource& source, const ChannelSearch& search, std::size_t file,
                                   const InputSettings& settings, bool by_position) {
  source.usual_depth_kind =
      source.rules->depth_kind != DepthKind::automatic ? source.rules->depth_kind : DepthKind::planar;
  if (by_position)
    if (auto [found, candidate] =
            search.find_by_rules(file, kPositionNames, settings.position_channels, source.rules->position);
        candidate)
      return found;
  if (!by_position)
    if (auto [found, candidate] = search.find_by_rules(file, kDepthNames, settings.depth_channel, source.rules->depth);
        candidate) {
      if (candidate->kind != DepthKind::automatic) source.usual_depth_kind = candidate->kind;
      return found;
    }
  if (by_position)
    return search.require(file, kPositionNames, settings.position_channels, !settings.position.empty(), "Position.X");
  if (settings.depth_kind == DepthKind::automatic && settings.depth_channel.empty() &&
      search.find(file, kDepthNames, "", !settings.depth.empty()).empty())
    if (auto position = search.find(file, kPositionNames, "", false); !position.empty()) return position;
  auto depth = search.require(file, kDepthNames, settings.depth_channel, !settings.depth.empty(), "Depth.Z");
  if (settings.depth_channel.empty()) doubt_depth_of_three(source, search, depth.front());
  return depth;
}

/// The normals, none where there are none; and what the rules say of their space.
std::vector<ChannelRef> find_normal(FrameSource& source, const ChannelSearch& search, std::size_t file,
                                    const InputSettings& settings) {
  if (source.rules->normal_space != NormalSpace::automatic) source.usual_normal_space = source.rules->normal_space;
  const std::string depth_layer = source.layer_of(source[RawPlane::depth].front());
  if (auto [found, candidate] =
          search.find_by_rules(file, kNormalNames, settings.normal_channels, source.rules->normal, depth_layer);
      candidate) {
    if (candidate->space != NormalSpace::automatic) source.usual_normal_space = candidate->space;
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
  const double aspect = source.camera.fy / source.camera.fx;
  if (std::abs(aspect / source.pixel_aspect - 1) < kSame) return;
  source.notes.push_back({NoteCode::said_otherwise,
                          fmt::format("by fx {:.6g} and fy {:.6g} of {} a pixel is {:.4g} times as wide as high, and "
                                      "by the pixelAspectRatio of the frame {:.4g} times: is one of them wrong? Where "
                                      "the picture was cropped, give the camera of what is left of it (--camera)",
                                      source.camera.fx, source.camera.fy, camera, aspect, source.pixel_aspect)});
}

/// Notes a camera file for another resolution of the same shape, which is a proxy's as well as a crop's.
void note_scaled_camera(FrameSource& source, const std::string& camera) {
  const auto [width, height] = source.camera.scaled_from;
  if (width == 0) return;
  source.notes.push_back(
      {NoteCode::camera_scaled,
       fmt::format("the camera of {} is for {}x{} pixels and was scaled to the frame's {}x{}, as of a proxy: a cropped "
                   "picture needs the camera of what is left of it (--camera)",
                   camera, width, height, source.camera.width, source.camera.height)});
}

/// What the positions say of the camera that saw them: it, or why they tell none. Nothing where there are no positions
/// that fit the depth.
std::optional<std::variant<Resection, NoResection>> camera_by_positions(const std::vector<ChannelRef>& positions,
                                                                        std::vector<ExrFile>& files,
                                                                        const InputSettings& settings) {
  if (positions.empty()) return std::nullopt;
  ExrFile& file = files[positions.front().file];
  const auto points = points_of(file, positions, settings.sky, kManyBands);
  auto found = resection_of(points, file.display());
  if (std::holds_alternative<NoResection>(found))
    if (const std::string panorama = panorama_of(points, file.display()); !panorama.empty())
      refuse_panorama(file.path(), panorama + " by its positions");
  return found;
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

/// The settings' camera, or else the header's, or else that of the positions. Options that give no more than a
/// projection leave the camera where the header says that it stands.
void find_camera(FrameSource& source, const ChannelSearch& search, const InputSettings& settings, int frame) {
  const ChannelRef& depth = source[RawPlane::depth].front();
  const ExrFile& file = source.files[depth.file];
  const auto attributes = file.attribute_texts(depth.part);
  const std::string layer = source.layer_of(depth);
  require_no_panorama(attributes, file.path());
  if (!names_a_camera(settings))
    if (auto found = header_camera(attributes, source.display, source.file_data, source.pixel_aspect, layer)) {
      source.camera = found->camera;
      source.camera_from = "the header's " + found->from;
      source.positions = positions_beside(search, source, settings);
      note_pixel_aspect(source, source.camera_from);
      return;
    }
  if (!names_a_camera(settings)) {
    source.positions = find_positions(search, source, settings);
    if (const auto found = camera_by_positions(source.positions, source.files, settings)) {
      if (const auto* none = std::get_if<NoResection>(&*found))
        throw NoCamera(file.path(), "its positions tell none, since " + none->why);
      source.camera = std::get<Resection>(*found).camera;
      const bool looks_around = settings.around > 0 || settings.around_all;
      if (source.camera.orthographic && looks_around && source[RawPlane::depth].size() == 1)
        throw NoCamera(file.path(),
                       "its positions do not tell how far away an orthographic camera stands, and --around "
                       "needs that");
      source.camera_from = kByPositions;
      return;
    }
  }
  if (!names_a_camera(settings))
    if (const std::string why = why_no_header_camera(attributes, layer); !why.empty()) throw NoCamera(file.path(), why);
  source.positions = positions_beside(search, source, settings);
  source.camera = camera_for(settings, source.display, source.pixel_aspect, frame, source.view);
  if (settings.camera.empty())
    return place_by_header(source.camera, attributes, source.display, source.pixel_aspect, layer);
  note_pixel_aspect(source, settings.camera);
  note_scaled_camera(source, settings.camera);
}

/// What of the meaning of depth and normals is said, and by whom; the rest is open.
void find_meaning(FrameSource& source, const InputSettings& settings) {
  const InputRules& rules = *source.rules;
  const auto decided = [](auto setting, auto from_camera, auto otherwise) {
    using Kind = decltype(setting);
    return setting != Kind::automatic ? setting : from_camera != Kind::automatic ? from_camera : otherwise;
  };
  const auto is_open = [&](auto setting, auto from_camera, bool in_rules) {
    using Kind = decltype(setting);
    return setting == Kind::automatic && from_camera == Kind::automatic && !(source.rules_said && in_rules);
  };
  source.depth_kind_open =
      is_open(settings.depth_kind, source.camera.depth_kind, rules.depth_kind != DepthKind::automatic);
  source.normal_space_open =
      is_open(settings.normal_space, source.camera.normal_space, rules.normal_space != NormalSpace::automatic);
  source.normal_encoding_open = is_open(settings.normal_encoding, source.camera.normal_encoding,
                                        rules.normal_encoding != NormalEncoding::automatic);
  source.depth_kind = source[RawPlane::depth].size() == 3
                          ? DepthKind::position
                          : decided(settings.depth_kind, source.camera.depth_kind, source.usual_depth_kind);
  source.depth_range = settings.depth_range;
  if (!source.depth_range.near)
    source.depth_range.near = source.camera.near ? source.camera.near : rules.depth_range.near;
  if (!source.depth_range.far) source.depth_range.far = source.camera.far ? source.camera.far : rules.depth_range.far;
  source.depth_range.reversed = settings.depth_range.reversed || source.camera.reversed_z || rules.depth_range.reversed;
  source.position_space = settings.position_space != PositionSpace::automatic ? settings.position_space
                          : source.camera.view_from_world                     ? PositionSpace::world
                                                                              : PositionSpace::view;
  const bool has_encoding = source.rules_said && rules.normal_encoding != NormalEncoding::automatic;
  source.normal_encoding = decided(settings.normal_encoding, source.camera.normal_encoding,
                                   has_encoding ? rules.normal_encoding : NormalEncoding::signed_float);
  source.flip_normal = settings.flip_normal;
  source.normal_space = decided(settings.normal_space, source.camera.normal_space, source.usual_normal_space);
}

/// Notes an INPUT that gives nothing although the frame has no normals: perhaps it holds them.
void note_unused_input(FrameSource& source, const InputSettings& settings) {
  if (settings.input.empty() || !source[RawPlane::normal].empty() || source.normals_left_out) return;
  const auto is_of_input = [&](const ChannelRef& ref) { return source.files[ref.file].path() == settings.input; };
  const auto is_used = [&](const std::vector<ChannelRef>& plane) { return std::ranges::any_of(plane, is_of_input); };
  if (std::ranges::any_of(source.planes.entries, is_used)) return;
  source.notes.push_back({NoteCode::unused_input,
                          fmt::format("no channel of {} is used: where it holds the normals, give it with --normal, "
                                      "or name them with --normal-channels",
                                      settings.input)});
}

}  // namespace

std::string FrameSource::layer_of(const ChannelRef& ref) const {
  const std::size_t dot = ref.channel.rfind('.');
  return dot == ref.channel.npos ? part_of(ref).name : ref.channel.substr(0, dot);
}

FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo) {
  FrameSource source;
  ChannelSearch search(settings, source.files);
  const std::string& depth_path = !settings.depth.empty()  ? settings.depth
                                  : settings.input.empty() ? main_input(settings)
                                                           : settings.input;
  const std::string& normal_path = !settings.normal.empty() ? settings.normal
                                   : settings.input.empty() ? depth_path
                                                            : settings.input;
  const std::string& beauty_path = !settings.beauty.empty() ? settings.beauty
                                   : settings.input.empty() ? depth_path
                                                            : settings.input;

  const auto is_deep_path = [&](const std::string& path) { return std::ranges::count(settings.deep, path) > 0; };
  const bool wants_position = !settings.position.empty() || !settings.position_channels.empty();
  const bool by_position = wants_position || settings.depth_kind == DepthKind::position;
  std::size_t depth_file = by_position && !settings.position.empty()
                               ? search.open(settings.position, "--position")
                               : search.open(depth_path, is_deep_path(depth_path) ? "--deep" : "--depth");
  source.view = search.view();
  find_rules(source, source.files[depth_file], settings);
  if (!by_position) source[RawPlane::depth] = find_deep_depth(source, search, depth_file, settings);
  if (source[RawPlane::depth].empty())
    source[RawPlane::depth] = find_depth(source, search, depth_file, settings, by_position);
  depth_file = source[RawPlane::depth][0].file;
  const ExrPart& depth_part = source.part_of(source[RawPlane::depth][0]);
  source.data = source.file_data = depth_part.deep ? source.deep_data : depth_part.data;
  source.display = source.files[depth_file].display();
  source.pixel_aspect = source.files[depth_file].pixel_aspect();
  source.supersampling = supersampling_of(source, settings);
  source.depth_is_half = has_half_channel(source, source[RawPlane::depth][0]) || source.deep_depth_is_half;
  source.depth_scale = settings.depth_scale;
  source.sky = settings.sky;

  source.normals_left_out = !wants_normals(settings);
  if (!source.normals_left_out) {
    source[RawPlane::normal] = find_normal(source, search, search.open(normal_path, "--normal"), settings);
    require_same_picture(source, source[RawPlane::normal], "normal", "--normal");
  }
  if (with_beauty) find_beauty(source, search, search.open(beauty_path, "--beauty"), settings);
  if (with_albedo) find_albedo(source, search, beauty_path, settings);
  find_material(source, search, settings);
  find_matte(source, search, settings);
  find_occluders(source, search, settings);
  find_behind(source, search, settings);
  find_deep(source, search, settings);

  note_unused_input(source, settings);

  const auto views = views_of(source.files[depth_file]);
  if (settings.view.empty() && views.size() > 1)
    source.notes.push_back(
        {NoteCode::default_view, fmt::format("of the views {} this is {} (--view)", list_of(views), source.view)});
  const auto has_views = [](const ExrFile& file) { return !views_of(file).empty(); };
  if (!settings.view.empty() && std::ranges::none_of(source.files, has_views))
    source.notes.push_back({NoteCode::said_otherwise,
                            fmt::format("--view {} chooses nothing: the frame's files name no views", settings.view)});
  find_camera(source, search, settings, frame);
  find_meaning(source, settings);
  take_deep(source, settings);
  if (!source[RawPlane::normal].empty() && source.normal_space == NormalSpace::world && !source.normal_space_open &&
      !source.camera.view_from_world)
    fail(ErrorKind::input, "{}: {}", source.files[source[RawPlane::normal][0].file].path(), kWorldWithoutMatrix);
  return source;
}

bool may_tell_camera(const InputSettings& settings) {
  std::vector<ExrFile> files;
  ChannelSearch search(settings, files);
  const std::size_t place = search.open(!settings.depth.empty()  ? settings.depth
                                        : settings.input.empty() ? main_input(settings)
                                                                 : settings.input,
                                        "INPUT");
  const ExrFile& file = files[place];
  for (std::size_t part = 0; part < file.parts().size(); part++) {
    const auto attributes = file.attribute_texts(int(part));
    if (header_camera(attributes, file.display(), file.parts()[part].data, file.pixel_aspect(), "") ||
        !why_no_header_camera(attributes, "").empty())
      return true;
  }
  FrameSource source;
  find_rules(source, file, settings);
  return !search.find_by_rules(place, kPositionNames, settings.position_channels, source.rules->position)
              .channels.empty() ||
         !search.find(place, kPositionNames, settings.position_channels, !settings.position.empty()).empty();
}

void read_planes(FrameSource& source, const std::vector<PlaneRead>& reads) {
  source.rows_read += std::uint64_t(source.data.height);
  std::vector<ChannelRead> firsts;
  // a channel that serves two purposes is decoded to the first place, and copied from there
  std::map<ChannelRef, float*> first;
  std::vector<std::pair<float*, float*>> copies;
  for (const auto& read : reads)
    for (std::size_t i = 0; i < read.channels->size(); i++) {
      const auto& channel = (*read.channels)[i];
      float* to = read.to + i * source.data.pixels();
      if (const auto [known, is_new] = first.try_emplace(channel, to); is_new)
        firsts.push_back({channel, to});
      else
        copies.emplace_back(known->second, to);
    }
  read_rows(source, firsts, source.data.y, source.data.height);
  for (const auto& [from, to] : copies) std::copy_n(from, source.data.pixels(), to);
}

}  // namespace alcove
