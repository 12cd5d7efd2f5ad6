// What the steps of settling a frame share: the frame, its pixels, and how a guess is made known.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"

namespace alcove {

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
  Settlement(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
             std::span<const float> normal, RawPlane about = RawPlane::depth);

 protected:
  const std::string& depth_path() const { return source_.depth_path(); }
  const std::string& normal_path() const { return source_.files[source_[RawPlane::normal][0].file].path(); }

  /// Takes down what was chosen; `unusual` guesses are noted too, with a warning unless nothing speaks against them.
  /// Fails with ErrorKind::input under --strict.
  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual, bool proven = false);
  /// The same of what the pixels prove, which is no guess.
  void prove(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual);
  void note(NoteCode code, std::string text);

  FrameSource& source_;
  const InputSettings& settings_;
  std::span<const float> depth_, normal_;
  View view_;

 private:
  void take_down(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
                 bool unusual, bool proven);

  const RawPlane about_;
};

/// Holds the camera against the positions that the depth's file may have beside it. Notes a lens that they refute by
/// pixels, and gives the note's text; "" where they do not. Refuses panoramas.
std::string settle_camera(FrameSource& source, const InputSettings& settings);

/// The kind by which the depth is that of the positions beside it: planar, ray or inverse. None where there are no
/// positions, or where more than one kind fits.
std::optional<DepthKind> kind_by_positions(FrameSource& source, const InputSettings& settings,
                                           std::span<const float> depth);

/// Settles kind and sign of the depth, or the space of positions.
void settle_depth(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                  std::span<const float> normal);

/// Settles encoding and space of the normals of a frame whose depth is settled. Refuses those that depth and camera
/// refute.
void settle_normals(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                    std::span<const float> normal);

/// Notes a principal point beside the centre that the pixels neither confirm nor refute.
void note_centre(FrameSource& source);

}  // namespace alcove
