// OpenEXR files in and out: headers, chosen channels in one pass, whole files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/settings.h"

namespace alcove {

enum class SampleType { half_float, single_float, integer };

struct ExrChannel {
  std::string name;
  SampleType type;
  bool subsampled;  // fewer samples than pixels: cannot be read as a plane
};

struct ExrPart {
  std::string name;  // empty in single-part files
  std::string view;  // of stereo files with a part a view; empty: none
  // of stereo files whose channels name their view, the default first; empty: none
  std::vector<std::string> multi_view;
  Window data;
  std::vector<ExrChannel> channels;
  bool dwa = false;  // compressed by DWAA or DWAB, which are lossy for channels whose name ends in R, G, B, Y, RY or BY
};

/// All attributes of one part's header, of every type, and those that only the first part has, to be carried into an
/// output.
class ExrAttributes;
class PictureReader;

/// A channel to read, and where to: width x height floats of the part's data window, or of some of its rows, row by
/// row.
struct ExrRead {
  int part;
  std::string channel;
  float* to;
};

/// An EXR file whose header has been read. Every failure is ErrorKind::input and names the file.
class ExrFile {
 public:
  /// Fails on a missing file, a folder, a file that is no EXR, deep data, no channels, and headers that ask for more
  /// than their file can hold.
  explicit ExrFile(const std::string& path, const char* option);
  /// Pictures of other formats with the same face: one whose header has been read, and one that has been read whole.
  ExrFile(const std::string& path, const char* option, std::unique_ptr<PictureReader> picture);
  ExrFile(const std::string& path, const char* option, Image image);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;

  const std::string& path() const;
  const std::vector<ExrPart>& parts() const;
  const Window& display() const;
  /// Width over height of a pixel.
  double pixel_aspect() const;
  std::shared_ptr<const ExrAttributes> attributes(int part) const;
  /// The attributes of a part that do not describe its storage, as text: numbers, strings and matrices by value, all
  /// else by type; the first 64 KiB.
  std::map<std::string, std::string> attribute_texts(int part) const;

  /// Reads the channels as float, each part decoded once. Fails on truncated or corrupt data.
  void read(std::span<const ExrRead> reads);
  /// Only `rows` rows of the parts' data windows, from the `first` one on.
  void read(std::span<const ExrRead> reads, int first, int rows);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Fails with ErrorKind::input where planes of that window are too much for host memory; before they are made, since a
/// header may say anything.
void require_host_room(const std::string& path, const Window& data);

/// A plane to write: width x height floats of the data window.
struct ExrPlane {
  std::string channel;
  SampleType type;  // half: rounded to nearest, at most +-65504
  std::span<const float> pixels;
};

struct ExrOutput {
  Window data, display;
  double pixel_aspect = 1;
  std::string compression = "zip";  // none, rle, zips, zip, piz
  // carried over, but those that describe the input's own channels and storage
  std::shared_ptr<const ExrAttributes> attributes;
  std::map<std::string, std::string> own_attributes;  // added as strings
  std::vector<ExrPlane> planes;
};

/// A single-part scan-line file, written from top to bottom: there once it is finished, else not at all. Fails with
/// ErrorKind::output.
class ExrWriter {
 public:
  /// The pixels of output.planes are not looked at.
  ExrWriter(const std::string& path, const ExrOutput& output);
  ~ExrWriter();
  ExrWriter(ExrWriter&&) noexcept;

  /// The next rows of every plane, as wide as the data window.
  void write(std::span<const std::span<const float>> planes);
  /// After the last row.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The same at once, with the pixels of output.planes.
void write_exr(const std::string& path, const ExrOutput& output);

/// Every channel of the file's first part that holds all the named ones (all channels: no names), as an image. Fails
/// with ErrorKind::input.
Image read_exr_image(const std::string& path, const std::vector<std::string>& channels = {});

/// A text attribute of a file that is whole: every chunk of its first part lies within it, which a file cut short does
/// not show otherwise. Nothing where it is not, where it is no EXR, and where there is no such attribute.
std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name);

/// How many threads the codecs may use, for the whole process; 0: none beside the caller's.
void set_exr_threads(int threads);

}  // namespace alcove
