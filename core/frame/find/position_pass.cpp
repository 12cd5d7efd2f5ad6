// Finds a pass of positions, picks points of it, and holds the camera that was given, and the depth, against them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/position_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "core/base/error.h"
#include "core/base/ranks.h"

namespace alcove {
namespace {

constexpr int kColumns = 48;
constexpr int kRows = 8;  // of a place

/// A surface bends less from pixel to pixel, as part of the step; more where a filter has put two together.
constexpr double kMostBend = 0.1;

/// Rows of a pass.
struct Band {
  Window window;
  std::array<std::vector<float>, 3> planes;

  Vector3 at(int x, int y) const {
    const auto i = std::size_t(y - window.y) * std::size_t(window.width) + std::size_t(x - window.x);
    return {planes[0][i], planes[1][i], planes[2][i]};
  }
};

bool is_surface(const Vector3& p, double sky) { return dot(p, p) > 0 && dot(p, p) < sky * sky; }

/// The difference of the steps to the pixels on both sides, relative to them; infinite if one is no surface.
double bend(const Vector3& before, const Vector3& here, const Vector3& after) {
  const double step = length(difference(after, before));
  const Vector3 second = difference(difference(after, here), difference(here, before));
  return step > 0 ? length(second) / step : std::numeric_limits<double>::infinity();
}

/// The bend of the surface about a pixel; infinite if the pixel shows none.
double roughness(const Band& band, int x, int y, double sky) {
  const Vector3 here = band.at(x, y);
  const std::array<Vector3, 4> about{band.at(x - 1, y), band.at(x + 1, y), band.at(x, y - 1), band.at(x, y + 1)};
  const bool shows =
      is_surface(here, sky) && std::ranges::all_of(about, [&](const Vector3& p) { return is_surface(p, sky); });
  if (!shows) return std::numeric_limits<double>::infinity();
  return std::max(bend(about[0], here, about[1]), bend(about[2], here, about[3]));
}

/// A pixel of a cell that shows a smooth surface; any of them, since the smoothest are all of walls. Else the
/// smoothest.
std::optional<std::pair<int, int>> place_in(const Band& band, const Window& cell, double sky, std::mt19937& random) {
  std::vector<std::pair<int, int>> smooth;
  std::optional<std::pair<int, int>> best;
  double least = std::numeric_limits<double>::infinity();
  const Window& whole = band.window;
  for (int y = std::max(cell.y, whole.y + 1); y < std::min(cell.y + cell.height, whole.y + whole.height - 1); y++)
    for (int x = std::max(cell.x, whole.x + 1); x < std::min(cell.x + cell.width, whole.x + whole.width - 1); x++) {
      const double rough = roughness(band, x, y, sky);
      if (rough < kMostBend) smooth.emplace_back(x, y);
      if (rough < least) least = rough, best = {x, y};
    }
  return smooth.empty() ? best : smooth[random() % smooth.size()];
}

/// The error of a point's place, px, since its numbers are rounded.
double rounding_at(const Band& band, int x, int y, double relative) {
  const double across = length(difference(band.at(x + 1, y), band.at(x - 1, y)));
  const double down = length(difference(band.at(x, y + 1), band.at(x, y - 1)));
  return relative * length(band.at(x, y)) / (0.5 * std::min(across, down));
}

}  // namespace

std::vector<ChannelRef> find_positions(const ChannelSearch& search, const FrameSource& source,
                                       const InputSettings& settings) {
  const auto& depth = source.channels[RawPlane::depth];
  if (depth.size() == 3) return depth;
  const std::size_t file = depth.front().file;
  auto found =
      search.find_by_rules(file, kPositionNames, settings.position_channels, source.program.rules->position).channels;
  if (found.empty()) found = search.find(file, kPositionNames, settings.position_channels, false);
  const auto fits = [&](const ChannelRef& ref) {
    return source.part_of(ref).data == source.part_of(found.front()).data;
  };
  return std::ranges::all_of(found, fits) ? found : std::vector<ChannelRef>{};
}

std::string fault_of_positions(std::span<const SeenPoint> points, const ExrFile& file,
                               const std::variant<Resection, NoResection>& found) {
  const Window& display = file.display();
  if (const auto* camera = std::get_if<Resection>(&found))
    return why_stretched(points, display, camera, file.pixel_aspect());
  std::string why = why_cut(points, display);
  if (!why.empty()) return why;
  if (const std::string panorama = panorama_of(points, display); !panorama.empty())
    refuse_panorama(file.path(), panorama + " by its positions");
  why = why_stretched(points, display, nullptr, file.pixel_aspect());
  return why.empty() ? why_bent(points, display) : why;
}

std::vector<SeenPoint> points_of(FrameSource& source, double sky, int bands) {
  const auto& positions = source.channels.positions;
  ExrFile& file = source.file_of(positions.front());
  const ExrPart& part = file.parts()[std::size_t(positions.front().part)];
  const Window& data = part.data;
  const bool is_half = std::ranges::any_of(positions, [&](const ChannelRef& ref) { return source.is_half(ref); });
  const double relative = is_half ? kHalfPrecision : kFloatPrecision;
  const int together = std::max(part.rows_together, 1);
  const int rows = (kRows + together - 1) / together * together;
  const int step = std::max(rows, data.height / bands / together * together);
  const Window& display = file.display();
  std::mt19937 random(1);  // the same frame has the same points
  std::vector<SeenPoint> points;
  for (int top = 0; top < data.height; top += step) {
    Band band{{data.x, data.y + top, data.width, std::min(rows, data.height - top)}, {}};
    std::vector<ExrRead> reads;
    for (std::size_t k = 0; k < 3; k++) {
      band.planes[k].resize(band.window.pixels());
      reads.push_back({positions[k].part, positions[k].channel, band.planes[k].data()});
    }
    file.read(reads, top, band.window.height);
    for (int first = band.window.y; first < band.window.y + band.window.height; first += kRows)
      for (int column = 0; column < kColumns; column++) {
        const int left = int(std::int64_t(data.width) * column / kColumns);
        const int right = int(std::int64_t(data.width) * (column + 1) / kColumns);
        const Window cell{data.x + left, first, right - left, kRows};
        const auto place = place_in(band, cell, sky, random);
        if (!place) continue;
        const auto [x, y] = *place;
        points.push_back({band.at(x, y), x + 0.5 - display.x, y + 0.5 - display.y, rounding_at(band, x, y, relative)});
      }
  }
  return points;
}

// Camera and depth against the positions.

namespace {

/// The share of the points, nearest to their pixels first, that counts: the rest may be of edges.
constexpr double kCounted = 0.9;
/// px, and part of the picture's width: a lens that is off by less is one that was rounded.
constexpr double kLeastBeside = 1, kLeastPart = 1e-3;
/// px. Where half of the points are farther off by the camera that fits best, they are of no camera; filtered ones are
/// nearer.
constexpr double kNoCamera = 2;

/// The largest distance, px, from most points to their pixels by a lens, beyond their rounding. `standing` is the
/// camera that places them.
double beside(const Camera& lens, const Camera& standing, std::span<const SeenPoint> points) {
  std::vector<double> distances;
  for (const auto& point : points) {
    Vector3 view = point.position;
    if (standing.view_from_world) {
      view = sum(times(*standing.view_from_world, point.position), standing.view_from_world_offset);
    } else if (standing.left_handed) {
      view[2] = -view[2];
    }
    const double over = lens.orthographic ? 1 : -1 / view[2];
    const double x = lens.cx + lens.fx * view[0] * over, y = lens.cy - lens.fy * view[1] * over;
    distances.push_back(std::hypot(x - point.x, y - point.y) - point.rounding);
  }
  return value_at_rank(distances, std::size_t(kCounted * double(distances.size() - 1)));
}

bool is_centred(const Camera& camera, double pixel_aspect) {
  constexpr double kSame = 2e-3;
  return std::abs(camera.cx - 0.5 * camera.width) < kSame * camera.width &&
         std::abs(camera.cy - 0.5 * camera.height) < kSame * camera.height &&
         std::abs(camera.fy / camera.fx / pixel_aspect - 1) < kSame;
}

/// The options that give this lens, or its numbers where no option does.
std::string text_of(const Camera& camera, double pixel_aspect) {
  const double width = camera.width / camera.fx;
  if (!is_centred(camera, pixel_aspect))
    return fmt::format("{} camera with fx {:.6g}, fy {:.6g}, cx {:.2f}, cy {:.2f} (--camera)",
                       camera.orthographic ? "an orthographic" : "a", camera.fx, camera.fy, camera.cx, camera.cy);
  if (camera.orthographic) return fmt::format("an orthographic camera (--ortho-width {:.6g})", width);
  const double degrees = 2 * std::atan(0.5 * width) * 180 / std::numbers::pi;
  return fmt::format("a field of view of {:.5g} degrees (--fov {:.5g})", degrees, degrees);
}

/// Names the source of the lens for messages.
std::string name_of_lens(const FrameSource& source, const InputSettings& settings) {
  if (!source.camera_from.empty()) return source.camera_from;
  if (!settings.camera.empty()) return "the camera of " + settings.camera;
  if (settings.fov) return fmt::format("--fov {:g}", *settings.fov);
  if (settings.vertical_fov) return fmt::format("--vertical-fov {:g}", *settings.vertical_fov);
  if (settings.focal_px) return fmt::format("--focal-px {:g}", *settings.focal_px);
  return settings.focal ? "--focal with --aperture" : "--ortho-width";
}

/// The planar depth of a point, scene units.
double planar_of(const SeenPoint& point, const Camera& camera) {
  if (!camera.view_from_world) return std::abs(point.position[2]);
  return -(dot((*camera.view_from_world)[2], point.position) + camera.view_from_world_offset[2]);
}

/// The median difference of numbers from their median, relative to it.
double spread(std::vector<double> numbers) {
  const double median = median_of(numbers);
  for (double& number : numbers) number = std::abs(number / median - 1);
  return median_of(std::move(numbers));
}

/// Whether the frame has positions beside a depth of its own.
bool has_positions_beside(const FrameSource& source) {
  return !source.channels.positions.empty() && source.channels[RawPlane::depth].size() == 1;
}

/// Whether the camera is no reading of the positions themselves.
bool has_own_camera(const FrameSource& source) { return !source.open.camera && source.camera_from != kByPositions; }

/// Says that the positions show the camera's lens a little apart from it, as that of a frame before has it; "" if they
/// do not, or so far away that they are of another world or in other units.
std::string why_elsewhere(const Camera& camera, const Camera& seen, std::span<const SeenPoint> points) {
  constexpr double kMostTurn = 30;  // degrees
  if (!camera.view_from_world || !seen.view_from_world || seen.orthographic) return "";
  const Matrix3 &from = *camera.view_from_world, &to = *seen.view_from_world;
  const Matrix3 turn = product(to, transposed(from));
  const double cosine = 0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1);
  const double degrees = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  const Vector3 eye = times(transposed(from), camera.view_from_world_offset),
                other = times(transposed(to), seen.view_from_world_offset);
  const double moved = length(difference(eye, other));
  std::vector<double> depths;
  for (const SeenPoint& point : points) depths.push_back(planar_of(point, seen));
  if (degrees > kMostTurn || moved > median_of(std::move(depths))) return "";
  return fmt::format(
      "they show the same lens turned by {:.2f} degrees and moved by {:.2g}: it may be the camera of "
      "another frame",
      degrees, moved);
}

}  // namespace

