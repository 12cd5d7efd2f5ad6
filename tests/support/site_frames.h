// Lattices of sites, and frames to choose sites in: walls, and pictures of what the rule of sites must tell apart.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/sites.h"
#include "tests/support/chain.h"

namespace alcove::test {

/// A coordinate in a period, also left of the first one.
inline int within(int x, int period) { return (x % period + period) % period; }

/// Whether a pixel lies on the lattice of a spacing; it counts from the display window's corner.
inline bool is_on_lattice(int x, int y, int spacing) {
  const int u = within(x, 4), v = within(y, 4);
  switch (spacing) {
    case 16: return u == 0 && v == 0;
    case 8: return u % 2 == 0 && v == 0;
    case 4: return u % 2 == 0 && v % 2 == 0;
    case 2: return (u + v) % 2 == 0;
    default: return true;
  }
}

/// Pictures made of what the rule must tell apart: a tilted wall, blades a pixel wide, patches, and sky.
inline HostFrame random_picture(std::mt19937& random) {
  const auto whole = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto number = [&](double least, double most) { return std::uniform_real_distribution(least, most)(random); };
  const int width = whole(1, 75), height = whole(1, 45);
  const Vec3 normal = unit({-1, number(-1, 1), number(-1, 1)});
  Shot shot = whole(0, 3) > 0 ? Shot::perspective({}, {1, 0, 0}, 50, width, height)
                              : Shot::orthographic({}, {1, 0, 0}, 4, width, height);
  shot.data.x = whole(-9, 9);
  shot.data.y = whole(-9, 9);
  HostFrame frame = render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, shot).frame;
  const auto put = [&](int x, int y, double depth) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const std::size_t i = std::size_t(y * width + x);
    frame.depth[i] = float(depth);
    put_normal(frame, i, {0, 0, 1});
  };
  for (int things = whole(0, 30); things > 0; things--) {
    const int x = whole(-4, width), y = whole(-4, height);
    const double depth = whole(0, 2) == 0 ? kSky : number(1, 4), slope = number(-1.5, 1.5);
    const int kind = whole(0, 2), reach = whole(1, 30);
    for (int i = 0; i < reach; i++) {
      if (kind == 0) put(x + i, y + int(std::floor(i * slope)), depth);
      if (kind == 1) put(x + int(std::floor(i * slope)), y + i, depth);
      for (int j = 0; kind == 2 && j < reach / 2 + 1; j++) put(x + i, y + j, depth);
    }
  }
  return frame;
}

/// Puts strands a pixel wide before what a frame shows.
inline void add_strands(HostFrame& frame) {
  const int width = frame.data.width, height = frame.data.height;
  std::mt19937 random(3);
  for (int strand = 0; strand < 14; strand++) {
    const double slope = double(random() % 400) / 100 - 2, x0 = random() % unsigned(width);
    const auto top = int(random() % unsigned(height)), bottom = std::min(height, top + 10 + int(random() % 40));
    for (int y = top; y < bottom; y++) {
      const int x = int(std::floor(x0 + slope * (y - top)));
      if (x >= 0 && x < width) frame.depth[std::size_t(y * width + x)] *= 0.93f;
    }
  }
}

/// A tilted wall that fills the picture, which lies so far from the display window's corner.
inline HostFrame wall_at(int x, int y, int width, int height, Vec3 normal, bool orthographic) {
  Shot shot = orthographic ? Shot::orthographic({}, {1, 0, 0}, 4, width, height)
                           : Shot::perspective({}, {1, 0, 0}, 40, width, height);
  shot.data.x = x;
  shot.data.y = y;
  shot.camera.cx += x;
  shot.camera.cy += y;
  return render({{Plane{.point = {5, 0, 0}, .normal = normal}}}, shot).frame;
}

/// Two planes at a right angle that opens towards the eye, along a slanting line; pixels beside it lie in both.
struct Crease {
  Rendering rendering = render({{Plane{.point = {5, 0, 0}, .normal = unit({-1, 0.8, 0.6})},
                                 Plane{.point = {5, 0, 0}, .normal = unit({-1, -0.8, -0.6})}}},
                               Shot::perspective({}, {1, 0, 0}, 60, 80, 60));

  /// 0 on the one plane, 1 on the other.
  std::vector<float> sides() const {
    std::vector<float> sides;
    for (const Hit& hit : rendering.hits) sides.push_back(float(hit.primitive));
    return sides;
  }
};

