// Finds cuts between estimates, packs estimates as kernels take them, and keeps the frames that others use.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/estimates.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

namespace alcove {
namespace {

// Cuts: where frames agree and where they contradict each other, on a grid of pixels.

constexpr int kGridColumns = 32, kGridRows = 18;  // of the grid
constexpr double kSameWidths = 3;                 // pixels' widths by which depths of one surface differ at most
constexpr double kSamePrecisions = 4;             // the same, of what depths may be off: see reprojection.glsl

struct Agreement {
  int same = 0, past = 0;  // of the grid's pixels
};

double depth_error_at(const EstimatedFrame& frame, double z) {
  const vec3& error = frame.depth_precision;
  return error.x + z * (error.y + z * double(error.z));
}

double depth_at(const EstimatedFrame& frame, int x, int y) {
  return std::abs(double(frame.depth[std::size_t(y) * std::size_t(frame.view.size.x) + std::size_t(x)]));
}

/// Where `to` sees what is at a pixel of `from`: it sees the same in one of three by three pixels, or past it in all.
void look(const EstimatedFrame& from, const EstimatedFrame& to, const ViewMap& map, int x, int y, Agreement& seen) {
  const double z = depth_at(from, x, y);
  if (z >= double(kSkyDepth)) return;
  const View& b = to.view;
  const SeenAt there = seen_from(b, map, from.view, x + 0.5, y + 0.5, z);
  const double distance = there.depth, width = double(b.tangent_per_pixel.x) * (b.orthographic != 0 ? 1 : distance);
  if (distance <= 0) return;
  const double column = std::floor(there.x), row = std::floor(there.y);
  if (!(column >= 1 && row >= 1 && column < b.size.x - 1 && row < b.size.y - 1)) return;
  const double margin =
      kSameWidths * width + kSamePrecisions * (depth_error_at(from, z) + depth_error_at(to, distance));
  bool same = false, past = true;
  for (int j = int(row) - 1; j <= int(row) + 1; j++)
    for (int i = int(column) - 1; i <= int(column) + 1; i++) {
      const double farther = depth_at(to, i, j) - distance;
      same = same || std::abs(farther) <= margin;
      past = past && farther > margin;
    }
  seen.same += same;
  seen.past += past;
}

/// What `to` sees of `from`.
void look(const EstimatedFrame& from, const EstimatedFrame& to, Agreement& seen) {
  const ViewMap map = view_from_view(to.camera, from.camera);
  for (int j = 0; j < kGridRows; j++)
    for (int i = 0; i < kGridColumns; i++)
      look(from, to, map, (2 * i + 1) * from.view.size.x / (2 * kGridColumns),
           (2 * j + 1) * from.view.size.y / (2 * kGridRows), seen);
}

}  // namespace

bool is_cut_between(const EstimatedFrame& a, const EstimatedFrame& b) {  // on a grid of pixels of both
  Agreement seen;
  look(a, b, seen);
  look(b, a, seen);
  return seen.past > seen.same;
}

namespace {

// Slots.

std::size_t planes_in(const EstimatedFrame& frame) { return frame.values.size() / frame.depth.size(); }

/// See NeighbourFrame.
std::size_t words_of(const EstimatedFrame& frame) { return frame.depth.size() * (2 + planes_in(frame) / 2); }

/// Of a value in [0, 1].
std::uint32_t half_word(float value) { return std::uint32_t(std::clamp(value, 0.0f, 1.0f) * 65535.0f + 0.5f); }

/// A coordinate of a packed normal with 8 bits instead of 16.
std::uint32_t shorter(std::uint32_t bits) {
  return std::uint32_t(std::clamp((int(std::int16_t(bits)) + 128) >> 8, -127, 127)) & 0xffu;
}

std::uint32_t taken_normal(std::uint32_t packed) {
  constexpr std::uint32_t kNoNormal = 0x80008000;  // see normal.glsl
  return packed == kNoNormal ? kNoTakenNormal : shorter(packed & 0xffffu) | shorter(packed >> 16) << 8;
}

NeighbourFrame seen_as(const EstimatedFrame& other, const EstimatedFrame& own, std::size_t first) {
  const ViewMap map = view_from_view(other.camera, own.camera);
  const auto row = [&](std::size_t i) { return vec3{float(map[i][0]), float(map[i][1]), float(map[i][2])}; };
  const vec3 &a = other.depth_precision, &b = own.depth_precision;
  return {other.view,
          row(0),
          row(1),
          row(2),
          {float(map[0][3]), float(map[1][3]), float(map[2][3])},
          {a.x + b.x, a.y + b.y, a.z + b.z},
          uint(first)};
}

void put(const EstimatedFrame& frame, std::span<std::uint32_t> words) {
  const std::size_t pixels = frame.depth.size(), planes = planes_in(frame);
  std::ranges::transform(frame.depth, words.begin(), [](float z) { return std::bit_cast<std::uint32_t>(z); });
  const auto value = [&](std::size_t plane, std::size_t i) {
    return plane < planes ? half_word(frame.values[plane * pixels + i]) : 0u;
  };
  for (std::size_t i = 0; i < pixels; i++) words[pixels + i] = taken_normal(frame.normal[i]) | value(0, i) << 16;
  for (std::size_t plane = 1; plane < planes; plane += 2)
    for (std::size_t i = 0; i < pixels; i++)
      words[(2 + plane / 2) * pixels + i] = value(plane, i) | value(plane + 1, i) << 16;
}

}  // namespace

EstimateSet EstimateSlots::filled(gpu::Recorder& gpu, const FramePlan& plan, const NeighbourEstimates& taken, int frame,
                                  std::uint64_t most_bytes) {
  EstimateSet result;
  if (taken.of.empty()) return result;
  const EstimatedFrame& own = taken.own(frame);
  result.depth = &uploaded(gpu, "own depth", own.depth);
  result.normal = &uploaded(gpu, "own normal", own.normal);
  result.values = &uploaded(gpu, "own values", own.values);
  result.view = own.view;
  result.has_moving = std::ranges::any_of(taken.of, [](const auto& estimated) { return estimated->has_moving; });
  std::size_t stride = 0;
  for (const auto& estimated : taken.of) stride = std::max(stride, words_of(*estimated));
  const std::size_t slots = std::size_t(plan.turns()), bytes = stride * sizeof(std::uint32_t);
  const std::size_t together =
      std::clamp<std::size_t>(most_bytes / bytes, 1, std::min<std::size_t>(slots, kMostNeighbours));
  groups_.resize((slots + together - 1) / together);
  for (std::size_t i = 0; i < groups_.size(); i++) {
    Group& group = groups_[i];
    gpu::Buffer& planes = gpu.buffer(fmt::format("estimates {}", i), together * bytes, gpu::Use::upload);
    gpu::Buffer& table =
        gpu.buffer(fmt::format("estimated frames {}", i), together * sizeof(NeighbourFrame), gpu::Use::upload);
    const bool is_as_before =
        group.buffer == planes.host().data() && group.stride == stride && group.held.size() == together;
    if (!is_as_before) group.held.assign(together, {});
    group.buffer = planes.host().data();
    group.stride = stride;
    uint count = 0;
    for (const auto& estimated : taken.of) {
      const std::size_t slot = std::size_t(plan.slot_of(estimated->frame));
      if (slot / together != i || estimated->frame == frame) continue;
      const std::size_t first = slot % together * stride;
      if (group.held[slot % together].lock() != estimated)
        put(*estimated, planes.as<std::uint32_t>().subspan(first, stride));
      group.held[slot % together] = estimated;
      table.as<NeighbourFrame>()[count++] = seen_as(*estimated, own, first);
    }
    if (count == 0) continue;
    // All but the frame itself, where nothing is cut away or missing.
    const std::size_t room = std::min(together, slots - i * together);
    const uint listed = std::max(count, uint(room) - 1);
    const auto frames = table.as<NeighbourFrame>();
    std::fill(frames.begin() + count, frames.begin() + listed, frames.front());
    result.groups.push_back({&planes, &table, count, listed});
  }
  return result;
}

const EstimatedFrame& NeighbourEstimates::own(int frame) const {
  return **std::ranges::find_if(of, [&](const auto& estimated) { return estimated->frame == frame; });
}

std::string text_of(const NeighbourEstimates& taken) {
  Neighbours others;
  for (const auto& estimated : taken.of) others.frames.push_back(estimated->frame);
  others.missing = taken.missing;
  return text_of(others);
}

NeighbourEstimates SharedFrames::estimates_of(int frame, const std::function<EstimatedFrame(int)>& estimate) {
  const FramesAround window = plan_.accumulated(frame);
  NeighbourEstimates taken{{}, estimated_.of(window.there, estimate), window.missing};
  {
    const std::lock_guard lock(mutex_);
    if (auto read = read_.extract(frame)) taken.read = std::move(read.mapped());
  }
  const EstimatedFrame& own = taken.own(frame);
  std::erase_if(taken.of, [&](const auto& other) { return other->frame != frame && is_cut_between(own, *other); });
  return taken;
}

void SharedFrames::keep_planes(int frame, ReadPlanes&& read) {
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(left_, frame) != left_.end()) read_.insert_or_assign(frame, std::move(read));
}

