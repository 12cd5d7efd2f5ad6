// Sites of a G-buffer as the host sees them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/chain/estimate/sites.h"
#include "tests/support/device.h"
#include "tests/support/site_frames.h"

namespace alcove::test {

/// Whether a pixel and its neighbours are one surface.
struct Linked {
  bool right = false, below = false;
};

/// What there is to know of a pixel: its surface, links to its neighbours, and whether it is a site.
struct Pixel {
  bool is_surface = false, is_site = false;
  Linked linked, flat;  // flat: without a bend
};

/// Pixels of an image, and of what lies about it.
struct Picture {
  int width, height;
  ivec2 origin;
  std::vector<Pixel> pixels;

  bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  const Pixel& at(int x, int y) const { return pixels[std::size_t(y * width + x)]; }
  Pixel& at(int x, int y) { return pixels[std::size_t(y * width + x)]; }
  bool is_on_lattice(int x, int y, int spacing) const {
    return test::is_on_lattice(x + origin.x, y + origin.y, spacing);
  }
  /// Whether it is one of the sites that the image's border has: every second pixel of it.
  bool is_on_border(int x, int y) const {
    return ((y == 0 || y == height - 1) && (x + origin.x) % 2 == 0) ||
           ((x == 0 || x == width - 1) && (y + origin.y) % 2 == 0);
  }
  bool right_of(int x, int y, Linked Pixel::*links) const {
    return !has(x, y) || !has(x + 1, y) || (at(x, y).*links).right;
  }
  bool below_of(int x, int y, Linked Pixel::*links) const {
    return !has(x, y) || !has(x, y + 1) || (at(x, y).*links).below;
  }
  bool row_is_linked(int from, int to, int y, Linked Pixel::*links) const {
    for (int x = std::min(from, to); x < std::max(from, to); x++)
      if (!right_of(x, y, links)) return false;
    return true;
  }
  bool column_is_linked(int x, int from, int to, Linked Pixel::*links) const {
    for (int y = std::min(from, to); y < std::max(from, to); y++)
      if (!below_of(x, y, links)) return false;
    return true;
  }
  /// Whether a path with one bend leads to a site in a quadrant. On the wider lattices it may not lead over a round
  /// surface, and on all but the densest what lies beyond the border counts as a site.
  bool has_site_towards(int x, int y, int sign_x, int sign_y, int spacing) const {
    const auto links = spacing >= 4 ? &Pixel::flat : &Pixel::linked;
    for (int away_y = 0; away_y <= 3; away_y++)
      for (int away_x = 0; away_x <= 3; away_x++) {
        const int u = x + sign_x * away_x, v = y + sign_y * away_y;
        if (!(has(u, v) ? at(u, v).is_site : spacing >= 2)) continue;
        if (row_is_linked(x, u, y, links) && column_is_linked(u, y, v, links)) return true;
        if (column_is_linked(x, y, v, links) && row_is_linked(x, u, v, links)) return true;
      }
    return false;
  }
  int quadrants_with_sites(int x, int y, int spacing) const {
    int count = 0;
    for (const int sign_x : {-1, 1})
      for (const int sign_y : {-1, 1}) count += has_site_towards(x, y, sign_x, sign_y, spacing);
    return count;
  }
  int count_of_sites() const { return int(std::ranges::count(pixels, true, &Pixel::is_site)); }
};

template <class T>
std::vector<T> downloaded(const gpu::Buffer& buffer) {
  recorder().download(buffer);
  recorder().run();
  const auto values = buffer.as<T>();
  return {values.begin(), values.end()};
}

struct Prepared {
  FrameInputs inputs;
  GBuffer gbuffer;
};

inline Prepared prepared(const HostFrame& frame) {
  Prepared result{upload(recorder(), frame), {}};
  result.gbuffer = reconstruct(recorder(), prepare(recorder(), result.inputs));
  return result;
}

/// What the words of all tiles say, and those of links without a bend where there are any. Fails where they say
/// anything of pixels beyond the border.
inline Picture picture_of(const std::vector<uint>& rows, const GBuffer& gbuffer, const std::vector<uint>& flat = {}) {
  const ivec2 size = gbuffer.view.size;
  Picture picture{size.x, size.y, gbuffer.grid.origin, std::vector<Pixel>(std::size_t(size.x * size.y))};
  const int tiles = (size.x + 7) / 8;
  const auto links_in = [](uint bits) { return Linked{(bits & 1u) != 0, (bits & 0x100u) != 0}; };
  for (int y = 0; y < (size.y + 7) / 8 * 8; y++)
    for (int x = 0; x < tiles * 8; x++) {
      const auto at = std::size_t((y / 8 * tiles + x / 8) * 8 + y % 8);
      const uint bits = rows[at] >> uint(x % 8), flat_bits = flat.empty() ? 0 : flat[at] >> uint(x % 8);
      const Pixel pixel{(bits & 0x10000u) != 0, (bits & 0x1000000u) != 0, links_in(bits), links_in(flat_bits)};
      if (picture.has(x, y))
        picture.at(x, y) = pixel;
      else
        EXPECT_EQ((bits & 0x1010101u) | (flat_bits & 0x101u), 0u) << x << " " << y;
    }
  return picture;
}

/// The words of these rows, with those of links without a bend where the rule is adaptive.
inline Picture picture_of(const gpu::Buffer& rows, const GBuffer& gbuffer, const SiteRule& rule) {
  if (!rule.is_adaptive) return picture_of(downloaded<uint>(rows), gbuffer);
  const auto& flat = recorder().buffer("flat links", rows.bytes(), gpu::Use::device);
  recorder().download(flat);
  const std::vector<uint> words = downloaded<uint>(rows);
  const auto flat_words = flat.as<uint>();
  return picture_of(words, gbuffer, {flat_words.begin(), flat_words.end()});
}

inline Picture chosen(const GBuffer& gbuffer, const SiteRule& rule) {
  return picture_of(*sites(recorder(), gbuffer, rule).rows, gbuffer, rule);
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
