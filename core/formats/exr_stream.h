// What the sources share that write EXR files: a stream that keeps what fails, and words of OpenEXR. No other file
// includes this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfPixelType.h>

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/formats/exr_shared.h"

namespace alcove {

/// An output stream into a file in the making. OpenEXR swallows what fails while it closes a file; failure() keeps it.
class FileStream : public Imf::OStream {
 public:
  explicit FileStream(const std::string& path) : Imf::OStream(path.c_str()), file_(path) {}
  void write(const char data[], int count) override {
    try {
      file_.write_at(position_, {data, std::size_t(count)});
    } catch (const Error& error) {
      if (!failure_) failure_ = error;
      throw;
    }
    position_ += std::uint64_t(count);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  const std::optional<Error>& failure() const { return failure_; }
  void commit() { file_.commit(); }
  const std::string& temporary() const { return file_.temporary(); }

 private:
  NewFile file_;
  std::uint64_t position_ = 0;
  std::optional<Error> failure_;
};

/// Runs a step of writing a file into a stream. Where the stream failed, its error is the reason that OpenEXR does not
/// tell. What is wrong with a file that is read for it is an Error, which passes.
template <class Function>
void run_writing(const FileStream& stream, const std::string& path, Function&& function) {
  try {
    function();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    if (!stream.failure()) fail(ErrorKind::output, "{}: could not be encoded: {}", path, one_line(error));
  }
  if (stream.failure()) throw *stream.failure();
}

/// Whether an attribute says how Alcove has made the input, which does not hold for what is made from it.
bool is_own_attribute(std::string_view name);

/// The compression of that name of ExrOutput; ZIP where there is none.
Imf::Compression compression_of(const std::string& name);

/// The type of a plane's channel.
Imf::PixelType pixel_type_of(SampleType type);

/// Rows of a plane as OpenEXR takes them; `halves` keeps those that are converted. Values are rounded to the nearest
/// half; beyond half's range they become its largest value, not infinity.
Imf::Slice slice_of(const Window& rows, SampleType type, std::span<const float> pixels,
                    std::deque<std::vector<std::uint16_t>>& halves);

}  // namespace alcove
