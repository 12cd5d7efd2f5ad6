// Statistics over pixels, and hypotheses tried on them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/ranks.h"
#include "kernels/geometry/geometry.h"

namespace alcove {
namespace {

constexpr double kRadians = std::numbers::pi / 180;  // of a degree
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAgreementDegrees = 20;    // to the normal that depth gives; depth's own steps turn it by less
constexpr double kCloseDegrees = 3;         // to it; less than a wrong camera turns most of the normals
constexpr std::size_t kLeastSamples = 200;  // fewer smooth places tell nothing
constexpr int kSamplesAcross = 160;         // places that are looked at in x and in y: enough for shares to a percent

int sparseness(const View& view) { return std::max(1, std::max(view.size.x, view.size.y) / kSamplesAcross); }
std::size_t index_of(const View& view, int x, int y) {
  return std::size_t(y) * std::size_t(view.size.x) + std::size_t(x);
}

/// Gives the point where the pixel's ray meets the plane at unit depth; orthographic: the pixel's place in the plane.
Vector3 tangent_at(const View& view, int x, int y) {
  return {(x + 0.5 - view.center.x) * view.tangent_per_pixel.x, (y + 0.5 - view.center.y) * view.tangent_per_pixel.y,
          -1};
}

Vector3 position_at(const View& view, int x, int y, double z) {
  const Vector3 t = tangent_at(view, x, y);
  return view.orthographic ? Vector3{t[0], t[1], -z} : Vector3{t[0] * z, t[1] * z, -z};
}

Vector3 value_at(std::span<const float> raw, std::size_t plane, std::size_t i) {
  return raw.size() == 3 * plane ? Vector3{raw[i], raw[i + plane], raw[i + 2 * plane]} : Vector3{raw[i], 0, 0};
}

/// Relative second difference of three evenly spaced values.
double bend(double before, double here, double after) { return std::abs(before + after - 2 * here) / std::abs(here); }

void count_value(ValueStatistics& s, float x) {
  s.pixels++;
  if (std::isnan(x)) {
    s.nan++;
    return;
  }
  if (std::isinf(x)) {
    s.infinite++;
    return;
  }
  s.negative += x < 0;
  s.zero += x == 0;
  s.one += x == 1;
  s.positive += x > 0;
  s.least = std::min(s.least, double(x));
  s.most = std::max(s.most, double(x));
}

/// Counts a normal as it stands in the file, unless it is zero or not finite. Components beyond `components` are 0.
void count_normal(NormalStatistics& s, std::vector<double>& lengths, const Vector3& n, std::size_t components) {
  Vector3 unorm{};
  for (std::size_t c = 0; c < components; c++) unorm[c] = 2 * n[c] - 1;
  const double length = std::sqrt(dot(n, n));
  const double unorm_length = std::sqrt(dot(unorm, unorm));
  if (!(length > 0) || std::isinf(length)) return;
  s.count++;
  lengths.push_back(length);
  s.mean_length += length;
  s.unorm_mean_length += unorm_length;
  s.unit_share += std::abs(length - 1) < kUnitTolerance;
  s.unorm_unit_share += std::abs(unorm_length - 1) < kUnitTolerance;
  for (std::size_t c = 0; c < components; c++) {
    s.least = std::min(s.least, n[c]);
    s.most = std::max(s.most, n[c]);
  }
}

/// World space, where the camera knows it, and view space, with all flips.
std::vector<NormalScore> readings_of_normals(const Camera& camera) {
  std::vector<NormalScore> scores;
  for (const NormalSpace space : {NormalSpace::world, NormalSpace::view})
    for (const bool x : {false, true})
      for (const NormalFlips flips : {NormalFlips{x, false, false}, NormalFlips{x, false, true},
                                      NormalFlips{x, true, false}, NormalFlips{x, true, true}})
        if (space == NormalSpace::view || camera.view_from_world) scores.push_back({space, flips});
  return scores;
}

/// A place of a smooth surface: the normal that depth gives it, of any length, and the way to the eye.
struct SurfacePlace {
  Vector3 normal, eye;
};

/// Gives nothing at edges, where the depths around the pixel are not those of a plane.
std::optional<SurfacePlace> surface_at(std::span<const float> raw, const DepthMap& map, const View& view, int x,
                                       int y) {
  constexpr double kSmooth = 0.005;  // bend of 1/z on one surface
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  const auto depth = [&](int dx, int dy) {
    return planar_depth(map, value_at(raw, plane, index_of(view, x + dx, y + dy)), ray_length(view, x + dx, y + dy));
  };
  const double left = depth(-1, 0), right = depth(1, 0), up = depth(0, -1), down = depth(0, 1), here = depth(0, 0);
  if (!(bend(1 / left, 1 / here, 1 / right) < kSmooth) || !(bend(1 / up, 1 / here, 1 / down) < kSmooth))
    return std::nullopt;
  const Vector3 along_y = difference(position_at(view, x, y + 1, down), position_at(view, x, y - 1, up));
  const Vector3 along_x = difference(position_at(view, x + 1, y, right), position_at(view, x - 1, y, left));
  const Vector3 p = position_at(view, x, y, here);
  // A view in which the picture is mirrored turns the product around.
  const bool is_mirrored = (view.tangent_per_pixel.x > 0) == (view.tangent_per_pixel.y > 0);
  return SurfacePlace{is_mirrored ? cross(along_x, along_y) : cross(along_y, along_x),
                      view.orthographic ? Vector3{0, 0, 1} : Vector3{-p[0], -p[1], -p[2]}};
}

/// The distance, in pixels, from a pixel to the place where a point of view space is seen; infinite behind the camera.
double pixels_beside(const View& view, int x, int y, const Vector3& p) {
  if (!(-p[2] > 0)) return kInfinity;
  const Vector3 t = tangent_at(view, x, y);
  const double scale = view.orthographic ? 1 : -p[2];
  return std::hypot((p[0] / scale - t[0]) / view.tangent_per_pixel.x, (p[1] / scale - t[1]) / view.tangent_per_pixel.y);
}

const double kAgreeing = std::cos(kAgreementDegrees * kRadians);
const double kClose = std::cos(kCloseDegrees * kRadians);

/// Calls `visit` with each place of a smooth surface that is looked at and the unit normal of the file there, in its
/// own space. Gives how many there are.
template <class Visit>
std::size_t for_each_normal(const NormalPlanes& planes, const Visit& visit) {
  const View& view = planes.view;
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  const int stride = sparseness(view);
  std::size_t count = 0;
  for (int y = 1; y + 1 < view.size.y; y += stride)
    for (int x = 1; x + 1 < view.size.x; x += stride) {
      auto surface = surface_at(planes.raw, planes.map, view, x, y);
      if (!surface) continue;
      const Vector3 vector = decoded_normal(planes.normal, plane, index_of(view, x, y), planes.encoding, planes.unorm);
      const double size = length(vector), by_depth = length(surface->normal);
      if (!(size * by_depth > 0) || std::isinf(size * by_depth)) continue;
      count++;
      surface->normal = scaled(surface->normal, 1 / by_depth);
      visit(*surface, scaled(vector, 1 / size));
    }
  return count;
}

/// The sums of one reading of the normals.
class NormalSum {
 public:
  explicit NormalSum(NormalScore& score, const Camera& camera)
      : score_(score), rotation_(view_from_normal(camera, score.space, score.flips)) {}

