// Which frames of a run are computed now, and which one is next: what frames share is kept for these alone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <span>
#include <vector>

namespace alcove {

/// The frames of a run, from the order in which they are begun to their end.
class FramesInWork {
 public:
  explicit FramesInWork(std::span<const int> frames) : left_(frames.begin(), frames.end()) {}

  void begin(int frame) { begun_.insert(frame); }
  void done(int frame);

  /// Whether it is not done yet.
  bool is_left(int frame) const;
  /// Those that are begun and not done, and the first one that is not begun.
  std::vector<int> now_and_next() const;

 private:
  std::vector<int> left_;  // in their order
  std::set<int> begun_;    // of them
};

}  // namespace alcove
