// A settling of planes, whether they come from files or from memory.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/frame/evidence.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/reading.h"

namespace alcove {

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

/// Planes of depth and normals that are being settled, as they were read.
struct PlanesToSettle {
  Reading& reading;
  Notes& notes;
  const InputSettings& settings;
  const RawPart& raw;
  Evidence& seen;
  std::string path;       // of the planes in question, for errors
  std::string file = {};  // the same for notes; empty: the frame's own
};

class Settlement {
 public:
  explicit Settlement(PlanesToSettle planes);

 protected:
  /// Takes down a choice, and notes an unusual one: with a warning unless the pixels prove it.
  void take_down(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
                 bool unusual, bool proven);
  /// Does the same for a guess. Fails with ErrorKind::input under --strict.
  void guess(const std::string& what, const std::string& chosen, const std::string& why, const std::string& option,
             bool unusual, bool proven = false);
  void note(NoteCode code, std::string text);

  Reading& reading_;
  const InputSettings& settings_;
  const RawPart& raw_;
  Evidence& seen_;
  View view_;
  const std::string path_;

 private:
  Notes& notes_;
  const std::string file_;
};

/// What is known of a depth beside its planes.
struct DepthFacts {
  Program program;
  bool is_kind_open = false;
  // Gives the kind by which it is the depth of positions beside it, if those tell. Null: there are none.
  std::function<std::optional<DepthKind>()> kind_by_positions = nullptr;
  const char* said_by = "--depth-kind, --source or the camera file";  // what may say the kind that is not open
};

/// Settles kind and sign of the depth, or the space of positions; where they are said, notes what speaks against them.
void settle_depth(const PlanesToSettle& planes, const DepthFacts& facts);

}  // namespace alcove