void SharedFrames::begin(int frame) {
  const std::lock_guard lock(mutex_);
  begun_.insert(frame);
}

void SharedFrames::done(int frame) {
  const std::lock_guard lock(mutex_);
  std::erase(left_, frame);
  begun_.erase(frame);
  // Those that take something now, and the next one.
  std::vector<int> takers(begun_.begin(), begun_.end());
  const auto next = std::ranges::find_if(left_, [&](int other) { return !begun_.contains(other); });
  if (next != left_.end()) takers.push_back(*next);
  const std::vector<int>& shot = plan_.shot();
  const auto place_of = [&](int number) { return std::ranges::lower_bound(shot, number) - shot.begin(); };
  const InputSettings input = plan_.at(frame).input;
  const std::int64_t reach = std::int64_t(farthest_seen(around_of(input))) + 2 * std::int64_t(input.accumulate);
  const auto is_seen = [&](int other) {
    return std::ranges::any_of(takers, [&](int taker) { return std::abs(place_of(taker) - place_of(other)) <= reach; });
  };
  const auto is_taken = [&](int other) {
    return std::ranges::any_of(takers, [&](int taker) { return plan_.is_accumulated(other, taker); });
  };
  views_.keep(is_seen);
  estimated_.keep(is_taken);
  std::erase_if(read_, [&](const auto& read) { return !is_taken(read.first); });
}

}  // namespace alcove
