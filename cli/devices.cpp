// `alcove devices [--json]`: what this machine can compute on.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/parsing.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/gpu/device_info.h"

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

}  // namespace

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

std::string text_of(const gpu::DeviceInfo& d) {
  return fmt::format("{}  {}  {}  {}  Vulkan {}  {:.1f} GiB  {}{}", d.index, printable(d.name), gpu::name_of(d.type),
                     printable(d.driver), d.api_version, double(d.memory_bytes) / (1 << 30), d.uuid,
                     d.unusable.empty() ? "" : "  not usable: " + printable(d.unusable));
}

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

}  // namespace alcove
