// Channels by name, in one file and in two.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/picture.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {
namespace {

std::vector<PictureChannel> channels_of(const ExrFile& file) {
  std::vector<PictureChannel> channels;
  const auto& parts = file.parts();
  for (std::size_t part = 0; part < parts.size(); part++)
    for (const auto& channel : parts[part].channels) {
      const bool repeats =
          parts[part].name.empty() || parts.size() == 1 || channel.name.starts_with(parts[part].name + ".");
      const std::string full = repeats ? channel.name : parts[part].name + "." + channel.name;
      if (!channel.subsampled && !parts[part].deep)
        channels.push_back({full, parts[part].data, int(part), channel.name});
    }
  return channels;
}

std::string last_part(const std::string& name) { return lower_case(name.substr(name.rfind('.') + 1)); }

/// All before the last part; "" where there is no more.
std::string layer_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == name.npos ? "" : name.substr(0, dot);
}

/// Whether `name` is all of `full`, or the end of it after a dot. Both are in lower case.
bool is_end_of(const std::string& name, const std::string& full) { return full == name || full.ends_with("." + name); }

std::string both_lists(const Picture& result, const Picture& reference) {
  return fmt::format("{} has {}; {} has {}", result.path(), list_of(result.layers()), reference.path(),
                     list_of(reference.layers()));
}

std::vector<ChannelPair> chosen_pairs(const Picture& result, const Picture& reference, const std::string& chosen) {
  std::vector<ChannelPair> pairs;
  std::istringstream list(chosen);
  for (std::string name; std::getline(list, name, ',');) {
    const std::size_t equals = name.find('=');
    const std::string in_reference = equals == name.npos ? name : name.substr(equals + 1);
    pairs.push_back({result.find(name.substr(0, equals), "--channel"), reference.find(in_reference, "--channel")});
  }
  return pairs;
}

/// Whether a layer bears the name of an AO pass: AO, Ambient Occlusion, ViewLayer.AmbientOcclusion.
bool is_of_ao(const std::string& layer) {
  std::string name = last_part(layer);
  std::erase_if(name, [](char c) { return c == ' ' || c == '_' || c == '-'; });
  return name == "ao" || name == "ambientocclusion";
}

/// A picture's AO.
struct AoChannels {
  std::vector<std::size_t> channels;  // empty: none that is certain
  bool by_layer = false;
};

/// The channels of the only AO layer, without its alpha; else the channel Y.
AoChannels ao_of(const Picture& picture) {
  AoChannels ao, plain;
  std::string only;
  for (std::size_t i = 0; i < picture.channels().size(); i++) {
    const std::string name = lower_case(picture.channels()[i].name), layer = is_of_ao(name) ? name : layer_of(name);
    if (name == "y") plain.channels.push_back(i);
    if (!is_of_ao(layer) || last_part(name) == "a") continue;
    if (!ao.channels.empty() && layer != only) return {};
    only = layer;
    ao.by_layer = true;
    ao.channels.push_back(i);
  }
  return ao.by_layer ? ao : plain;
}

/// Pairs the AO of both. Of a layer in colours only red counts where the other picture has one channel.
ChannelMatch ao_pairs(const Picture& result, const Picture& reference) {
  const AoChannels a = ao_of(result), b = ao_of(reference);
  if (a.channels.empty() || b.channels.empty() || !(a.by_layer || b.by_layer)) return {};
  const auto last_of = [](const Picture& picture, std::size_t i) { return last_part(picture.channels()[i].name); };
  const auto one_of = [&](const Picture& picture, const AoChannels& ao) {
    const auto red = std::ranges::find_if(ao.channels, [&](std::size_t i) { return last_of(picture, i) == "r"; });
    return red == ao.channels.end() ? ao.channels.front() : *red;
  };
  if (a.channels.size() == 1 || b.channels.size() == 1) return {{{one_of(result, a), one_of(reference, b)}}, true};
  ChannelMatch match{{}, true};
  for (const std::size_t r : a.channels)
    for (const std::size_t f : b.channels)
      if (last_of(result, r) == last_of(reference, f)) match.pairs.push_back({r, f});
  return match;
}

/// Pairs the channels whose names are the same once `key` has been applied to them.
template <class Key>
std::vector<ChannelPair> same_names(const Picture& result, const Picture& reference, const Key& key) {
  std::vector<ChannelPair> pairs;
  for (std::size_t r = 0; r < result.channels().size(); r++)
    for (std::size_t f = 0; f < reference.channels().size(); f++)
      if (key(result.channels()[r].name) == key(reference.channels()[f].name)) pairs.push_back({r, f});
  return pairs;
}

/// Whether a channel is x, y or z of a layer that has all three.
bool is_of_vector(const Picture& picture, std::size_t index) {
  const std::string name = lower_case(picture.channels()[index].name);
  const std::string layer = name.substr(0, name.size() - last_part(name).size());
  const auto has = [&](const char* component) {
    return std::ranges::any_of(picture.channels(),
                               [&](const auto& channel) { return lower_case(channel.name) == layer + component; });
  };
  const std::string last = last_part(name);
  return (last == "x" || last == "y" || last == "z") && has("x") && has("y") && has("z");
}

}  // namespace

