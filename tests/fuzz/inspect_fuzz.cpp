// A whole frame as `alcove inspect` reads it: the search for AOVs, what the pixels say of their meaning, and the
// report.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/inspect.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/formats/exr.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

namespace {

bool is_small(const std::string& path) {
  bool small = false;
  fuzz::accepts([&] {
    const ExrFile file(path, "INPUT");
    small = std::ranges::all_of(file.parts(), [](const auto& part) { return part.data.pixels() <= fuzz::kMostPixels; });
  });
  return small;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  if (!is_small(input.path())) return 0;
  InputSettings settings;
  settings.input = input.path();
  settings.fov = 60;
  fuzz::accepts([&] {
    const Inspection inspection = inspect_frame(settings, 1, {.inputs = settings});
    fuzz::require(nlohmann::json::accept(inspection_json(inspection)), "the JSON is JSON");
    const bool commands = std::ranges::any_of(inspection_text(inspection, true),
                                              [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; });
    fuzz::require(!commands, "a terminal shows text only");
  });
  return 0;
}
