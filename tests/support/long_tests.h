// Whether the tests shall take their long forms: tests/long.sh asks for them, docs/testing.md lists them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>

namespace alcove::test {

/// True where ALCOVE_TEST_LONG is set: more cases of the same facts, which take minutes.
inline bool long_tests() { return std::getenv("ALCOVE_TEST_LONG") != nullptr; }

}  // namespace alcove::test
