// Settles a frame: the pixels decide the questions that settings and camera leave open (kind and sign of depth, space
// and encoding of normals), and show faults.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/evidence.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

/// Settles the open questions of `source` by its depth and normals, and adds to its notes. Never overrules the settings
/// or the camera file. Fails with ErrorKind::input if the pixels speak for two readings or against all, and names the
/// options that decide; under settings.strict, on every guess. Fails with ErrorKind::usage if near or far are missing.
void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw);
/// Does the same, with the evidence in `seen` instead of the source; if it fails, `seen` has the evidence so far.
void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen);

/// The most pixels that a frame is settled by.
constexpr std::size_t kEvidencePixels = std::size_t(1) << 24;

/// Settles a frame by planes of all its pixels. If they are more than kEvidencePixels, or their results take more than
/// `most_bytes`, rows from the middle decide. Fails as settle() does.
void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Does the same by planes that it reads itself: of all rows, or of as many from the middle as fit into `most_bytes`.
/// Fails with ErrorKind::device too, if a single row holds more than kEvidencePixels.
void settle_by_rows(FrameSource& source, const InputSettings& settings,
                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Settles a frame as another one of its sequence is settled. Returns false if it has other planes: then it must be
/// settled by itself.
bool settle_like(FrameSource& source, const FrameSource& settled);

/// Whether the normals are vectors in x, y and z, so that they have lengths.
bool has_lengths(const FrameSource& source);

/// The word of --normal-encoding for normals of a frame that is settled.
const char* encoding_name(NormalEncoding encoding, bool unorm);

// Shared by the steps that settle a frame.

/// The usual reading stays where its score is at least this part of the best one.
inline constexpr double kAsGood = 0.8;
/// Another reading is taken only where it is this many times as good as the second best.
inline constexpr double kClear = 2;
/// The least share of the normals that must agree with depth. Some reading reaches half by chance: rooms have three
/// directions.
inline constexpr double kLeastAgreement = 0.6;
/// If a smaller share of the normals agrees with depth, they are not of this depth or not of this camera. Chance gives
/// some 5 %. Measured: 12 frames of rendered scenes and games that were read rightly gave 87 % and more; 30 wrongly
/// turned cameras gave 37 % at most, and 25 % but for one.
inline constexpr double kRefuted = 0.1;

/// A frame that is being settled, by planes of depth and normals as they were read.
class Settlement {
 public:
  /// Messages name the file of the plane `about`.
  Settlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen,
             RawPlane about = RawPlane::depth);

 protected:
  const std::string& depth_path() const { return source_.depth_path(); }
  const std::string& normal_path() const { return source_.path_of(RawPlane::normal); }

  /// Takes down a choice, and notes an unusual one: with a warning unless the pixels prove it.
  void take_down(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
                 bool unusual, bool proven);
  /// Does the same for a guess. Fails with ErrorKind::input under --strict.
  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual, bool proven = false);
  void note(NoteCode code, std::string text);

  FrameSource& source_;
  Reading& reading_;
  const InputSettings& settings_;
  const RawPart& raw_;
  Evidence& seen_;
  View view_;

 private:
  const RawPlane about_;
};

/// Settles kind and sign of the depth, or the space of positions.
void settle_depth(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen);

/// Settles encoding and space of the normals of a frame whose depth is settled. Refuses
/// normals that depth and camera refute.
void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen);

/// Notes a principal point beside the centre that the pixels neither confirm nor refute.
void note_centre(FrameSource& source);

}  // namespace alcove
