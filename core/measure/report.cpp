// Puts the report's JSON into the page that the build has made of report/.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/report.h"

#include "core/measure/report_template.h"

namespace alcove {
namespace {

constexpr std::string_view kJsonMark = "{{report.json}}";

}  // namespace

std::string report_page(const std::string& json) {
  const std::string_view page = report_template();
  const std::size_t mark = page.find(kJsonMark);
  std::string text;
  text.reserve(page.size() + json.size() + json.size() / 64);
  text += page.substr(0, mark);
  // In JSON a '<' can only stand inside a string. Escaped, neither "</script>" nor "<!--" can end or change the block
  // it is in.
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  text += page.substr(mark + kJsonMark.size());
  return text;
}

}  // namespace alcove
