// How an action fails.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/error.h"
#include "tests/support/test.h"

namespace alcove::test {

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

}  // namespace alcove::test