// Sites of a G-buffer as the host sees them.

/// Pixels of an image, and which of them are sites.
struct Picture {
  int width, height;
  ivec2 origin;  // from the display window's corner
  std::vector<bool> sites;

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  bool is_site(int x, int y) const { return sites[index(x, y)]; }
  int count_of_sites() const { return int(std::ranges::count(sites, true)); }
  /// Whether a pixel lies on the lattice of a spacing; that of 16 has the pixels beside the middles of blocks.
  bool is_on_lattice(int x, int y, int spacing) const {
    return test::is_on_lattice(x + origin.x - 1, y + origin.y - 1, spacing);
  }
};

/// What the words of all blocks say. Fails where they say anything of pixels beyond the border.
inline Picture picture_of(const Sites& sites, const GBuffer& gbuffer) {
  const std::vector<uint> words = downloaded<uint>(*sites.words);
  const ivec2 size = gbuffer.view.size, overhang = sites.grid.overhang, blocks = sites.grid.blocks;
  Picture picture{size.x, size.y, gbuffer.grid.origin, std::vector<bool>(std::size_t(size.x * size.y))};
  for (int y = 0; y < blocks.y * kBlock; y++)
    for (int x = 0; x < blocks.x * kBlock; x++) {
      const uint word = words[std::size_t(y / kBlock * blocks.x + x / kBlock)];
      if ((word >> (y % kBlock * kBlock + x % kBlock) & 1) == 0) continue;
      const int u = x - overhang.x, v = y - overhang.y;
      EXPECT_TRUE(u >= 0 && v >= 0 && u < size.x && v < size.y) << u << " " << v;
      picture.sites[picture.index(u, v)] = true;
    }
  return picture;
}

inline Picture chosen(const GBuffer& gbuffer, const SiteRule& rule) {
  return picture_of(sites(recorder(), gbuffer, rule), gbuffer);
}

inline Picture chosen(const HostFrame& frame, const SiteRule& rule) { return chosen(prepared(frame).gbuffer, rule); }

/// Points and normals of a G-buffer in view space, as the kernels read them.
struct Geometry {
  View view;
  std::vector<float> depth;
  std::vector<uint> normal;

  explicit Geometry(const GBuffer& gbuffer)
      : view(gbuffer.view), depth(downloaded<float>(*gbuffer.depth)), normal(downloaded<uint>(*gbuffer.normal)) {}

  std::size_t index(int x, int y) const { return std::size_t(y * view.size.x + x); }
  Vec3 point(int x, int y) const {
    const double z = depth[index(x, y)], scale = view.orthographic ? 1 : z;
    return {(x + 0.5 - view.center.x) * view.tangent_per_pixel.x * scale,
            (y + 0.5 - view.center.y) * view.tangent_per_pixel.y * scale, -z};
  }
  Vec3 normal_of(int x, int y) const {
    const uint word = normal[index(x, y)];
    const double u = std::int16_t(word & 0xffffu) / 32767.0, v = std::int16_t(word >> 16) / 32767.0;
    Vec3 n{u, v, 1 - std::abs(u) - std::abs(v)};
    if (n.z < 0) n = {(u >= 0 ? 1 : -1) * (1 - std::abs(v)), (v >= 0 ? 1 : -1) * (1 - std::abs(u)), n.z};
    return unit(n);
  }
  bool is_surface(int x, int y) const { return x < view.size.x && y < view.size.y && depth[index(x, y)] < kSkyDepth; }
  /// The larger of both distances from the other's plane, in widths of the pixel there, squared.
  double apart_sq(int x, int y, int u, int v) const {
    const Vec3 away = point(u, v) - point(x, y);
    const double width = (std::abs(view.tangent_per_pixel.x) + std::abs(view.tangent_per_pixel.y)) / 2;
    const auto width_at = [&](int i, int j) { return width * (view.orthographic ? 1 : depth[index(i, j)]); };
    return std::pow(std::max(std::abs(dot(normal_of(x, y), away)) / width_at(x, y),
                             std::abs(dot(normal_of(u, v), away)) / width_at(u, v)),
                    2);
  }
  /// How far two pixels show one surface, 1 at most, as likeness.glsl has it.
  double likeness(int x, int y, int u, int v) const {
    return dot(normal_of(x, y), normal_of(u, v)) - apart_sq(x, y, u, v);
  }
};

}  // namespace alcove::test
