// The test programs' device, and the check that the validation layer stayed silent.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/device.h"

#include "tests/support/test.h"

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

/// Both end with the last test: at the end of the program, when statics go, the validation layer has lost what it keeps
/// per thread.
std::optional<gpu::Device> shared_device;
std::optional<gpu::Recorder> shared_recorder;

/// Fails the program when any test made the validation layer speak.
class SilentValidation : public testing::Environment {
 public:
  void TearDown() override {
    if (options().validate) EXPECT_EQ(device().validation_messages(), 0);
    shared_recorder.reset();
    shared_device.reset();
  }
};
const auto* const kSilentValidation = testing::AddGlobalTestEnvironment(new SilentValidation);

}  // namespace

gpu::Device& device() {
  if (!shared_device) shared_device.emplace(options());
  return *shared_device;
}

gpu::Recorder& recorder() {
  if (!shared_recorder) shared_recorder.emplace(device());
  return *shared_recorder;
}

EstimatorSettings plain_settings() {
  EstimatorSettings settings;
  settings.thickness = ThicknessKind::infinite;
  settings.denoise = Denoise::none;
  settings.stride = 1;
  return settings;
}

}  // namespace alcove::test
