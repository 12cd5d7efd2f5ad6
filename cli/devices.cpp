// `alcove devices`: what this machine can compute on. `alcove doctor`: what a report of a bug needs to say of the
// machine, and what is amiss with it; --version.
// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/options.h"
#include "core/base/system.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/bench/device_check.h"
#include "core/formats/image_io.h"
#include "core/gpu/device_info.h"
#include "core/options/options.h"

namespace alcove {
namespace {

struct DevicesArguments {
  bool json = false;
};

CommandOf<DevicesArguments> devices_syntax() {
  CommandOf<DevicesArguments> command{
      "alcove devices", "Lists the Vulkan devices; --device of alcove run takes an index, a name or a UUID.\n"};
  OptionGroup(command.rows, "Options", Effect::none).flag("--json", &DevicesArguments::json, "print JSON");
  return command;
}

/// The fields of docs/json.md.
nlohmann::ordered_json json_of(const gpu::DeviceInfo& d) {
  return {{"index", d.index},
          {"name", d.name},
          {"type", gpu::name_of(d.type)},
          {"uuid", d.uuid},
          {"driver", d.driver},
          {"api_version", d.api_version},
          {"memory_bytes", d.memory_bytes},
          {"buffer_bytes", d.buffer_bytes},
          {"usable", d.unusable.empty()},
          {"reason", d.unusable}};
}

/// One line without its end.
std::string text_of(const gpu::DeviceInfo& d) {
  return fmt::format("{}  {}  {}  {}  Vulkan {}  {:.1f} GiB  {}{}", d.index, printable(d.name), gpu::name_of(d.type),
                     printable(d.driver), d.api_version, double(d.memory_bytes) / (1 << 30), d.uuid,
                     d.unusable.empty() ? "" : "  not usable: " + printable(d.unusable));
}

}  // namespace

Command describe_devices() { return devices_syntax().shown(); }

int devices_command(const std::vector<std::string>& arguments) {
  const auto parsed = devices_syntax().parse(arguments);
  if (!parsed) return 0;
  const auto devices = gpu::list_devices();
  auto list = nlohmann::ordered_json::array();
  for (const auto& d : devices) list.push_back(json_of(d));
  if (parsed->json)
    fmt::print("{}\n", json_text(list, 1));
  else
    for (const auto& d : devices) fmt::print("{}\n", text_of(d));
  if (devices.empty())
    fail(ErrorKind::device, "no Vulkan device found; lavapipe computes on the CPU (Debian: mesa-vulkan-drivers)");
  return 0;
}

// The doctor.

namespace {

struct Facts {
  std::vector<std::pair<std::string, std::string>> lines;  // name and text
  std::vector<gpu::DeviceInfo> devices;
  std::vector<std::string> checks;    // of each device; empty: not asked for
  std::vector<std::string> problems;  // sentences
  bool is_abandoned = false;          // a device still computes
};

std::string gibibytes(std::uint64_t bytes) { return fmt::format("{:.1f} GiB", double(bytes) / (1 << 30)); }

std::string memory_text() {
  // The kernel's own word for no limit is a number close to 2^63.
  constexpr std::uint64_t kAbsurd = std::uint64_t(1) << 60;
  const auto limit = [](std::uint64_t bytes) { return bytes >= kAbsurd ? "no limit" : gibibytes(bytes); };
  return fmt::format("{} free on the machine; left by control groups: {}; asked of Slurm: {}; a run takes up to {}",
                     gibibytes(memory_left_on_machine()), limit(memory_left_in_groups()), limit(memory_of_slurm_job()),
                     gibibytes(free_memory() / 2));
}

std::string preset_text(Facts& facts) {
  try {
    return fmt::format("{}, {} of them", preset_folder(), preset_names().size());
  } catch (const Error& error) {
    facts.problems.emplace_back(error.what());
    return "none";
  }
}

std::string picture_text() {
  const std::string why = why_no_image_io();
  return why.empty() ? "TIFF and others can be read" : "EXR, DDS and PNG only: " + why;
}

/// The variables that change what a run does, those that are set.
std::string environment_text() {
  std::vector<std::string> names = gpu::driver_variables(), set;
  names.insert(names.end(), {"ALCOVE_PRESETS", "ALCOVE_PRESET_PATH", "OCIO", "TMPDIR", "SLURM_JOB_ID"});
  for (const auto& name : names)
    if (const char* value = std::getenv(name.c_str())) set.push_back(fmt::format("{}={}", name, value));
  return set.empty() ? "nothing of note" : fmt::format("{}", fmt::join(set, " "));
}

EstimatorSettings settings_of(const std::string& preset) {
  const auto known = std::ranges::find(preset_texts(), preset, &std::pair<std::string, std::string>::first);
  return with_values({}, preset_values(preset, known->second)).estimator;
}

/// The seconds that a device may take for a preset, all of its kernels with it.
constexpr std::chrono::seconds kPatience{60};

/// The RMS by which a device errs with a preset. Fails as a device does, or where it takes too long.
double deviation_of(const gpu::DeviceInfo& device, const std::string& preset, Facts& facts) {
  const auto values = values_within(kPatience, [index = device.index, preset] {
    gpu::Device opened({.choice = std::to_string(index)});
    gpu::Recorder recorder(opened);
    return check_values(recorder, settings_of(preset));
  });
  facts.is_abandoned = facts.is_abandoned || !values;
  if (!values)
    fail(ErrorKind::device,
         "it takes more than {} s for preset {}, most of them to compile; compute on another --device",
         kPatience.count(), preset);
  return deviation(preset, *values);
}

/// What a device makes of a small frame with each preset, and whether that is right; if it is not, a problem.
std::string check_device(const gpu::DeviceInfo& device, Facts& facts) {
  if (!device.unusable.empty()) return "not usable";
  std::string text;
  try {
    for (const char* preset : kCheckedPresets) {
      const double error = deviation_of(device, preset, facts);
      text += fmt::format("{}{} {:.6f}", text.empty() ? "RMS " : ", ", preset, error);
      if (!(error <= kMostDeviation))
        facts.problems.push_back(fmt::format(
            "{} (index {}) computes wrongly: the AO of preset {} differs from what it must be by {:.6f} RMS, "
            "and {} is allowed; update its driver, or compute on another --device",
            device.name, device.index, preset, error, kMostDeviation));
    }
  } catch (const Error& error) {
    facts.problems.push_back(fmt::format("{} (index {}) fails: {}", device.name, device.index, error.what()));
    return text + (text.empty() ? "failed" : ", failed");
  }
  return text;
}

Facts gather(bool checks_devices) {
  Facts facts;
  const auto tell = [&](const char* name, const std::string& text) { facts.lines.emplace_back(name, text); };
  tell("version", kVersion);
  tell("build", kBuild);
  tell("libraries", kLibraries);
  tell("system", system_name());
  tell("cores", std::to_string(core_count()));
  tell("memory", memory_text());
  tell("program", program_folder());
  tell("presets", preset_text(facts));
  tell("other pictures", picture_text());
  tell("environment", environment_text());
  try {
    tell("vulkan loader", gpu::loader_version());
    facts.devices = gpu::list_devices();
  } catch (const Error& error) {
    facts.problems.emplace_back(error.what());
  }
  const auto is_usable = [](const gpu::DeviceInfo& device) { return device.unusable.empty(); };
  if (std::ranges::none_of(facts.devices, is_usable))
    facts.problems.emplace_back(
        "no Vulkan device can compute; lavapipe does on the CPU (Debian: mesa-vulkan-drivers), and a GPU needs its "
        "maker's driver");
  for (const auto& device : facts.devices)
    if (checks_devices) facts.checks.push_back(check_device(device, facts));
  return facts;
}

void print_text(const Facts& facts) {
  for (const auto& [name, text] : facts.lines) fmt::print("{:<17} {}\n", name, printable(text));
  for (const auto& device : facts.devices) fmt::print("{:<17} {}\n", "device", text_of(device));
  for (std::size_t i = 0; i < facts.checks.size(); i++) fmt::print("{:<17} {}  {}\n", "checked", i, facts.checks[i]);
  for (const auto& problem : facts.problems) fmt::print("{:<17} {}\n", "problem", printable(problem));
  if (facts.problems.empty()) fmt::print("{:<17} none\n", "problems");
}

void print_json(const Facts& facts) {
  nlohmann::ordered_json all;
  for (const auto& [name, text] : facts.lines) all[name] = text;
  all["devices"] = nlohmann::ordered_json::array();
  for (const auto& device : facts.devices) all["devices"].push_back(json_of(device));
  for (std::size_t i = 0; i < facts.checks.size(); i++) all["devices"][i]["checked"] = facts.checks[i];
  all["problems"] = facts.problems;
  fmt::print("{}\n", json_text(all, 1));
}

struct DoctorArguments {
  bool json = false, check_device = false;
};

CommandOf<DoctorArguments> doctor_syntax() {
  CommandOf<DoctorArguments> command{
      "alcove doctor",
      "Prints the facts for a bug report: version, libraries, devices and drivers, memory and its limits, folders; and "
      "why nothing can be computed. It sends nothing anywhere.\n"};
  OptionGroup options(command.rows, "Options", Effect::none);
  options.flag("--check-device", &DoctorArguments::check_device,
               "compute a small frame with four presets on every device; one with wrong values is a problem");
  options.flag("--json", &DoctorArguments::json, "print JSON");
  return command;
}

}  // namespace

std::string version_text() { return fmt::format("alcove {}\n{}\n{}\n", kVersion, kBuild, kLibraries); }

Command describe_doctor() { return doctor_syntax().shown(); }

int doctor_command(const std::vector<std::string>& arguments) {
  const auto parsed = doctor_syntax().parse(arguments);
  if (!parsed) return 0;
  const Facts facts = gather(parsed->check_device);
  parsed->json ? print_json(facts) : print_text(facts);
  const int code = facts.problems.empty() ? 0 : int(ErrorKind::device);
  if (facts.is_abandoned) {
    std::fflush(stdout);
    std::_Exit(code);
  }
  return code;
}

}  // namespace alcove
