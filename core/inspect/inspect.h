// The contents of a frame's files, the way `run` would read them and why, and missing inputs: as values, as text for
// people and as JSON.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
#include "core/frame/find/frame_source.h"
#include "core/frame/find/matte.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/reading.h"
#include "core/run/plan.h"

namespace alcove {

struct InspectedDeep {
  std::string file;
  std::vector<int> parts;  // their samples are put together
  DeepLayout layout;       // of the first of them
  DeepCounts counts;       // over the whole file
  // "planar" or "along the ray", by the flat depth beside it; "the depth of the frame"; empty: unknown
  std::string depth;
  std::vector<std::string> channels;  // the surfaces of its samples that any pixel has

  double samples_per_pixel() const { return double(counts.samples) / double(counts.pixels); }
  /// The share of samples that lie behind an opaque one.
  double hidden_share() const { return double(counts.covered) / double(std::max<std::uint64_t>(1, counts.samples)); }
  /// Whether so few samples are hidden that the file was rendered in one go, up to the first opaque surface of each
  /// ray.
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

/// The rules by which the frame is read, and the attribute, channel or option that told them.
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

/// The distances of surfaces, in scene units; none if everything is sky.
struct Distances {
  double sky_share = 0;
  std::optional<double> nearest, median, farthest;
};
/// Gives the distances of a settled frame. `raw` is its depth over source.reading.data, as it was read.
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
  std::optional<double> mean_length, unit_share;  // none if the normals are not vectors in x, y and z
  std::vector<NormalScore> scores;                // the best first
  std::optional<NormalScore> chosen;              // the score of the chosen reading
};

/// Whether the light passes beside the beauty add up to it, as a composite of them needs.
struct InspectedLight {
  std::string renderer;              // whose passes they are by their names
  std::string sum;                   // such as "(DiffDir + DiffInd) x DiffCol + Emit"
  std::vector<std::string> lacking;  // passes of that renderer that the file does not hold
  double share = 0;                  // of the beauty that the sum is, over the surfaces
  double other_part = 0;             // of the surfaces, where the sum is another light than the beauty
  double other_share = 1;            // of the beauty there that the sum is
  bool adds_up = false;              // the sum is the beauty all over the surfaces, up to noise
};

/// A property that changes along a sequence.
struct SequenceChange {
  std::string what;
  // Each value with its frames, in the order of their appearance.
  std::vector<std::pair<std::string, std::vector<int>>> values;
};

/// The movement of a sequence's camera, from its first frame on.
struct SequenceCamera {
  double farthest = 0;               // from its first place, scene units
  double largest_turn = 0;           // from its first direction, degrees
  double largest_step = 0;           // from one frame to the next, scene units
  int at_largest_step = 0;           // the frame after it
  double widest = 0, narrowest = 0;  // horizontal field of view in degrees; orthographic: scene units
  bool is_placed = false;            // false: no frame gives its position
};

/// The distances of one frame of a sequence.
struct SequenceDepth {
  int frame;
  Distances distances;
};

struct InspectedSequence {
  int shown;                        // the frame that the other members of Inspection describe
  std::vector<int> frames, absent;  // on the disk; and missing: asked for, or in a gap
  std::vector<SequenceChange> changes;
  std::vector<std::string> same;         // properties that do not change
  std::optional<SequenceCamera> camera;  // none without a camera
  std::vector<SequenceDepth> depth;      // of the frames whose pixels were read
};

/// A channel that may hold hidden surfaces, by its name alone.
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
  std::optional<InspectedLight> light;  // the light passes beside the beauty
  std::vector<Guess> guesses;
  std::vector<HiddenGuess> hidden;  // read only if options name them
  std::string hidden_options;       // the options that name all of them; "" for none
  Notes notes, suspicious;
  std::vector<std::string> missing;           // one sentence each
  std::vector<std::string> refused;           // inputs that a run would fail on; the rest is told without them
  std::string command;                        // the run that reads the frame so; empty if there is none
  bool shows_surfaces = false;                // the pixels tell their reading
  std::optional<InspectedSequence> sequence;  // none for a single frame
  std::optional<Error> unreadable;            // headers are whole, pixels are not: the rest is told by the headers
};

/// The inspection as lines for people, without any character that a terminal would obey: the reading first, the command
/// last. With `has_evidence` also attributes, statistics and the scores of every reading.
std::string inspection_text(const Inspection& inspection, bool has_evidence);

/// The inspection as JSON, with the fields that docs/inputs.md lists.
std::string inspection_json(const Inspection& inspection);

const char* name_of(SampleType type);

/// The channels of the frame's files that may hold hidden surfaces by their names, and from which nothing is read yet.
/// Only the frame's view and the settings' layer count, since a run finds no others.
std::vector<HiddenGuess> hidden_guesses(const FrameSource& source, const InputSettings& settings);

/// Adds up the light passes beside the beauty at some rows. `planar` is the depth over the beauty's pixels, infinite
/// where there is no surface: a background is light of no surface. None if no renderer is known by the names of the
/// passes, or if they cover other pixels than the depth.
std::optional<InspectedLight> light_passes_of(FrameSource& source, std::span<const float> planar);

/// The sentence on passes that do not add up.
std::string missing_light_text(const InspectedLight& light);

/// An option of a proposed run, and the words that give it: "--slices" and "--slices 8".
struct ProposedOption {
  std::string option, words;
};

/// The files and options of a proposed run.
struct CommandNames {
  InputSettings inputs;  // its files and cameras
  std::string output = "ao.exr", composite = "composite.exr";
  std::string frames = {};                 // a list, or empty
  std::vector<ProposedOption> typed = {};  // by the user, as far as they have an effect
};

/// The command of the run that reads the settled frame as it was understood, with every guess made explicit. Without a
/// camera or a radius to propose, it holds a word to replace.
std::string command_of(const FrameSource& source, const CommandNames& names, bool has_camera);

/// The text of a camera file that read_camera() reads back: of a single frame, or of a sequence with its `frames` by
/// number.
std::string camera_file(const Camera& camera);
std::string camera_file(const std::map<int, Camera>& cameras);

/// Writes an 8-bit PNG to settings.output.preview, with the data window three times: depth (near is bright,
/// logarithmic), view-space normals (0.5 + 0.5 n), and AO with sky in a colour of its own. The radius is
/// settings.estimator.radius, or else a tenth of the median distance. Fails as reading and computing the frame do, and
/// with ErrorKind::output.
void write_contact_sheet(const Settings& settings, int frame);

/// Opens the files of the settings and reads depth and normals. Faults that `run` would refuse are part of the answer;
/// it only fails if a file's header cannot be read, with ErrorKind::input. The proposed command names the files of
/// `run`.
Inspection inspect_frame(const InputSettings& settings, int frame, const CommandNames& run);

/// The result of a search for a camera in the settings and the frame.
struct CameraSearch {
  bool is_found = true;
  std::string why;                   // why the frame's header or its positions give none; "" if it has neither
  std::optional<FrameSource> frame;  // if the search had to open it
};
/// Looks for a camera. A file that cannot be opened has none.
CameraSearch look_for_camera(const InputSettings& settings, int frame);

/// Inspects the frame by which a run would decide the reading of all, and adds changes along the sequence: by the
/// headers of all frames, and by the pixels of a few. Fails as inspect_frame() does for that frame; faults of others
/// are part of the answer.
Inspection inspect_sequence(const FramePlan& plan, const CommandNames& run);

}  // namespace alcove
