// NumPy's arrays: a header that is a Python dictionary, then numbers. Source of the format: numpy.lib.format.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/half.h"
#include "core/base/text.h"
#include "core/formats/row_reader.h"
#include "core/formats/sample_loops.h"

namespace alcove {
namespace {

constexpr std::size_t kMostHeader = 4096;  // bytes; that of a plain array has 118

/// Infinite where it is beyond a float's range.
float as_float(double number) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return std::isfinite(number) && std::abs(number) > kMost ? float(std::copysign(INFINITY, number)) : float(number);
}

struct Type {
  const char* name;  // a letter, and the bytes of a number
  float (*value)(const char*);
};
constexpr Type kTypes[] = {
    {"f2", [](const char* at) { return from_half(number_at<std::uint16_t>(at)); }},
    {"f4", [](const char* at) { return number_at<float>(at); }},
    {"f8", [](const char* at) { return as_float(number_at<double>(at)); }},
    {"u1", [](const char* at) { return float(number_at<std::uint8_t>(at)) / 255; }},
    {"u2", [](const char* at) { return float(number_at<std::uint16_t>(at)) / 65535; }},
    {"i4", [](const char* at) { return float(number_at<std::int32_t>(at)); }},
};

class NpyReader : public RowReader {
 public:
  NpyReader(const std::string& path, const char* option) : RowReader(path, option, "NumPy") {
    std::array<char, 12> start{};  // six letters, the version, and the length of the header
    next(start.data(), 10);
    if (start[6] > 1) next(start.data() + 10, 2);
    const std::size_t size = start[6] > 1 ? number_at<std::uint32_t>(&start[8]) : number_at<std::uint16_t>(&start[8]);
    std::string header(std::min(size, kMostHeader), ' ');
    next(header.data(), header.size());
    const std::string type = text_of(header, "'descr':", '\'', '\''), shape = text_of(header, "'shape':", '(', ')');
    type_ = std::ranges::find(kTypes, type.substr(std::min<std::size_t>(1, type.size())), &Type::name);
    if (size > kMostHeader) refuse(fmt::format("its header has {} bytes, and that of a plain array has 118", size));
    if (type_ == std::end(kTypes))
      refuse(fmt::format("its numbers are {}: save array.astype('float32')",
                         type.empty() ? "records" : "of the type " + type));
    if (header.find("True") != header.npos) refuse("it is in Fortran's order: save numpy.ascontiguousarray(array)");
    auto sizes = split(shape);
    std::erase(sizes, "");  // behind the last comma
    if (sizes.size() == 2) sizes.emplace_back("1");
    const auto size_of = [&](std::size_t i) { return std::uint32_t(std::min(1e6, number_of(sizes[i]).value_or(0))); };
    if (sizes.size() != 3 || shape.find_first_not_of("0123456789, ") != shape.npos || size_of(2) < 1 || size_of(2) > 4)
      refuse(
          fmt::format("its shape is ({}), and a picture has (height, width), or 1 to 4 channels behind these: "
                      "save array.squeeze(), or numpy.moveaxis(array, 0, -1) where channels come first",
                      shape));
    names = size_of(2) == 1 ? std::vector<std::string>{"Z"} : std::vector<std::string>{"R", "G", "B", "A"};
    names.resize(size_of(2));
    is_reversed_ = type[0] == '>';
    begin(size_of(1), size_of(0), names.size() * bytes());
  }

 private:
  std::size_t bytes() const { return std::size_t(type_->name[1] - '0'); }

  /// What stands between two marks behind a key; "" where nothing does.
  static std::string text_of(const std::string& header, const std::string& key, char from, char to) {
    const std::size_t name = std::min(header.find(key), header.size()),
                      begin = header.find_first_not_of(' ', name + key.size());
    const std::size_t end = begin == header.npos || header[begin] != from ? header.npos : header.find(to, begin + 1);
    return end == header.npos ? "" : header.substr(begin + 1, end - begin - 1);
  }

  float sample_of(const char* pixel, std::size_t channel) const override {
    std::array<char, 8> number{};
    std::copy_n(pixel + channel * bytes(), bytes(), number.begin());
    if (is_reversed_) std::reverse(number.begin(), number.begin() + std::ptrdiff_t(bytes()));
    return type_->value(number.data());
  }

  const Type* type_;
  bool is_reversed_;  // the highest byte of a number comes first
};

}  // namespace

std::unique_ptr<PictureReader> open_npy(const std::string& path, const char* option) {
  return std::make_unique<NpyReader>(path, option);
}

}  // namespace alcove
