// The light passes of renderers by name, and their sums over blocks of pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/inspect.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"

namespace alcove {
namespace {

/// A part of the light: one pass, or two that are its direct and its indirect light, times a colour. "": there is none.
struct LightParts {
  const char *whole, *direct, *indirect, *color;
  bool is_usual = true;  // its absence is worth a word
};

struct Convention {
  const char* renderer;
  std::vector<LightParts> parts;  // the first is the diffuse light
};

const std::vector<Convention> kConventions{
    {"Cycles",
     {{"", "DiffDir", "DiffInd", "DiffCol"},
      {"", "GlossDir", "GlossInd", "GlossCol"},
      {"", "TransDir", "TransInd", "TransCol"},
      {"", "SubsurfaceDir", "SubsurfaceInd", "SubsurfaceCol", false},
      {"", "VolumeDir", "VolumeInd", ""},
      {"Emit", "", "", ""}}},
    {"Blender 5",
     {{"", "Diffuse Direct", "Diffuse Indirect", "Diffuse Color"},
      {"", "Glossy Direct", "Glossy Indirect", "Glossy Color"},
      {"", "Transmission Direct", "Transmission Indirect", "Transmission Color"},
      {"", "Volume Direct", "Volume Indirect", ""},
      {"Emission", "", "", ""}}},
    {"Arnold",
     {{"diffuse", "diffuse_direct", "diffuse_indirect", ""},
      {"specular", "specular_direct", "specular_indirect", ""},
      {"coat", "coat_direct", "coat_indirect", ""},
      {"sheen", "sheen_direct", "sheen_indirect", ""},
      {"transmission", "transmission_direct", "transmission_indirect", ""},
      {"sss", "sss_direct", "sss_indirect", ""},
      {"volume", "volume_direct", "volume_indirect", ""},
      {"emission", "", "", ""}}},
    {"V-Ray",
     {{"", "VRayLighting", "VRayGlobalIllumination", ""},
      {"VRayReflection", "", "", ""},
      {"VRayRefraction", "", "", ""},
      {"VRaySpecular", "", "", ""},
      {"VRaySSS2", "", "", ""},
      {"VRayCaustics", "", "", ""},
      {"VRaySelfIllumination", "", "", ""},
      {"VRayAtmosphere", "", "", ""}}},
    {"V-Ray",
     {{"", "lighting", "GI", ""},
      {"reflect", "", "", ""},
      {"refract", "", "", ""},
      {"specular", "", "", ""},
      {"SSS", "", "", ""},
      {"caustics", "", "", ""},
      {"selfIllum", "", "", ""},
      {"atmosphere", "", "", ""}}},
    {"Karma",
     {{"combineddiffuse", "directdiffuse", "indirectdiffuse", ""},
      {"combinedglossyreflection", "directglossyreflection", "indirectglossyreflection", ""},
      {"glossytransmission", "", "", ""},
      {"coat", "directcoat", "indirectcoat", ""},
      {"sss", "", "", ""},
      {"combinedvolume", "directvolume", "indirectvolume", ""},
      {"combinedemission", "directemission", "indirectemission", ""}}},
};

using Pass = std::array<ChannelRef, 3>;

/// A product of the sum: passes that are added, and the colour of them.
struct Term {
  std::vector<Pass> lights;
  std::optional<Pass> color;
};

/// The passes beside a beauty.
class PassSearch {
 public:
  explicit PassSearch(const FrameSource& source) : beauty_(source.channels[RawPlane::beauty][0]) {
    const ExrFile& file = source.file_of(beauty_);
    channels_ = channels_in(file, beauty_.file, "", view_in(file, source.channels.view));
    for (const auto& channel : channels_)
      if (channel.ref == beauty_) name_ = channel.spellings.front();
    std::erase_if(channels_, [&](const NamedChannel& channel) {
      return channel.subsampled || source.part_of(channel.ref).data != source.part_of(beauty_).data;
    });
    // "viewlayer.combined.r" has its passes below "viewlayer.", and "r" has them anywhere at the top.
    for (int word = 0; word < 2; word++) name_.resize(name_.rfind('.') == name_.npos ? 0 : name_.rfind('.'));
    if (!name_.empty()) name_ += ".";
  }

