// Values that several threads need, each made once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace alcove {

/// Values of frames that several frames take: each is made once, by the first thread that needs it. Any thread may ask.
/// A thread whose value is being made elsewhere makes another missing value first, then waits.
template <class T>
class SharedCache {
 public:
  using Value = std::shared_ptr<const T>;

  /// The values of the frames, in their order. Fails as `make` does; the next thread that needs the value tries again.
  std::vector<Value> of(std::span<const int> frames, const std::function<T(int)>& make) {
    std::vector<Value> values(frames.size());
    std::unique_lock lock(mutex_);
    while (true) {
      bool are_all = true;
      std::optional<int> free;
      for (std::size_t i = 0; i < frames.size(); i++) {
        const auto known = values_.find(frames[i]);
        if (!values[i] && known != values_.end()) values[i] = known->second;
        if (!values[i] && known == values_.end() && !free) free = frames[i];
        are_all = are_all && values[i];
      }
      if (are_all) return values;
      if (free)
        make_one(*free, make, lock);
      else
        changed_.wait(lock);
    }
  }

  /// Drops all values whose frame is not kept.
  void keep(const std::function<bool(int)>& is_kept) {
    const std::lock_guard lock(mutex_);
    std::erase_if(values_, [&](const auto& value) { return value.second && !is_kept(value.first); });
  }

  /// The number of values that exist or are being made.
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return values_.size();
  }

 private:
  void make_one(int frame, const std::function<T(int)>& make, std::unique_lock<std::mutex>& lock) {
    values_[frame] = nullptr;
    lock.unlock();
    try {
      auto made = std::make_shared<const T>(make(frame));
      lock.lock();
      values_[frame] = std::move(made);
    } catch (...) {
      lock.lock();
      values_.erase(frame);
      changed_.notify_all();
      throw;
    }
    changed_.notify_all();
  }

  mutable std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::map<int, Value> values_;  // null: being made
};

}  // namespace alcove
