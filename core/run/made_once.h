// Values of frames that several frames take: each is made once, by whoever needs it first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace alcove {

/// Any thread may ask. One that needs what another one makes makes what nobody is at, and only then waits.
template <class T>
class MadeOnce {
 public:
  using Value = std::shared_ptr<const T>;

  /// Those of the frames, in their order. Fails as `make` does: the next one that needs the value tries again.
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

  /// Lets the others go.
  void keep(const std::function<bool(int)>& is_kept) {
    const std::lock_guard lock(mutex_);
    std::erase_if(values_, [&](const auto& value) { return value.second && !is_kept(value.first); });
  }

  /// The number of those that are kept or in the making.
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
  std::map<int, Value> values_;  // null: in the making
};

}  // namespace alcove
