// Files as strangers bring them: every case of tests/strangers is read right, or is refused or warned about with its
// true cause.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/formats/exr.h"
#include "tests/support/program.h"

namespace alcove::test {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

const std::string kFolder = std::string(ALCOVE_SOURCE_DIR) + "/tests/strangers";

const Json& all_cases() {
  static const Json cases = Json::parse(read_bytes(kFolder + "/cases.json"));
  return cases;
}

/// Texts of a list; none where the key is missing.
Arguments texts_in(const Json& expect, const char* key) {
  return expect.contains(key) ? expect[key].get<Arguments>() : Arguments();
}

class Strangers : public testing::TestWithParam<std::size_t> {
 protected:
  struct Called {
    Finished finished;
    std::string output;
  };

  /// Runs a command line once.
  const Called& called(const std::string& command, const Arguments& arguments) {
    Arguments all{command};
    all.insert(all.end(), arguments.begin(), arguments.end());
    auto [found, is_new] = called_.try_emplace(all);
    if (!is_new) return found->second;
    found->second.output = folder_ / fmt::format("{}.exr", called_.size());
    if (command == "run") all.insert(all.end(), {"-o", found->second.output, "--progress", "none"});
    found->second.finished = run_program(all, {.folder = kFolder});
    return found->second;
  }

  std::vector<float> ao_of(const Json& to) {
    if (to.is_string()) return read_exr_image(kFolder + "/" + to.get<std::string>(), {"Y"}).pixels;
    const Called& plain = called("run", to.get<Arguments>());
    EXPECT_EQ(plain.finished.code, 0) << plain.finished;
    return read_exr_image(plain.output, {"Y"}).pixels;
  }

  /// Says how the result differs from what it should be; nothing where it does not.
  std::string difference(const Called& run, const Json& expect) {
    if (run.finished.code != 0) return fmt::format("exit code {}; ", run.finished.code);
    const std::vector<float> ao = read_exr_image(run.output, {"Y"}).pixels, truth = ao_of(expect["to"]);
    if (ao.size() != truth.size()) return "another size; ";
    double squares = 0;
    for (std::size_t i = 0; i < ao.size(); i++) squares += std::pow(ao[i] - truth[i], 2);
    const double rmse = std::sqrt(squares / double(ao.size()));
    return rmse <= expect["rmse"].get<double>() ? ""
                                                : fmt::format("RMSE {:.4f} above {}; ", rmse, expect["rmse"].dump());
  }

  /// Lists what does not hold; "" where all does.
  std::string failures(const Arguments& arguments, const Json& expect) {
    const bool is_inspect = expect.contains("inspect");
    const Called& call = called(is_inspect ? "inspect" : "run", arguments);
    const std::string said = is_inspect ? call.finished.out + call.finished.err : call.finished.err;
    const Json& words = is_inspect ? expect["inspect"] : expect;
    std::string failed;
    if (expect.contains("rmse")) failed += difference(call, expect);
    if (expect.contains("exit")) {
      const Json codes = expect["exit"].is_array() ? expect["exit"] : Json::array({expect["exit"]});
      if (std::ranges::find(codes, Json(call.finished.code)) == codes.end())
        failed += fmt::format("exit code {} is not in {}; ", call.finished.code, codes.dump());
    }
    const auto says = [&](const std::string& pattern) {
      return std::regex_search(said, std::regex(pattern, std::regex::icase));
    };
    for (const auto& pattern : texts_in(words, "says"))
      if (!says(pattern)) failed += fmt::format("does not say /{}/; ", pattern);
    for (const auto& pattern : texts_in(words, "not_says"))
      if (says(pattern)) failed += fmt::format("says /{}/; ", pattern);
    if (!expect.contains("any_of")) return failed;
    std::string others;
    for (const auto& other : expect["any_of"]) {
      const std::string why = failures(arguments, other);
      if (why.empty()) return failed;
      others += "neither " + why;
    }
    return failed + others;
  }

  TemporaryFolder folder_;
  std::map<Arguments, Called> called_;
};

TEST_P(Strangers, AreReadRightOrToldWhatIsWrong) {
  const Json& row = all_cases()[GetParam()];
  const auto arguments = row["args"].get<Arguments>();
  const bool is_inspect = row["expect"].contains("inspect");
  EXPECT_EQ(failures(arguments, row["expect"]), "") << row["what"].get<std::string>() << "\n"
                                                    << called(is_inspect ? "inspect" : "run", arguments).finished;
}

INSTANTIATE_TEST_SUITE_P(Pack, Strangers, testing::Range(std::size_t(0), all_cases().size()), [](const auto& info) {
  std::string name = all_cases()[info.param]["name"];
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace alcove::test