  void add(const SurfacePlace& surface, const Vector3& vector) {
    Vector3 n = times(rotation_, vector);
    double cosine = std::min(1.0, dot(n, surface.normal));
    score_.facing += dot(n, surface.eye) > 0;
    score_.agreement += cosine > kAgreeing;
    score_.close += cosine > kClose;
    if (cosine < -kAgreeing) {
      score_.opposite++;
      cosine = std::min(1.0, -cosine);
      n = scaled(n, -1);
    }
    cosines_.push_back(cosine);
    if (cosine > kAgreeing) add_turn(surface.normal, n);
  }
  void finish() {
    const auto count = double(cosines_.size());
    for (double* share : {&score_.facing, &score_.agreement, &score_.opposite, &score_.close}) *share /= count;
    score_.angle =
        std::acos(std::max(-1.0, value_at_rank(cosines_, std::size_t(0.75 * double(cosines_.size()))))) / kRadians;
    // A turn about the surfaces' own normals does not show.
    constexpr double kUnseen = 1e-4;
    for (std::size_t i = 0; i < 3; i++) across_[i][i] += kUnseen * count;
    const double whole = determinant(across_);
    for (std::size_t i = 0; i < 3; i++) {
      Matrix3 replaced = across_;  // symmetrical: its rows are its columns
      replaced[i] = moved_;
      score_.turn[i] = determinant(replaced) / whole;
    }
  }

