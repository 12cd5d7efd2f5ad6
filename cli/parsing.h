// What the subcommands share in parsing arguments with CLI11: ranges, words, and complaints with the nearest names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace alcove {

/// A number's allowed range, as text and as a check.
struct Range {
  double low, high;
  bool open_low, open_high;
  std::string text;
  bool holds(double x) const { return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high); }
};

Range above(double low);
Range between(double low, double high);
Range below_and_at_least(double low, double high);
Range strictly_between(double low, double high);
Range above_to(double low, double high);

/// A finite number within its range, or CLI11's complaint.
CLI::Validator check_of(const Range& range);
/// One of a few words, or a complaint with the nearest of them.
CLI::Validator check_of(const std::vector<std::string>& words);

/// Bytes: "512M", "4G", "1.5GiB", "100000"; K, M, G and T are powers of 1024. Else CLI11's complaint.
std::uint64_t read_size(const char* option, const std::string& text);

/// Parses; false: --help was asked for and printed. Fails with ErrorKind::usage in one sentence, with the nearest of
/// the app's options where one is misspelt. The app's name is the whole command, such as "alcove run".
bool parse_arguments(CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace alcove
