// Lanes: each computes one frame after the other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/chain/reuse.h"
#include "core/gpu/recorder.h"
#include "core/run/estimates.h"

namespace alcove {

/// The buffers of one frame after the other, and their contents from the frame before.
struct Lane {
  explicit Lane(gpu::Device& device) : gpu(device) {}

  gpu::Recorder gpu;
  LastFrame last;
  EstimateSlots estimates;
};

/// One lane for each frame in flight. A lane keeps its buffers from frame to frame. On a CPU each lane has a device of
/// its own, so that every frame has a core from its first byte to its last. A GPU is shared by all lanes.
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

  /// Changes the number of lanes. Idle lanes release their buffers.
  void set_count(int count);

  /// Exclusive use of a lane. At most count() threads may have one at once.
  class Lease {
   public:
    explicit Lease(Lanes& lanes);
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease();

    Lane& lane() { return *place_.lane; }
    /// Keeps the lane's buffers for the next frame. Without this call, the end of the lease releases the buffers.
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
