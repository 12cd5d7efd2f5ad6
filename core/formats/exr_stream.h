// What the sources share that write EXR files: a stream that keeps what fails, and words of OpenEXR. No other file
// includes this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ImfCompression.h>
#include <ImfIO.h>
#include <half.h>

#include <optional>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/formats/exr_attributes.h"

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

/// Whether an attribute says how Alcove has made the input, which does not hold for what is made from it.
bool is_own_attribute(std::string_view name);

/// The compression of that name of ExrOutput; ZIP where there is none.
Imf::Compression compression_of(const std::string& name);

/// Rounds to nearest. Values beyond half's range become its largest value, not infinity.
std::vector<half> to_half(std::span<const float> values);

}  // namespace alcove
