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
constexpr int kLabelHeight = 2 * kLetterHeight + kGap;        // px: letters may have twice their size
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

}  // namespace

Sheet::Sheet(std::size_t cells, std::size_t columns)
    : cells_(cells),
      columns_(columns ? columns : std::size_t(std::ceil(std::sqrt(double(cells))))),
      cell_width_(std::max(kLeastCell, kMostWidth / int(columns_))) {}

int Sheet::shrinkage(const ShownPicture& picture) const { return (picture.width + cell_width_ - 1) / cell_width_; }

void Sheet::put(std::size_t cell, const std::string& label, std::span<const ShownPicture> pictures) {
  const std::lock_guard lock(mutex_);
  labels_[cell] = label;
  if (pictures.empty()) return;
  if (cell_height_ == 0) {
    const int shrunk = shrinkage(pictures[0]);
    cell_height_ = kLabelHeight + int(pictures.size()) * (pictures[0].height / shrunk + kGap);
    cell_width_ = (pictures[0].width + shrunk - 1) / shrunk;  // in which it is shrunk by as much
    width_ = int(columns_) * (cell_width_ + kGap) + kGap;
    height_ = int((cells_ + columns_ - 1) / columns_) * cell_height_ + kGap;
    pixels_.assign(3 * std::size_t(width_) * std::size_t(height_), kPaper);
  }
  const int room = (cell_height_ - kLabelHeight) / int(pictures.size());
  for (std::size_t i = 0; i < pictures.size(); i++)
    draw(left_of(cell), top_of(cell) + kLabelHeight + int(i) * room, room, pictures[i]);
}

int Sheet::left_of(std::size_t cell) const { return kGap + int(cell % columns_) * (cell_width_ + kGap); }

int Sheet::top_of(std::size_t cell) const { return kGap + int(cell / columns_) * cell_height_; }

void Sheet::draw(int left, int top, const std::string& label) {
  const int size = int(label.size()) * kLetterWidth * 2 <= cell_width_ ? 2 : 1;
  const int width = std::min(cell_width_, int(label.size()) * kLetterWidth * size);
  for (int y = 0; y < kLetterHeight * size; y++)
    for (int x = 0; x < width; x++)
      if (has_ink(label[std::size_t(x / size / kLetterWidth)], x / size % kLetterWidth, y / size))
        std::fill_n(at(left + x, top + y), 3, kInk);
}

void Sheet::draw(int left, int top, int room, const ShownPicture& picture) {
  const int shrunk = shrinkage(picture);
  for (int y = top; y < top + std::min(picture.height / shrunk, room - kGap); y++)
    for (int x = left; x < left + picture.width / shrunk; x++)
      for (int c = 0; c < 3; c++) {
        float sum = 0;
        for (int i = 0; i < shrunk * shrunk; i++) {
          const auto row = std::size_t((y - top) * shrunk + i / shrunk);
          const auto column = std::size_t((x - left) * shrunk + i % shrunk);
          sum += std::clamp(picture.pixels[(row * std::size_t(picture.width) + column) * std::size_t(picture.channels) +
                                           std::size_t(std::min(c, picture.channels - 1))],
                            0.0f, 1.0f);
        }
        at(x, y)[c] = sum / float(shrunk * shrunk);
      }
}

void Sheet::write(const std::string& path) {
  if (pixels_.empty()) return;
  for (const auto& [cell, label] : labels_) draw(left_of(cell), top_of(cell), label);
  write_png(path, width_, height_, 3, pixels_);
}

}  // namespace alcove
