// Finds the surroundings of a region by the nearest depth in it, and cuts frames by what their tiles take with them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/tiles.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/system.h"
#include "core/chain/estimate/estimate.h"
#include "core/chain/filters/filters.h"
#include "core/chain/results/outputs.h"
#include "core/chain/results/results.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/settle.h"
#include "core/run/frame_files.h"
#include "kernels/estimate/estimate.h"
#include "kernels/estimate/exact.h"
#include "kernels/geometry/geometry.h"
#include "kernels/hidden/hidden.h"

namespace alcove {
namespace {

// The blocks whose nearest depths tell how far they reach, px. Most files compress so many rows together.
constexpr int kBlockWidth = 64, kBlockHeight = 16;
// Windows begin at multiples of so many px, the grid of the coarsest resolution, so that its pixels are the same ones.
constexpr int kGrid = 4;

/// An angle close to a right one, in radians: beyond it the image of a sphere has no end.
constexpr double kWidestAngle = 1.57;
/// More pixels than any frame has.
constexpr double kEverywhere = 1e9, kFarther = 1e6;
/// Scene units: farther than any surface.
constexpr double kEndlessReach = 1e30;

Window grown(const Window& window, int margin_x, int margin_y, const Window& within) {
  const auto down = [](int x, int origin) { return origin + (x - origin) / kGrid * kGrid; };
  const int left = down(std::max(window.x - margin_x, within.x), within.x),
            top = down(std::max(window.y - margin_y, within.y), within.y);
  const int right = std::min(window.x + window.width + margin_x + kGrid, within.x + within.width);
  const int bottom = std::min(window.y + window.height + margin_y + kGrid, within.y + within.height);
  return {left, top, right - left, bottom - top};
}

/// How far pixels count for what filters make of another one, in px: by their estimates, and by whether they have one.
int reach_of_filters(const EstimatorSettings& settings) { return filter_reach_of(settings) + site_reach_of(settings); }

/// The same for all that a frame's outputs are made from.
int filter_reach(const Settings& settings) {
  const int own = reach_of_filters(settings.estimator);
  const bool is_alone = settings.output.lights.empty() && !wants(settings.output, &FrameOutputs::confidence);
  return is_alone ? own : std::max(own, reach_of_filters(bracket_of(settings.estimator)));
}

/// How far lines reach beyond the sphere of the radius until they tell what those of the whole frame do, in px; 0 where
/// no line tells how far back anything is solid.
int line_reach(const EstimatorSettings& settings) {
  if (searches_exactly(settings)) return int(settings.resolution) * (kProfileRestart + 2);
  return tells_backs(settings) ? int(settings.resolution) * 4 : 0;
}
int line_reach(const Settings& settings) {
  const int own = line_reach(settings.estimator);
  return settings.output.lights.empty() ? own : std::max(own, line_reach(bracket_of(settings.estimator)));
}

/// The reach, in px, of the passes that pair surfaces with their backs and read mattes of occluders; 0 without them.
int pair_reach(const FrameSource& source, const EstimatorSettings& settings) {
  const bool tells = std::ranges::any_of(source.reading.behind,
                                         [](const BehindPlane& plane) { return plane.kind == BehindKind::surfaces; });
  const int occluders = source.channels[RawPlane::occluders].empty() ? 0 : kOccludersReach;
  return occluders + (tells && settings.hidden > 0 ? kEndsReach + kEndsBeyond : 0);
}

/// How far surfaces block, in scene units: within the radius, or a light.
double reach_of_occluders(const Settings& settings) {
  const double radius = settings.estimator.radius ? radii_of(settings.estimator).back() : 0;
  if (settings.output.lights.empty()) return radius;
  return std::max(radius, settings.estimator.shadow_reach.value_or(kEndlessReach));
}

/// Runs wider than this many radii block as if infinite: with `auto` a wider one is no thicker, and its other end
/// decides nothing else. It is a little more than 4 radii, twice the width from which runs level off, since exact.comp
/// rounds. Where surfaces are completed, a run is half as thick as wide, and may begin up to 3 radii beyond the reach:
/// see complete.comp. In a search by samples, nothing farther away than kLongestChain counts.
double widest_run(const EstimatorSettings& settings) {
  if (tells_backs(settings)) return kLongestChain + 0.1;
  return completes(settings) ? 3 + 8.4 : 4.2;
}

/// How many pixels the image of a sphere reaches from the image of its centre, on one axis. Centres are no nearer than
/// `nearest`, and no farther off axis than `tangent`.
double sphere_reach(double radius, double nearest, double tangent, double pixels_per_tangent, bool orthographic) {
  if (orthographic) return radius * pixels_per_tangent;
  if (radius >= nearest) return kEverywhere;
  const double edge = std::atan(tangent) + std::asin(radius / nearest);
  return edge < kWidestAngle ? (std::tan(edge) - tangent) * pixels_per_tangent : kEverywhere;
}

}  // namespace

Window region_of(const FrameSource& source, const Window& roi) {
  constexpr std::int64_t kFarthest = 1 << 30;  // px; no file has a window that reaches farther
  const Window& data = source.reading.data;
  const Window picture = picture_of(source.reading, source.reading.display);
  const std::int64_t left = std::int64_t(picture.x) + roi.x, top = std::int64_t(picture.y) + roi.y;
  const bool is_near = std::max({std::abs(left), std::abs(top), left + roi.width, top + roi.height}) < kFarthest;
  Window region;
  if (is_near)
    region =
        enlarged({int(left), int(top), roi.width, roi.height}, source.reading.display, source.reading.supersampling);
  if (!is_near || common_part(region, data) != region)
    fail(ErrorKind::usage, "{}: --roi is {}x{} at ({}, {}), and the data window is {}: give a region within it",
         source.depth_path(), roi.width, roi.height, left, top, to_string(picture_of(source.reading, data)));
  return region;
}

Surroundings::Surroundings(const FrameSource& source, const Settings& settings, std::span<const float> depth)
    : Surroundings(source, settings,
                   [&data = source.reading.data, depth](const Window& rows) { return cropped(depth, data, rows); }) {}

Surroundings::Surroundings(const FrameSource& source, const Settings& settings, DepthRows depth)
    : source_(source),
      depth_(std::move(depth)),
      file_data_(source.reading.data),
      columns_((file_data_.width + kBlockWidth - 1) / kBlockWidth),
      blocks_(std::size_t(file_data_.height + kBlockHeight - 1) / kBlockHeight),
      view_(view_of(source.reading, source.reading.data)),
      orthographic_(source.reading.camera.orthographic),
      radius_(settings.estimator.radius ? radii_of(settings.estimator).back() : 0),
      occluders_(reach_of_occluders(settings)),
      filters_(filter_reach(settings) + reduce_reach(settings.output.filter, source.reading.supersampling)),
      lines_(line_reach(settings)),
      pairs_(pair_reach(source, settings.estimator)),
      widest_run_(widest_run(settings.estimator)) {}

Window Surroundings::window_of(int block_row, int column) const {
  const int left = column * kBlockWidth, top = block_row * kBlockHeight;
  return {file_data_.x + left, file_data_.y + top, std::min(kBlockWidth, file_data_.width - left),
          std::min(kBlockHeight, file_data_.height - top)};
}

std::vector<float> Surroundings::nearest_depths(int block_row) {
  Window window = window_of(block_row, 0);
  window.width = file_data_.width;
  const auto planar = planar_depths(depth_(window), depth_map_of(source_.reading), view_of(source_.reading, window));
  std::vector<float> nearest(std::size_t(columns_), kSkyDepth);
  for (std::size_t i = 0; i < planar.size(); i++) {
    float& of_block = nearest[i % std::size_t(window.width) / kBlockWidth];
    of_block = std::min(of_block, planar[i]);
  }
  return nearest;
}

Surroundings::Reach Surroundings::reach(double distance, double nearest, const Window& block) const {
  const auto margin = [&](int low, int high, double center, double tangent_per_pixel) {
    const double tangent = std::max(std::abs(low - center), std::abs(high - center)) * std::abs(tangent_per_pixel);
    const double pixels = sphere_reach(distance, nearest, tangent, 1 / std::abs(tangent_per_pixel), orthographic_);
    return int(std::ceil(std::min(pixels, kFarther))) + 2;
  };
  const int left = block.x - file_data_.x, top = block.y - file_data_.y;
  return {margin(left, left + block.width, view_.center.x, view_.tangent_per_pixel.x),
          margin(top, top + block.height, view_.center.y, view_.tangent_per_pixel.y)};
}

const std::vector<Surroundings::Block>& Surroundings::blocks_of(int block_row) {
  std::vector<Block>& blocks = blocks_[std::size_t(block_row)];
  if (!blocks.empty()) return blocks;
  const std::vector<float> nearest = nearest_depths(block_row);
  for (int column = 0; column < columns_; column++) {
    const Window window = window_of(block_row, column);
    const double depth = nearest[std::size_t(column)];
    blocks.push_back({reach(occluders_, depth, window), reach(widest_run_ * radius_, depth, window)});
  }
  return blocks;
}

Window Surroundings::within(Reach Block::*reach, const Window& window) {
  const int end_x = window.x + window.width, end_y = window.y + window.height;
  int left = window.x, top = window.y, right = end_x, bottom = end_y;
  for (int row = (window.y - file_data_.y) / kBlockHeight; row <= (end_y - 1 - file_data_.y) / kBlockHeight; row++) {
    const std::vector<Block>& blocks = blocks_of(row);
    for (int i = (window.x - file_data_.x) / kBlockWidth; i <= (end_x - 1 - file_data_.x) / kBlockWidth; i++) {
      const Window block = window_of(row, i);
      const Reach& far = blocks[std::size_t(i)].*reach;
      left = std::min(left, std::max(block.x, window.x) - far.x);
      top = std::min(top, std::max(block.y, window.y) - far.y);
      right = std::max(right, std::min(block.x + block.width, end_x) + far.x);
      bottom = std::max(bottom, std::min(block.y + block.height, end_y) + far.y);
    }
  }
  left = std::max(left, file_data_.x), top = std::max(top, file_data_.y);
  right = std::min(right, file_data_.x + file_data_.width), bottom = std::min(bottom, file_data_.y + file_data_.height);
  return grown({left, top, right - left, bottom - top}, 0, 0, file_data_);
}

Window Surroundings::direct(const Window& part) const { return grown(part, filters_, filters_, file_data_); }

Window Surroundings::around(const Window& part) {
  const Window occluders = within(&Block::occluders, direct(part));
  const Window lines = lines_ == 0 ? occluders : within(&Block::runs, grown(occluders, lines_, lines_, file_data_));
  return pairs_ == 0 ? lines : grown(lines, pairs_, pairs_, file_data_);
}

// Tiles.

namespace {

constexpr int kLeastRows = 16;     // px of a tile: most files compress so many rows together
constexpr int kLeastColumns = 64;  // px of a tile

std::uint64_t mebibytes_above(std::uint64_t bytes) { return (bytes + kMebibyte - 1) / kMebibyte; }

/// The bytes of a row of results that is put together from tiles, and of its encoded twin.
std::uint64_t row_bytes(const WindowLimits& limits, const Window& row) {
  return 2 * limits.memory.written * row.pixels();
}

int most_columns(const Window& row) { return std::max(1, row.width / kLeastColumns); }

/// So many tiles, whose widths differ by a pixel at most.
std::vector<Window> columns_of(const Window& row, int count) {
  std::vector<Window> tiles;
  for (int i = 0; i < count; i++) {
    const int left = int(std::int64_t(row.width) * i / count), right = int(std::int64_t(row.width) * (i + 1) / count);
    tiles.push_back({row.x + left, row.y, right - left, row.height});
  }
  return tiles;
}

/// Cuts a window into columns, or into halves that are cut in turn, whichever computes fewer pixels.
class Cutter {
  static constexpr std::uint64_t kNoWay = std::numeric_limits<std::uint64_t>::max();