std::vector<SeenPoint> points_to_check(FrameSource& source, double sky) {
  const bool is_needed = has_positions_beside(source) || has_own_camera(source);
  if (source.channels.positions.empty() || !is_needed) return {};
  return points_of(source, sky, kFewBands);
}

std::string settle_camera(FrameSource& source, const InputSettings& settings, std::span<const SeenPoint> points) {
  if (points.empty() || !has_own_camera(source)) return "";
  ExrFile& file = source.file_of(source.channels.positions.front());
  const double limit = std::max(kLeastBeside, kLeastPart * source.reading.display.width);
  const double by_camera = beside(source.reading.camera, source.reading.camera, points);
  if (by_camera <= limit) return "";
  const auto found = resection_of(points, source.reading.display);
  const auto* seen = std::get_if<Resection>(&found);
  const std::string& held = file.path();
  const std::string lens = name_of_lens(source, settings);
  const std::string why = fault_of_positions(points, file, found);
  const auto noted = [&](NoteCode code, const std::string& text) {
    source.notes.push_back({code, text});
    return text;
  };
  if (!seen && (std::get<NoResection>(found).median <= kNoCamera || !source.camera_from.empty())) return "";
  if (!why.empty())
    return noted(NoteCode::field_of_view,
                 fmt::format("the positions of {} show no camera, since {} (--set position-channels); {} is taken",
                             held, why, lens));
  if (!seen)
    return noted(NoteCode::field_of_view,
                 fmt::format("no camera fits the positions of {}: by the best one half of them lie {:.3g} px and more "
                             "from their pixels, so they are a panorama's, or no positions (--set position-channels); "
                             "{} is taken",
                             held, std::get<NoResection>(found).median, lens));
  const double px = beside(source.reading.camera, seen->camera, points);
  if (px > limit)
    return noted(NoteCode::field_of_view,
                 fmt::format("by {} most positions of {} lie up to {:.3g} px from their pixels; they show {}{}", lens,
                             held, px, text_of(seen->camera, source.reading.pixel_aspect),
                             source.camera_from.empty() ? ": give that, or leave the option out" : ""));
  const std::string elsewhere = why_elsewhere(source.reading.camera, seen->camera, points);
  if (elsewhere.empty()) return "";
  return noted(NoteCode::positions_disagree,
               fmt::format("by {} most positions of {} lie up to {:.3g} px from their pixels; {}", lens, held,
                           by_camera, elsewhere));
}

