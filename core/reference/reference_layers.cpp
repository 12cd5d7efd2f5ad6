// Merges planes behind the first surface, and pairs front faces with the back faces that close their solids.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace alcove {
namespace {

/// Surfaces are one if they are no farther apart than so many times what a depth may be off, and a pixel.
constexpr double kPrecisions = 4;
/// The ends of a surface count that are no more pixels away.
constexpr int kReach = 64;
/// A solid is at most so many times as thick as its front is wide.
constexpr double kMostThickness = 2;

class Layers {
 public:
  Layers(const ReferenceScene& scene, const HostFrame& frame, int hidden)
      : scene_(scene),
        frame_(frame),
        hidden_(hidden),
        pixels_(frame.data.pixels()),
        planes_(std::size_t(hidden) * pixels_),
        open_(planes_.size()) {}

  void merge(double separation) {
    std::vector<DepthMap> maps;
    for (const auto& plane : frame_.behind)
      maps.push_back(plane.depth_kind == DepthKind::automatic
                         ? depth_map_of(frame_)
                         : depth_map(plane.depth_kind, {}, {}, frame_.camera, plane.scale, frame_.sky));
    const DepthPrecision precision = hidden_precision_of(frame_);
    const auto separation_at = [&](double z) {
      if (separation >= 0) return separation;
      return kPrecisions * precision.at_depth(z) + pixel_size(z);
    };
    for_pixels([&](int x, int y) {
      double last = scene_.depth(x, y);
      int kept = 0;
      for (const auto& [z, kind] : found(x, y, maps)) {
        if (kept == hidden_) break;
        if (z <= last + separation_at(last)) continue;
        const std::size_t at = index(x, y, ++kept);
        planes_[at] = float(kind == Kind::closes ? -z : z);
        open_[at] = kind == Kind::unknown;
        last = z;
      }
    });
  }

  /// Finds which surfaces of unknown kind close a solid.
  void pair() {
    std::vector<bool> closes(planes_.size());
    for_pixels([&](int x, int y) {
      bool opens = true;  // the surface before is none that closes one itself
      for (int k = 1; k <= hidden_ && depth(x, y, k) > 0; k++) {
        const std::size_t at = index(x, y, k);
        const bool known = planes_[at] < 0;
        closes[at] = open_[at] && opens && ends_with(x, y, k - 1);
        opens = !known && !closes[at];
      }
    });
    for (std::size_t i = 0; i < planes_.size(); i++)
      if (closes[i]) planes_[i] = -planes_[i];
  }

  std::vector<float> take() { return std::move(planes_); }

 private:
  enum class Kind { closes, front, unknown };
  struct End {
    int vote = 0;   // 1: with the surface behind it; -1: without it; 0: not known
    int steps = 0;  // as far as that, or as was looked
  };

  void for_pixels(const std::function<void(int, int)>& take) const {
    for (int y = 0; y < scene_.height(); y++)
      for (int x = 0; x < scene_.width(); x++)
        if (scene_.depth(x, y) > 0) take(x, y);
  }
  double pixel_size(double z) const { return (scene_.orthographic() ? 1 : z) / scene_.fx(); }
  std::size_t index(int x, int y, int surface) const {
    return std::size_t(surface - 1) * pixels_ + std::size_t(y) * std::size_t(scene_.width()) + std::size_t(x);
  }
  double depth(int x, int y, int surface) const {
    return surface == 0 ? scene_.depth(x, y) : std::abs(planes_[index(x, y, surface)]);
  }

  /// All that the planes hold, nearer first; of those that are equally near, the better known one.
  std::vector<std::pair<double, Kind>> found(int x, int y, const std::vector<DepthMap>& maps) const {
    const double ray_length = scene_.orthographic() ? 1 : length(scene_.position(x, y, 1));
    std::vector<std::pair<double, Kind>> found;
    for (std::size_t plane = 0; plane < maps.size(); plane++) {
      const BehindKind kind = frame_.behind[plane].kind;
      const float raw = frame_.behind_depth[plane * pixels_ + index(x, y, 1)];
      double z = planar_depth(maps[plane], {raw, 0, 0}, ray_length);
      if (kind == BehindKind::thickness) z += scene_.depth(x, y);
      if (std::isfinite(z) && z > 0)
        found.emplace_back(z, kind == BehindKind::surfaces ? Kind::unknown
                              : kind == BehindKind::fronts ? Kind::front
                                                           : Kind::closes);
    }
    std::ranges::sort(found);
    return found;
  }

