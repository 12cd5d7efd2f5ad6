// Channel search by the names that renderers use.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/gbuffer.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/dds.h"
#include "core/formats/image_io.h"
#include "core/frame/header_camera.h"

namespace alcove {
namespace {

/// A channel under its full name: among several parts, a part's name stands for a layer where the channel does not
/// repeat it.
struct NamedChannel {
  ChannelRef ref;
  std::string full;
  // lower case, without the chosen layer: the full name, and the name within the part where that is another
  std::vector<std::string> spellings;
  bool subsampled;
};

using Components = std::vector<std::vector<std::string>>;  // sets of last name parts that may spell an AOV

/// An AOV's usual names, lower case, the likeliest first.
struct AovNames {
  const char* what;
  const char* channel_option;
  std::vector<std::string> layers;
  Components in_layer;  // below one of the layers
  Components bare;      // by themselves in any file
  Components alone;     // by themselves in a file that was given for this AOV only
  bool may_have_alpha = false;
  bool may_be_two = false;
};

const AovNames kDepthNames{"depth",
                           "--depth-channel",
                           {"depth", "z", "zdepth", "vrayzdepth", "z-depth", "__depth", "cgeometry_zdepth",
                            "finalimagemovierenderqueue_worlddepth"},
                           {{"z"}, {"depth"}, {"r"}, {"y"}},
                           {{"z"}, {"depth"}, {"zdepth"}, {"pz"}},
                           {{"r"}, {"y"}}};
const AovNames kNormalNames{"normal",
                            "--normal-channels",
                            {"normal", "n", "nn", "normals", "ns", "__nworld", "cgeometry_normalsshading"},
                            {{"x", "y", "z"}, {"r", "g", "b"}},
                            {{"nx", "ny", "nz"}},
                            {{"x", "y", "z"}, {"r", "g", "b"}, {"x", "y"}, {"r", "g"}},
                            false,
                            true};
const AovNames kPositionNames{"position",
                              "--position-channels",
                              {"position", "p", "pworld", "__pworld", "worldposition", "cgeometry_worldposition"},
                              {{"x", "y", "z"}, {"r", "g", "b"}},
                              {{"px", "py", "pz"}},
                              {{"x", "y", "z"}, {"r", "g", "b"}}};
const AovNames kBeautyNames{"beauty",
                            "--beauty-channels",
                            {"combined", "rgba", "beauty"},
                            {{"r", "g", "b"}, {"red", "green", "blue"}},
                            {{"r", "g", "b"}},
                            {},
                            true};
const AovNames kIndirectNames{
    "indirect diffuse", "--layer", {"diffind", "diffuse indirect", "diffuse_indirect", "indirectdiffuse", "gi"},
    {{"r", "g", "b"}},  {},        {}};
const AovNames kDiffuseColorNames{"diffuse colour", "--layer", {"diffcol", "diffuse color"}, {{"r", "g", "b"}}, {}, {}};

const AovNames kMaterialNames{
    "material AO",          "--material-ao-channel", {"ao", "occlusion", "ambient occlusion", "materialao"},
    {{"y"}, {"r"}, {"ao"}}, {{"ao"}, {"occlusion"}}, {{"y"}, {"r"}}};
const AovNames kAlbedoNames{"diffuse colour",
                            "--albedo-channels",
                            {"diffcol", "diffuse color", "albedo", "diffuse_albedo"},
                            {{"r", "g", "b"}},
                            {},
                            {{"r", "g", "b"}}};

/// The name without the layer; nothing when it lies elsewhere. Without a layer: the name.
std::optional<std::string> within_layer(const std::string& name, const std::string& layer) {
  if (layer.empty()) return lower_case(name);
  if (!lower_case(name).starts_with(lower_case(layer) + ".")) return std::nullopt;
  return lower_case(name).substr(layer.size() + 1);
}

/// The views of a stereo file, the default first; none of any other file.
std::vector<std::string> views_of(const ExrFile& file) {
  std::vector<std::string> views;
  for (const auto& part : file.parts())
    for (const auto& view : part.multi_view.empty() ? std::vector{part.view} : part.multi_view)
      if (!view.empty() && std::ranges::find(views, view) == views.end()) views.push_back(view);
  return views;
}

/// The name without its view, which stands before the last name part ("depth.right.Z", "right.R"); nothing where it is
/// of another view. Channels that name no view belong to the first.
std::optional<std::string> within_view(const std::string& name, const std::vector<std::string>& views,
                                       const std::string& view) {
  if (views.empty()) return name;
  const std::size_t last = name.rfind('.'),
                    before = last == name.npos || last == 0 ? name.npos : name.rfind('.', last - 1);
  const std::size_t begin = before == name.npos ? 0 : before + 1;
  const std::string named = last == name.npos ? "" : name.substr(begin, last - begin);
  if (std::ranges::find(views, named) == views.end())
    return lower_case(view) == lower_case(views.front()) ? std::optional(name) : std::nullopt;
  if (lower_case(named) != lower_case(view)) return std::nullopt;
  return name.substr(0, begin) + name.substr(last + 1);
}

/// The channels of the chosen view and layer; all of them without a layer.
std::vector<NamedChannel> channels_of(const ExrFile& file, std::size_t index, const std::string& layer,
                                      const std::string& chosen_view) {
  const auto views = views_of(file);
  const std::string view = chosen_view.empty() && !views.empty() ? views.front() : chosen_view;
  std::vector<NamedChannel> channels;
  for (std::size_t part = 0; part < file.parts().size(); part++) {
    const auto& p = file.parts()[part];
    if (!p.view.empty() && !view.empty() && lower_case(p.view) != lower_case(view)) continue;
    // "depth.left" of view "left" is the layer "depth".
    const std::string part_name = !p.view.empty() && p.name.ends_with("." + p.view)
                                      ? p.name.substr(0, p.name.size() - p.view.size() - 1)
                                      : p.name;
    for (const auto& channel : p.channels) {
      const auto plain = within_view(channel.name, p.multi_view, view);
      if (!plain) continue;
      const bool alone = file.parts().size() == 1 || part_name.empty() || channel.name.starts_with(part_name + ".");
      NamedChannel named{{index, int(part), channel.name},
                         alone ? channel.name : part_name + "." + channel.name,
                         {},
                         channel.subsampled};
      for (const auto& name : plain != channel.name ? std::vector{*plain} : std::vector{named.full, channel.name})
        if (const auto spelling = within_layer(name, layer);
            spelling && (named.spellings.empty() || named.spellings.back() != *spelling))
          named.spellings.push_back(*spelling);
      if (!named.spellings.empty()) channels.push_back(std::move(named));
    }
  }
  return channels;
}

std::vector<std::string> full_names(const std::vector<NamedChannel>& channels) {
  std::vector<std::string> names;
  std::ranges::transform(channels, std::back_inserter(names), &NamedChannel::full);
  return names;
}

/// All that stands before a dot in a full name, once each: "ViewLayer", "ViewLayer.Depth" ...
std::vector<std::string> layers_of(const ExrFile& file) {
  std::set<std::string> layers;
  for (const auto& channel : channels_of(file, 0, "", ""))
    for (std::size_t dot = channel.full.find('.'); dot != channel.full.npos; dot = channel.full.find('.', dot + 1))
      layers.insert(channel.full.substr(0, dot));
  return {layers.begin(), layers.end()};
}

/// What stands before `.component` (or "" for the bare component); nothing when the name does not end so.
std::optional<std::string> prefix_of(const std::string& name, const std::string& component) {
  if (name == component) return "";
  const std::string end = "." + component;
  if (name.size() <= end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0) return std::nullopt;
  return name.substr(0, name.size() - end.size());
}

/// Whether a layer path is, or ends in, this layer.
bool is_layer(const std::string& path, const std::string& layer) {
  return path == layer || (!layer.empty() && prefix_of(path, layer));
}

/// The channels of one part that spell `layer` with these components: one entry for each place where all are found.
std::vector<std::vector<const NamedChannel*>> places_of(const std::vector<NamedChannel>& channels,
                                                        const std::string& layer,
                                                        const std::vector<std::string>& components) {
  std::map<std::pair<int, std::string>, std::vector<const NamedChannel*>> places;
  for (std::size_t i = 0; i < components.size(); i++)
    for (const auto& channel : channels)
      for (const auto& spelling : channel.spellings) {
        const auto prefix = prefix_of(spelling, components[i]);
        if (!prefix || !is_layer(*prefix, layer)) continue;
        auto& place = places[{channel.ref.part, *prefix}];
        if (place.size() == i) place.push_back(&channel);
      }
  std::vector<std::vector<const NamedChannel*>> whole;
  std::set<std::vector<const NamedChannel*>> known;
  for (auto& [key, place] : places)
    if (place.size() == components.size() && known.insert(place).second) whole.push_back(std::move(place));
  return whole;
}

std::vector<ChannelRef> refs_of(const std::vector<const NamedChannel*>& channels, const ExrFile& file) {
  std::vector<ChannelRef> refs;
  for (const auto* channel : channels) {
    if (channel->subsampled)
      fail(ErrorKind::input, "{}: channel {} is subsampled; it must have a sample for every pixel", file.path(),
           channel->full);
    refs.push_back(channel->ref);
  }
  return refs;
}

/// The AOV at the one place where `layer` holds one of the component sets; empty when there is none. Two places are an
/// error.
std::vector<ChannelRef> find_in_layer(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                      const AovNames& names, const std::string& layer, const Components& sets) {
  for (const auto& components : sets) {
    const auto places = places_of(channels, layer, components);
    if (places.size() > 1)
      fail(ErrorKind::input, "{}: two layers hold a {}: {} and {}; say which with --layer or {}", file.path(),
           names.what, places[0][0]->full, places[1][0]->full, names.channel_option);
    if (places.size() == 1) return refs_of(places[0], file);
  }
  return {};
}

/// The AOV under its usual names; empty when there is none.
std::vector<ChannelRef> find_usual(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                   const AovNames& names, bool own_file) {
  for (const auto& layer : names.layers)
    if (auto found = find_in_layer(file, channels, names, layer, names.in_layer); !found.empty()) return found;
  auto found = find_in_layer(file, channels, names, "", names.bare);
  return found.empty() && own_file ? find_in_layer(file, channels, names, "", names.alone) : found;
}

const NamedChannel* find_named(const std::vector<NamedChannel>& channels, const std::string& name) {
  const std::string lower = lower_case(name);
  for (const auto& channel : channels)
    if (lower_case(channel.full) == lower || lower_case(channel.ref.channel) == lower) return &channel;
  return nullptr;
}

/// The channels that the user named: each by its full name, or all by their layer.
std::vector<ChannelRef> find_chosen(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                    const AovNames& names, const std::string& chosen) {
  auto wanted = split(chosen);
  const std::size_t count = names.in_layer.front().size();
  if (wanted.size() == 1 && count > 1)
    for (const auto& components : names.in_layer)
      if (const auto places = places_of(channels, lower_case(chosen), components); places.size() == 1)
        return refs_of(places[0], file);
  if (wanted.size() != count && !(names.may_have_alpha && wanted.size() == count + 1) &&
      !(names.may_be_two && wanted.size() == 2))
    fail(ErrorKind::input, "{}: no layer {} for {}{}; there is {}; {} takes a layer or {} channel names with commas",
         file.path(), chosen, names.channel_option, suggestion(chosen, full_names(channels)),
         list_of(full_names(channels)), names.channel_option, count);
  std::vector<const NamedChannel*> found;
  for (const auto& name : wanted) {
    found.push_back(find_named(channels, name));
    if (!found.back())
      fail(ErrorKind::input, "{}: no channel {} for {}{}; there is {}", file.path(), name, names.channel_option,
           suggestion(name, full_names(channels)), list_of(full_names(channels)));
  }
  return refs_of(found, file);
}

/// Where the first of the candidates is, in the order of the rules; a name is a layer, or else a channel. Null: none is
/// there.
std::pair<std::vector<ChannelRef>, const AovCandidate*> find_candidate(const ExrFile& file,
                                                                       const std::vector<NamedChannel>& channels,
                                                                       const AovNames& names,
                                                                       const std::vector<AovCandidate>& candidates) {
  for (const auto& candidate : candidates) {
    auto found = find_in_layer(file, channels, names, candidate.name, names.in_layer);
    const std::size_t dot = candidate.name.rfind('.');
    if (found.empty() && names.in_layer.front().size() == 1)
      found = find_in_layer(file, channels, names, dot == std::string::npos ? "" : candidate.name.substr(0, dot),
                            {{dot == std::string::npos ? candidate.name : candidate.name.substr(dot + 1)}});
    if (!found.empty()) return {std::move(found), &candidate};
  }
  return {};
}

/// Files opened once each, and their channels.
class Search {
 public:
  Search(const InputSettings& settings, std::vector<ExrFile>& files) : settings_(settings), files_(files) {}

