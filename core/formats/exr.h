// OpenEXR files in and out: headers, chosen channels in one pass, whole files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"

namespace alcove {

enum class SampleType { half_float, single_float, integer };

struct ExrChannel {
  std::string name;
  SampleType type;
  bool subsampled;  // fewer samples than pixels: cannot be read as a plane
};

struct ExrPart {
  std::string name;  // empty in single-part files
  std::string view;  // of stereo files that have one part per view; empty: none
  // the views of stereo files whose channels name their view, the default first; empty: none
  std::vector<std::string> multi_view;
  Window data;
  std::vector<ExrChannel> channels;
  bool dwa = false;  // compressed by DWAA or DWAB, which are lossy for channels whose name ends in R, G, B, Y, RY or BY
};

/// The attributes of one part's header, of every type, and those that only the first part has. They are carried into
/// outputs.
class ExrAttributes;
class PictureReader;

/// A channel to read and its destination: one float per pixel of the part's data window, or of some of its rows, row by
/// row.
struct ExrRead {
  int part;
  std::string channel;
  float* to;
};

/// An EXR file whose header has been read. Every failure is ErrorKind::input and names the file.
class ExrFile {
 public:
  /// Fails on a missing file, a folder, a file that is no EXR, deep data, a part without channels, and headers that
  /// ask for more than their file can hold.
  explicit ExrFile(const std::string& path, const char* option);
  /// Pictures of other formats, to be read like an EXR of one part: the first has been opened, the second read whole.
  ExrFile(const std::string& path, const char* option, std::unique_ptr<PictureReader> picture);
  ExrFile(const std::string& path, const char* option, Image image);
  ~ExrFile();
  ExrFile(ExrFile&&) noexcept;

  const std::string& path() const;
  const std::vector<ExrPart>& parts() const;
  const Window& display() const;
  /// The width of a pixel over its height.
  double pixel_aspect() const;
  std::shared_ptr<const ExrAttributes> attributes(int part) const;
  /// Gives as text the attributes of a part that do not describe its storage. Numbers, strings and matrices are given
  /// by value, of which the first 64 KiB count, and all else by type.
  std::map<std::string, std::string> attribute_texts(int part) const;

  /// Reads the channels as float, each part decoded once. Fails on truncated or corrupt data.
  void read(std::span<const ExrRead> reads);
  /// Reads only `rows` rows of the parts' data windows, from the `first` one on.
  void read(std::span<const ExrRead> reads, int first, int rows);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Fails with ErrorKind::input if planes of that window are too much for host memory. It is asked before they are made,
/// since a header may say anything.
void require_host_room(const std::string& path, const Window& data);

/// A plane to write: one float per pixel of the data window.
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

/// Writes a single-part scan-line file from top to bottom. The file has its name once it is finished, and is gone if it
/// is not. Fails with ErrorKind::output.
class ExrWriter {
 public:
  /// Ignores the pixels of output.planes.
  ExrWriter(const std::string& path, const ExrOutput& output);
  ~ExrWriter();
  ExrWriter(ExrWriter&&) noexcept;

  /// Writes the next rows of every plane, as wide as the data window.
  void write(std::span<const std::span<const float>> planes);
  /// Ends the file after its last row.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a whole file with the pixels of output.planes.
void write_exr(const std::string& path, const ExrOutput& output);

/// Reads the named channels, from the first part that holds all of them; without names, every channel of the first
/// part. Fails with ErrorKind::input.
Image read_exr_image(const std::string& path, const std::vector<std::string>& channels = {});

/// Gives a text attribute of a file that is whole, with every chunk of its first part within it; a file that was cut
/// short shows it in no other way. Gives nothing if the file is cut, is no EXR, or has no such attribute.
std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name);

/// Gives the value of a half float's bits.
float from_half(std::uint16_t bits);

/// Sets how many threads the codecs may use in the whole process. 0: none beside the caller's.
void set_exr_threads(int threads);

}  // namespace alcove
