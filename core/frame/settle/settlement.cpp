// Takes down the choices that are made.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/settle/settlement.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {

Settlement::Settlement(PlanesToSettle planes)
    : reading_(planes.reading),
      settings_(planes.settings),
      raw_(planes.raw),
      seen_(planes.seen),
      view_(view_of(planes.reading, planes.raw.window)),
      path_(std::move(planes.path)),
      notes_(planes.notes),
      file_(std::move(planes.file)) {}

void Settlement::note(NoteCode code, std::string text) { notes_.push_back({code, std::move(text), file_}); }

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
    fail(ErrorKind::input, "{}: --strict, and the {} is a guess, {} ({}): give {}", path_, what, chosen, why, option);
  take_down(what, chosen, why, option, unusual, proven);
}

}  // namespace alcove