namespace {

constexpr double kSame = 0.005;  // of depth that is that of the positions, in whatever unit

/// Calls `take` with the planar depth of each point in front of the camera, with the raw value beside it, and with the
/// length of its ray.
template <class Take>
void for_each_beside(const FrameSource& source, std::span<const SeenPoint> points, const RawPart& raw,
                     const Take& take) {
  const Window &data = raw.window, &display = source.reading.display;
  const View view = view_of(source.reading, data);
  for (const auto& point : points) {
    const int x = int(point.x) + display.x - data.x, y = int(point.y) + display.y - data.y;
    if (x < 0 || y < 0 || x >= data.width || y >= data.height) continue;
    const double z = planar_of(point, source.reading.camera);
    if (z > 0)
      take(z, double(raw.depth[std::size_t(y) * std::size_t(data.width) + std::size_t(x)]), ray_length(view, x, y));
  }
}

/// The difference of most numbers from another, at the most, relative to it. Half of a picture may be one wall, whose
/// depth is the same.
double most_apart(std::span<const double> numbers, double from) {
  constexpr double kMost = 0.8;
  std::vector<double> apart;
  for (const double number : numbers) apart.push_back(std::abs(number / from - 1));
  return value_at_rank(apart, std::size_t(kMost * double(apart.size() - 1)));
}

/// Says how planar depths differ from those of positions; "" if they do not.
std::string difference_of(const std::vector<double>& depths, const std::vector<double>& by_positions) {
  std::vector<double> ratios, off, offsets, moved;
  for (std::size_t i = 0; i < depths.size(); i++) {
    ratios.push_back(depths[i] / by_positions[i]);
    off.push_back(std::abs(ratios[i] - 1));
    offsets.push_back(by_positions[i] - depths[i]);
  }
  const double ratio = median_of(ratios), offset = median_of(offsets), half = median_of(off);
  if (half <= 2 * kSame) return "";
  if (most_apart(ratios, ratio) <= kSame)
    return fmt::format("depth is {:.4g} times theirs, so the units differ: --depth-scale {:.4g} mends it", ratio,
                       1 / ratio);
  for (std::size_t i = 0; i < depths.size(); i++) moved.push_back((depths[i] + offset) / by_positions[i]);
  if (most_apart(moved, 1) <= kSame)
    return fmt::format("depth is theirs less {:.4g}, so it does not count from the eye", offset);
  return fmt::format("half of the depth is {:.2g} % and more off, so it is of another kind (--depth-kind) or frame",
                     100 * half);
}

}  // namespace

