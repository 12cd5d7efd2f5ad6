// A labelled picture of pictures: the contact sheet of a shot, the looks of a wedge.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// Interleaved display values in [0, 1], rows from the top.
struct ShownPicture {
  int width = 0, height = 0, channels = 1;  // channels: 1 or 3
  std::vector<float> pixels;
};

/// Cells in rows, each a label with pictures below it, one above the other. All have the room of the first that comes.
/// Larger pictures are shrunk by a whole number, so that the sheet stays about 3840 px wide.
class Sheet {
 public:
  /// `columns`: 0: about as many as rows.
  explicit Sheet(std::size_t cells, std::size_t columns = 0);
  /// Fills a cell, or only its label. Any thread may. ASCII is drawn, and other characters as ?.
  void put(std::size_t cell, const std::string& label, std::span<const ShownPicture> pictures);
  /// Writes a PNG; nothing where there is no picture. Fails with ErrorKind::output.
  void write(const std::string& path);

 private:
  int left_of(std::size_t cell) const;
  int top_of(std::size_t cell) const;
  int shrinkage(const ShownPicture& picture) const;
  void draw(int left, int top, const std::string& label);
  void draw(int left, int top, int room, const ShownPicture& picture);
  float* at(int x, int y) { return pixels_.data() + 3 * (std::size_t(y) * std::size_t(width_) + std::size_t(x)); }

  const std::size_t cells_, columns_;
  std::mutex mutex_;  // of all below
  std::map<std::size_t, std::string> labels_;
  int cell_width_, cell_height_ = 0;  // px, without the gaps between; height 0: no cell is filled yet
  int width_ = 0, height_ = 0;
  std::vector<float> pixels_;
};

}  // namespace alcove