  /// The file's place in the list, opened now if it is new.
  std::size_t open(const std::string& path, const char* option) {
    if (path.empty()) fail(ErrorKind::usage, "no INPUT and no {} FILE: give one of them", option);
    const auto known = std::ranges::find(files_, path, &ExrFile::path);
    if (known != files_.end()) return std::size_t(known - files_.begin());
    files_.push_back(open_file(path, path == settings_.input ? "INPUT" : option));
    const auto views = views_of(files_.back());
    const auto same = [&](const std::string& view) { return lower_case(view) == lower_case(settings_.view); };
    if (!settings_.view.empty() && !views.empty() && std::ranges::none_of(views, same))
      fail(ErrorKind::input, "{}: there is no view {}{} for --view; there is {}", path, settings_.view,
           suggestion(settings_.view, views), list_of(views));
    channels_.push_back(channels_of(files_.back(), files_.size() - 1, settings_.layer, settings_.view));
    return files_.size() - 1;
  }

  /// The AOV by the names that the user chose, or else its usual ones; empty when there is none. `own_file`: the file
  /// holds nothing else.
  std::vector<ChannelRef> find(std::size_t file, const AovNames& names, const std::string& chosen,
                               bool own_file) const {
    return chosen.empty() ? find_usual(files_[file], channels_[file], names, own_file)
                          : find_chosen(files_[file], channels_[file], names, chosen);
  }