 public:
  struct Cut {
    TileRows rows;
    std::uint64_t pixels = kNoWay;  // that are computed
  };

  Cutter(Surroundings& surroundings, const WindowLimits& limits) : surroundings_(surroundings), limits_(limits) {}

  /// No way where one of the smallest tiles is still too large.
  Cut cut(const Window& window) {
    Cut best = in_columns(window);
    if (window.height <= kLeastRows || (best.pixels != kNoWay && best.rows[0].size() == 1)) return best;
    const int upper = (window.height / kLeastRows + 1) / 2 * kLeastRows;
    Cut halves = cut({window.x, window.y, window.width, upper});
    if (halves.pixels >= best.pixels) return best;
    Cut lower = cut({window.x, window.y + upper, window.width, window.height - upper});
    if (lower.pixels >= best.pixels - halves.pixels) return best;
    halves.pixels += lower.pixels;
    std::ranges::move(lower.rows, std::back_inserter(halves.rows));
    return halves;
  }

 private:
  /// As few columns as are allowed, for each more makes a border; no way where even the narrowest are not.
  Cut in_columns(const Window& row) {
    const int most = most_columns(row);
    for (int count = 1;; count = std::min(most, count + (count + 1) / 2)) {
      Cut cut{{columns_of(row, count)}, 0};
      const auto is_allowed = [&](const Window& tile) {
        const Window computed = surroundings_.around(tile);
        cut.pixels += computed.pixels();
        return limits_.allow(computed, row_bytes(limits_, row));
      };
      if (std::ranges::all_of(cut.rows[0], is_allowed)) return cut;
      if (count == most) return {};
    }
  }

