// The frame to be settled, and its guesses.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settlement.h"

#include "core/base/error.h"

namespace alcove {

Settlement::Settlement(FrameSource& source, const InputSettings& settings, std::span<const float> depth,
                       std::span<const float> normal, RawPlane about)
    : source_(source),
      settings_(settings),
      depth_(depth),
      normal_(normal),
      view_(view_of(source.camera, source.data, source.display)),
      about_(about) {}

void Settlement::note(NoteCode code, std::string text) {
  source_.notes.push_back({code, std::move(text), about_ == RawPlane::normal ? source_.normal_file() : ""});
}

void Settlement::guess(const std::string& what, const std::string& chosen, const std::string& why,
                       const std::string& option, bool unusual, bool proven) {
  if (settings_.strict)
    fail(ErrorKind::input, "{}: --strict, and nothing says the {}; it would be {} ({}): give {}",
         about_ == RawPlane::normal ? normal_path() : depth_path(), what, chosen, why, option);
  take_down(what, chosen, why, option, unusual, proven);
}

void Settlement::prove(const std::string& what, const std::string& chosen, const std::string& why,
                       const std::string& option, bool unusual) {
  take_down(what, chosen, why, option, unusual, true);
}

void Settlement::take_down(const std::string& what, const std::string& chosen, const std::string& why,
                           const std::string& option, bool unusual, bool proven) {
  source_.guesses.push_back({what, chosen, why, option});
  if (unusual)
    note(proven ? NoteCode::proven_reading : NoteCode::unusual_reading,
         fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
}

}  // namespace alcove
