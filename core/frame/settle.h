// Decides by the pixels what settings and camera leave open about a frame: kind and sign of depth, space and encoding
// of normals; and what is suspicious about them.
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
#include "core/frame/gbuffer.h"

namespace alcove {

/// Settles what is open in `source`, from the planes of depth and normals as they were read, and adds to its guesses
/// and notes. What the settings or the camera file say is never overruled. Fails with ErrorKind::input where the pixels
/// speak for two ways or against all, naming the options that decide; under settings.strict, wherever there is a guess.
/// Near or far that are missing are ErrorKind::usage.
void settle(FrameSource& source, const InputSettings& settings, const RawPart& raw);

/// The most pixels that a frame is settled by.
constexpr std::size_t kEvidencePixels = std::size_t(1) << 24;

/// Settles a frame by planes that are there. Where so many bytes, or kEvidencePixels, are too few for
/// what is made of them, rows from the middle decide. Fails as settle() does.
void settle_by_planes(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                      std::span<const float> normal,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Does the same by planes that it reads itself: of all rows, or of those from the middle that so many bytes have room
/// for. Fails with ErrorKind::device too where a single row holds more than kEvidencePixels.
void settle_by_rows(FrameSource& source, const InputSettings& settings,
                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Settles a frame as another one of its sequence is settled. False: it has other planes, so it must be settled by
/// itself.
bool settle_like(FrameSource& source, const FrameSource& settled);

/// Whether the normals are vectors in x, y and z, which have a length to look at.
bool has_lengths(const FrameSource& source);

/// The word of --normal-encoding for normals of a frame that is settled.
const char* encoding_name(NormalEncoding encoding, bool unorm);

/// Gives the share of the rows' steps from one surface to another that take a pixel in between. It is near 0 for point
/// samples, near 1 where pixels were averaged, and 0 if there are too few steps to tell. `planar` is infinite on sky.
double blended_edges(std::span<const float> planar, int width);

// What the steps of settling a frame share.

/// The usual reading stays where its score is at least this part of the best one.
inline constexpr double kAsGood = 0.8;
/// Another reading is taken only where it is this many times as good as the second best.
inline constexpr double kClear = 2;
/// So many of the normals must agree with depth. Some reading reaches half by chance, as rooms have three directions.
inline constexpr double kLeastAgreement = 0.6;
/// If fewer of the normals agree with depth, they are not of this depth or not of this camera. Chance gives some 5 %.
/// Of 12 frames of rendered scenes and games that were read rightly the least was 87 %; by 30 wrongly turned cameras it
/// was 37 % at most, and 25 % but for one.
inline constexpr double kRefuted = 0.1;

/// A frame that is being settled, by planes of depth and normals as they were read.
class Settlement {
 public:
  /// `about` is the plane whose file is named by what is said.
  Settlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, RawPlane about = RawPlane::depth);

 protected:
  const std::string& depth_path() const { return source_.depth_path(); }
  const std::string& normal_path() const { return source_.files[source_.channels[RawPlane::normal][0].file].path(); }

  /// Takes down what was chosen; `unusual` guesses are noted too, with a warning unless nothing speaks against them.
  void take_down(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
                 bool unusual, bool proven);
  /// The same of what is no more than a guess. Fails with ErrorKind::input under --strict.
  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual, bool proven = false);
  void note(NoteCode code, std::string text);

  FrameSource& source_;
  const InputSettings& settings_;
  const RawPart& raw_;
  View view_;

 private:
  const RawPlane about_;
};

/// Holds the camera against the positions that the depth's file may have beside it. Notes a lens that they refute by
/// pixels, and gives the note's text; "" where they do not. Refuses panoramas.
std::string settle_camera(FrameSource& source, const InputSettings& settings);

/// The kind by which the depth is that of the positions beside it: planar, ray or inverse. None where there are no
/// positions, or where more than one kind fits.
std::optional<DepthKind> kind_by_positions(FrameSource& source, const InputSettings& settings, const RawPart& raw);

/// Settles kind and sign of the depth, or the space of positions.
void settle_depth(FrameSource& source, const InputSettings& settings, const RawPart& raw);

/// Settles encoding and space of the normals of a frame whose depth is settled. Refuses those that depth and camera
/// refute.
void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw);

/// Notes a principal point beside the centre that the pixels neither confirm nor refute.
void note_centre(FrameSource& source);

}  // namespace alcove