  /// As the rules name it; empty when the user chose, or none is there.
  std::pair<std::vector<ChannelRef>, const AovCandidate*> find_by_rules(
      std::size_t file, const AovNames& names, const std::string& chosen,
      const std::vector<AovCandidate>& candidates) const {
    return chosen.empty() ? find_candidate(files_[file], channels_[file], names, candidates)
                          : std::pair<std::vector<ChannelRef>, const AovCandidate*>{};
  }

  /// As find(), but not to find anything is an error. `hint` is the name that near misses are measured by.
  std::vector<ChannelRef> require(std::size_t file, const AovNames& names, const std::string& chosen, bool own_file,
                                  const char* hint) const {
    auto found = find(file, names, chosen, own_file);
    if (!found.empty()) return found;
    if (channels_[file].empty() && !settings_.layer.empty()) {
      const auto layers = layers_of(files_[file]);
      fail(ErrorKind::input, "{}: there is no layer {}{} for --layer; there is {}", files_[file].path(),
           settings_.layer, suggestion(settings_.layer, layers), list_of(layers));
    }
    const auto all = full_names(channels_[file]);
    const std::string within = settings_.layer.empty() ? "" : fmt::format(" in layer {}", settings_.layer);
    fail(ErrorKind::input, "{}: no {} channel found{}{}; there is {}; name it with {}", files_[file].path(), names.what,
         within, suggestion(hint, all), list_of(all), names.channel_option);
  }

