// What inspecting a frame finds, as values; and the same as text for people and as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/formats/exr.h"
#include "core/frame/evidence.h"
#include "core/frame/gbuffer.h"

namespace alcove {

struct InspectedPart {
  ExrPart header;
  std::map<std::string, std::string> attributes;
};

struct InspectedFile {
  std::string path;
  Window display;
  double pixel_aspect;
  std::vector<InspectedPart> parts;
};

/// The rules by which the frame is read, and the attribute, channel or option that told.
struct InspectedSource {
  std::string name, by;
};

struct InspectedAov {
  std::string name, file;
  int part;
  std::vector<std::string> channels;
  bool is_chosen;  // The user named it by an option.
};

struct InspectedCamera {
  Camera camera;
  std::string from;
};

struct InspectedDepth {
  std::string kind;
  ValueStatistics values;
  // Distances are in scene units. They are unknown until the frame is settled, and where all is sky.
  std::optional<double> sky_share, nearest, median, farthest;
  std::optional<std::vector<DepthScore>> scores;
};

struct InspectedNormals {
  NormalSpace space;
  std::string encoding;
  NormalFlips flips;
  double least, most;                             // of all components
  std::optional<double> mean_length, unit_share;  // none where the normals are no vectors in x, y and z
  std::vector<NormalScore> scores;                // the best first
  std::optional<NormalScore> chosen;              // the score of the reading that was taken
};

struct Inspection {
  std::vector<InspectedFile> files;
  std::optional<InspectedSource> source;
  std::vector<InspectedAov> aovs;
  std::optional<InspectedCamera> camera;
  std::optional<InspectedDepth> depth;
  std::optional<InspectedNormals> normals;
  std::vector<Guess> guesses;
  std::vector<std::string> notes, suspicious, missing;  // one sentence each
  std::string command;                                  // the run that reads the frame so; empty if there is none
  std::optional<Error> unreadable;  // The headers are whole and the pixels are not: the rest is what the headers tell.
};

/// Lines for people, without any character that a terminal would obey.
std::string inspection_text(const Inspection& inspection);

/// JSON with the fields that README.md lists.
std::string inspection_json(const Inspection& inspection);

const char* name_of(NormalSpace space);
const char* name_of(SampleType type);

}  // namespace alcove
