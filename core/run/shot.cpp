// Keeps and releases the frames that others of a shot use.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/shot.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "core/run/shot_frames.h"

namespace alcove {

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
