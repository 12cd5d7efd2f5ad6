// Messages to the standard error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace alcove {

/// Ignores what becomes of the message, since a log on a full disk should end no run.
template <class... Args>
void print_error(fmt::format_string<Args...> format, Args&&... args) {
  (void)std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

}  // namespace alcove
