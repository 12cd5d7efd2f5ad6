// The files of a run: the inputs of each frame, and the outputs, which are checked before any work.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/options/options.h"
#include "core/run/plan.h"

namespace alcove {

/// Whether the preview is the composite as a display shows it, and not the AO as data.
bool shows_composite(const OutputSettings& output);

/// All input files of a frame: the files that options name, manifests of Cryptomattes, and the display configuration,
/// without its tables. Opens files with Cryptomattes. An unreadable file has no manifest.
std::vector<NamedFile> inputs_of(const Settings& frame);

/// Adds the inputs of the frames of all chunks, of the frames around them, and of all frames on the disk: another run
/// may compute any of them.
void add_inputs(FileUses& uses, const FramePlan& plan);

/// Adds all files that the run writes. `run` names the run in messages if there are several.
void add_outputs(FileUses& uses, const FramePlan& plan, const std::string& run = "");

/// Fails with ErrorKind::usage where the run would write a file that it reads, or one file twice.
void refuse_overwriting(const FramePlan& plan);

/// Fails with ErrorKind::output where an output cannot be made. Removes unfinished files that killed runs have left
/// beside the outputs.
void prepare_outputs(const FramePlan& plan);

/// Fails with ErrorKind::usage where the name of an output does not end as its format does.
void require_endings(const OutputSettings& output);

/// Makes the folders of these files, unless the settings say not to. Fails with ErrorKind::output.
void make_folders(const std::vector<NamedFile>& files, const OutputSettings& settings);

/// The folders that a run creates. The destructor removes the empty ones, so that a run that is refused after reading
/// leaves nothing.
class NewFolders {
 public:
  explicit NewFolders(const FramePlan& plan);
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

 private:
  std::set<std::string> folders_;  // parents first
};

}  // namespace alcove
