// Header and checks of the file of compiled pipelines, and its place.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/pipeline_cache.h"

#include <vulkan/vulkan_core.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/error.h"
#include "core/base/file.h"

namespace alcove::gpu {
namespace {

namespace fs = std::filesystem;

struct FileHeader {
  std::array<char, 8> magic{'a', 'l', 'c', 'o', 'v', 'e', 'P', '1'};
  std::uint64_t bytes = 0;     // behind this header
  std::uint64_t checksum = 0;  // XXH3 of them
};
static_assert(sizeof(FileHeader) == 24);

/// The beginning of `bytes` as a T. There must be enough of them.
template <class T>
T beginning_of(std::span<const char> bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

/// Whether data begin with the header that Vulkan demands, and that header names the owner.
bool is_owned(std::span<const char> data, const CacheOwner& owner) {
  if (data.size() < sizeof(VkPipelineCacheHeaderVersionOne)) return false;
  const auto header = beginning_of<VkPipelineCacheHeaderVersionOne>(data);
  if (header.headerSize != sizeof(header) || header.headerVersion != VK_PIPELINE_CACHE_HEADER_VERSION_ONE) return false;
  return owner == CacheOwner{header.vendorID, header.deviceID, std::to_array(header.pipelineCacheUUID)};
}

}  // namespace

std::string cache_folder() {
  const std::string home = cache_home();
  return home.empty() ? "" : (fs::path(home) / "alcove").string();
}

std::string cache_file(const CacheOwner& owner) {
  const std::string folder = cache_folder();
  if (folder.empty()) return "";
  std::string uuid;
  for (const std::uint8_t byte : owner.uuid) uuid += fmt::format("{:02x}", byte);
  const std::string name = fmt::format("pipelines-{:04x}-{:04x}-{}.bin", owner.vendor, owner.device, uuid);
  return (fs::path(folder) / name).string();
}

std::string packed_cache(std::span<const char> data) {
  FileHeader header;
  header.bytes = data.size();
  header.checksum = XXH3_64bits(data.data(), data.size());
  std::string file(sizeof(header), '\0');
  std::memcpy(file.data(), &header, sizeof(header));
  return file.append(data.data(), data.size());
}

std::span<const char> checked_cache(std::span<const char> file, const CacheOwner& owner) {
  if (file.size() < sizeof(FileHeader)) return {};
  const auto header = beginning_of<FileHeader>(file);
  const auto data = file.subspan(sizeof(header));
  if (header.magic != FileHeader{}.magic || header.bytes != data.size()) return {};
  if (header.checksum != XXH3_64bits(data.data(), data.size()) || !is_owned(data, owner)) return {};
  return data;
}

std::string read_cache(const std::string& path, const CacheOwner& owner) {
  std::ifstream stream(fs::path(path), std::ios::binary);
  const std::string file = read_rest(stream);
  const auto data = checked_cache(file, owner);
  return {data.begin(), data.end()};
}

void write_cache(const std::string& path, std::span<const char> data) noexcept {
  try {
    fs::create_directories(fs::path(path).parent_path());
    write_whole(path, packed_cache(data));
  } catch (const std::exception&) {
    // write_cache() ignores failures: see the header.
  }
}

}  // namespace alcove::gpu