 private:
  /// A small turn moves a unit vector g by turn x g, so that g x n is the part of the turn that is across g.
  void add_turn(const Vector3& g, const Vector3& n) {
    const Vector3 moved = cross(g, n);
    for (std::size_t i = 0; i < 3; i++) {
      moved_[i] += moved[i];
      for (std::size_t j = 0; j < 3; j++) across_[i][j] += double(i == j) - g[i] * g[j];
    }
  }

  NormalScore& score_;
  Matrix3 rotation_, across_{};
  Vector3 moved_{};
  std::vector<double> cosines_;
};

/// Fills in how well the frame agrees with each of the readings. Gives false where too little of it is smooth.
bool score(std::vector<NormalScore>& scores, const NormalPlanes& planes) {
  std::vector<NormalSum> sums;
  for (auto& score : scores) sums.emplace_back(score, planes.camera);
  const std::size_t count = for_each_normal(planes, [&](const SurfacePlace& surface, const Vector3& n) {
    for (auto& sum : sums) sum.add(surface, n);
  });
  if (count < kLeastSamples) return false;
  for (auto& sum : sums) sum.finish();
  return true;
}

}  // namespace

Vector3 decoded_normal(std::span<const float> raw, std::size_t pixels, std::size_t i, NormalEncoding encoding,
                       bool unorm) {
  Vector3 n{};
  for (std::size_t c = 0; c * pixels < raw.size(); c++)
    n[c] = unorm ? 2 * raw[c * pixels + i] - 1.0 : raw[c * pixels + i];
  const double squared = n[0] * n[0] + n[1] * n[1];
  if (encoding == NormalEncoding::octahedral) {
    n[2] = 1 - std::abs(n[0]) - std::abs(n[1]);
    if (n[2] < 0) n = {std::copysign(1 - std::abs(n[1]), n[0]), std::copysign(1 - std::abs(n[0]), n[1]), n[2]};
  } else if (encoding == NormalEncoding::spheremap) {
    const double across = 2 * std::sqrt(std::max(1 - squared, 0.0));
    n = squared <= 1 ? Vector3{across * n[0], across * n[1], 2 * squared - 1} : Vector3{};
  } else if (raw.size() < 3 * pixels) {
    n[2] = std::sqrt(std::max(1 - squared, 0.0));
  }
  return n;
}

ValueStatistics statistics_of(std::span<const float> values, std::size_t step) {
  ValueStatistics s;
  s.least = kInfinity;
  s.most = -kInfinity;
  for (std::size_t i = 0; i < values.size(); i += step) count_value(s, values[i]);
  if (s.least > s.most) s.least = s.most = 0;
  return s;
}

NormalStatistics normal_statistics(std::span<const float> normal, std::span<const float> raw, const DepthMap& map,
                                   std::size_t step) {
  NormalStatistics s;
  std::vector<double> lengths;
  s.least = kInfinity;
  s.most = -kInfinity;
  const std::size_t plane = map.form == kDepthPosition ? raw.size() / 3 : raw.size();
  const std::size_t components = normal.size() / plane;
  for (std::size_t i = 0; i < plane; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw, plane, i), 1))) continue;
    Vector3 n{};
    for (std::size_t c = 0; c < components; c++) n[c] = normal[c * plane + i];
    count_normal(s, lengths, n, components);
  }
  if (!s.count) return {};
  s.usual_length = value_at_rank(lengths, lengths.size() / 2);
  const double tolerance = kUnitTolerance * s.usual_length;
  s.usual_share =
      double(std::ranges::count_if(lengths, [&](double l) { return std::abs(l - s.usual_length) < tolerance; }));
  for (double* share : {&s.mean_length, &s.unorm_mean_length, &s.unit_share, &s.unorm_unit_share, &s.usual_share})
    *share /= double(s.count);
  return s;
}

