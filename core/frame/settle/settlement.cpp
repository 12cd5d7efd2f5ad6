// Takes down the choices that are made.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settlement.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {

Settlement::Settlement(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen,
                       RawPlane about)
    : source_(source),
      reading_(source.reading),
      settings_(settings),
      raw_(raw),
      seen_(seen),
      view_(view_of(source.reading, raw.window)),
      about_(about) {}

void Settlement::note(NoteCode code, std::string text) {
  source_.notes.push_back({code, std::move(text), about_ == RawPlane::normal ? source_.normal_file() : ""});
}

bool Settlement::is_allowed(NoteCode code) const {
  const auto allowed = split(settings_.allow);
  return std::ranges::find(allowed, facts_of(code).name) != allowed.end();
}

void Settlement::take_down(const std::string& what, const std::string& chosen, const std::string& why,
                           const std::string& option, bool unusual, bool proven) {
  seen_.guesses.push_back({what, chosen, why, option});
  if (unusual)
    note(proven ? NoteCode::proven_reading : NoteCode::unusual_reading,
         fmt::format("{} taken as {}: {} ({} says otherwise)", what, chosen, why, option));
}

void Settlement::guess(const std::string& what, const std::string& chosen, const std::string& why,
                       const std::string& option, bool unusual, bool proven) {
  if (settings_.strict)
    fail(ErrorKind::input, "{}: --strict, and nothing says the {}; it would be {} ({}): give {}",
         about_ == RawPlane::normal ? normal_path() : depth_path(), what, chosen, why, option);
  take_down(what, chosen, why, option, unusual, proven);
}

}  // namespace alcove
