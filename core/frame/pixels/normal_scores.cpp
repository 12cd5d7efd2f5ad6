// Readings of normals, tried on places of smooth surfaces.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/normal_scores.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/ranks.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"

namespace alcove {
namespace {

constexpr double kRadians = std::numbers::pi / 180;  // of a degree
constexpr double kAgreementDegrees = 20;    // to the normal that depth gives; depth's own steps turn it by less
constexpr double kCloseDegrees = 3;         // to it; less than a wrong camera turns most of the normals
constexpr std::size_t kLeastSamples = 200;  // fewer smooth places tell nothing

Vector3 position_at(const View& view, int x, int y, double z) {
  const Vector3 t = tangent_at(view, x, y);
  return view.orthographic ? Vector3{t[0], t[1], -z} : Vector3{t[0] * z, t[1] * z, -z};
}

/// Relative second difference of three evenly spaced values.
double bend(double before, double here, double after) { return std::abs(before + after - 2 * here) / std::abs(here); }

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
  const auto depth = [&](int dx, int dy) { return planar_depth_at(map, raw, view, x + dx, y + dy); };
  const double left = depth(-1, 0), right = depth(1, 0), here = depth(0, 0);
  if (!(bend(1 / left, 1 / here, 1 / right) < kSmooth)) return std::nullopt;
  const double up = depth(0, -1), down = depth(0, 1);
  if (!(bend(1 / up, 1 / here, 1 / down) < kSmooth)) return std::nullopt;
  const Vector3 along_y = difference(position_at(view, x, y + 1, down), position_at(view, x, y - 1, up));
  const Vector3 along_x = difference(position_at(view, x + 1, y, right), position_at(view, x - 1, y, left));
  const Vector3 p = position_at(view, x, y, here);
  // A view in which the picture is mirrored turns the product around.
  const bool is_mirrored = (view.tangent_per_pixel.x > 0) == (view.tangent_per_pixel.y > 0);
  return SurfacePlace{is_mirrored ? cross(along_x, along_y) : cross(along_y, along_x),
                      view.orthographic ? Vector3{0, 0, 1} : Vector3{-p[0], -p[1], -p[2]}};
}

const double kAgreeing = std::cos(kAgreementDegrees * kRadians);
const double kClose = std::cos(kCloseDegrees * kRadians);

Vector3 normal_at(const NormalPlanes& planes, std::size_t plane, std::size_t i) {
  if (planes.components.empty()) return decoded_normal(planes.normal, plane, i, planes.encoding, planes.unorm);
  std::vector<float> values;
  for (const std::size_t component : planes.components) values.push_back(planes.normal[component * plane + i]);
  return decoded_normal(values, 1, 0, planes.encoding, planes.unorm);
}

/// Calls `visit` with each place of a smooth surface that is looked at and the unit normal of the file there, in its
/// own space. Gives how many there are.
template <class Visit>
std::size_t for_each_normal(const NormalPlanes& planes, const Visit& visit) {
  const View& view = planes.view;
  const std::size_t plane = std::size_t(view.size.x) * std::size_t(view.size.y);
  const int stride = sparseness(view) * planes.sparse;
  std::size_t count = 0;
  for (int y = 1; y + 1 < view.size.y; y += stride)
    for (int x = 1; x + 1 < view.size.x; x += stride) {
      auto surface = surface_at(planes.raw, planes.map, view, x, y);
      if (!surface) continue;
      const Vector3 vector = normal_at(planes, plane, index_of(view, x, y));
      const double size = length(vector), by_depth = length(surface->normal);
      if (!(size * by_depth > 0) || std::isinf(size * by_depth)) continue;
      count++;
      surface->normal = scaled(surface->normal, 1 / by_depth);
      visit(*surface, scaled(vector, 1 / size));
    }
  return count;
}

/// A place of a smooth surface with the unit normal of the file there, in its own space.
struct ReadPlace {
  SurfacePlace surface;
  Vector3 normal;
};

/// The products of components whose sums, with the signs of flips, are the cosines of a normal to that of depth and to
/// the eye: all flips of a space share them.
struct Products {
  Vector3 by_depth, by_eye;
};

std::vector<Products> products_of(const std::vector<ReadPlace>& places, const Camera& camera, NormalSpace space) {
  const Matrix3 normal_from_view = transposed(view_from_normal(camera, space, {}));
  std::vector<Products> all;
  all.reserve(places.size());
  for (const auto& [surface, normal] : places) {
    Products p{times(normal_from_view, surface.normal), times(normal_from_view, surface.eye)};
    for (std::size_t c = 0; c < 3; c++) p.by_depth[c] *= normal[c], p.by_eye[c] *= normal[c];
    all.push_back(p);
  }
  return all;
}

/// Fills in the shares.
void count_agreeing(NormalScore& score, const Vector3& signs, const std::vector<Products>& products) {
  for (const Products& p : products) {
    const double cosine = dot(signs, p.by_depth);
    score.facing += dot(signs, p.by_eye) > 0;
    score.agreement += cosine > kAgreeing;
    score.close += cosine > kClose;
    score.opposite += cosine < -kAgreeing;
  }
  for (double* share : {&score.facing, &score.agreement, &score.opposite, &score.close})
    *share /= double(products.size());
}

/// Fills in the angle.
void measure_angle(NormalScore& score, const Vector3& signs, const std::vector<Products>& products) {
  std::vector<double> cosines;
  cosines.reserve(products.size());
  for (const Products& p : products) {
    const double cosine = dot(signs, p.by_depth);
    cosines.push_back(std::min(1.0, cosine < -kAgreeing ? -cosine : cosine));
  }
  score.angle =
      std::acos(std::max(-1.0, value_at_rank(cosines, std::size_t(0.75 * double(cosines.size()))))) / kRadians;
}

/// Fills in the turn: a small one moves a unit vector g by turn x g, so that g x n is the part of it that is across g.
void measure_turn(NormalScore& score, const std::vector<ReadPlace>& places, const Camera& camera) {
  constexpr double kUnseen = 1e-4;  // a turn about the surfaces' own normals does not show
  const Matrix3 rotation = view_from_normal(camera, score.space, score.flips);
  Matrix3 across{};
  Vector3 moved{};
  for (const auto& [surface, normal] : places) {
    const Vector3& g = surface.normal;
    const Vector3 n = times(rotation, normal);
    const double cosine = dot(g, n);
    if (std::abs(cosine) <= kAgreeing) continue;
    const Vector3 beside = cross(g, n);
    for (std::size_t i = 0; i < 3; i++) {
      moved[i] += cosine < 0 ? -beside[i] : beside[i];
      for (std::size_t j = 0; j < 3; j++) across[i][j] += double(i == j) - g[i] * g[j];
    }
  }
  for (std::size_t i = 0; i < 3; i++) across[i][i] += kUnseen * double(places.size());
  if (const auto inverse = inverse_of(across)) score.turn = applied(*inverse, moved);
}

/// Fills in how well the frame agrees with each of the readings; angle and turn of those by which half of the normals
/// agree. Gives false where too little of it is smooth.
bool score(std::vector<NormalScore>& scores, const NormalPlanes& planes) {
  std::vector<ReadPlace> places;
  for_each_normal(planes, [&](const SurfacePlace& surface, const Vector3& n) { places.push_back({surface, n}); });
  if (places.size() < kLeastSamples) return false;
  std::vector<Products> products;
  for (std::size_t i = 0; i < scores.size(); i++) {
    NormalScore& score = scores[i];
    if (i == 0 || score.space != scores[i - 1].space) products = products_of(places, planes.camera, score.space);
    const NormalFlips& flips = score.flips;
    const Vector3 signs{flips.x ? -1.0 : 1, flips.y ? -1.0 : 1, flips.z ? -1.0 : 1};
    count_agreeing(score, signs, products);
    if (score.explained() < kUsable) continue;
    measure_angle(score, signs, products);
    measure_turn(score, places, planes.camera);
  }
  return true;
}

}  // namespace

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

bool is_sharper(const NormalScore& other, const NormalScore& score) {
  constexpr double kLeastClose = 0.3, kSharper = 1.2, kLeastSharper = 0.1;
  return other.close >= kLeastClose && other.close > kSharper * score.close &&
         other.close > score.close + kLeastSharper;
}

const NormalScore* sharpest_of(const std::vector<NormalScore>& scores) {
  const NormalScore* sharpest = nullptr;
  for (const auto& score : scores)
    if (score.explained() >= kLeastAgreement && (!sharpest || score.close > sharpest->close)) sharpest = &score;
  return sharpest;
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
