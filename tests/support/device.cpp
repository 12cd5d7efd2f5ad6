// The test programs' device, and the check that the validation layer stayed silent.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/device.h"

#include "tests/support/threads.h"

namespace alcove::test {
namespace {

constexpr std::size_t kGuardBytes = 4096;

gpu::DeviceOptions options() {
  gpu::DeviceOptions options;
  if (const char* name = std::getenv("ALCOVE_TEST_DEVICE"); name && *name) options.choice = name;
  const bool is_staged = std::getenv("ALCOVE_TEST_STAGED") != nullptr;
  options.guard_bytes = is_staged ? 0 : kGuardBytes;  // the host must see the guards
  options.map_memory = !is_staged;
  options.validate = std::getenv("ALCOVE_TEST_VALIDATE") != nullptr;
  return options;
}

/// Fails the program when any test made the validation layer speak.
class SilentValidation : public testing::Environment {
 public:
  void TearDown() override {
    if (options().validate) EXPECT_EQ(device().validation_messages(), 0);
  }
};
const auto* const kSilentValidation = testing::AddGlobalTestEnvironment(new SilentValidation);

}  // namespace

gpu::Device& device() {
  static gpu::Device device(options());
  return device;
}

gpu::Recorder& recorder() {
  static gpu::Recorder recorder(device());
  return recorder;
}

EstimatorSettings plain_settings() {
  EstimatorSettings settings;
  settings.thickness = ThicknessKind::infinite;
  settings.denoise = Denoise::none;
  settings.stride = 1;
  return settings;
}

}  // namespace alcove::test