std::vector<float> planar_depths(std::span<const float> raw, const DepthMap& map, const View& view, int row_step) {
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  std::vector<float> planar;
  planar.reserve(plane / std::size_t(row_step) + std::size_t(view.size.x));
  for (int y = 0; y < view.size.y; y += row_step)
    for (int x = 0; x < view.size.x; x++)
      planar.push_back(float(planar_depth(map, value_at(raw, plane, index_of(view, x, y)), ray_length(view, x, y))));
  return planar;
}

std::optional<double> reprojection_error(std::span<const float> position, PositionSpace space, bool mirrored,
                                         const Camera& camera, const View& view) {
  const std::size_t plane = position.size() / 3;
  const int stride = sparseness(view);
  std::vector<double> errors;
  for (int y = 0; y < view.size.y; y += stride)
    for (int x = 0; x < view.size.x; x += stride) {
      const std::size_t i = index_of(view, x, y);
      Vector3 p{position[i], position[i + plane], position[i + 2 * plane]};
      if (!(dot(p, p) > 0) || !(dot(p, p) < 1e18)) continue;
      if (space == PositionSpace::world) {
        p = times(*camera.view_from_world, p);
        for (std::size_t c = 0; c < 3; c++) p[c] += camera.view_from_world_offset[c];
      } else if (camera.left_handed != mirrored) {
        p[2] = -p[2];
      }
      errors.push_back(pixels_beside(view, x, y, p));
    }
  return errors.empty() ? std::nullopt : std::optional(median_of(std::move(errors)));
}

NormalPlanes::NormalPlanes(const Reading& reading, std::span<const float> of_file, std::span<const float> depth)
    : normal(of_file),
      raw(depth),
      encoding(reading.normal_encoding),
      unorm(reading.normal_unorm),
      map(depth_map_of(reading)),
      camera(reading.camera),
      view(view_of(reading.camera, reading.data, reading.display)) {}

std::vector<NormalScore> score_normals(const NormalPlanes& planes) {
  std::vector<NormalScore> scores = readings_of_normals(planes.camera);
  if (!score(scores, planes)) return {};
  std::ranges::stable_sort(scores, std::greater(), &NormalScore::agreement);
  return scores;
}

const NormalScore* score_of(const std::vector<NormalScore>& scores, NormalSpace space, const NormalFlips& flips) {
  const auto found = std::ranges::find_if(
      scores, [&](const auto& s) { return s.space == space && to_string(s.flips) == to_string(flips); });
  return found == scores.end() ? nullptr : &*found;
}

std::optional<CutScore> score_cut(NormalSpace space, const NormalPlanes& planes) {
  constexpr double kBelow = -0.25;  // a component that noise of the depth does not make
  const Matrix3 normal_from_view = transposed(view_from_normal(planes.camera, space, {}));
  CutScore cut;
  std::size_t needed = 0;
  const std::size_t count = for_each_normal(planes, [&](const SurfacePlace& surface, const Vector3& n) {
    const Vector3 whole = times(normal_from_view, surface.normal);
    if (std::ranges::min(whole) > kBelow) return;
    needed++;
    Vector3 absolute, clamped;
    for (std::size_t c = 0; c < 3; c++) absolute[c] = std::abs(whole[c]), clamped[c] = std::max(whole[c], 0.0);
    cut.absolute += dot(n, absolute) > kAgreeing;
    cut.clamped += dot(n, clamped) > kAgreeing * length(clamped);
  });
  if (count < kLeastSamples) return std::nullopt;
  cut.needed = double(needed) / double(count);
  for (double* share : {&cut.absolute, &cut.clamped}) *share /= std::max(1.0, double(needed));
  return cut;
}

double NormalScore::turn_degrees() const { return length(turn) / kRadians; }

std::optional<NormalScore> score_normals_as(NormalSpace space, const NormalFlips& flips, const NormalPlanes& planes) {
  std::vector<NormalScore> scores{{space, flips}};
  if (!score(scores, planes)) return std::nullopt;
  return scores[0];
}

std::string to_string(const NormalFlips& flips) {
  const std::string text = std::string(flips.x ? "x" : "") + (flips.y ? "y" : "") + (flips.z ? "z" : "");
  return text.empty() ? "none" : text;
}

}  // namespace alcove