void check_by_positions(FrameSource& source, const InputSettings& settings, const RawPart& raw,
                        std::span<const SeenPoint> points) {
  const Camera& camera = source.reading.camera;
  if (!has_positions_beside(source) || source.open.camera || camera.orthographic) return;
  const double limit = std::max(kLeastBeside, kLeastPart * source.reading.display.width);
  if (points.empty() || beside(camera, camera, points) > limit) return;
  const DepthMap map = depth_map_of(source.reading);
  std::vector<double> depths, by_positions;
  for_each_beside(source, points, raw, [&](double z, double value, double ray) {
    const double depth = planar_depth(map, {value, 0, 0}, ray);
    if (!(depth > 0 && depth < settings.sky)) return;
    depths.push_back(depth);
    by_positions.push_back(z);
  });
  if (depths.size() < kLeastPoints) return;
  const std::string why = difference_of(depths, by_positions);
  if (!why.empty())
    source.notes.push_back({NoteCode::positions_disagree,
                            fmt::format("the positions beside the depth disagree with it: {}; --depth-kind position "
                                        "takes the positions instead",
                                        why)});
}

std::optional<DepthKind> kind_by_positions(const FrameSource& source, const InputSettings& settings, const RawPart& raw,
                                           std::span<const SeenPoint> points) {
  constexpr double kOther = 4;  // times as far is another kind
  if (!has_positions_beside(source)) return std::nullopt;
  std::vector<double> planar, ray, inverse;
  for_each_beside(source, points, raw, [&](double z, double signed_value, double to) {
    const double value = std::abs(signed_value);
    if (!(value > 0 && value < settings.sky)) return;
    planar.push_back(value / z);
    ray.push_back(value / (z * to));
    inverse.push_back(value * z);
  });
  if (planar.size() < kLeastPoints) return std::nullopt;
  const std::array spreads{std::pair{spread(planar), DepthKind::planar}, std::pair{spread(ray), DepthKind::ray},
                           std::pair{spread(inverse), DepthKind::inverse}};
  const auto best = std::ranges::min_element(spreads);
  const auto fits_too = [&](const auto& other) {
    return other.second != best->second && other.first < kOther * std::max(best->first, 1e-5);
  };
  if (best->first > kSame || std::ranges::any_of(spreads, fits_too)) return std::nullopt;
  return best->second;
}

}  // namespace alcove
