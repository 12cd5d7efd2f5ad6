// Whether the tests shall take their long forms: tests/long.sh asks for them, docs/testing.md lists them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>

namespace alcove::test {

/// True where ALCOVE_TEST_LONG is set: more cases of the same facts, which take minutes.
inline bool long_tests() { return std::getenv("ALCOVE_TEST_LONG") != nullptr; }

/// Whether a combination of several axes' values is tried: in the long form each is, else one of every `parts`. With
/// the sum of the values' numbers along their axes, each value is still met by some of every other axis.
inline bool tried(int sum_of_numbers, int parts) { return long_tests() || sum_of_numbers % parts == 0; }

/// How many of `count` random cases are tried: where the program runs once more with vectors of another width, which
/// shows what differs by the width alone, a third of them.
inline int cases_of(int count) { return long_tests() || !std::getenv("LP_NATIVE_VECTOR_WIDTH") ? count : count / 3; }

}  // namespace alcove::test