  std::optional<Pass> find(const std::string& pass) const {
    if (pass.empty()) return std::nullopt;
    Pass found;
    const std::array components{"r", "g", "b"};
    for (std::size_t c = 0; c < 3; c++) {
      const std::string wanted = name_ + lower_case(pass) + "." + components[c];
      const auto channel = std::ranges::find_if(
          channels_, [&](const NamedChannel& each) { return std::ranges::count(each.spellings, wanted) > 0; });
      if (channel == channels_.end()) return std::nullopt;
      found[c] = channel->ref;
    }
    return found;
  }

 private:
  const ChannelRef& beauty_;
  std::vector<NamedChannel> channels_;
  std::string name_;  // what stands before the names of the passes, in lower case
};

struct FoundLight {
  InspectedLight text;
  std::vector<Term> terms;
};

/// Adds a part of the light to the sum, or its passes to what is lacking.
void add(FoundLight& found, const LightParts& parts, const PassSearch& search) {
  Term term;
  std::vector<std::string> names, lacking;
  const auto take = [&](const std::string& name) {
    const auto pass = search.find(name);
    if (pass) term.lights.push_back(*pass), names.push_back(name);
    if (!pass && !name.empty()) lacking.push_back(name);
    return pass.has_value();
  };
  const std::string color = parts.color;
  if (!take(parts.whole)) {
    if (*parts.direct) lacking.clear();
    take(parts.direct);
    take(parts.indirect);
  }
  term.color = search.find(color);
  if (!color.empty() && !term.color) lacking.push_back(color);
  if (parts.is_usual) found.text.lacking.insert(found.text.lacking.end(), lacking.begin(), lacking.end());
  if (names.empty() || (!color.empty() && !term.color)) return;
  const std::string lights = names.size() > 1 && term.color ? "(" + names[0] + " + " + names[1] + ")"
                                                            : fmt::format("{}", fmt::join(names, " + "));
  found.text.sum += (found.terms.empty() ? "" : " + ") + lights + (term.color ? " x " + color : "");
  found.terms.push_back(std::move(term));
}

/// The passes of the renderer whose names fit most; none where there are less than two parts, or no diffuse light.
std::optional<FoundLight> find_light(const FrameSource& source) {
  const PassSearch search(source);
  std::optional<FoundLight> best;
  for (const auto& [renderer, parts] : kConventions) {
    FoundLight found{{renderer, "", {}}, {}};
    const bool has_diffuse = std::ranges::any_of(std::array{parts[0].whole, parts[0].direct, parts[0].indirect},
                                                 [&](const char* name) { return search.find(name).has_value(); });
    for (const LightParts& part : parts) add(found, part, search);
    if (has_diffuse && found.terms.size() > 1 && (!best || found.terms.size() > best->terms.size()))
      best = std::move(found);
  }
  return best;
}

/// The planes of a few rows: the sum, and the beauty, of the three components one behind the other.
struct Strip {
  Window window;
  std::vector<float> sum, beauty;
};

/// Reads all passes at once: each row is decoded once.
Strip strip_of(FrameSource& source, const Window& window, const FoundLight& light) {
  const auto& beauty = source.channels[RawPlane::beauty];
  std::vector<std::vector<ChannelRef>> channels{{beauty[0], beauty[1], beauty[2]}};
  for (const Term& term : light.terms) {
    for (const Pass& pass : term.lights) channels.emplace_back(pass.begin(), pass.end());
    if (term.color) channels.emplace_back(term.color->begin(), term.color->end());
  }
  std::vector<std::vector<float>> planes(channels.size(), std::vector<float>(3 * window.pixels()));
  std::vector<PlaneRead> reads;
  for (std::size_t i = 0; i < channels.size(); i++) reads.push_back({&channels[i], planes[i].data()});
  read_planes(source, window, reads);
  Strip strip{window, std::vector<float>(3 * window.pixels()), std::move(planes[0])};
  std::size_t next = 1;
  for (const Term& term : light.terms) {
    const std::size_t color = next + term.lights.size();
    for (; next < color; next++)
      for (std::size_t i = 0; i < strip.sum.size(); i++)
        strip.sum[i] += planes[next][i] * (term.color ? planes[color][i] : 1);
    next += term.color.has_value();
  }
  return strip;
}

/// Sums over pixels with surfaces. Noise of a beauty that was denoised is to both sides.
struct Sums {
  std::size_t pixels = 0;
  double beauty = 0, sum = 0, apart = 0;

