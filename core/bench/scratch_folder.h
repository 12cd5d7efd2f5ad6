// A folder for the outputs of what is timed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace alcove {

/// A folder in the system's place for such things that is deleted with all that is in it. Fails with ErrorKind::output
/// where none can be made.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  std::string file(int frame) const;
  std::string pattern() const { return path_ + "/ao.%04d.exr"; }

 private:
  std::string path_;
};

}  // namespace alcove