  /// A channel beside the r, g, b of a beauty, under the same layer.
  std::vector<ChannelRef> with_alpha(std::vector<ChannelRef> beauty) const {
    if (beauty.size() != 3) return beauty;
    const std::string& red = beauty[0].channel;
    const std::size_t dot = red.rfind('.');
    const std::string prefix = dot == red.npos ? "" : red.substr(0, dot + 1);
    for (const auto& channel : channels_[beauty[0].file]) {
      if (channel.ref.part != beauty[0].part || channel.subsampled) continue;
      const std::string& name = channel.ref.channel;
      if (lower_case(name) == lower_case(prefix + "a") || lower_case(name) == lower_case(prefix + "alpha")) {
        beauty.push_back(channel.ref);
        break;
      }
    }
    return beauty;
  }

 private:
  const InputSettings& settings_;
  std::vector<ExrFile>& files_;
  std::vector<std::vector<NamedChannel>> channels_;
};

const ExrPart& part_of(const FrameSource& source, const ChannelRef& ref) {
  return source.files[ref.file].parts()[std::size_t(ref.part)];
}

bool has_half_channel(const FrameSource& source, const ChannelRef& ref) {
  const auto& channels = part_of(source, ref).channels;
  const auto channel = std::ranges::find(channels, ref.channel, &ExrChannel::name);
  return channel != channels.end() && channel->type == SampleType::half_float;
}

/// All planes of a frame lie over the same pixels.
void require_same_window(const FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                         const char* option) {
  for (const auto& channel : channels) {
    const Window& data = part_of(source, channel).data;
    if (data != source.data)
      fail(ErrorKind::input, "{}: the {} channel {} is {}, and the depth is {}: both must cover the same pixels ({})",
           source.files[channel.file].path(), what, channel.channel, to_string(data), to_string(source.data), option);
  }
}

void find_beauty(FrameSource& source, const Search& search, std::size_t file, const InputSettings& settings) {
  source[RawPlane::beauty] = search.with_alpha(
      search.require(file, kBeautyNames, settings.beauty_channels, !settings.beauty.empty(), "Combined.R"));
  source[RawPlane::indirect] = search.find(file, kIndirectNames, "", false);
  source[RawPlane::diffuse_color] = search.find(file, kDiffuseColorNames, "", false);
  // Blender's indirect light (DiffInd, from version 5 on Diffuse Indirect) is without the surface's colour; without the
  // colour pass the part is unknown. Others' includes it.
  const std::string indirect =
      source[RawPlane::indirect].empty() ? "" : lower_case(source[RawPlane::indirect][0].channel);
  const bool is_blender =
      indirect.find("diffind") != indirect.npos || indirect.find("diffuse indirect") != indirect.npos;
  if (is_blender && source[RawPlane::diffuse_color].empty()) source[RawPlane::indirect].clear();
  if (!is_blender) source[RawPlane::diffuse_color].clear();
  for (const auto* aov : {&source[RawPlane::beauty], &source[RawPlane::indirect], &source[RawPlane::diffuse_color]})
    require_same_window(source, *aov, "beauty", "--beauty");
}

/// What is multiplied in, where the settings name a file or a channel of it.
void find_material(FrameSource& source, Search& search, const InputSettings& settings) {
  if (settings.material_ao.empty() && settings.material_ao_channel.empty()) return;
  const std::size_t file =
      search.open(settings.material_ao.empty() ? settings.input : settings.material_ao, "--material-ao");
  source[RawPlane::material_ao] =
      search.require(file, kMaterialNames, settings.material_ao_channel, !settings.material_ao.empty(), "AO");
  require_same_window(source, source[RawPlane::material_ao], "material AO", "--material-ao");
}

/// The colour that light takes at the surfaces.
void find_albedo(FrameSource& source, Search& search, const std::string& beauty_path, const InputSettings& settings) {
  const std::size_t file = search.open(settings.albedo.empty() ? beauty_path : settings.albedo, "--albedo");
  source[RawPlane::albedo] = search.find(file, kAlbedoNames, settings.albedo_channels, !settings.albedo.empty());
  if (source[RawPlane::albedo].empty())
    fail(ErrorKind::input,
         "{}: no diffuse colour found for --multi-bounce: name its channels with --albedo-channels, or give --albedo a "
         "file or a number",
         source.files[file].path());
  require_same_window(source, source[RawPlane::albedo], "diffuse colour", "--albedo");
}

/// The rules that the settings name, or those of the file.
void find_rules(FrameSource& source, std::size_t file, const InputSettings& settings) {
  const bool detects = settings.source.empty() || settings.source == "auto";
  const DetectedRules found =
      detects ? detect_rules(source.files[file]) : DetectedRules{&input_rules(settings.source), "--source"};
  source.rules = found.rules, source.rules_by = found.by, source.rules_said = !detects;
}

/// The depth channel; the position's where the settings say so, or where there is no depth.
std::vector<ChannelRef> find_depth(FrameSource& source, const Search& search, std::size_t file,
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
  return search.require(file, kDepthNames, settings.depth_channel, !settings.depth.empty(), "Depth.Z");
}

/// The normals, none where there are none; and what the rules say of their space.
std::vector<ChannelRef> find_normal(FrameSource& source, const Search& search, std::size_t file,
                                    const InputSettings& settings) {
  if (source.rules->normal_space != NormalSpace::automatic) source.usual_normal_space = source.rules->normal_space;
  if (auto [found, candidate] =
          search.find_by_rules(file, kNormalNames, settings.normal_channels, source.rules->normal);
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

bool names_a_camera(const InputSettings& settings) {
  return !settings.camera.empty() || settings.fov || settings.focal || settings.ortho_width;
}

/// The settings' camera, or else the header's.
void find_camera(FrameSource& source, const InputSettings& settings, const ChannelRef& depth, int frame) {
  const ExrFile& file = source.files[depth.file];
  const auto attributes = file.attribute_texts(depth.part);
  require_no_panorama(attributes, file.path());
  if (!names_a_camera(settings))
    if (auto found = header_camera(attributes, source.display, source.file_data, source.pixel_aspect)) {
      source.camera = found->camera;
      source.camera_from = found->from;
      return;
    }
  source.camera = camera_for(settings, source.display, source.pixel_aspect, frame);
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

/// Reads whole rows, since that is how files are stored, and keeps what lies in source.data.
void read_part(FrameSource& source, const std::vector<PlaneRead>& reads) {
  const Window part = source.data, rows{source.file_data.x, part.y, source.file_data.width, part.height};
  source.data = rows;
  std::vector<std::vector<float>> whole;
  std::vector<PlaneRead> whole_reads;
  for (const auto& read : reads) {
    whole.emplace_back(read.channels->size() * rows.pixels());
    whole_reads.push_back({read.channels, whole.back().data()});
  }
  read_planes(source, whole_reads);
  for (std::size_t i = 0; i < reads.size(); i++) std::ranges::copy(cropped(whole[i], rows, part), reads[i].to);
  source.data = part;
}

}  // namespace

FrameSource find_frame(const InputSettings& settings, bool with_beauty, int frame, bool with_albedo) {
  FrameSource source;
  Search search(settings, source.files);
  const std::string& depth_path = !settings.depth.empty()  ? settings.depth
                                  : settings.input.empty() ? settings.position
                                                           : settings.input;
  const std::string& normal_path = !settings.normal.empty() ? settings.normal
                                   : settings.input.empty() ? depth_path
                                                            : settings.input;
  const std::string& beauty_path = !settings.beauty.empty() ? settings.beauty
                                   : settings.input.empty() ? depth_path
                                                            : settings.input;

  const bool wants_position = !settings.position.empty() || !settings.position_channels.empty();
  const bool by_position = wants_position || settings.depth_kind == DepthKind::position;
  const std::size_t depth_file = by_position && !settings.position.empty()
                                     ? search.open(settings.position, "--position")
                                     : search.open(depth_path, "--depth");
  find_rules(source, depth_file, settings);
  source[RawPlane::depth] = find_depth(source, search, depth_file, settings, by_position);
  source.data = source.file_data = part_of(source, source[RawPlane::depth][0]).data;
  source.display = source.files[depth_file].display();
  source.pixel_aspect = source.files[depth_file].pixel_aspect();
  source.depth_is_half = has_half_channel(source, source[RawPlane::depth][0]);
  source.depth_scale = settings.depth_scale;
  source.sky = settings.sky;

  const std::size_t normal_file = search.open(normal_path, "--normal");
  source[RawPlane::normal] = find_normal(source, search, normal_file, settings);
  require_same_window(source, source[RawPlane::normal], "normal", "--normal");
  if (with_beauty) find_beauty(source, search, search.open(beauty_path, "--beauty"), settings);
  if (with_albedo) find_albedo(source, search, beauty_path, settings);
  find_material(source, search, settings);

  const auto views = views_of(source.files[depth_file]);
  if (settings.view.empty() && views.size() > 1)
    source.notes.push_back(fmt::format("of the views {} this is {} (--view)", list_of(views), views.front()));
  find_camera(source, settings, source[RawPlane::depth][0], frame);
  find_meaning(source, settings);
  if (!source[RawPlane::normal].empty() && source.normal_space == NormalSpace::world && !source.normal_space_open &&
      !source.camera.view_from_world)
    fail(ErrorKind::input,
         "{}: its normals are in world space, and the camera has no world_to_camera: give a --camera file with it, or "
         "--normal-space view",
         source.files[source[RawPlane::normal][0].file].path());
  return source;
}

ExrFile open_file(const std::string& path, const char* option) {
  if (is_dds(path)) return {path, option, read_dds(path, option)};
  const std::string ending = lower_case(path.substr(std::min(path.rfind('.'), path.size())));
  for (const char* other : {".png", ".tif", ".tiff", ".tga", ".bmp", ".hdr"})
    if (ending == other) return {path, option, open_picture(path, option)};
  return ExrFile(path, option);
}

bool header_has_camera(const InputSettings& settings) {
  const ExrFile file = open_file(!settings.depth.empty()  ? settings.depth
                                 : settings.input.empty() ? settings.position
                                                          : settings.input,
                                 "INPUT");
  for (std::size_t part = 0; part < file.parts().size(); part++)
    if (header_camera(file.attribute_texts(int(part)), file.display(), file.parts()[part].data, file.pixel_aspect()))
      return true;
  return false;
}

void read_planes(FrameSource& source, const std::vector<PlaneRead>& reads) {
  if (source.data.width != source.file_data.width) return read_part(source, reads);
  std::vector<std::vector<ExrRead>> by_file(source.files.size());
  // a channel that serves two purposes is decoded to the first place, and copied from there
  std::map<ChannelRef, float*> first;
  std::vector<std::pair<float*, float*>> copies;
  for (const auto& read : reads)
    for (std::size_t i = 0; i < read.channels->size(); i++) {
      const auto& channel = (*read.channels)[i];
      float* to = read.to + i * source.data.pixels();
      if (const auto [known, is_new] = first.try_emplace(channel, to); is_new)
        by_file[channel.file].push_back({channel.part, channel.channel, to});
      else
        copies.emplace_back(known->second, to);
    }
  for (std::size_t file = 0; file < by_file.size(); file++)
    source.files[file].read(by_file[file], source.data.y - source.file_data.y, source.data.height);
  for (const auto& [from, to] : copies) std::copy_n(from, source.data.pixels(), to);
}

}  // namespace alcove
