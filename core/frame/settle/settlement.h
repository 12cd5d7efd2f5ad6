// A frame that is being settled: what its steps share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"
#include "core/frame/evidence.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/pixels/normal_scores.h"

namespace alcove {

/// A frame that is being settled, by planes of depth and normals as they were read.
class Settlement {
 public:
  /// Messages name the file of the plane `about`.
  Settlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen,
             RawPlane about = RawPlane::depth);

  const Evidence& evidence() const { return seen_; }

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
  /// Whether --set allow names the code: then it is no error.
  bool is_allowed(NoteCode code) const;

  FrameSource& source_;
  Reading& reading_;
  const InputSettings& settings_;
  const RawPart& raw_;
  Evidence& seen_;
  View view_;

 private:
  const RawPlane about_;
};

}  // namespace alcove