  Surroundings& surroundings_;
  const WindowLimits& limits_;
};

/// That one of the windows of the smallest tiles which takes the most memory. Windows of one size take the same.
Window largest_least(const Window& whole, Surroundings& surroundings, const FrameMemory& memory) {
  std::map<std::pair<int, int>, Window> sizes;
  for (int y = 0; y < whole.height; y += kLeastRows)
    for (const auto& tile :
         columns_of({whole.x, whole.y + y, whole.width, std::min(kLeastRows, whole.height - y)}, most_columns(whole))) {
      const Window window = surroundings.around(tile);
      sizes.emplace(std::pair(window.width, window.height), window);
    }
  const auto bytes = [&](const auto& size) { return memory.of(size.second).host; };
  return std::ranges::max_element(sizes, {}, bytes)->second;
}

/// The bytes of host memory of the frame at once, which is read whole where only a region of it is computed.
std::uint64_t bytes_at_once(const FrameSource& source, Surroundings& surroundings, const WindowLimits& limits) {
  return limits.memory.of(surroundings.around(written_of(source))).host + (source.region ? raw_bytes_of(source) : 0);
}

}  // namespace

void require_numbered_lines(const FrameSource& source, const EstimatorSettings& settings) {
  if (!searches_exactly(settings)) return;
  // Slopes times steps from the display window's corner are of the type int: see lines.glsl.
  const std::int64_t farthest = std::numeric_limits<int>::max() / kSlopeUnit - 1;
  const std::int64_t left = std::int64_t(source.reading.data.x) - source.reading.display.x;
  const std::int64_t top = std::int64_t(source.reading.data.y) - source.reading.display.y;
  const std::int64_t reach =
      std::max({-left, -top, left + source.reading.data.width, top + source.reading.data.height}) /
      int(settings.resolution);
  if (reach > farthest)
    fail(ErrorKind::input,
         "{}: its pixels reach {} px from the display window's corner, and an exact search takes at most {}: give "
         "--search steps",
         source.depth_path(), reach, farthest);
}

std::string why_whole(const Settings& settings, bool is_wedge) {
  if (is_wedge)
    return fmt::format("a wedge needs it whole: choose a {}region with --roi", settings.input.roi ? "smaller " : "");
  if (!settings.output.preview.empty()) return "--preview needs it whole: leave it out";
  return settings.output.debug.empty() ? "" : "--set debug needs it whole: leave it out";
}

std::string MemoryNeeds::cost() const {
  return fmt::format("in {} parts, about {} times as long", parts,
                     factor < 10 ? fmt::format("{:.2g}", factor) : fmt::format("{:.0f}", factor));
}

namespace {

MemoryNeeds memory_needs(const FrameSource& source, Surroundings& surroundings, const WindowLimits& limits) {
  const Window& whole = written_of(source);
  const Window row{whole.x, whole.y, whole.width, std::min(whole.height, kLeastRows)};
  MemoryNeeds needs;
  needs.at_once = bytes_at_once(source, surroundings, limits);
  if (limits.memory.beside > 0)
    return {needs.at_once, needs.at_once};  // a picture shows the whole frame, so parts are no help
  WindowLimits smallest = limits;
  smallest.kept = raw_bytes_of(source);
  needs.least =
      smallest.kept + row_bytes(limits, row) + limits.memory.of(largest_least(whole, surroundings, limits.memory)).host;
  smallest.budget = {.bytes = needs.least};
  // All of it at once may take less than such parts.
  const auto cut = needs.least < needs.at_once ? Cutter(surroundings, smallest).cut(whole) : Cutter::Cut();
  if (cut.rows.empty()) return {needs.at_once, needs.at_once};
  needs.parts = 0;
  for (const auto& tiles : cut.rows) needs.parts += tiles.size();
  needs.factor = double(cut.pixels) / double(surroundings.around(whole).pixels());
  return needs;
}

/// The surroundings by a depth that is read when they are asked for. Settles the frame where nobody has.
Surroundings surroundings_of(FrameSource& source, const Settings& settings, const WindowLimits& limits) {
  if (!source.evidence) settle_by_rows(source, settings.input, limits.budget.bytes);
  return {source, settings, [&source](const Window& rows) {
            const auto& channels = source.channels[RawPlane::depth];
            std::vector<float> depth(channels.size() * rows.pixels());
            read_planes(source, rows, {{&channels, depth.data()}});
            return depth;
          }};
}

}  // namespace

MemoryNeeds memory_needs(FrameSource& source, const Settings& settings, const WindowLimits& limits) {
  Surroundings surroundings = surroundings_of(source, settings, limits);
  return memory_needs(source, surroundings, limits);
}

MemoryNeeds tiles_within(FrameSource& source, const Settings& settings, const WindowLimits& limits) {
  const WindowLimits of_parts = limits.in_parts(source, settings);
  Surroundings surroundings = surroundings_of(source, settings, limits);
  const Window& whole = written_of(source);
  MemoryNeeds needs{.parts = 0, .factor = 0};
  for (const auto& row : tiles_of(whole, surroundings, of_parts, source))
    for (const auto& tile : row) {
      needs.parts++;
      needs.factor += double(surroundings.around(tile).pixels()) / double(surroundings.around(whole).pixels());
    }
  return needs;
}

WindowLimits WindowLimits::in_parts(FrameSource& source, const Settings& settings) const {
  WindowLimits limits = *this;
  limits.kept = raw_bytes_of(source);
  if (limits.kept < budget.bytes) return limits;
  refuse(fmt::format("{}: its pixels take {} MiB as they are read: use a smaller frame", source.depth_path(),
                     mebibytes_above(limits.kept)),
         memory_needs(source, settings, limits));
}

bool WindowLimits::is_too_long(const Window& computed) const {
  return std::max(computed.width, computed.height) > longest_side(memory.estimator);
}

bool WindowLimits::allow(const Window& computed, std::uint64_t beside) const {
  if (computed.pixels() > budget.pixels || is_too_long(computed)) return false;
  const FrameMemory::Bytes bytes = memory.of(computed);
  return bytes.host + kept + beside <= budget.bytes && bytes.device <= budget.device_bytes &&
         bytes.buffer <= budget.buffer_bytes;
}

std::string WindowLimits::why_not(const Window& computed) const {
  if (is_too_long(computed))
    return fmt::format("lines of an exact search have at most {} pixels", longest_side(memory.estimator));
  const FrameMemory::Bytes bytes = memory.of(computed);
  if (bytes.host + kept > budget.bytes)
    return fmt::format("{} leaves {} MiB for it, and at once it takes {} MiB",
                       budget.is_chosen ? "--memory" : "half of the free memory", (budget.bytes - kept) / kMebibyte,
                       mebibytes_above(bytes.host));
  if (bytes.buffer > budget.buffer_bytes)
    return fmt::format("the device takes buffers of {} MiB at most", budget.buffer_bytes / kMebibyte);
  return "the device has too little memory for it at once";
}

void WindowLimits::refuse(const std::string& what, const Window& computed) const {
  const std::uint64_t bytes = memory.of(computed).host + kept;
  if (bytes > budget.bytes) refuse(what, MemoryNeeds{bytes, bytes});
  if (is_too_long(computed))
    fail(ErrorKind::device, "{}, or give --search steps, since lines of an exact search have at most {} pixels", what,
         longest_side(memory.estimator));
  fail(ErrorKind::device, "{}, or use another --device, with more memory or larger buffers", what);
}

std::string WindowLimits::option_for(std::uint64_t bytes) const {
  const std::uint64_t without = bytes - std::min(bytes, memory.codec_bytes(budget.bytes));
  std::uint64_t mebibytes = mebibytes_above(budget.program_bytes + without);
  // Terminates: codec memory grows more slowly than the limit, whose last MiB counts too.
  while (without + memory.codec_bytes(mebibytes * kMebibyte - budget.program_bytes) + budget.program_bytes >
         mebibytes * kMebibyte)
    mebibytes++;
  return fmt::format("{}M", mebibytes);
}

void WindowLimits::refuse(const std::string& what, const MemoryNeeds& needs) const {
  const std::string at_once = fmt::format("--memory {}", option_for(needs.at_once));
  fail(budget.is_chosen ? ErrorKind::usage : ErrorKind::device,
       "{}, or let the run take at least {}; {} MiB are for the program itself", what,
       option_for(needs.least) == option_for(needs.at_once)
           ? at_once
           : fmt::format("--memory {} ({}), or {} for all of it at once", option_for(needs.least), needs.cost(),
                         at_once),
       mebibytes_above(budget.program_bytes));
}

TileRows tiles_of(const Window& whole, Surroundings& surroundings, const WindowLimits& limits,
                  const FrameSource& source) {
  if (auto cut = Cutter(surroundings, limits).cut(whole); !cut.rows.empty()) return std::move(cut.rows);
  const std::string what =
      fmt::format("{}: a tile depends on too many pixels to compute at once: give a smaller --radius{}",
                  source.depth_path(), surroundings.reaches_beyond_radius() ? " or --set shadow-reach" : "");
  const MemoryNeeds needs = memory_needs(source, surroundings, limits);
  if (needs.least > limits.budget.bytes) limits.refuse(what, needs);
  limits.refuse(what, largest_least(whole, surroundings, limits.memory));
}

}  // namespace alcove