  void add(const Sums& other) {
    pixels += other.pixels;
    beauty += other.beauty;
    sum += other.sum;
    apart += other.apart;
  }
  void add(const Strip& strip, std::size_t pixel) {
    pixels++;
    for (std::size_t i = pixel; i < strip.sum.size(); i += strip.window.pixels()) {
      const double b = strip.beauty[i], s = strip.sum[i];
      if (!std::isfinite(b) || !std::isfinite(s)) continue;
      beauty += b;
      sum += s;
      apart += std::abs(b - s);
    }
  }
  bool differ() const {
    constexpr double kLeast = 0.05, kOneSided = 0.8;
    return std::abs(beauty - sum) > kLeast * std::max(beauty, sum) && std::abs(beauty - sum) > kOneSided * apart;
  }
};

/// Whether no sky is near a pixel: a pixel's filter reaches its neighbours, and mixes the light of a background into
/// the beauty that no pass of light has.
bool is_within_surfaces(std::span<const float> planar, const Window& data, int x, int y) {
  constexpr int kReach = 2;  // px
  for (int row = std::max(0, y - kReach); row <= std::min(data.height - 1, y + kReach); row++)
    for (int column = std::max(0, x - kReach); column <= std::min(data.width - 1, x + kReach); column++)
      if (std::isinf(planar[std::size_t(row) * std::size_t(data.width) + std::size_t(column)])) return false;
  return true;
}

}  // namespace

std::optional<InspectedLight> light_passes_of(FrameSource& source, std::span<const float> planar) {
  constexpr int kStrips = 24, kRows = 8, kColumns = 24;
  constexpr double kMost = 0.02;  // of the blocks
  const Window& data = source.part_of(source.channels[RawPlane::beauty][0]).data;
  if (data != source.reading.data || planar.size() != data.pixels()) return std::nullopt;
  auto light = find_light(source);
  if (!light) return std::nullopt;
  Sums all, others;
  std::size_t blocks = 0, other = 0;
  const int rows = std::min(kRows, data.height), strips = std::min(kStrips, data.height / rows);
  for (int i = 0; i < strips; i++) {
    const int top = int(std::int64_t(data.height - rows) * i / std::max(1, strips - 1));
    const Strip strip = strip_of(source, {data.x, data.y + top, data.width, rows}, *light);
    std::array<Sums, kColumns> of{};
    for (std::size_t p = 0; p < strip.window.pixels(); p++) {
      const auto width = std::size_t(data.width), x = p % width;
      if (is_within_surfaces(planar, data, int(x), top + int(p / width))) of[x * kColumns / width].add(strip, p);
    }
    for (const Sums& block : of) {
      all.add(block);
      blocks += block.pixels > 0;
      if (block.pixels == 0 || !block.differ()) continue;
      other++;
      others.add(block);
    }
  }
  if (!(all.beauty > 0)) return std::nullopt;
  light->text.share = all.sum / all.beauty;
  light->text.other_part = double(others.pixels) / double(all.pixels);
  light->text.other_share = others.beauty > 0 ? others.sum / others.beauty : 1;
  light->text.adds_up = double(other) <= kMost * double(blocks);
  return light->text;
}

std::string missing_light_text(const InspectedLight& light) {
  const std::string lacking =
      light.lacking.empty() ? ""
                            : fmt::format("; of {}'s passes the file lacks {}", light.renderer, list_of(light.lacking));
  constexpr double kOneSided = 0.03;
  const std::string where = fmt::format("on {:.2g} % of the surfaces", 100 * light.other_part);
  if (std::abs(light.other_share - 1) < kOneSided)
    return fmt::format(
        "{} is not the beauty {}, brighter in places and darker in others: they are of different renderings, or the "
        "beauty is no linear light, such as one with a view transform",
        light.sum, where);
  const std::string sum = fmt::format("{} is {:.3g} % of the beauty {}", light.sum, 100 * light.other_share, where);
  if (light.other_share > 1)
    return fmt::format("{}: the beauty lacks light, or is no linear light, such as one with a view transform", sum);
  return fmt::format(
      "{}: light is missing, and a composite of these passes is too dark{}; the beauty itself may also be no "
      "linear light, such as one with a view transform",
      sum, lacking);
}

}  // namespace alcove
