// What a frame's files hold, how `run` would understand them and why, and what is missing: as values, as text for
// people and as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/note.h"
#include "core/base/settings.h"
#include "core/formats/deep_surfaces.h"
#include "core/formats/exr.h"
#include "core/frame/camera/camera.h"
#include "core/frame/evidence.h"
#include "core/frame/gbuffer.h"
#include "core/frame/matte.h"

namespace alcove {

struct InspectedDeep {
  std::string file;
  std::vector<int> parts;  // whose samples were put together
  DeepLayout layout;       // of the first of them
  DeepCounts counts;       // over the whole file
  // "planar" or "along the ray", by the flat depth beside it; "the depth of the frame"; empty: nothing tells
  std::string depth;
  std::vector<std::string> channels;  // of the surfaces that its samples make, those that any pixel has

  double samples_per_pixel() const { return double(counts.samples) / double(counts.pixels); }
  /// Of the samples, those that lie behind an opaque one.
  double hidden_share() const { return double(counts.covered) / double(std::max<std::uint64_t>(1, counts.samples)); }
  /// Whether so few are hidden that the file was rendered in one go, up to the first opaque surface of each ray.
  bool shows_nothing_hidden() const { return hidden_share() < 1e-3; }
};

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

/// Of the surfaces, in scene units; none where all is sky.
struct Distances {
  double sky_share = 0;
  std::optional<double> nearest, median, farthest;
};
/// `raw` is the depth of a settled frame, as it was read.
Distances distances_of(const FrameSource& source, std::span<const float> raw);

struct InspectedDepth {
  std::string kind;
  ValueStatistics values;
  std::optional<Distances> distances;  // none until the frame is settled
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
  Distances distances;
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

const char* name_of(SampleType type);

/// Those among the channels of the frame's files that nothing is read from yet, by their names: of the frame's view and
/// the settings' layer, since a run finds no others.
std::vector<HiddenGuess> hidden_guesses(const FrameSource& source, const InputSettings& settings);

/// What a run is told of files and frames.
struct CommandNames {
  InputSettings inputs;  // whose files and cameras it names
  std::string output = "ao.exr";
  std::string frames = {};  // a list, or empty
};

/// The run that reads the settled frame as it was understood, every guess made explicit. Without a camera or a radius
/// to propose it holds a word to be replaced.
std::string command_of(const FrameSource& source, const CommandNames& names, bool has_camera);

/// The text of a camera file that read_camera() reads back: of a frame by itself, or of a sequence with its `frames`,
/// by number.
std::string camera_file(const Camera& camera);
std::string camera_file(const std::map<int, Camera>& cameras);

/// Writes an 8-bit PNG to settings.output.preview, with the data window three times: depth (near is bright,
/// logarithmic), view-space normals (0.5 + 0.5 n) and AO, sky in a colour of its own. The radius is
/// settings.estimator.radius, or else a tenth of the median distance. Fails as reading and computing the frame do, and
/// with ErrorKind::output.
void write_contact_sheet(const Settings& settings, int frame);

/// Opens the files that the settings name and reads depth and normals. What `run` would refuse is part of the answer;
/// only a file whose header cannot be read fails, with ErrorKind::input.
Inspection inspect_frame(const InputSettings& settings, int frame);

/// Does the same for a frame of a sequence. `run` is what the proposed command names instead of the frame's files.
Inspection inspect_frame(const InputSettings& settings, int frame, const CommandNames& run);

/// Whether the settings or the frame give a camera.
struct CameraSearch {
  // what to give where nothing gives one, and why the frame's positions, if it has any, do not; "" where there is one
  std::string lacking;
  std::optional<FrameSource> found;  // the frame, where it had to be found to know
};
/// A file that cannot be opened has no camera.
CameraSearch look_for_camera(const InputSettings& settings, int frame);

/// The frames that a sequence is told of, and their files.
struct SequenceNames {
  InputSettings named;                   // as the user gave them, with places for the frame number
  std::vector<int> frames;               // those that there are, in order, at least one
  std::vector<int> absent;               // those that were asked for, or lie between them, and are not there
  std::vector<int> evidence;             // some of them, by one of which a run decides how all are read
  std::string said;                      // --frames, or empty
  std::function<InputSettings(int)> of;  // the settings with the files of one frame
};

/// Inspects the frame by which a run would decide how all are read, and adds what changes along the sequence: by the
/// headers of all frames, and by the pixels of a few. Fails as inspect_frame() does for that frame; what is wrong with
/// others is part of the answer.
Inspection inspect_sequence(const SequenceNames& names);

}  // namespace alcove
