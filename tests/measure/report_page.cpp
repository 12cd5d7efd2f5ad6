// Writes the report page of the JSON on standard input to standard output: what tests/measure/report_page_test.py opens
// in a browser.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/report.h"

#include <iostream>
#include <iterator>

int main() {
  const std::string json{std::istreambuf_iterator<char>(std::cin), {}};
  std::cout << alcove::report_page(json);
  return std::cout.flush() ? 0 : 1;
}
