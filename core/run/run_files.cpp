// Inputs by the table of files and by what they name themselves; outputs against inputs and each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/run_files.h"

#include <filesystem>

#include "core/base/error.h"
#include "core/formats/color.h"
#include "core/formats/exr.h"
#include "core/formats/sequence.h"
#include "core/frame/find/matte.h"
#include "core/frame/raw_plane.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;

/// Adds the files of manifests that lie beside a file with Cryptomattes of a view. One that cannot be read has none.
void add_manifests(std::vector<NamedFile>& files, const char* option, const std::string& path,
                   const std::string& view) {
  try {
    for (const auto& matte : cryptomattes_of(ExrFile(path, option), view))
      if (!matte.manifest_file.empty()) files.push_back({fmt::format("the manifest of {}", path), matte.manifest_file});
  } catch (const Error&) {
  }
}

/// Every file that the run writes, and whose it is.
struct Output {
  NamedFile file;
  std::string whose;
};

std::vector<Output> outputs_of(const FramePlan& plan, const std::vector<int>& frames) {
  std::vector<Output> outputs;
  for (const int frame : frames)
    for (const auto& file : files_of(plan.at(frame), FileRole::output)) {
      const bool is_of_all = !plan.is_sequence() || (plan.has_contact_sheet() && file.option == "--preview");
      outputs.push_back({file, is_of_all ? "" : fmt::format(" of frame {}", frame)});
    }
  for (const auto& file : files_of(plan.settings(), FileRole::report)) outputs.push_back({file, ""});
  return outputs;
}

}  // namespace

bool shows_composite(const OutputSettings& output) {
  return !output.preview.empty() && !output.composite.empty() && output.preview_style != "ao";
}

std::vector<NamedFile> inputs_of(const Settings& frame) {
  const InputSettings& input = frame.input;
  std::vector<NamedFile> files = files_of(frame, FileRole::input);
  if (!input.matte_object.empty())
    add_manifests(files, "--matte", input.matte.empty() ? main_input(input) : input.matte, input.view);
  if (!input.occluder_objects.empty() || !input.ignored_objects.empty())
    add_manifests(files, "--set objects", input.objects.empty() ? main_input(input) : input.objects, input.view);
  const std::string display = shows_composite(frame.output) ? display_config_file(frame.output.ocio) : "";
  if (!display.empty() && frame.output.ocio.empty()) files.push_back({"the OCIO variable", display});
  return files;
}

void add_inputs(FileUses& uses, const FramePlan& plan) {
  for (const auto* frames : {&plan.all(), &plan.shot()})
    for (const int frame : *frames)
      for (const auto& file : inputs_of(plan.at(frame))) uses.add_input(file);
  for (const int frame : plan.on_disk())
    for (const auto& file : files_of(plan.at(frame), FileRole::input)) uses.add_input(file);
}

void add_outputs(FileUses& uses, const FramePlan& plan, const std::string& run) {
  for (const auto& [file, whose] : outputs_of(plan, plan.all())) uses.add_output(file, whose + run);
}

void refuse_overwriting(const FramePlan& plan) {
  FileUses uses;
  add_inputs(uses, plan);
  add_outputs(uses, plan);
}

void require_endings(const OutputSettings& output) {
  require_ending(output.output, "--output", ".exr", "OpenEXR");
  require_ending(output.composite, "--composite", ".exr", "OpenEXR");
  require_ending(output.preview, "--preview", ".png", "PNG");
}

void prepare_outputs(const FramePlan& plan) {
  const OutputSettings& output = plan.settings().output;
  std::set<std::string> folders;
  for (const auto& [file, whose] : outputs_of(plan, plan.frames())) {
    (output.no_mkdir ? require_writable : require_makeable)(file.path, file.option.c_str());
    folders.insert(folder_of(file.path));
  }
  for (const auto& folder : folders) remove_unfinished(folder);
}

void make_folders(const std::vector<NamedFile>& files, const OutputSettings& settings) {
  if (settings.no_mkdir) return;
  for (const auto& file : files) make_folder_of(file.path, file.option.c_str());
}

NewFolders::NewFolders(const FramePlan& plan) {
  std::error_code error;
  for (const auto& [file, whose] : outputs_of(plan, plan.frames()))
    for (std::string folder = folder_of(file.path);
         !folders_.contains(folder) && fs::status(folder, error).type() == fs::file_type::not_found;
         folder = folder_of(folder))
      folders_.insert(folder);
}

NewFolders::~NewFolders() {
  std::error_code not_empty;
  for (auto folder = folders_.rbegin(); folder != folders_.rend(); folder++) fs::remove(*folder, not_empty);
}

}  // namespace alcove
