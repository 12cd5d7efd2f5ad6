// Proves that lavapipe computes with the width of vectors that LP_NATIVE_VECTOR_WIDTH asks for; built into the programs
// that run once per width.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/device.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using namespace test;

TEST(VectorWidth, is_the_one_that_is_asked_for) {
  const char* width = std::getenv("LP_NATIVE_VECTOR_WIDTH");
  const std::string name = device().info().name;
  if (!width || name.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "no width is asked for, or no lavapipe";
  const std::string said = ", " + std::string(width) + " bits)";
  EXPECT_THAT(name, HasSubstr(said));
  EXPECT_THAT(run_program({"devices"}).out, HasSubstr(said));
}

}  // namespace
}  // namespace alcove
