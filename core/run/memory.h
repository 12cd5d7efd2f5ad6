// The memory of a frame, before its pixels are read; and the memory limit of a run, with the number of frames that it
// allows at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/settings.h"
#include "core/chain/results/outputs.h"
#include "core/frame/find/frame_source.h"
#include "core/gpu/device.h"
#include "core/run/plan.h"

namespace alcove {

/// The part of a frame's memory that the codec of one of its files may take.
constexpr std::uint64_t kCodecPart = 8;

/// Rows of a frame's results that are written together. No compression takes more.
constexpr int kRowsWritten = 256;

/// The longest side of a window, in pixels, for the passes of these settings: the marks of an exact search hold the
/// step along a line in 16 bits.
int longest_side(const EstimatorSettings& settings);

/// The memory that windows of a frame take while they are computed.
struct FrameMemory {
  /// Upper bounds, in bytes.
  struct Bytes {
    std::uint64_t device;  // of the device's own memory: all buffers
    std::uint64_t host;    // buffers or their staging twins, and planes that are read, shown and written
    std::uint64_t buffer;  // of the largest buffer
  };
  /// Rehearses the chain for a window.
  Bytes of(const Window& computed) const;
  /// Host memory of the codecs of the frame's files if `budget` bytes are left for the frame.
  std::uint64_t codec_bytes(std::uint64_t budget) const;
  /// Takes over the settings. An unknown radius counts as 1.
  void take(const Settings& settings);

  Reading reading;
  Window file_data;
  RawPlaneArray<std::size_t> channels;
  EstimatorSettings estimator;
  Wanted wanted;
  bool looks_at_others = false;
  bool is_cropped = false;  // a region of it is written

  std::uint64_t beside = 0;                 // in host memory beside buffers, for each pixel
  std::uint64_t written = 0;                // of the planes that are written, for each pixel
  std::vector<std::uint64_t> codec_groups;  // bytes of the rows that each codec takes together
  std::uint64_t fixed_on_device = 0;        // in buffers, whatever the window
  std::uint64_t fixed_bytes = 0;  // in host memory whatever the window: codecs, and files that are kept decoded
};
FrameMemory memory_of(const FrameSource& source, const Settings& settings);

/// The bytes of all planes of a frame, as they are read.
std::uint64_t raw_bytes_of(const FrameSource& source);

// What a run may take.

/// The memory that a run, or one frame in flight, may take: as much as the user says, or half of the free memory.
struct MemoryBudget {
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t bytes = 0;                // of host memory, left for frames
  std::uint64_t device_bytes = kEndless;  // of buffers in the device's own memory; no limit where it is the host's
  std::uint64_t buffer_bytes = kEndless;  // of one buffer of the device
  std::uint64_t pixels = kEndless;        // at once: fewer than those for which the device had no memory
  std::uint64_t program_bytes = 0;        // of host memory: the process with one lane, and without frames
  std::uint64_t lane_bytes = 0;           // of host memory: each further lane without its frame
  bool is_chosen = false;                 // the user has said how much
};

/// For an unknown device: assumes the CPU, which needs the most host memory.
MemoryBudget memory_of_host(const Settings& settings);
MemoryBudget memory_for_frames(const Settings& settings, const gpu::DeviceInfo& device);

/// The room of each of `lanes` frames in flight.
MemoryBudget budget_of_lane(MemoryBudget memory, int lanes);

// Other frames of a shot.

/// The largest number of other frames and views that a frame uses.
std::size_t most_others(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings);

/// The memory of a frame of the plan, with the memory that its lane takes for the frame's others.
FrameMemory memory_with_others(const FramePlan& plan, const FrameSource& frame, const Settings& settings);

/// Bytes of host memory of the prepared frames that so many lanes keep.
std::uint64_t bytes_of_shot(const FramePlan& plan, const FrameSource& frame, const InputSettings& settings, int lanes);

/// Bytes of host memory of the estimates that so many lanes keep for the means of these frames. The frames are computed
/// in this order.
std::uint64_t bytes_of_estimates(const FramePlan& plan, const FrameSource& frame, const Settings& settings,
                                 std::span<const int> frames, int lanes);

/// The memory without the part for prepared frames and estimates.
MemoryBudget without_shared_frames(MemoryBudget memory, const FramePlan& plan, const FrameSource& frame,
                                   const Settings& settings, std::span<const int> frames, int lanes);

/// The number of these frames, up to `most`, that the memory has room for at once.
int frames_at_once(const MemoryBudget& memory, const FramePlan& plan, const FrameSource& frame,
                   const Settings& settings, std::span<const int> frames, int most);

/// The threads of the process: as many as --threads says, else one per core.
int threads_of(const DeviceSettings& settings);

/// Fails if the memory has no room for the frames around one: with ErrorKind::usage if --memory was given, else with
/// ErrorKind::device. The message names the number of frames that fit, and the memory that is enough.
void require_room_for_others(const MemoryBudget& memory, const FramePlan& plan, const FrameSource& frame,
                             const Settings& settings, std::span<const int> frames);

/// Fails with ErrorKind::device if a plane of a frame does not fit into a buffer of `most_bytes`. A frame for others is
/// prepared whole: only computed frames are cut into tiles.
void require_buffers_for_others(std::uint64_t most_bytes, const FrameSource& frame, const Settings& settings);

}  // namespace alcove
