// The search for channels: patterns, views, tables of usual names, and the places that spell an AOV.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/channels.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr.h"

namespace alcove {

// Patterns: after the last star, a name is tried from each place on.

bool is_escape(std::string_view text, std::size_t at) {
  return text[at] == '\\' && at + 1 < text.size() && std::string_view("*?, \\").find(text[at + 1]) != text.npos;
}

bool is_pattern(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); i++) {
    if (is_escape(text, i))
      i++;
    else if (text[i] == '*' || text[i] == '?')
      return true;
  }
  return false;
}

std::string unescaped(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); i++) name += is_escape(text, i) ? text[++i] : text[i];
  return name;
}

bool fits_pattern(std::string_view name, std::string_view pattern) {
  std::size_t at = 0, star = pattern.npos, retry = 0, p = 0;
  while (at < name.size()) {
    const bool escapes = p < pattern.size() && is_escape(pattern, p);
    const char wanted = p < pattern.size() ? pattern[p + std::size_t(escapes)] : 0;
    if (p < pattern.size() && ((!escapes && wanted == '?') || (wanted == name[at] && (escapes || wanted != '*')))) {
      p += 1 + std::size_t(escapes);
      at++;
    } else if (p < pattern.size() && !escapes && wanted == '*') {
      star = p++;
      retry = at;
    } else if (star != pattern.npos) {
      p = star + 1;
      at = ++retry;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == pattern.npos;
}

std::optional<float> number_in(const std::string& text) {
  float number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

// Views.

namespace {

/// A view's name among the words of a channel's name.
struct ViewWord {
  std::size_t begin, end;  // the dot behind it is at the end
};

/// Finds the view that a name holds: before the last word, by the convention of OpenEXR ("depth.right.Z"), or as the
/// first word, as Nuke has it ("right.depth.Z"). Gives nothing where neither is one of the views.
std::optional<ViewWord> view_word(const std::string& name, const std::vector<std::string>& views) {
  const std::size_t last = name.rfind('.');
  if (last == name.npos) return std::nullopt;
  const std::size_t before = last == 0 ? name.npos : name.rfind('.', last - 1);
  const ViewWord second_last{before == name.npos ? 0 : before + 1, last}, first{0, name.find('.')};
  for (const ViewWord& word : {second_last, first}) {
    const std::string text = name.substr(word.begin, word.end - word.begin);
    if (!text.empty() && std::ranges::any_of(views, [&](const auto& view) { return same_name(view, text); }))
      return word;
  }
  return std::nullopt;
}

std::string without(const std::string& name, const ViewWord& word) {
  return name.substr(0, word.begin) + name.substr(word.end + 1);
}

}  // namespace

bool same_name(std::string_view a, std::string_view b) { return lower_case(a) == lower_case(b); }

std::vector<std::string> views_of(const ExrFile& file) {
  std::vector<std::string> views;
  for (const auto& part : file.parts())
    for (const auto& view : part.multi_view.empty() ? std::vector{part.view} : part.multi_view)
      if (!view.empty() && std::ranges::none_of(views, [&](const auto& known) { return same_name(known, view); }))
        views.push_back(view);
  return views;
}

std::string view_in(const ExrFile& file, const std::string& wanted) {
  const auto views = views_of(file);
  const auto found = std::ranges::find_if(views, [&](const auto& view) { return same_name(view, wanted); });
  return found != views.end() ? *found : views.empty() ? "" : views.front();
}

std::string view_of(const ExrPart& part, const std::string& channel) {
  if (part.multi_view.empty()) return part.view;
  const auto word = view_word(channel, part.multi_view);
  return word ? channel.substr(word->begin, word->end - word->begin) : part.multi_view.front();
}

std::optional<std::string> name_in_view(const ExrPart& part, const std::string& channel, const std::string& view) {
  const std::string own = view_of(part, channel);
  const bool is_shared = part.multi_view.empty() && (own.empty() || view.empty());
  if (!is_shared && !same_name(own, view)) return std::nullopt;
  const auto word = view_word(channel, part.multi_view.empty() ? std::vector{part.view} : part.multi_view);
  return word ? without(channel, *word) : channel;
}

std::string layer_of(const ExrPart& part) {
  const auto word = view_word(part.name + ".", {part.view});
  if (!word) return part.name;
  const std::string rest = without(part.name + ".", *word);
  return rest.empty() ? rest : rest.substr(0, rest.size() - 1);
}

// The rules that fit the header of a file.

namespace {

/// Lists what identifies a file, in lower case: attributes as "name" and "name=value", channels as "channel:name". Nuke
/// puts prefixes before others' attributes.
std::vector<std::string> marks_of(const ExrFile& file) {
  constexpr std::size_t kLongest = 200;  // characters of a mark that count
  std::vector<std::string> marks;
  for (std::size_t p = 0; p < file.parts().size(); p++) {
    for (const auto& [name, value] : file.attribute_texts(int(p))) {
      std::string plain = name.substr(0, kLongest);
      if (plain.starts_with("nuke/exr/")) plain.erase(0, 9);
      if (plain.starts_with("exr/")) plain.erase(0, 4);
      marks.push_back(lower_case(plain));
      marks.push_back(lower_case(plain + "=" + value.substr(0, kLongest)));
    }
    for (const auto& channel : file.parts()[p].channels) {
      marks.push_back("channel:" + lower_case(channel.name.substr(0, kLongest)));
      if (!file.parts()[p].name.empty())
        marks.push_back("channel:" + lower_case((file.parts()[p].name + "." + channel.name).substr(0, kLongest)));
    }
  }
  return marks;
}

}  // namespace

DetectedRules detect_rules(const ExrFile& file) {
  const auto marks = marks_of(file);
  for (const bool last : {false, true})
    for (const auto& rules : all_input_rules())
      for (const auto& pattern : last ? rules.detect_last : rules.detect)
        if (const auto mark = std::ranges::find_if(
                marks, [wanted = lower_case(pattern)](const auto& m) { return fits_pattern(m, wanted); });
            mark != marks.end())
          return {&rules, *mark};
  return {&input_rules("generic"), ""};
}

// Usual names.

static const Components kColours{{"r", "g", "b"}, {"red", "green", "blue"}};
static const Components kVectors{{"x", "y", "z"}, {"r", "g", "b"}, {"red", "green", "blue"}};

const AovNames kDepthNames{
    .what = "depth",
    .channel_option = "--depth-channel",
    .file_option = "--depth",
    .layers = {"depth", "z", "zdepth", "vrayzdepth", "z-depth", "__depth", "cgeometry_zdepth",
               "finalimagemovierenderqueue_worlddepth"},
    .in_layer = {{"z"}, {"depth"}, {"r"}, {"red"}, {"y"}, {"v"}},
    .bare = {{"z"}, {"depth"}, {"zdepth"}, {"pz"}},
    .alone = {{"r"}, {"red"}, {"y"}, {"v"}},
};

const AovNames kNormalNames{
    .what = "normal",
    .channel_option = "--normal-channels",
    .file_option = "--normal",
    .layers = {"normal", "n", "nn", "normals", "ns", "__nworld", "cgeometry_normalsshading"},
    .in_layer = kVectors,
    .bare = {{"nx", "ny", "nz"}},
    .alone = {{"x", "y", "z"}, {"r", "g", "b"}, {"red", "green", "blue"}, {"x", "y"}, {"r", "g"}, {"red", "green"}},
    .may_be_two = true,
};

const AovNames kPositionNames{
    .what = "position",
    .channel_option = "--set position-channels",
    .file_option = "--position",
    .layers = {"position", "p", "pworld", "__pworld", "worldposition", "cgeometry_worldposition"},
    .in_layer = kVectors,
    .bare = {{"px", "py", "pz"}},
    .alone = kVectors,
};

const AovNames kBeautyNames{
    .what = "beauty",
    .channel_option = "--set beauty-channels",
    .file_option = "--beauty",
    .layers = {"combined", "rgba", "beauty"},
    .in_layer = kColours,
    .bare = kColours,
    .may_have_alpha = true,
};

const AovNames kIndirectNames{
    .what = "indirect diffuse",
    .channel_option = "--layer",
    .layers = {"diffind", "diffuse indirect", "diffuse_indirect", "indirectdiffuse", "gi"},
    .in_layer = kColours,
};

const AovNames kLightNames{
    .what = "light",
    .channel_option = "--set ambient",
    .in_layer = kColours,
    .is_listed = true,
};

const AovNames kDiffuseColorNames{
    .what = "diffuse colour",
    .channel_option = "--layer",
    .layers = {"diffcol", "diffuse color"},
    .in_layer = kColours,
};

const AovNames kMaterialNames{
    .what = "material AO",
    .channel_option = "--set material-ao-channel",
    .layers = {"ao", "occlusion", "ambient occlusion", "materialao"},
    .in_layer = {{"y"}, {"r"}, {"ao"}, {"v"}},
    .bare = {{"ao"}, {"occlusion"}},
    .alone = {{"y"}, {"r"}, {"v"}},
};

const AovNames kAlbedoNames{
    .what = "diffuse colour",
    .channel_option = "--set albedo-channels",
    .layers = {"diffcol", "diffuse color", "albedo", "diffuse_albedo"},
    .in_layer = kColours,
    .alone = kColours,
};

const AovNames kMatteNames{
    .what = "matte",
    .channel_option = "--set matte-channel",
    .file_option = "--matte",
    .layers = {"matte", "mask"},
    .in_layer = {{"y"}, {"a"}, {"r"}, {"v"}},
    .bare = {{"matte"}, {"mask"}},
    .alone = {{"y"}, {"a"}, {"alpha"}, {"r"}, {"v"}},
};

const AovNames kObjectNames{
    .what = "numbers of objects",
    .channel_option = "--set object-channel",
    .layers = {"indexob", "object index", "objectid", "object_id", "vrayobjectid", "id"},
    .in_layer = {{"x"}, {"y"}, {"r"}, {"v"}},
    .bare = {{"objectid"}, {"object_id"}, {"id"}},
    .alone = {{"y"}, {"x"}, {"r"}, {"v"}},
};

namespace {

/// Gives the name without the layer; nothing if it lies elsewhere. Without a layer it gives the name. A channel of the
/// layer's own name lies in it.
std::optional<std::string> within_layer(const std::string& name, const std::string& layer) {
  if (layer.empty()) return lower_case(name);
  if (same_name(name, layer)) return lower_case(name.substr(name.rfind('.') + 1));
  if (!lower_case(name).starts_with(lower_case(layer) + ".")) return std::nullopt;
  return lower_case(name).substr(layer.size() + 1);
}

/// A name with that of a part before it, where the name does not repeat it.
std::string within_part(const std::string& part, const std::string& name) {
  return part.empty() || name.starts_with(part + ".") ? name : part + "." + name;
}

/// Gives the view of the channels that the settings name, or whose layer they name; the default one where that is among
/// them, and nothing where there are none.
std::string named_view(const ExrFile& file, const InputSettings& settings) {
  std::set<std::string> views;
  for (const std::string& named : {settings.depth_channel, split(settings.position_channels).front(), settings.layer})
    for (const auto& part : file.parts())
      for (const auto& channel : part.channels)
        for (const auto& name : {channel.name, within_part(part.name, channel.name)}) {
          if (named.empty() || !(lower_case(name) + ".").starts_with(lower_case(named) + ".")) continue;
          views.insert(view_of(part, name));
        }
  const std::string first = view_in(file, "");
  const auto is_first = [&](const std::string& view) { return view.empty() || same_name(view, first); };
  return views.empty() || std::ranges::any_of(views, is_first) ? "" : *views.begin();
}

std::vector<std::string> full_names(const std::vector<NamedChannel>& channels) {
  std::vector<std::string> names;
  std::ranges::transform(channels, std::back_inserter(names), &NamedChannel::full);
  return names;
}

/// Lists once each everything that stands before a dot in a full name: "ViewLayer", "ViewLayer.Depth" ...
std::vector<std::string> layers_of(const ExrFile& file, const std::string& view) {
  std::set<std::string> layers;
  for (const auto& channel : channels_in(file, 0, "", view))
    for (std::size_t dot = channel.full.find('.'); dot != channel.full.npos; dot = channel.full.find('.', dot + 1))
      layers.insert(channel.full.substr(0, dot));
  return {layers.begin(), layers.end()};
}

/// Gives the part of a name before `.component`, or "" for the bare component; nothing if the name does not end so.
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

/// Lists the places within parts where `layer` has all of these components: for each place, its channels.
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

/// Finds the AOV at the one place where `layer` holds one of the component sets; gives nothing if there is none. Two
/// places are an error.
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

/// Finds the AOV under its usual names; gives nothing if there is none.
std::vector<ChannelRef> find_usual(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                   const AovNames& names, bool own_file) {
  for (const auto& layer : names.layers)
    if (auto found = find_in_layer(file, channels, names, layer, names.in_layer); !found.empty()) return found;
  auto found = find_in_layer(file, channels, names, "", names.bare);
  if (!found.empty() || !own_file) return found;
  found = find_in_layer(file, channels, names, "", names.alone);
  const bool is_single = names.in_layer.front().size() == 1 && channels.size() == 1;
  return found.empty() && is_single ? refs_of({&channels[0]}, file) : found;
}

/// Finds the channel by its full name, or else as its part or its view has it.
const NamedChannel* find_named(const std::vector<NamedChannel>& channels, const std::string& name) {
  const std::string lower = lower_case(name);
  const auto find = [&](auto&& has_name) {
    const auto found = std::ranges::find_if(channels, has_name);
    return found == channels.end() ? nullptr : &*found;
  };
  const auto* found = find([&](const NamedChannel& channel) { return lower_case(channel.full) == lower; });
  if (!found) found = find([&](const NamedChannel& channel) { return lower_case(channel.ref.channel) == lower; });
  if (!found)
    found = find([&](const NamedChannel& channel) {
      return std::ranges::find(channel.spellings, lower) != channel.spellings.end();
    });
  return found;
}

/// Further components of a layer that the user names: only their order is in question then.
const Components kOtherComponents{{"0", "1", "2"}, {"u", "v", "w"}, {"nx", "ny", "nz"}, {"px", "py", "pz"}};

/// The components that a layer named by the user may hold.
Components sets_of(const AovNames& names) {
  Components sets = names.in_layer;
  sets.insert(sets.end(), kOtherComponents.begin(), kOtherComponents.end());
  if (names.may_be_two) sets.insert(sets.end(), {{"x", "y"}, {"r", "g"}, {"red", "green"}});
  return sets;
}

/// Lists the values that the AOV's option takes, for the proposals of messages: channels, or for several components the
/// layers that hold them.
std::vector<std::string> takes(const std::vector<NamedChannel>& channels, const AovNames& names) {
  std::vector<std::string> taken;
  const auto add = [&](const std::string& name) {
    if (name.find(',') == name.npos && std::ranges::find(taken, name) == taken.end()) taken.push_back(name);
  };
  const bool is_single = names.in_layer.front().size() == 1;
  const Components sets = sets_of(names);
  for (const auto& channel : channels) {
    const std::string layer = channel.full.substr(0, std::min(channel.full.rfind('.'), channel.full.size()));
    const auto holds = [&](const auto& components) {
      return places_of(channels, lower_case(layer), components).size() == 1;
    };
    if (channel.subsampled) continue;
    if (is_single)
      add(channel.full);
    else if (layer != channel.full && std::ranges::any_of(sets, holds))
      add(layer);
  }
  return taken;
}

/// Finds the channels that the user named: each by its full name, or all by their layer.
std::vector<ChannelRef> find_chosen(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                    const AovNames& names, const std::string& chosen, const std::string& within) {
  auto wanted = split(chosen);
  const std::size_t count = names.in_layer.front().size();
  if (count == 1)
    if (const auto* whole = find_named(channels, chosen)) return refs_of({whole}, file);
  if (wanted.size() == 1 && count > 1)
    if (auto found = find_in_layer(file, channels, names, lower_case(chosen), sets_of(names)); !found.empty())
      return found;
  if (wanted.size() != count && !(names.may_have_alpha && wanted.size() == count + 1) &&
      !(names.may_be_two && wanted.size() == 2)) {
    const auto layers = takes(channels, names);
    fail(ErrorKind::input, "{}: no layer {}{} for {}{}; there is {}; {} takes a layer{}", file.path(), chosen, within,
         names.channel_option, suggestion(chosen, layers), list_of(names.is_listed ? layers : full_names(channels)),
         names.channel_option, names.is_listed ? "" : fmt::format(" or {} channel names with commas", count));
  }
  std::vector<const NamedChannel*> found;
  for (const auto& name : wanted) {
    found.push_back(find_named(channels, name));
    if (!found.back())
      fail(ErrorKind::input, "{}: no channel {}{} for {}{}; there is {}", file.path(), name, within,
           names.channel_option, suggestion(name, full_names(channels)), list_of(full_names(channels)));
  }
  return refs_of(found, file);
}

/// The layers that fit a pattern and hold the AOV, in lower case.
std::vector<std::string> fitting_layers(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                        const AovNames& names, const std::string& pattern) {
  std::set<std::string> layers;
  for (const auto& channel : channels)
    for (const auto& spelling : channel.spellings) {
      const std::string layer = spelling.substr(0, std::min(spelling.rfind('.'), spelling.size()));
      if (fits_pattern(layer, pattern)) layers.insert(layer);
    }
  std::erase_if(layers,
                [&](const auto& layer) { return find_in_layer(file, channels, names, layer, names.in_layer).empty(); });
  return {layers.begin(), layers.end()};
}

/// Keeps the layer whose end, for which the last * of the pattern stands, another layer ends in too. The longest end
/// counts.
void keep_beside(std::vector<std::string>& layers, const std::string& pattern, const std::string& beside) {
  const std::size_t star = pattern.rfind('*');
  const std::string stem = pattern.substr(pattern.rfind('*', star - 1) + 1, star - 1 - pattern.rfind('*', star - 1));
  const auto end_of = [&](const std::string& layer) { return layer.substr(layer.rfind(stem) + stem.size()); };
  std::erase_if(layers, [&](const auto& layer) { return !lower_case(beside).ends_with(end_of(layer)); });
  if (layers.size() > 1)
    layers = {*std::ranges::max_element(layers, {}, [&](const auto& l) { return end_of(l).size(); })};
}

/// Finds the AOV in the layer that fits a pattern.
std::vector<ChannelRef> find_fitting(const ExrFile& file, const std::vector<NamedChannel>& channels,
                                     const AovNames& names, const std::string& pattern, const std::string& beside) {
  auto layers = fitting_layers(file, channels, names, pattern);
  if (layers.size() > 1 && !beside.empty()) keep_beside(layers, pattern, beside);
  if (layers.empty()) return {};
  if (layers.size() == 1) return find_in_layer(file, channels, names, layers.front(), names.in_layer);
  std::vector<std::string> found;
  for (const auto& layer : layers)
    found.push_back(find_in_layer(file, channels, names, layer, names.in_layer).front().channel);
  fail(ErrorKind::input, "{}: several cameras or passes hold a {}: {}; say which with {}", file.path(), names.what,
       list_of(found), names.channel_option);
}

/// Finds the first of the candidates that is there, in the order of the rules. Its name is a layer, a pattern of
/// layers, or else a channel.
FoundByRules find_candidate(const ExrFile& file, const std::vector<NamedChannel>& channels, const AovNames& names,
                            const std::vector<AovCandidate>& candidates, const std::string& beside) {
  for (const auto& candidate : candidates) {
    if (candidate.name.find('*') != std::string::npos) {
      if (auto found = find_fitting(file, channels, names, candidate.name, beside); !found.empty())
        return {std::move(found), &candidate};
      continue;
    }
    auto found = find_in_layer(file, channels, names, candidate.name, names.in_layer);
    const std::size_t dot = candidate.name.rfind('.');
    if (found.empty() && names.in_layer.front().size() == 1)
      found = find_in_layer(file, channels, names, dot == std::string::npos ? "" : candidate.name.substr(0, dot),
                            {{dot == std::string::npos ? candidate.name : candidate.name.substr(dot + 1)}});
    if (!found.empty()) return {std::move(found), &candidate};
  }
  return {};
}

}  // namespace

std::vector<NamedChannel> channels_in(const ExrFile& file, std::size_t index, const std::string& layer,
                                      const std::string& view) {
  std::vector<NamedChannel> channels;
  for (std::size_t i = 0; i < file.parts().size(); i++) {
    const ExrPart& part = file.parts()[i];
    if (part.deep) continue;  // its channels are no planes
    for (const auto& channel : part.channels) {
      const auto plain = name_in_view(part, channel.name, view);
      if (!plain) continue;
      const bool is_alone = file.parts().size() == 1;
      NamedChannel named{{index, int(i), channel.name},
                         is_alone ? channel.name : within_part(layer_of(part), channel.name),
                         {},
                         channel.subsampled};
      // The user may write the view too, as the file does.
      for (const auto& name : {is_alone ? *plain : within_part(layer_of(part), *plain), *plain,
                               is_alone ? channel.name : within_part(part.name, *plain), channel.name})
        if (const auto spelling = within_layer(name, layer);
            spelling && std::ranges::find(named.spellings, *spelling) == named.spellings.end())
          named.spellings.push_back(*spelling);
      if (!named.spellings.empty()) channels.push_back(std::move(named));
    }
  }
  return channels;
}

std::size_t ChannelSearch::open(const std::string& path, const char* option) {
  if (path.empty()) fail(ErrorKind::usage, "no INPUT and no {} FILE: give one of them", option);
  const auto known = std::ranges::find(files_, path, &ExrFile::path);
  if (known != files_.end()) return std::size_t(known - files_.begin());
  files_.push_back(open_image(path, path == settings_.input ? "INPUT" : option, Formats::of_frames));
  const auto views = views_of(files_.back());
  const auto same = [&](const std::string& view) { return same_name(view, settings_.view); };
  if (!settings_.view.empty() && !views.empty() && std::ranges::none_of(views, same))
    fail(ErrorKind::input, "{}: there is no view {}{} for --view; there is {}", path, settings_.view,
         suggestion(settings_.view, views), list_of(views));
  // The first file with views says which one the frame is of where no option does.
  if (view_.empty()) view_ = view_in(files_.back(), named_view(files_.back(), settings_));
  channels_.push_back(channels_in(files_.back(), files_.size() - 1, settings_.layer, view_in(files_.back(), view_)));
  return files_.size() - 1;
}

/// The frame that a result of Alcove was computed from; empty: the file is none.
static std::string input_of_result(const ExrFile& file) {
  for (std::size_t part = 0; part < file.parts().size(); part++) {
    const auto attributes = file.attribute_texts(int(part));
    if (const auto input = attributes.find("alcove/input"); input != attributes.end()) return input->second;
  }
  return "";
}

std::vector<ChannelRef> ChannelSearch::find(std::size_t file, const AovNames& names, const std::string& chosen,
                                            bool own_file) const {
  // Its Y is AO.
  if (own_file && names.channel_option == std::string_view(kDepthNames.channel_option) &&
      !input_of_result(files_[file]).empty())
    own_file = false;
  const bool is_all_of_layer = !settings_.layer.empty() && channels_[file].size() == 1;
  return chosen.empty() ? find_usual(files_[file], channels_[file], names, own_file || is_all_of_layer)
                        : find_chosen(files_[file], channels_[file], names, chosen, where(file));
}

FoundByRules ChannelSearch::find_by_rules(std::size_t file, const AovNames& names, const std::string& chosen,
                                          const std::vector<AovCandidate>& candidates,
                                          const std::string& beside) const {
  return chosen.empty() ? find_candidate(files_[file], channels_[file], names, candidates, beside) : FoundByRules{};
}

std::vector<ChannelRef> ChannelSearch::require(std::size_t file, const AovNames& names, const std::string& chosen,
                                               bool own_file, const char* hint) const {
  auto found = find(file, names, chosen, own_file);
  if (!found.empty()) return found;
  if (channels_[file].empty() && !settings_.layer.empty()) {
    const std::string view = view_in(files_[file], view_);
    const auto layers = layers_of(files_[file], view);
    fail(ErrorKind::input, "{}: there is no layer {}{} for --layer{}; there is {}", files_[file].path(),
         settings_.layer, view.empty() ? "" : " of the view " + view, suggestion(settings_.layer, layers),
         list_of(layers));
  }
  const bool is_deep =
      std::ranges::any_of(files_[file].parts(), [](const ExrPart& part) { return part.deep.has_value(); });
  if (is_deep && channels_[file].empty())
    fail(ErrorKind::input,
         "{}: it holds deep data only, which has no single value per pixel: no {} ({}); --deep takes it",
         files_[file].path(), names.what, names.channel_option);
  if (const std::string input = input_of_result(files_[file]); !input.empty())
    fail(ErrorKind::input, "{}: no {} channel found: this is a result of Alcove, which was computed from {}",
         files_[file].path(), names.what, input);
  const bool may_have_file = !own_file && *names.file_option;
  fail(ErrorKind::input, "{}: no {} channel found{}{}; there is {}; name it with {}{}", files_[file].path(), names.what,
       where(file), suggestion(hint, takes(channels_[file], names)), list_of(full_names(channels_[file])),
       names.channel_option, may_have_file ? fmt::format(", or give its own file with {}", names.file_option) : "");
}

std::string ChannelSearch::where(std::size_t file) const {
  const std::string view = view_in(files_[file], view_);
  return (settings_.layer.empty() ? "" : " in layer " + settings_.layer) + (view.empty() ? "" : " of the view " + view);
}

const NamedChannel* ChannelSearch::find_beside(const ChannelRef& ref, const std::string& component) const {
  const std::size_t dot = ref.channel.rfind('.');
  const std::string wanted = lower_case(dot == std::string::npos ? "" : ref.channel.substr(0, dot + 1)) + component;
  for (const auto& channel : channels_[ref.file])
    if (channel.ref.part == ref.part && lower_case(channel.ref.channel) == wanted) return &channel;
  return nullptr;
}

std::optional<ChannelRef> ChannelSearch::beside(const ChannelRef& ref, const std::string& component) const {
  const NamedChannel* found = find_beside(ref, component);
  return found && !found->subsampled ? std::optional(found->ref) : std::nullopt;
}

std::vector<ChannelRef> ChannelSearch::with_alpha(std::vector<ChannelRef> beauty) const {
  if (beauty.size() != 3) return beauty;
  auto alpha = beside(beauty[0], "a");
  if (!alpha) alpha = beside(beauty[0], "alpha");
  if (alpha) beauty.push_back(*alpha);
  return beauty;
}

}  // namespace alcove