Picture::Picture(const std::string& path, const char* option)
    : path_(path), file_(open_image(path, option, Formats::all)), channels_(channels_of(file_)) {
  if (std::ranges::any_of(file_.parts(), [](const ExrPart& part) { return part.deep.has_value(); }) &&
      channels_.empty())
    fail(ErrorKind::input, "{}: it holds deep data only, which has no single value per pixel: flatten it first ({})",
         path_, option);
  if (channels_.empty())
    fail(ErrorKind::input, "{}: it has no channel with a sample for every pixel ({})", path, option);
}

std::vector<std::string> Picture::names() const {
  std::vector<std::string> names;
  std::ranges::transform(channels_, std::back_inserter(names), &PictureChannel::name);
  return names;
}

std::size_t Picture::find(const std::string& name, const char* option) const {
  const std::string wanted = lower_case(name);
  std::vector<std::string> found;
  std::size_t index = 0;
  for (std::size_t i = 0; i < channels_.size(); i++) {
    const std::string full = lower_case(channels_[i].name);
    if (full == wanted) return i;
    if (!is_end_of(wanted, full)) continue;
    found.push_back(channels_[i].name);
    index = i;
  }
  if (found.size() > 1)
    fail(ErrorKind::input, "{}: {} may be {}; give {} a longer name", path_, name, list_of(found), option);
  if (found.empty())
    fail(ErrorKind::input, "{}: no channel {} for {}{}; there is {}", path_, name, option, suggestion(name, names()),
         list_of(names()));
  return index;
}

std::vector<std::string> Picture::layers() const {
  std::vector<std::pair<std::string, std::vector<std::string>>> grouped;
  for (const auto& channel : channels_) {
    const std::string layer = layer_of(channel.name);
    const auto known = std::ranges::find(grouped, layer, &std::pair<std::string, std::vector<std::string>>::first);
    if (known != grouped.end() && !layer.empty())
      known->second.push_back(channel.name.substr(layer.size() + 1));
    else
      grouped.push_back({layer, {layer.empty() ? channel.name : channel.name.substr(layer.size() + 1)}});
  }
  std::vector<std::string> layers;
  for (const auto& [layer, names] : grouped) {
    const std::string shown = names.size() > 1 ? fmt::format("{} ({})", layer, fmt::join(names, ", "))
                              : layer.empty()  ? names.front()
                                               : layer + "." + names.front();
    layers.push_back(shown);
  }
  return layers;
}

std::vector<float> Picture::read(std::span<const std::size_t> channels) {
  const Window& data = channels_[channels[0]].data;
  require_host_room(path_, data);
  std::vector<float> planes(channels.size() * data.pixels());
  std::vector<ExrRead> reads;
  for (std::size_t i = 0; i < channels.size(); i++) {
    const auto& channel = channels_[channels[i]];
    if (channel.data != data)
      fail(ErrorKind::input,
           "{}: channel {} is {}, and channel {} is {}: they do not cover the same pixels; choose with --channel",
           path_, channels_[channels[0]].name, to_string(data), channel.name, to_string(channel.data));
    reads.push_back({channel.part, channel.name_in_part, planes.data() + i * data.pixels()});
  }
  file_.read(reads);
  return planes;
}

ChannelMatch match_channels(const Picture& result, const Picture& reference, const std::string& chosen) {
  if (!chosen.empty()) return {chosen_pairs(result, reference, chosen)};
  if (result.channels().size() == 1 && reference.channels().size() == 1) return {{{0, 0}}};
  auto pairs = same_names(result, reference, lower_case);
  if (pairs.empty()) {
    if (ChannelMatch ao = ao_pairs(result, reference); !ao.pairs.empty()) return ao;
    pairs = same_names(result, reference, last_part);
    // The Y of an AO file is no component of a normal.
    std::erase_if(pairs, [&](const ChannelPair& pair) {
      return is_of_vector(result, pair.result) != is_of_vector(reference, pair.reference);
    });
  }
  if (pairs.empty())
    fail(ErrorKind::input,
         "the pictures share no channel: {}; say what to compare with --channel RESULT=REFERENCE, such as Y=AO.R",
         both_lists(result, reference));
  std::vector<std::size_t> seen_result, seen_reference;
  for (const auto& pair : pairs) {
    if (std::ranges::count(seen_result, pair.result) || std::ranges::count(seen_reference, pair.reference))
      fail(ErrorKind::input, "channel {} could be compared with several: {}; say which with --channel RESULT=REFERENCE",
           result.channels()[pair.result].name, both_lists(result, reference));
    seen_result.push_back(pair.result);
    seen_reference.push_back(pair.reference);
  }
  return {std::move(pairs)};
}

}  // namespace alcove
