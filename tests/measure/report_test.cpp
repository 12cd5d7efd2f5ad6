// The report page as text: nothing in the data can end its block, nothing in the page would be fetched.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/report.h"
#include "tests/support/program.h"

#include <regex>

using namespace alcove::test;
using alcove::report_page;

namespace {

nlohmann::json small_report(const std::string& name) {
  return {{"title", name},
          {"kind", "compare"},
          {"device", nullptr},
          {"yardstick_ms", nullptr},
          {"candidates", nlohmann::json::array()},
          {"rows", nlohmann::json::array()},
          {"images", nlohmann::json::array()}};
}

/// What `expression` finds in the page without its data: the first capture of each match.
std::vector<std::string> found(const char* expression) {
  const std::string page = report_page(small_report("title").dump());
  const std::regex pattern(expression, std::regex::icase);
  std::vector<std::string> matches;
  for (std::sregex_iterator at(page.begin(), page.end(), pattern), end; at != end; ++at) matches.push_back((*at)[1]);
  return matches;
}

}  // namespace

TEST(Report, hostile_strings_come_back_from_the_block_as_they_went_in) {
  for (const char* name : {"<script>alert(1)</script>", "</SCRIPT >", "<!-- <script>", "\"\\u003c", "a\nb\tc", "]]>",
                           "{{page.js}}", "{{report.json}}", "\u00e9\u2028"}) {
    const nlohmann::json report = small_report(name);
    EXPECT_EQ(nlohmann::json::parse(data_of_page(report_page(report.dump()))), report) << name;
  }
}

TEST(Report, the_block_holds_no_less_than_sign) {
  EXPECT_THAT(data_of_page(report_page(small_report("<a><!--</script>").dump())), Not(HasSubstr("<")));
}

TEST(Report, all_marks_are_filled) { EXPECT_THAT(found("(\\{\\{[a-z_]+\\.[a-z.]+\\}\\})"), IsEmpty()); }

TEST(Report, nothing_would_be_fetched) {
  EXPECT_THAT(found("<script[^>]*\\s(src)"), IsEmpty());
  EXPECT_THAT(found("<link[^>]*\\shref\\s*=\\s*[\"']?([^\"'>\\s]*)"), Each(StartsWith("data:")));
  EXPECT_THAT(found("<(?:img|iframe|object|embed|video|audio|source|base|form)\\b[^>]*\\s(?:src|data|href|action)\\s*="
                    "\\s*[\"']?([^\"'>\\s]*)"),
              IsEmpty());
  EXPECT_THAT(found("(@import)"), IsEmpty());
  EXPECT_THAT(found("\\burl\\(([^)]*)\\)"), IsEmpty());
  EXPECT_THAT(found("(sourceMappingURL)"), IsEmpty());
}

TEST(Report, the_browser_is_told_to_fetch_nothing) {
  EXPECT_THAT(report_page("{}"),
              HasSubstr("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:;"));
}

TEST(Report, the_page_is_below_half_a_megabyte) { EXPECT_LT(report_page("{}").size(), 500'000U); }
