// Draws cells and their labels, letter by letter.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sheet.h"

#include <algorithm>
#include <cmath>

#include "core/formats/png.h"

namespace alcove {
namespace {

constexpr int kMostWidth = 3840, kLeastCell = 120, kGap = 8;  // px
constexpr int kLetterWidth = 6, kLetterHeight = 8;            // px, with the gap to the next one
constexpr int kLetterOfCell = 300;                            // px of a cell for each pixel of a letter's dot
constexpr float kPaper = 0.11f, kInk = 0.9f;

/// The letters from the blank to ~: each has eight rows from the top, a digit of base 32 for the five pixels of each.
constexpr char kLetters[] =
    "0000000044444040aa000000aavavaa04fke5u40pp248jj0cik8lid04400000024888420842224800level00044v440000000048000e0000"
    "0000004011248gg0ehjlphe04ck444v0eh1248v0eh161he026aiv220vgu11he0egguhhe0v1244880ehhehhe0ehhf11e00040040000400448"
    "248g842000v0v00084212480eh124040ehnlngf0ehhvhhh0uhhuhhu0ehggghe0uhhhhhu0vgguggv0vgguggg0ehgnhhe0hhhvhhh0e44444e0"
    "72222ic0hikokih0ggggggv0hrllhhh0hpllljh0ehhhhhe0uhhuggg0ehhhlid0uhhukih0fgge11u0v4444440hhhhhhe0hhhhha40hhhllrh0"
    "hha4ahh0hha44440v1248gv0e88888e0gg842110e22222e04ah000000000000v8400000000e1fhf0gguhhhu000egghe011fhhhf000ehvge0"
    "698s888000fhhf1eggmphhh040c444e0206222icggikoki0c44444e000qllll000mphhh000ehhhe000uhhugg00fhhf1100mpggg000fge1u0"
    "88s8896000hhhjd000hhha4000hllla000ha4ah000hhhf1e00v248v03448443044444440o44244o0009li000";

/// Whether a letter has ink at (x, y).
bool has_ink(char letter, int x, int y) {
  if (x >= kLetterWidth - 1) return false;
  const char digit =
      kLetters[std::size_t(letter < ' ' || letter > '~' ? '?' - ' ' : letter - ' ') * kLetterHeight + std::size_t(y)];
  return ((digit <= '9' ? digit - '0' : digit - 'a' + 10) >> (kLetterWidth - 2 - x)) & 1;
}

/// The px of a letter's dot: letters grow with the cells, for sheets that are seen whole, and are never too small.
int dot_of(int cell_width) { return std::clamp(cell_width / kLetterOfCell, 2, 4); }

/// A label in lines of so many letters, broken at blanks, or within words that are longer.
std::vector<std::string> lines_of(std::string label, std::size_t most) {
  std::vector<std::string> lines;
  while (label.size() > most) {
    const std::size_t blank = label.rfind(' ', most);
    const std::size_t end = blank == label.npos || blank == 0 ? most : blank;
    lines.push_back(label.substr(0, end));
    label.erase(0, std::min(label.find_first_not_of(' ', end), label.size()));
  }
  lines.push_back(label);
  return lines;
}

}  // namespace

Sheet::Sheet(std::size_t cells, std::size_t columns)
    : cells_(cells), columns_(columns ? columns : std::size_t(std::ceil(std::sqrt(double(cells))))) {}

void Sheet::put(std::size_t number, const std::string& label, std::span<const ShownPicture> pictures) {
  Cell cell{label, {0, 0, 3, {}}};
  ShownPicture& small = cell.picture;
  for (const auto& picture : pictures) {
    const int most = std::max(kLeastCell, kMostWidth / int(columns_)), block = (picture.width + most - 1) / most;
    small.width = picture.width / block;
    const int top = small.height ? small.height + kGap : 0;
    small.height = top + picture.height / block;
    small.pixels.resize(3 * std::size_t(small.width) * std::size_t(top), kPaper);
    for (int i = 0; i < 3 * small.width * (small.height - top); i++) {
      const int x = i / 3 % small.width * block, y = i / 3 / small.width * block;
      float sum = 0;
      for (int k = 0; k < block * block; k++) {
        const std::size_t pixel = std::size_t(y + k / block) * std::size_t(picture.width) + std::size_t(x + k % block);
        const auto channel = std::size_t(std::min(i % 3, picture.channels - 1));
        sum += std::clamp(picture.pixels[pixel * std::size_t(picture.channels) + channel], 0.0f, 1.0f);
      }
      small.pixels.push_back(sum / float(block * block));
    }
  }
  const std::lock_guard lock(mutex_);
  filled_[number] = std::move(cell);
}

void Sheet::write(const std::string& path) const {
  int width = 0, height = 0;  // of a cell's picture
  for (const auto& [number, cell] : filled_) {
    width = std::max(width, cell.picture.width);
    height = std::max(height, cell.picture.height);
  }
  if (width == 0) return;
  width = std::max(width, kLeastCell);
  const int dot = dot_of(width);
  std::map<std::size_t, std::vector<std::string>> labels;
  std::size_t lines = 1;
  for (const auto& [number, cell] : filled_) {
    labels[number] = lines_of(cell.label, std::size_t(width / (dot * kLetterWidth)));
    lines = std::max(lines, labels[number].size());
  }
  const int line = dot * kLetterHeight + kGap / 2, label = int(lines) * line + kGap / 2;
  const std::size_t row = 3 * (columns_ * std::size_t(width + kGap) + kGap);  // values
  const std::size_t rows = (cells_ + columns_ - 1) / columns_ * std::size_t(label + height + kGap) + kGap;
  std::vector<float> pixels(row * rows, kPaper);
  for (const auto& [number, cell] : filled_) {
    const std::size_t left = kGap + number % columns_ * std::size_t(width + kGap);
    const std::size_t top = kGap + number / columns_ * std::size_t(label + height + kGap);
    const auto at = [&](int x, int y) {
      return pixels.begin() + std::ptrdiff_t(row * (top + std::size_t(y)) + 3 * (left + std::size_t(x)));
    };
    for (int i = 0; i < int(labels[number].size()); i++) {
      const std::string& text = labels[number][std::size_t(i)];
      for (int y = 0; y < kLetterHeight * dot; y++)
        for (int x = 0; x < int(text.size()) * kLetterWidth * dot; x++)
          if (has_ink(text[std::size_t(x / dot / kLetterWidth)], x / dot % kLetterWidth, y / dot))
            std::fill_n(at(x, i * line + y), 3, kInk);
    }
    const auto& picture = cell.picture;
    for (int y = 0; y < picture.height; y++)
      std::copy_n(picture.pixels.begin() + 3 * y * picture.width, 3 * picture.width, at(0, label + y));
  }
  write_png(path, int(row / 3), int(rows), 3, pixels);
}

}  // namespace alcove
