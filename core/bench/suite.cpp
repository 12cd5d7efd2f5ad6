// Benchmark suites from TOML.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/suite.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <tuple>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/toml.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// A table of the suite; every complaint names file, table and key.
struct Table {
  std::string path, name;
  const toml::table& values;

  [[noreturn]] void refuse(std::string_view key, const char* why) const {
    fail(ErrorKind::input, "{}: \"{}\" of {} {}", path, key, name, why);
  }

  std::string text(std::string_view key) const {
    const auto value = values[key].value<std::string>();
    if (!values.contains(key)) refuse(key, "is missing");
    if (!value || value->empty()) refuse(key, "must be a string");
    return *value;
  }

  double positive(std::string_view key) const {
    const auto value = values[key].value<double>();
    if (!value || !(*value > 0) || !std::isfinite(*value)) refuse(key, "must be a number above 0");
    return *value;
  }

  int count(std::string_view key, int otherwise, int least) const {
    if (!values.contains(key)) return otherwise;
    const auto value = values[key].value<std::int64_t>();
    if (!value || *value < least || *value > 100000) refuse(key, "must be a whole number of a sensible size");
    return int(*value);
  }

  void require_keys(const std::set<std::string>& known) const {
    const std::vector<std::string> names(known.begin(), known.end());
    for (const auto& [key, value] : values)
      if (!known.contains(std::string(key.str())))
        fail(ErrorKind::input, "{}: {} has no \"{}\"{}", path, name, key.str(), suggestion(key.str(), names));
  }
};

/// A TOML value as an option's argument.
std::string argument_of(const Table& table, std::string_view key, const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto number = node.value_exact<std::int64_t>()) return fmt::format("{}", *number);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  if (const auto flag = node.value_exact<bool>(); flag && *flag) return "true";
  table.refuse(key, "must be a string, a number or true");
}

std::vector<std::string> paths_of(const Table& table, const fs::path& folder) {
  std::vector<std::string> paths;
  if (const auto* list = table.values["truth"].as_array())
    for (const auto& entry : *list) {
      const auto name = entry.value<std::string>();
      if (!name || name->empty()) table.refuse("truth", "must be one file or two");
      paths.push_back((folder / *name).string());
    }
  else
    paths.push_back((folder / table.text("truth")).string());
  if (paths.empty() || paths.size() > 2) table.refuse("truth", "must be one file or two");
  return paths;
}

SuiteFrame frame_of(const Table& table, const fs::path& folder) {
  table.require_keys({"name", "input", "camera", "radius", "truth", "reference"});
  return {table.text("name"),
          (folder / table.text("input")).string(),
          (folder / table.text("camera")).string(),
          table.positive("radius"),
          paths_of(table, folder),
          table.values.contains("reference") ? (folder / table.text("reference")).string() : ""};
}

/// A setting as alcove run takes it.
std::string argument(const std::string& key, const std::string& value) {
  return key == "preset" ? "--preset=" + value : fmt::format("--set={}={}", key, value);
}

SuiteCandidate candidate_of(const Table& table) {
  SuiteCandidate candidate{table.text("name"), {}};
  for (const auto& [key, value] : table.values)
    if (key.str() != "name") {
      candidate.arguments.push_back(argument(std::string(key.str()), argument_of(table, key.str(), value)));
    }
  return candidate;
}

/// One candidate for every combination of the listed values, named by them.
std::vector<SuiteCandidate> candidates_of_sweep(const Table& table) {
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

/// Calls `use` for each table of a list of tables.
template <class Use>
void for_each_table(const std::string& path, const toml::table& root, const char* key, Use use) {
  if (!root.contains(key)) return;
  const auto* list = root[key].as_array();
  if (!list) fail(ErrorKind::input, "{}: [[{}]] must be a list of tables", path, key);
  int number = 0;
  for (const auto& entry : *list) {
    const auto* values = entry.as_table();
    if (!values) fail(ErrorKind::input, "{}: [[{}]] must be a list of tables", path, key);
    use(Table{path, fmt::format("[[{}]] {}", key, ++number), *values});
  }
}

template <class List>
void require_unique_names(const std::string& path, const List& list, const char* what) {
  std::set<std::string> names;
  for (const auto& entry : list)
    if (!names.insert(entry.name).second) fail(ErrorKind::input, "{}: two {}s are called {}", path, what, entry.name);
  if (names.empty()) fail(ErrorKind::input, "{}: there is no [[{}]]", path, what);
}

toml::table parse(const std::string& path, const char* what, const char* option) {
  const std::string text = read_text(path, what, option);
  try {
    return parse_toml(text);
  } catch (const Error& error) {
    fail(ErrorKind::input, "{}: {}", path, error.what());
  }
}

}  // namespace

Suite read_suite(const std::string& path, const std::string& data) {
  const toml::table root = parse(path, "suite", "SUITE");
  const Table top{path, "the suite", root};
  top.require_keys({"title", "repeats", "reference-slices", "frame", "candidate", "sweep"});
  const fs::path folder = data.empty() ? fs::path(path).parent_path() : fs::path(data);
  Suite suite;
  suite.title = top.text("title");
  suite.repeats = top.count("repeats", suite.repeats, 1);
  suite.reference_slices = top.count("reference-slices", suite.reference_slices, 0);
  for_each_table(path, root, "frame", [&](const Table& table) { suite.frames.push_back(frame_of(table, folder)); });
  for_each_table(path, root, "candidate", [&](const Table& table) { suite.candidates.push_back(candidate_of(table)); });
  for_each_table(path, root, "sweep", [&](const Table& table) {
    for (auto& candidate : candidates_of_sweep(table)) suite.candidates.push_back(std::move(candidate));
  });
  require_unique_names(path, suite.frames, "frame");
  require_unique_names(path, suite.candidates, "candidate");
  return suite;
}

std::vector<Limit> read_limits(const std::string& path) {
  const toml::table root = parse(path, "limits", "--limits");
  Table{path, "the limits", root}.require_keys({"limit"});
  std::vector<Limit> limits;
  for_each_table(path, root, "limit", [&](const Table& table) {
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
