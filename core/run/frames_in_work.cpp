// Follows the frames of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/frames_in_work.h"

#include <algorithm>

namespace alcove {

void FramesInWork::done(int frame) {
  std::erase(left_, frame);
  begun_.erase(frame);
}

bool FramesInWork::is_left(int frame) const { return std::ranges::find(left_, frame) != left_.end(); }

std::vector<int> FramesInWork::now_and_next() const {
  std::vector<int> frames(begun_.begin(), begun_.end());
  const auto next = std::ranges::find_if(left_, [&](int frame) { return !begun_.contains(frame); });
  if (next != left_.end()) frames.push_back(*next);
  return frames;
}

}  // namespace alcove
