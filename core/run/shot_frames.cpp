// Numbers of frames that detect movement, are prepared and are estimated.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/shot_frames.h"

#include <algorithm>
#include <set>

namespace alcove {
namespace {

/// The least number of frames on each side that detect motion in a frame. More do if more are used: a thing that rests
/// for a while is detected only by frames that see the place before it comes or after it has left.
constexpr int kLeastWitnesses = 2;

int witnesses_to_each_side(int count) { return std::max(count, kLeastWitnesses); }

}  // namespace

bool takes_frames(const InputSettings& settings) {
  const bool asks_vectors = settings.accumulate > 0 && !settings.motion.empty();
  return around_of(settings) > 0 || asks_vectors;
}

bool takes_others(const InputSettings& settings) { return takes_frames(settings) || settings.other_views; }

std::vector<int> seen_around(const FramePlan& plan, int frame) {
  const int count = around_of(plan.at(frame).input);
  const std::vector<int> around = plan.around(frame, count).there;
  if (count == kWholeShot) return around;
  std::set<int> seen(around.begin(), around.end());
  for (const int other : around)
    for (const int witness : witnesses_of(plan, other)) seen.insert(witness);
  seen.erase(frame);
  return {seen.begin(), seen.end()};
}

std::vector<int> witnesses_of(const FramePlan& plan, int frame) {
  return plan.nearest(frame, witnesses_to_each_side(around_of(plan.at(frame).input)));
}

int most_witnesses(int count) { return count == kWholeShot ? count : 2 * witnesses_to_each_side(count); }

std::vector<int> frames_seen_for(const FramePlan& plan, int frame) {
  std::vector<int> first = plan.accumulated(frame).there;
  if (first.empty()) return seen_around(plan, frame);
  const InputSettings input = plan.at(frame).input;
  std::set<int> seen(first.begin(), first.end());
  for (const int estimated : first) {
    const std::vector<int> around = seen_around(plan, estimated);
    seen.insert(around.begin(), around.end());
    // Vectors are proved by the frames beside theirs.
    if (input.motion.empty()) continue;
    const std::vector<int> beside = plan.around(estimated, 1).there;
    seen.insert(beside.begin(), beside.end());
  }
  seen.erase(frame);
  return {seen.begin(), seen.end()};
}

SharedCounts shared_counts(const FramePlan& plan, std::span<const int> frames) {
  std::set<int> prepared, estimated;
  const auto add = [](std::set<int>& all, const std::vector<int>& more) { all.insert(more.begin(), more.end()); };
  for (const int frame : frames) add(estimated, plan.accumulated(frame).there);
  const std::set<int> takers = estimated.empty() ? std::set<int>(frames.begin(), frames.end()) : estimated;
  const InputSettings& input = plan.settings().input;
  for (const int taker : takers) {
    const std::vector<int> around =
        around_of(input) > 0 ? plan.around(taker, around_of(input)).there : std::vector<int>();
    add(prepared, around);
    for (const int other : around) add(prepared, witnesses_of(plan, other));
    // Vectors are proved by the frames beside theirs.
    if (estimated.empty() || input.motion.empty()) continue;
    add(prepared, {taker});
    add(prepared, plan.around(taker, 1).there);
  }
  return {prepared.size(), estimated.size()};
}

int farthest_seen(int count) {
  const int witnesses = witnesses_to_each_side(count);
  // At the ends of the shot they all lie on one side.
  return count == kWholeShot ? count : std::max(count + witnesses, 2 * witnesses);
}

}  // namespace alcove