  bool same(double a, double b) const {
    return a > 0 && b > 0 && std::abs(a - b) < kRunSlope * pixel_size(std::min(a, b));
  }

  /// The surface of the neighbour that goes on from this one: each is the other's nearest; -1: none.
  int link(int x, int y, int surface, int next_x, int next_y) const {
    const double z = depth(x, y, surface);
    int best = -1;
    for (int j = 0; j <= hidden_; j++) {
      const double other = depth(next_x, next_y, j);
      const double gap = std::abs(z - other);
      if (!same(z, other) || (best >= 0 && gap >= std::abs(z - depth(next_x, next_y, best)))) continue;
      bool mutual = true;
      for (int i = 0; i <= hidden_; i++)
        mutual = mutual && !(i != surface && same(depth(x, y, i), other) && std::abs(depth(x, y, i) - other) < gap);
      if (mutual) best = j;
    }
    return best;
  }

  /// Follows a surface until it ends, and looks whether the one behind it ends there too.
  End end_of(int x, int y, int surface, int step_x, int step_y) const {
    for (int step = 1; step <= kReach; step++) {
      const int next_x = x + step_x;
      const int next_y = y + step_y;
      if (!scene_.inside(next_x, next_y)) return {0, step};
      const int next = link(x, y, surface, next_x, next_y);
      if (next < 0) return {vote(x, y, surface, step_x, step_y), step};
      surface = next;
      x = next_x;
      y = next_y;
    }
    return {0, kReach};
  }

  /// At the last pixel of a surface, of the one behind it.
  int vote(int x, int y, int surface, int step_x, int step_y) const {
    const int behind = surface + 1;
    if (behind > hidden_ || depth(x, y, behind) == 0) return 0;
    const int next_x = x + step_x;
    const int next_y = y + step_y;
    const int next = link(x, y, behind, next_x, next_y);
    const double last = depth(next_x, next_y, hidden_);
    // Behind a full list it may go on unseen.
    if (next < 0) return last > 0 && last < depth(x, y, behind) ? 0 : 1;
    // Its outline may lie a pixel farther out.
    const int after_x = next_x + step_x;
    const int after_y = next_y + step_y;
    return scene_.inside(after_x, after_y) && link(next_x, next_y, next, after_x, after_y) < 0 ? 1 : -1;
  }

  /// Whether a surface ends with the one behind it, at most of its ends along row and column, and stands no farther
  /// before it than a solid is thick.
  bool ends_with(int x, int y, int surface) const {
    int votes = 0;
    std::array<int, 2> width{-1, -1};
    for (const int way : {-1, 1}) {
      const End along_row = end_of(x, y, surface, way, 0);
      const End along_column = end_of(x, y, surface, 0, way);
      votes += along_row.vote + along_column.vote;
      width[0] += along_row.steps;
      width[1] += along_column.steps;
    }
    const double z = depth(x, y, surface);
    return votes > 0 && depth(x, y, surface + 1) - z <= kMostThickness * std::min(width[0], width[1]) * pixel_size(z);
  }

  const ReferenceScene& scene_;
  const HostFrame& frame_;
  int hidden_;
  std::size_t pixels_;
  std::vector<float> planes_;
  std::vector<bool> open_;  // whether it may close a solid, for each of `planes_`
};

}  // namespace

ReferenceLayers reference_layers(const ReferenceScene& scene, const HostFrame& frame, int hidden, double separation) {
  Layers layers(scene, frame, hidden);
  layers.merge(separation);
  layers.pair();
  return {layers.take(), list_all(frame.behind)};
}

}  // namespace alcove
