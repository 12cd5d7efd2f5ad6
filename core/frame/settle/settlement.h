// A frame during settling, from files or from memory: the state that the steps share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/frame/evidence.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/normal_scores.h"

namespace alcove {

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

}  // namespace alcove
