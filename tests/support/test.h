// What every test stands on: GoogleTest, its matchers by their names, and the parts of the standard library that most
// tests use. Each header of support includes it, so a test that includes one of them needs no more.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.h"

namespace alcove::test {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

// How an action fails.

/// What the error says, in one line, with which the action must end; "" where there is none.
template <class Action>
std::string error_of(ErrorKind kind, const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

/// The action must end with an error that holds the words.
template <class Action>
void expect_error(ErrorKind kind, const std::vector<std::string>& words, const Action& action) {
  const std::string text = error_of(kind, action);
  for (const auto& word : words) EXPECT_THAT(text, HasSubstr(word));
}

// Whether the tests shall take their long forms: tests/long.sh asks for them, docs/testing.md lists them.

/// True where ALCOVE_TEST_LONG is set: more cases of the same facts, which take minutes.
inline bool long_tests() { return std::getenv("ALCOVE_TEST_LONG") != nullptr; }

/// Whether a combination of several axes' values is tried: in the long form each is, else one of every `parts`. With
/// the sum of the values' numbers along their axes, each value is still met by some of every other axis.
inline bool tried(int sum_of_numbers, int parts) { return long_tests() || sum_of_numbers % parts == 0; }

/// Whether the program runs once more with vectors of another width.
inline bool has_other_width() { return std::getenv("LP_NATIVE_VECTOR_WIDTH") != nullptr; }

/// Shares cases out: even ones at lavapipe's own width, odd ones at the other; in the long form, and on another device,
/// all.
inline bool tried_at_width(int number) {
  return std::getenv("ALCOVE_TEST_DEVICE") != nullptr || tried(number + has_other_width(), 2);
}

/// How many of `count` random cases are tried: at another width, which shows what differs by the width alone, a third.
inline int cases_of(int count) { return long_tests() || !has_other_width() ? count : count / 3; }

// How many threads lavapipe computes with in the tests.

/// Lavapipe computes in the thread that calls it, in this process and in the programs that it starts. Tests run
/// beside each other, and for small frames lavapipe's threads take longer to wait for each other than to compute. Where
/// ALCOVE_TEST_THREADS is set, lavapipe has its own threads, so that workgroups do run at once: tests/CMakeLists.txt
/// sets it for some tests, and tests/long.sh for all. LP_NUM_THREADS of the environment comes first.
inline const bool kComputesInOneThread =
    std::getenv("ALCOVE_TEST_THREADS") == nullptr && ::setenv("LP_NUM_THREADS", "0", 0) == 0;

}  // namespace alcove::test
