// Notes to the user about a frame or a run that did not fail: a stable code and a sentence each.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

namespace alcove {

/// The subject of a note. Its name is stable: scripts may look for it.
enum class NoteCode {
  // reading of the frame
  unusual_reading,
  assumed_reading,
  proven_reading,
  said_otherwise,
  near_plane,
  negative_depth,
  depth_below_1,
  finite_sky,
  beyond_planes,
  default_view,
  several_objects,
  normals_disagree,
  principal_point,
  field_of_view,
  positions_disagree,
  camera_scaled,
  // faults that harm AO
  no_surfaces,
  holes_in_depth,
  enlarged_depth,
  smoothed_depth,
  noisy_depth,
  half_depth,
  overflown_depth,
  jittered_depth,
  letterbox_bars,
  part_of_picture,
  missing_tile,
  depth_offset,
  depth_curve,
  clamped_depth,
  wrapped_depth,
  displaced_normals,
  antialiased_depth,
  shortened_normals,
  averaged_normals,
  scaled_normals,
  cut_normals,
  lossy_compression,
  damaged_file,
  windows_differ,
  // fit of the radius
  radius_below_precision,
  radius_below_pixel,
  radius_beyond_picture,
  // hidden surfaces
  empty_layer,
  nothing_hidden,
  before_first,
  repaired_samples,
  // repaired or replaced pixels
  repaired_depth,
  repaired_normals,
  turned_normals,
  repaired_material_ao,
  repaired_beauty,
  transparent_beauty,
  negative_composite,
  no_normals,
  unused_input,
  unread_ranks,
  no_indirect_light,
  light_passes,
  sun_in_sky,
  dark_light,
  far_lamp,
  // computing
  device_memory,
  in_parts,
  no_gpu,
  // frames, and choices for them
  sequence_hole,
  frame_number,
  other_frame,
  automatic_radius,
  computed_again,
  // comparisons
  ao_layer,
  sky_differs,
  holes,
};

/// The form of a note in the header of an output. Headers are the same bits for the same inputs.
enum class InHeader {
  text,     // its sentence
  meaning,  // the code's meaning, since a number in the sentence depends on how the frame was cut into tiles
  nothing,  // left out, since the note is not about the pixels of the frame
};

/// The facts about a code.
struct NoteFacts {
  NoteCode code;
  const char* name;     // as --log-json, --stats and headers have it
  bool is_warning;      // the result may be wrong; else the note is only good to know
  const char* meaning;  // for lists of all codes; ends without a full stop
  InHeader in_header = InHeader::text;
};

/// The facts of all codes, in the order of the enumeration.
std::span<const NoteFacts> note_table();
const NoteFacts& facts_of(NoteCode code);

struct Note {
  NoteCode code;
  std::string text;       // a sentence without a full stop; it may hold text of files: show it by printable()
  std::string file = {};  // its subject; empty: the frame's file

  bool operator==(const Note&) const = default;
};

using Notes = std::vector<Note>;

/// The word "warning" or "note".
const char* level_of(const Note& note);

/// The line "FILE: TEXT [CODE]". FILE is the note's, else `frame`, the frame's file; if both are empty, it is left out.
std::string line_of(const Note& note, const std::string& frame);

/// Adds the notes of `more` that `notes` lacks.
void add_new(Notes& notes, const Notes& more);

Notes warnings_of(Notes notes);

/// Whether a list of codes with commas, such as that of --set allow, has this one.
bool is_listed(NoteCode code, const std::string& codes);

/// The sentences of notes, without their codes.
std::vector<std::string> texts_of(const Notes& notes);

/// The attribute alcove/notes: a line "CODE: TEXT" per warning; "" without warnings.
std::string header_text(const Notes& notes);

}  // namespace alcove
