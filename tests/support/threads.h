// How many threads lavapipe computes with in the tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>

namespace alcove::test {

/// Lavapipe computes in the thread that calls it, in this process and in the programs that it starts. Tests run
/// beside each other, and for small frames lavapipe's threads take longer to wait for each other than to compute. Where
/// ALCOVE_TEST_THREADS is set, lavapipe has its own threads, so that workgroups do run at once: tests/CMakeLists.txt
/// sets it for some tests, and tests/long.sh for all. LP_NUM_THREADS of the environment comes first.
inline const bool kComputesInOneThread =
    std::getenv("ALCOVE_TEST_THREADS") == nullptr && ::setenv("LP_NUM_THREADS", "0", 0) == 0;

}  // namespace alcove::test
