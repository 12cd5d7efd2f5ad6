// The file of compiled pipelines: its name, and checks of its contents. Drivers trust their caches, and some crash on
// damaged ones. So a driver gets only data that the same driver has given, bit for bit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace alcove::gpu {

/// The device and driver that a cache is for, as the header of its data says.
struct CacheOwner {
  std::uint32_t vendor = 0, device = 0;
  std::array<std::uint8_t, 16> uuid{};  // identifies the driver's version too

  bool operator==(const CacheOwner&) const = default;
};

/// The folder of the caches of all owners, by the XDG base directory specification; empty without a home.
std::string cache_folder();

/// The path of the owner's file in the XDG cache folder; empty without a home.
std::string cache_file(const CacheOwner& owner);

/// The contents of a cache file: a header with length and checksum, and the driver's data.
std::string packed_cache(std::span<const char> data);

/// The driver's data in the contents of a file; empty unless they are whole and the owner's.
std::span<const char> checked_cache(std::span<const char> file, const CacheOwner& owner);

/// The driver's data in the file at a path; empty unless they can be read, are whole, and are the owner's.
std::string read_cache(const std::string& path, const CacheOwner& owner);

/// Replaces the file. Failures are ignored: a cache that cannot be written costs time, not results, and read-only homes
/// are normal on farms.
void write_cache(const std::string& path, std::span<const char> data) noexcept;

}  // namespace alcove::gpu
