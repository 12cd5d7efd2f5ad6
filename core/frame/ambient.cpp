// A list of layers, colours and weights.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/ambient.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/frame/typed_number.h"

namespace alcove {
namespace {

/// One of the lights, as it was typed.
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

void append(std::vector<ChannelRef>& planes, const std::vector<ChannelRef>& more) {
  planes.insert(planes.end(), more.begin(), more.end());
}

void add_typed(FrameSource& source, const ChannelSearch& search, std::size_t file, const std::string& text) {
  const TypedLight typed = typed_light(text);
  const auto light = search.find(file, kLightNames, typed.light, false);
  const std::string color = typed.color.empty() ? color_of(light.front()) : typed.color;
  auto& colors = source[RawPlane::diffuse_color];
  source.ambient.push_back({typed.weight, color.empty() ? -1 : int(colors.size() / 3)});
  append(source[RawPlane::indirect], light);
  if (!color.empty()) append(colors, search.find(file, kLightNames, color, false));
}

/// The indirect diffuse light; Blender's only with its colour, without which the part of the beauty is unknown.
void find_usual(FrameSource& source, const ChannelSearch& search, std::size_t file) {
  const auto light = search.find(file, kIndirectNames, "", false);
  if (light.empty()) return;
  const bool lacks_color = !color_of(light.front()).empty();
  const auto color = lacks_color ? search.find(file, kDiffuseColorNames, "", false) : std::vector<ChannelRef>();
  if (lacks_color && color.empty()) return;
  source[RawPlane::indirect] = light;
  source[RawPlane::diffuse_color] = color;
  source.ambient = {{1, lacks_color ? 0 : -1}};
}

}  // namespace

void find_ambient(FrameSource& source, const ChannelSearch& search, std::size_t file, const InputSettings& settings) {
  const auto lights = settings.ambient.empty() ? std::vector<std::string>() : split(settings.ambient);
  if (lights.size() > kMostAmbientLights)
    fail(ErrorKind::usage, "--set ambient: it takes at most {} lights, and there are {}", kMostAmbientLights,
         lights.size());
  for (const auto& light : lights) add_typed(source, search, file, light);
  if (lights.empty()) find_usual(source, search, file);
}

}  // namespace alcove
