// The EXR header after "OpenEXR File Layout": magic, version, attributes (name, type, size, value), an empty name.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/exr_header.h"

#include <ostream>

#include "tests/support/program.h"

namespace alcove::test {
namespace {

/// Bytes read from the front.
struct Bytes {
  const std::string& bytes;
  std::size_t at = 0;

  std::int32_t integer() {
    std::int32_t value = 0;
    std::memcpy(&value, take(4).data(), 4);
    return value;
  }
  std::string take(std::size_t count) {
    if (bytes.size() - at < count) throw std::runtime_error("the header ends early");
    at += count;
    return bytes.substr(at - count, count);
  }
  std::string text() {
    const std::size_t end = bytes.find('\0', at);
    if (end == bytes.npos) throw std::runtime_error("a name of the header does not end");
    const std::string text = bytes.substr(at, end - at);
    at = end + 1;
    return text;
  }
};

}  // namespace

ExrHeader read_header(const std::string& path) {
  const std::string file = read_bytes(path);
  Bytes bytes{file};
  if (bytes.integer() != 20000630) throw std::runtime_error(path + ": no EXR");
  if (const auto version = bytes.integer(); (version & 0x1aff) != 2)
    throw std::runtime_error(path + ": no single-part scan-line EXR");
  ExrHeader header;
  for (std::string name = bytes.text(); !name.empty(); name = bytes.text()) {
    const std::string type = bytes.text();
    header[name] = {type, bytes.take(std::size_t(bytes.integer()))};
  }
  return header;
}

std::vector<HeaderChannel> channels_in(const ExrHeader& header) {
  Bytes bytes{header.at("channels").bytes};
  std::vector<HeaderChannel> channels;
  for (std::string name = bytes.text(); !name.empty(); name = bytes.text()) {
    channels.push_back({name, bytes.integer()});
    bytes.take(12);  // perceptual linearity, three unused bytes, sampling in x and y
  }
  return channels;
}

std::string text_in(const ExrHeader& header, const std::string& name) {
  const auto found = header.find(name);
  return found == header.end() || found->second.type != "string" ? "(none)" : found->second.bytes;
}

}  // namespace alcove::test
