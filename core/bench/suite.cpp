// Benchmark suites from TOML.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/suite.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <tuple>

#include "core/base/error.h"
#include "core/base/frame_list.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// A TOML value as an option's argument.
std::string argument_of(const TomlTable& table, std::string_view key, const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("{}", *number);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  if (const auto flag = node.value_exact<bool>(); flag && *flag) return "true";
  table.refuse(key, "must be a string, a number or true");
}

SuiteFrame frame_of(const ListedFrame& listed, const std::string& path) {
  const auto require = [&](bool is_there, const char* key) {
    if (!is_there) fail(ErrorKind::input, "{}: frame {} has no \"{}\"", path, listed.name, key);
  };
  require(!listed.camera.empty(), "camera");
  require(listed.radius.has_value(), "radius");
  require(!listed.truth.empty(), "truth");
  // Suites of before lists were those of compare, too, have it as "reference".
  const bool is_old = listed.cpu_reference.empty() && listed.reference.size() == 1;
  const std::string& kept = is_old ? listed.reference.front() : listed.cpu_reference;
  return {listed.name, listed.input, listed.camera, *listed.radius, listed.truth, kept};
}

/// A setting as alcove run takes it.
std::string argument(const std::string& key, const std::string& value) {
  return key == "preset" ? "--preset=" + value : fmt::format("--set={}={}", key, value);
}

SuiteCandidate candidate_of(const TomlTable& table) {
  SuiteCandidate candidate{table.text("name"), {}};
  for (const auto& [key, value] : table.values)
    if (key.str() != "name") {
      candidate.arguments.push_back(argument(std::string(key.str()), argument_of(table, key.str(), value)));
    }
  return candidate;
}

/// One candidate for every combination of the listed values, named by them.
std::vector<SuiteCandidate> candidates_of_sweep(const TomlTable& table) {
  std::vector<SuiteCandidate> candidates(1);
  for (const auto& [key, value] : table.values) {
    std::vector<std::string> choices;
    if (const auto* list = value.as_array())
      for (const auto& entry : *list) choices.push_back(argument_of(table, key.str(), entry));
    else
      choices.push_back(argument_of(table, key.str(), value));
    if (choices.empty()) table.refuse(key.str(), "must not be empty");
    std::vector<SuiteCandidate> longer;
    for (const auto& candidate : candidates)
      for (const auto& choice : choices) {
        longer.push_back(candidate);
        longer.back().name += fmt::format("{}{} {}", candidate.name.empty() ? "" : ", ", key.str(), choice);
        longer.back().arguments.push_back(argument(std::string(key.str()), choice));
      }
    candidates = std::move(longer);
  }
  return candidates;
}

}  // namespace

Suite read_suite(const std::string& path, const std::string& data) {
  const toml::table root = read_toml(path, "suite", "SUITE");
  const TomlTable top{path, "the suite", root};
  Suite suite;
  suite.title = top.text("title");
  suite.repeats = top.count("repeats", suite.repeats, 1);
  suite.reference_slices = top.count("reference-slices", suite.reference_slices, 0);
  for (const auto& frame : frames_in(root, path, data.empty() ? fs::path(path).parent_path().string() : data))
    suite.frames.push_back(frame_of(frame, path));
  for_each_table(path, root, "candidate",
                 [&](const TomlTable& table) { suite.candidates.push_back(candidate_of(table)); });
  for_each_table(path, root, "sweep", [&](const TomlTable& table) {
    for (auto& candidate : candidates_of_sweep(table)) suite.candidates.push_back(std::move(candidate));
  });
  require_unique_names(path, suite.candidates, "candidate");
  return suite;
}

std::vector<Limit> read_limits(const std::string& path) {
  const toml::table root = read_toml(path, "limits", "--limits");
  TomlTable{path, "the limits", root}.require_keys({"limit"});
  std::vector<Limit> limits;
  for_each_table(path, root, "limit", [&](const TomlTable& table) {
    const std::set<std::string> measures = {"rmse", "mae", "p99", "bias", "grain", "mottle", "estimator-rmse"};
    auto known = measures;
    known.insert({"frame", "candidate"});
    table.require_keys(known);
    for (const auto& measure : measures)
      if (table.values.contains(measure))
        limits.push_back({table.text("frame"), table.text("candidate"), measure, table.positive(measure)});
  });
  if (limits.empty()) fail(ErrorKind::input, "{}: there is no [[limit]] with a measure (--limits)", path);
  return limits;
}

void require_known(const std::vector<Limit>& limits, const Suite& suite, const std::string& path) {
  std::vector<std::string> frames, candidates;
  std::ranges::transform(suite.frames, std::back_inserter(frames), &SuiteFrame::name);
  std::ranges::transform(suite.candidates, std::back_inserter(candidates), &SuiteCandidate::name);
  for (const auto& limit : limits) {
    if (limit.measure == "estimator-rmse" && suite.reference_slices == 0)
      fail(ErrorKind::usage, "{}: a limit for estimator-rmse needs --reference-slices above 0 (--limits)", path);
    for (const auto& [what, name, names] :
         {std::tuple("frame", &limit.frame, &frames), {"candidate", &limit.candidate, &candidates}})
      if (std::ranges::find(*names, *name) == names->end())
        fail(ErrorKind::input, "{}: the suite has no {} {}{} (--limits)", path, what, *name, suggestion(*name, *names));
  }
}

}  // namespace alcove
