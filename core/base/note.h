// What the user should know about a frame or a run although nothing failed: a stable code and a sentence.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

namespace alcove {

/// What a note is about. Its name is stable: scripts may look for it.
enum class NoteCode {
  // how the frame is read
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
  camera_scaled,
  // what harms AO
  half_depth,
  overflown_depth,
  jittered_depth,
  letterbox_bars,
  antialiased_depth,
  shortened_normals,
  averaged_normals,
  scaled_normals,
  cut_normals,
  lossy_compression,
  damaged_file,
  windows_differ,
  // whether the radius suits the frame
  radius_below_precision,
  radius_below_pixel,
  radius_beyond_picture,
  // what lies behind the first surface
  empty_layer,
  nothing_hidden,
  before_first,
  repaired_samples,
  // what was repaired or replaced
  repaired_depth,
  repaired_normals,
  turned_normals,
  repaired_material_ao,
  repaired_beauty,
  no_normals,
  unused_input,
  unread_ranks,
  no_indirect_light,
  // how it was computed
  device_memory,
  in_parts,
  no_gpu,
  // which frames there are, and what was chosen for them
  sequence_hole,
  frame_number,
  automatic_radius,
};

/// What the header of an output says of a note. Headers are the same bits for the same inputs.
enum class InHeader {
  text,     // its sentence
  meaning,  // the code's meaning, for the sentence has a number that depends on how the frame was cut into tiles
  nothing,  // it says nothing about the pixels of the frame
};

/// What is known of a code.
struct NoteFacts {
  NoteCode code;
  const char* name;     // as --log-json, --stats and headers have it
  bool is_warning;      // the result may not be what is wanted; else it is only good to know
  const char* meaning;  // for lists of all codes; ends without a full stop
  InHeader in_header = InHeader::text;
};

/// All codes, in the order of the enumeration.
std::span<const NoteFacts> note_table();
const NoteFacts& facts_of(NoteCode code);

struct Note {
  NoteCode code;
  std::string text;  // a sentence without a full stop; it may hold text of files, so printable() is for who shows it
  std::string file = {};  // that it is about; empty: the frame's

  bool operator==(const Note&) const = default;
};

using Notes = std::vector<Note>;

/// "warning" or "note".
const char* level_of(const Note& note);

/// "FILE: TEXT [CODE]", without the file where neither the note nor the caller names one; `frame` is the frame's file.
std::string line_of(const Note& note, const std::string& frame);

/// Adds those of `more` that are not there yet.
void add_new(Notes& notes, const Notes& more);

Notes warnings_of(const Notes& notes);

/// The sentences alone.
std::vector<std::string> texts_of(const Notes& notes);

/// The attribute alcove/notes: a line per warning, "CODE: TEXT"; "" where there is none.
std::string header_text(const Notes& notes);

/// The table of all codes as docs/troubleshooting.md shows it.
std::string note_table_markdown();

}  // namespace alcove
