// Cryptomatte, after its specification 1.2.0 (Friedman and Jones, "Fully automatic ID mattes with support for motion
// blur and transparency", 2015; Psyop): which objects a file knows, and in which channels they lie.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/formats/exr.h"

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
  std::vector<Rank> ranks = {};  // the one that covers most first
};

/// All Cryptomattes of a view of a file, with their manifests, of which one may be a file beside it; those without
/// channels are left out. Never fails: a header or a manifest that makes no sense is none.
std::vector<Cryptomatte> cryptomattes_of(const ExrFile& file, const std::string& view);

/// The identifier of a name: MurmurHash3 (32 bits, Appleby) of its UTF-8, changed where it is no normal number.
std::uint32_t cryptomatte_id(const std::string& name);

}  // namespace alcove
