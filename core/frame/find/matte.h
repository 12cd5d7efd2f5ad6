// Selections of surfaces: receivers of AO (--matte), blockers (occluders, ignore); Cryptomattes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/formats/exr.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

/// A Cryptomatte of a file: a layer of channels in ranks, each an object's identifier and its coverage.
struct Cryptomatte {
  std::string name;  // of the layer, such as CryptoObject
  int part = 0;      // of the file
  // the names of objects with their identifiers, the bits of a float; empty: the file has none
  std::map<std::string, std::uint32_t> manifest = {};
  std::string manifest_file = {};  // beside the file, where the header has no manifest but names that
  std::string lacking = {};        // why there is no manifest, where there ought to be one
  struct Rank {
    std::string object, coverage;  // channels
  };
  std::vector<Rank> ranks = {};  // by coverage, the largest first
};

/// Gives all Cryptomattes of a view of a file that have channels, with their manifests. A manifest may be a file beside
/// it. Never fails: a senseless header or manifest is none.
std::vector<Cryptomatte> cryptomattes_of(const ExrFile& file, const std::string& view);

/// The identifier of a name: MurmurHash3 (32 bits, Appleby) of its UTF-8, changed where it is no normal number.
std::uint32_t cryptomatte_id(const std::string& name);

/// Finds the matte if the settings ask for one, in --matte or else in INPUT. Without objects it is a plane of coverage.
/// With objects it is their coverage in a Cryptomatte: patterns and names are looked up in its manifest; without a
/// manifest names are taken as they are. If matte-channel names another channel, objects are its numbers. Fails with
/// ErrorKind::input if nothing is found, and names the file and its content, or if the matte has another window than
/// the depth.
void find_matte(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Finds the selection of occluders if the settings ask for one: a file of coverage; or objects, as above, in the file
/// of objects or else in INPUT. Numbers need no object-channel if the channel has a usual name. Fails alike.
void find_occluders(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

}  // namespace alcove
