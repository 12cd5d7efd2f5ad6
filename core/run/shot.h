// What the frames of a shot see of each other: every frame is read and prepared once for all that it lies around.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/chain/other_views.h"
#include "core/frame/gbuffer.h"
#include "core/gpu/recorder.h"
#include "core/run/frames_in_work.h"
#include "core/run/plan.h"

namespace alcove {

/// What one view of a frame sees, in host memory.
struct SeenFrame {
  Camera camera;
  Window data, display;
  View view{};
  vec3 depth_precision{};
  std::vector<float> depth;           // planar; kSkyDepth for sky
  std::vector<std::uint32_t> normal;  // packed, in its own view space
  std::uint64_t hash = 0;             // of both planes
};

/// What of a frame counts in no other one.
struct Movement {
  std::vector<std::uint32_t> flags;  // of each pixel, see OtherView::moving
  std::uint64_t hash = 0;            // of them
};

/// What a frame takes from others.
struct Others {
  std::vector<OtherView> seen;
  std::vector<int> frames, missing;  // around it: those that it takes, and those that are not there
  std::vector<std::string> views;    // that it takes of its own instant
};

/// Names them, for a header; empty where it takes none: "frames 3-5, 7; missing 6; views right".
std::string text_of(const Others& others);

/// What it took to prepare others.
struct PreparedOthers {
  std::uint64_t rows_read = 0;
  std::vector<gpu::PassTime> passes = {};
};

/// Fails with ErrorKind::input where nobody knows where a frame's camera stands.
void require_place(const FrameSource& source, int frame, const char* option);

/// Whether frames look at others of the shot for more than their estimates; and whether they look at these or at views.
bool takes_frames(const InputSettings& settings);
bool takes_others(const InputSettings& settings);

/// Frames that are prepared, and kept for as long as a frame needs them that is being computed, or the next one: see
/// SharedEstimates. What one takes from others is the same whatever lane asks, and in whatever order.
class SharedFrames {
 public:
  /// `frames` are those that are to be computed, in their order; each must be told of by begin() and done(). All are
  /// read as `settled` is; null: each by itself.
  SharedFrames(const FramePlan& plan, const FrameSource* settled, std::span<const int> frames);

  /// Gives what a frame takes from others, in upload buffers of the recorder, which is free before and after. Fails
  /// with ErrorKind::input, naming the file, where one of them cannot be read or its camera says not where it stands.
  Others others_of(gpu::Recorder& gpu, const FrameSource& target, int frame, PreparedOthers& took);

  /// What of a frame moves by its motion vectors: 1 for each pixel that does, and up to `around` pixels beside it, else
  /// 0. None where the settings name no vectors, and at an end of the shot where they lead out of it. Fails as
  /// others_of() does, and where no reading of the vectors is right.
  std::optional<std::vector<std::uint8_t>> moving_by_vectors(gpu::Recorder& gpu, int frame, PreparedOthers& took,
                                                             int around = 0);

  /// From here on what this frame takes is kept.
  void begin(int frame);
  /// No one will ask for what this frame takes.
  void done(int frame);

  /// Frames that are kept now.
  std::size_t kept() const;

 private:
  struct Entry {
    std::mutex preparing, judging;  // judging is locked first
    std::shared_ptr<const SeenFrame> seen;
    std::shared_ptr<const Movement> moving;
  };
  using Seen = std::shared_ptr<const SeenFrame>;

  std::shared_ptr<Entry> entry_of(int frame);
  using Moving = std::shared_ptr<const Movement>;
  struct Judged {
    Seen seen;
    Moving moving;
  };

  std::vector<Judged> frames_around(gpu::Recorder& gpu, const FrameSource& target, int frame, Others& others,
                                    PreparedOthers& took);
  std::vector<Judged> other_views(gpu::Recorder& gpu, const FrameSource& target, int frame, Others& others,
                                  PreparedOthers& took) const;
  Seen seen(gpu::Recorder& gpu, int frame, PreparedOthers& took);
  /// The entry's preparing is locked.
  Seen seen_in(Entry& entry, gpu::Recorder& gpu, int frame, PreparedOthers& took) const;
  /// What moves as the witnesses tell, or cannot stand for its surface.
  static std::vector<std::uint32_t> judged(gpu::Recorder& gpu, const SeenFrame& seen, std::span<const Seen> witnesses,
                                           PreparedOthers& took);
  Moving moving(gpu::Recorder& gpu, int frame, PreparedOthers& took);
  void prepare_free_ones(gpu::Recorder& gpu, std::span<const int> frames, PreparedOthers& took);
  /// `option`: by which it is taken.
  Seen prepare(gpu::Recorder& gpu, const InputSettings& settings, const FrameSource* like, int frame,
               const char* option, PreparedOthers& took) const;

  const FramePlan& plan_;
  const FrameSource* settled_;
  mutable std::mutex mutex_;  // of all below
  std::map<int, std::shared_ptr<Entry>> entries_;
  FramesInWork in_work_;
};

/// The frames that tell what moves in one, of which frames take what stands still.
std::vector<int> judges_of(const FramePlan& plan, int frame);
/// How many of them there are at most, where so many frames to each side are taken.
int most_judges(int count);

/// All frames that change what a frame takes: those around it, and their judges. In order.
std::vector<int> frames_seen_for(const FramePlan& plan, int frame);
/// How far from a frame they lie at most, in frames of the shot.
int with_judges(int count);

}  // namespace alcove
