// The file of compiled pipelines: its name, and what a driver may see of it. Drivers trust their caches, and some crash
// on damaged ones, so nothing reaches a driver that is not, bit for bit, what the same driver has given.
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
  std::array<std::uint8_t, 16> uuid{};  // of the driver's version too

  bool operator==(const CacheOwner&) const = default;
};

/// The folder of all owners, after the XDG base directory specification; empty when there is no home.
std::string cache_folder();

/// The path of the owner's file in the XDG cache folder; empty when there is no home.
std::string cache_file(const CacheOwner& owner);

/// A driver's data as a file: a header with length and checksum goes before them.
std::string packed_cache(std::span<const char> data);

/// The driver's data in a file; empty unless they are whole and this owner's.
std::span<const char> checked_cache(std::span<const char> file, const CacheOwner& owner);

/// As checked_cache, from the path; empty too where it cannot be read.
std::string read_cache(const std::string& path, const CacheOwner& owner);

/// Replaces the file. What goes wrong is passed over: a cache that cannot be written costs time, not results, and
/// read-only homes are normal on farms.
void write_cache(const std::string& path, std::span<const char> data) noexcept;

}  // namespace alcove::gpu
