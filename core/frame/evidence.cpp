// Statistics over pixels, and hypotheses tried on them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/frame/flatness.h"
#include "kernels/prepare.h"

namespace alcove {
namespace {

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

/// Relative second difference of three evenly spaced values.
double bend(double before, double here, double after) { return std::abs(before + after - 2 * here) / std::abs(here); }

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

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

constexpr double kUnitTolerance = 0.05;  // of a length that is taken for 1

/// Counts a normal as it stands in the file, unless it is zero or not finite. Components beyond `components` are 0.
void count_normal(NormalStatistics& s, const Vector3& n, std::size_t components) {
  Vector3 unorm{};
  for (std::size_t c = 0; c < components; c++) unorm[c] = 2 * n[c] - 1;
  const double length = std::sqrt(dot(n, n));
  const double unorm_length = std::sqrt(dot(unorm, unorm));
  if (!(length > 0) || std::isinf(length)) return;
  s.count++;
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

/// How far a point of view space is seen from the pixel, in pixels; infinite where it is behind the camera.
double pixels_beside(const View& view, int x, int y, const Vector3& p) {
  if (!(-p[2] > 0)) return kInfinity;
  const Vector3 t = tangent_at(view, x, y);
  const double scale = view.orthographic ? 1 : -p[2];
  return std::hypot((p[0] / scale - t[0]) / view.tangent_per_pixel.x, (p[1] / scale - t[1]) / view.tangent_per_pixel.y);
}

/// Fills in how well the frame agrees with each of the readings. Gives false where too little of it is smooth.
bool score(std::vector<NormalScore>& scores, const NormalPlanes& planes, const Camera& camera, const View& view) {
  std::vector<Matrix3> rotations;
  for (const auto& score : scores) rotations.push_back(view_from_normal(camera, score.space, score.flips));

  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  const int stride = sparseness(view);
  const double agreeing = std::cos(kAgreementDegrees * std::numbers::pi / 180);
  const double close = std::cos(kCloseDegrees * std::numbers::pi / 180);
  std::size_t count = 0;
  std::vector<std::vector<double>> cosines(scores.size());
  for (int y = 1; y + 1 < view.size.y; y += stride)
    for (int x = 1; x + 1 < view.size.x; x += stride) {
      const auto surface = surface_at(planes.raw, planes.map, view, x, y);
      if (!surface) continue;
      const Vector3 vector = decoded_normal(planes.normal, plane, index_of(view, x, y), planes.encoding, planes.unorm);
      const double lengths = std::sqrt(dot(vector, vector) * dot(surface->normal, surface->normal));
      if (!(lengths > 0) || std::isinf(lengths)) continue;
      count++;
      for (std::size_t k = 0; k < scores.size(); k++) {
        const Vector3 n = times(rotations[k], vector);
        scores[k].facing += dot(n, surface->eye) > 0;
        cosines[k].push_back(std::min(1.0, dot(n, surface->normal) / lengths));
        scores[k].agreement += cosines[k].back() > agreeing;
        scores[k].close += cosines[k].back() > close;
      }
    }
  if (count < kLeastSamples) return false;
  for (std::size_t k = 0; k < scores.size(); k++) {
    scores[k].facing /= double(count);
    scores[k].agreement /= double(count);
    scores[k].close /= double(count);
    scores[k].angle = std::acos(std::max(-1.0, quantile(cosines[k], 0.75))) * 180 / std::numbers::pi;
  }
  return true;
}

}  // namespace

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
  s.least = kInfinity;
  s.most = -kInfinity;
  const std::size_t plane = map.form == kDepthPosition ? raw.size() / 3 : raw.size();
  const std::size_t components = normal.size() / plane;
  for (std::size_t i = 0; i < plane; i += step) {
    if (std::isinf(planar_depth(map, value_at(raw, plane, i), 1))) continue;
    Vector3 n{};
    for (std::size_t c = 0; c < components; c++) n[c] = normal[c * plane + i];
    count_normal(s, n, components);
  }
  if (!s.count) return {};
  for (double* share : {&s.mean_length, &s.unorm_mean_length, &s.unit_share, &s.unorm_unit_share})
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

std::vector<float> decoded_normals(std::span<const float> raw, std::size_t pixels, NormalEncoding encoding,
                                   bool unorm) {
  std::vector<float> decoded(3 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const Vector3 n = decoded_normal(raw, pixels, i, encoding, unorm);
    for (std::size_t c = 0; c < 3; c++) decoded[c * pixels + i] = float(n[c]);
  }
  return decoded;
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
  return errors.empty() ? std::nullopt : std::optional(quantile(errors, 0.5));
}

std::vector<NormalScore> score_normals(const NormalPlanes& planes, const Camera& camera, const View& view) {
  std::vector<NormalScore> scores = readings_of_normals(camera);
  if (!score(scores, planes, camera, view)) return {};
  std::ranges::stable_sort(scores, std::greater(), &NormalScore::agreement);
  return scores;
}

std::optional<NormalScore> score_normals_as(NormalSpace space, const NormalFlips& flips, const NormalPlanes& planes,
                                            const Camera& camera, const View& view) {
  std::vector<NormalScore> scores{{space, flips}};
  if (!score(scores, planes, camera, view)) return std::nullopt;
  return scores[0];
}

std::string to_string(const NormalFlips& flips) {
  const std::string text = std::string(flips.x ? "x" : "") + (flips.y ? "y" : "") + (flips.z ? "z" : "");
  return text.empty() ? "none" : text;
}

}  // namespace alcove
