// The frame to be settled, and its guesses.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settlement.h"

#include "core/base/error.h"

namespace alcove {

Settlement::Settlement(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                       std::span<const float> normal)
    : source_(source),
      settings_(settings),
      depth_(depth),
      normal_(normal),
      view_(view_of(source.camera, source.data, source.display)) {}

void Settlement::guess(const std::string& what, const std::string& chosen, const std::string& why,
                       const std::string& option, bool unusual) {
  if (settings_.strict)
    fail(ErrorKind::input, "{}: --strict, and nothing says the {}; it would be {} ({}): give {}", depth_path(), what,
         chosen, why, option);
  source_.guesses.push_back({what, chosen, why, option});
  if (unusual)
    note(NoteCode::unusual_reading, fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
}

}  // namespace alcove
