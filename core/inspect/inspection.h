// What inspecting a frame finds, as values; and the same as text for people and as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/note.h"
#include "core/formats/exr.h"
#include "core/frame/cryptomatte.h"
#include "core/frame/evidence.h"
#include "core/frame/flatness.h"
#include "core/frame/gbuffer.h"
#include "core/inspect/deep_samples.h"

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
  std::vector<Cryptomatte> cryptomattes = {};
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

/// Something that is not the same in all frames of a sequence.
struct SequenceChange {
  std::string what;
  // In the order in which the values come: the value, and the frames that have it.
  std::vector<std::pair<std::string, std::vector<int>>> values;
};

/// How the camera of a sequence moves, from its first frame on.
struct SequenceCamera {
  double farthest = 0;               // from its first place, scene units
  double largest_turn = 0;           // from its first direction, degrees
  double largest_step = 0;           // from one frame to the next, scene units
  int at_largest_step = 0;           // the frame after it
  double widest = 0, narrowest = 0;  // horizontal field of view in degrees; orthographic: scene units
  bool is_placed = false;            // false: no frame says where it stands
};

/// The distances of one frame of a sequence.
struct SequenceDepth {
  int frame;
  double sky_share;
  std::optional<double> nearest, median, farthest;  // scene units; none where all is sky
};

struct InspectedSequence {
  int shown;                        // the frame that all else describes
  std::vector<int> frames, absent;  // there, and not there: asked for, or between those that are there
  std::vector<SequenceChange> changes;
  std::vector<std::string> same;         // what was looked at and does not change
  std::optional<SequenceCamera> camera;  // none without a camera
  std::vector<SequenceDepth> depth;      // of the frames whose pixels were read
};

/// A channel that may hold what lies behind the first surface, by its name alone.
struct HiddenGuess {
  std::string file, channel;
  BehindKind kind;
};

struct Inspection {
  std::vector<InspectedFile> files;
  std::optional<InspectedSource> source;
  std::vector<InspectedAov> aovs;
  std::optional<InspectedCamera> camera;
  std::optional<InspectedDepth> depth;
  std::optional<InspectedNormals> normals;
  std::vector<InspectedDeep> deep;
  std::vector<Guess> guesses;
  std::vector<HiddenGuess> hidden;  // what is not read unless a run is told to
  std::string hidden_options;       // by which it takes all of them; "" where there are none
  Notes notes, suspicious;
  std::vector<std::string> missing;           // one sentence each
  std::vector<std::string> refused;           // what is given and a run would fail on; the rest is without it
  std::string command;                        // the run that reads the frame so; empty if there is none
  bool shows_surfaces = false;                // the pixels show how they are to be read
  std::optional<InspectedSequence> sequence;  // none of a single frame
  std::optional<Error> unreadable;  // The headers are whole and the pixels are not: the rest is what the headers tell.
};

/// Lines for people, without any character that a terminal would obey: the reading first, the command last. With
/// `has_evidence` also attributes, statistics and the scores of every reading.
std::string inspection_text(const Inspection& inspection, bool has_evidence);

/// JSON with the fields that docs/inputs.md lists.
std::string inspection_json(const Inspection& inspection);

const char* name_of(NormalSpace space);
const char* name_of(SampleType type);

}  // namespace alcove
