// Lanes: where one frame after the other is computed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/chain/reuse.h"
#include "core/gpu/recorder.h"
#include "core/run/shot.h"

namespace alcove {

/// Where one frame after the other is computed: its buffers, and what they still hold.
struct Lane {
  explicit Lane(gpu::Device& device) : gpu(device) {}

  gpu::Recorder gpu;
  LastFrame last;
  EstimateSlots estimates;
};

/// One lane for each frame in flight, whose buffers are kept from frame to frame. Each lane on a CPU has a device of
/// its own, so that every frame has a core of its own from its first byte to its last, and no frame waits for another.
/// A GPU is shared by all lanes.
class Lanes {
  struct Place {
    gpu::Device* device;
    std::unique_ptr<Lane> lane;  // null: without buffers
  };

 public:
  Lanes(const gpu::DeviceOptions& options, int count);

  gpu::Device& device() { return *devices_.front(); }
  int count() const;
  int validation_messages() const;

  /// Changes the number of lanes. The buffers of those that nobody uses are given back.
  void set_count(int count);

  /// A lane that nobody else uses. At most count() threads may have one at once.
  class Lease {
   public:
    explicit Lease(Lanes& lanes);
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();

    Lane& lane() { return *place_.lane; }
    /// Leaves the lane its buffers for the next frame; else they are given back with it.
    void keep_buffers() { keeps_buffers_ = true; }

   private:
    Lanes& lanes_;
    Place place_;
    bool keeps_buffers_ = false;
  };

 private:
  Place take();
  void give_back(Place place);

  gpu::DeviceOptions options_;
  int count_;
  mutable std::mutex mutex_;  // of all that may change
  std::vector<std::unique_ptr<gpu::Device>> devices_;
  std::vector<Place> free_;
  bool is_first_taken_ = false;
};

}  // namespace alcove
