// TOML: rules of input presets, suites and limits of the benchmark.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/toml.h"
#include "core/bench/bench.h"
#include "core/frame/find/input_rules.h"
#include "tests/fuzz/fuzz.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const fuzz::InputFile input(data, size);
  fuzz::accepts([&] { parse_flat_toml(text); });
  fuzz::accepts([&] { parse_input_rules("cycles", text); });
  fuzz::accepts([&] { read_suite(input.path(), ""); });
  fuzz::accepts([&] { read_limits(input.path()); });
  return 0;
}
