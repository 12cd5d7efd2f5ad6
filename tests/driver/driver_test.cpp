// What the driver is told, seen from a fake one that stands before it: memory types, kernels' code, the pipeline cache,
// extensions and submissions; and what becomes of a device that refuses.
// SPDX-License-Identifier: BSD-3-Clause
#include <spirv/unified1/spirv.hpp>

#include "core/chain/chain.h"
#include "core/run/frame_run.h"
#include "tests/driver/fake_driver.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"

namespace alcove::driver_test {
namespace {

using namespace test;

/// A fake driver as it is at the beginning, for each test.
class Driver : public testing::Test {
 protected:
  Driver() { fake = {}; }
  ~Driver() override { fake = {}; }

  /// On lavapipe, whatever type it shows; without guards, whose memory the host must reach.
  static gpu::DeviceOptions options() {
    gpu::DeviceOptions options = device().options();
    options.choice = "llvmpipe";
    options.guard_bytes = 0;
    return options;
  }

  FakeDriver& fake = fake_driver();
};

EstimatorSettings settings_of(double radius) {
  EstimatorSettings settings;
  settings.radius = radius;
  return settings;
}

/// Every direction of so many slices is two passes.
EstimatorSettings exact_settings(int slices) {
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.4;
  settings.search = SliceSearch::exact;
  settings.slices = slices;
  return settings;
}

/// As many directions as an error of 0.03 takes, tile by tile.
EstimatorSettings tolerant_settings() {
  EstimatorSettings settings = exact_settings(2);
  settings.tolerance = 0.03;
  return settings;
}

EstimatorSettings settings_of(Estimator estimator, Resolution resolution) {
  EstimatorSettings settings = settings_of(0.4);
  settings.estimator = estimator;
  settings.resolution = resolution;
  return settings;
}

std::vector<float> ao_of(gpu::Recorder& gpu, const EstimatorSettings& settings) {
  return compute_ao(gpu, furnished_room(70, 45).frame, settings).ao;
}

std::vector<float> ao_on(const gpu::DeviceOptions& options, const EstimatorSettings& settings) {
  gpu::Device device(options);
  gpu::Recorder recorder(device);
  return ao_of(recorder, settings);
}

TEST_F(Driver, maps_only_memory_that_the_host_reads_through_its_cache) {
  const auto expected = ao_on(options(), settings_of(0.4));
  constexpr std::uint32_t kHostMemory = 2;
  fake.has_own_memory = true;
  fake.mapped_types.clear();
  EXPECT_EQ(ao_on(options(), settings_of(0.4)), expected);
  EXPECT_THAT(fake.mapped_types, AllOf(Not(IsEmpty()), Each(kHostMemory)));
}

TEST_F(Driver, maps_a_frame_of_sky_in_memory_of_its_own) {
  fake.has_own_memory = true;
  HostFrame sky = furnished_room(70, 45).frame;
  std::ranges::fill(sky.depth, kSky);
  gpu::Device device(options());
  gpu::Recorder recorder(device);
  const HostResult result = compute_ao(recorder, sky, settings_of(0.4));
  EXPECT_THAT(result.ao, Each(1.0f));
  EXPECT_EQ(result.sky_pixels, sky.depth.size());
}

TEST_F(Driver, gets_no_more_allocations_than_it_allows) {
  fake.most_allocations = 3;
  gpu::Device device(options());
  {
    gpu::Recorder recorder(device);
    EXPECT_THROW(
        {
          try {
            ao_of(recorder, settings_of(0.4));
          } catch (const gpu::OutOfMemory& error) {
            EXPECT_THAT(error.what(), AllOf(HasSubstr("3 buffers"), HasSubstr("--threads")));
            EXPECT_EQ(error.kind(), ErrorKind::device);
            throw;
          }
        },
        gpu::OutOfMemory);
    EXPECT_EQ(fake.live_allocations, 3);
  }
  EXPECT_EQ(fake.live_allocations, 0);
  gpu::Recorder again(device);
  for (const char* name : {"a", "b", "c"}) again.buffer(name, 256, gpu::Use::device);
}

TEST_F(Driver, that_ran_out_of_memory_gets_no_buffer_larger_than_it_must_be) {
  fake.most_allocations = 1;
  gpu::Device device(options());
  gpu::Recorder recorder(device);
  const auto capacity_for = [&](std::size_t bytes) {
    recorder.abandon();
    return recorder.buffer("a", bytes, gpu::Use::device).capacity();
  };
  capacity_for(1000);
  EXPECT_EQ(capacity_for(900), 1000);
  EXPECT_THROW(recorder.buffer("b", 8, gpu::Use::device), gpu::OutOfMemory);
  EXPECT_EQ(capacity_for(800), 800);
}

TEST_F(Driver, keeps_buffers_for_frames_of_nearly_one_size) {
  gpu::Device device(options());
  gpu::Recorder recorder(device);
  compute_ao(recorder, furnished_room(140, 90).frame, settings_of(0.4));
  const int before = fake.allocations;
  for (const int width : {140, 131, 139, 120}) {
    const HostFrame frame = furnished_room(width, 88).frame;
    const auto ao = compute_ao(recorder, frame, settings_of(0.4)).ao;
    gpu::Recorder alone(device);
    const int before_alone = fake.allocations;
    EXPECT_EQ(ao, compute_ao(alone, frame, settings_of(0.4)).ao) << width;
    fake.allocations = before_alone;
  }
  EXPECT_EQ(fake.allocations - before, 0);
}

/// Whether code declares that NaN, infinity and signed zero of 32-bit floats are to be kept.
bool declares_nan(const std::vector<std::uint32_t>& code) {
  bool has_capability = false, has_mode = false;
  for (std::size_t at = 5; at < code.size(); at += code[at] >> spv::WordCountShift) {
    const auto opcode = code[at] & spv::OpCodeMask;
    if (opcode == spv::OpCapability && code[at + 1] == spv::CapabilitySignedZeroInfNanPreserve) has_capability = true;
    if (opcode == spv::OpExecutionMode && code[at + 2] == spv::ExecutionModeSignedZeroInfNanPreserve)
      has_mode = code[at + 3] == 32;
  }
  return has_capability && has_mode;
}

TEST_F(Driver, of_a_gpu_is_told_to_keep_nan_in_every_kernel) {
  const auto expected = ao_on(options(), settings_of(0.4));
  fake.modules.clear();
  fake.is_discrete = true;
  const auto told = ao_on(options(), settings_of(0.4));
  EXPECT_GE(fake.modules.size(), 5);
  for (const auto& module : fake.modules) EXPECT_TRUE(declares_nan(module));
  ASSERT_EQ(told.size(), expected.size());
  double squares = 0;
  for (std::size_t i = 0; i < told.size(); i++) squares += std::pow(told[i] - expected[i], 2);
  EXPECT_LT(std::sqrt(squares / double(told.size())), 1e-4) << "as two devices may differ";
}

// Buffers of texels.

/// The number of modules that read buffers of texels.
int reading_texels(const std::vector<std::vector<std::uint32_t>>& modules) {
  return int(std::ranges::count_if(modules, [](const auto& code) {
    for (std::size_t at = 5; at < code.size(); at += code[at] >> spv::WordCountShift)
      if ((code[at] & spv::OpCodeMask) == spv::OpImageRead) return true;
    return false;
  }));
}

TEST_F(Driver, reads_texels_or_storage_buffers_with_the_same_bits) {
  EstimatorSettings quick = settings_of(0.4);
  quick.search = SliceSearch::quick;
  gpu::DeviceOptions texels = options(), buffers = options();
  texels.texels = true;
  buffers.texels = false;
  for (const EstimatorSettings& settings :
       {settings_of(0.4), quick, exact_settings(3), tolerant_settings(),
        settings_of(Estimator::bitmask, Resolution::half), settings_of(Estimator::hbao, Resolution::quarter),
        settings_of(Estimator::crytek, Resolution::full)}) {
    fake.modules.clear();
    const auto expected = ao_on(buffers, settings);
    EXPECT_EQ(reading_texels(fake.modules), 0);
    fake.modules.clear();
    EXPECT_EQ(ao_on(texels, settings), expected);
    EXPECT_GE(reading_texels(fake.modules), 3);
  }
}

TEST_F(Driver, that_is_an_old_lavapipe_reads_texels) {
  for (const auto& [version, reads] :
       {std::pair{"Mesa 22.3.6 (LLVM 15.0.6)", true}, {"Mesa 25.0.7 (LLVM 15.0.6)", false}}) {
    fake.version = version;
    fake.modules.clear();
    ao_on(options(), settings_of(0.4));
    EXPECT_EQ(reading_texels(fake.modules) > 0, reads) << version;
  }
}

TEST_F(Driver, that_has_no_texels_for_a_whole_plane_reads_storage_buffers) {
  gpu::DeviceOptions texels = options();
  texels.texels = true;
  const auto expected = ao_on(texels, settings_of(0.4));
  const int all = reading_texels(fake.modules);
  fake.most_texels = 70 * 45;  // a plane, and no more
  fake.modules.clear();
  EXPECT_EQ(ao_on(texels, settings_of(0.4)), expected);
  EXPECT_THAT(reading_texels(fake.modules), AllOf(testing::Gt(0), testing::Lt(all)));
  fake.most_texels = 1;
  fake.modules.clear();
  EXPECT_EQ(ao_on(texels, settings_of(0.4)), expected);
  EXPECT_EQ(reading_texels(fake.modules), 0);
}

TEST_F(Driver, may_have_a_portable_part_of_vulkan_only) {
  { const gpu::Device whole(options()); }
  EXPECT_THAT(fake.device_extensions, Not(Contains("VK_KHR_portability_subset")));
  fake.is_portable = true;
  const gpu::Device device(options());
  EXPECT_TRUE(fake.instance_flags & 1u) << "VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR";
  EXPECT_THAT(fake.instance_extensions, Contains("VK_KHR_portability_enumeration"));
  EXPECT_THAT(fake.device_extensions, Contains("VK_KHR_portability_subset"));
  EXPECT_TRUE(fake.is_robust);
}

// Submissions.

TEST_F(Driver, gets_a_long_recording_in_parts_that_give_the_same_bits) {
  for (const EstimatorSettings& settings :
       {settings_of(0.4), exact_settings(20), tolerant_settings(), settings_of(Estimator::bitmask, Resolution::half),
        settings_of(Estimator::hbao, Resolution::quarter), settings_of(Estimator::crytek, Resolution::full)}) {
    gpu::DeviceOptions limited = options();
    const auto expected = ao_on(limited, settings);
    limited.submission_ms = 1e-6;
    gpu::Device device(limited);
    gpu::Recorder recorder(device);
    std::vector<std::string> names;
    for (const bool is_measured : {false, true}) {
      fake.submissions = 0;
      EXPECT_EQ(ao_of(recorder, settings), expected) << is_measured;
      // Passes that were measured, and take longer than that, are cut up.
      EXPECT_GE(fake.submissions, (is_measured ? 4 : 1) * int(recorder.passes().size()));
      if (is_measured) EXPECT_EQ(names.size(), recorder.passes().size());
      names.clear();
      double ms = 0;
      for (const auto& pass : recorder.passes()) {
        names.push_back(pass.name);
        ms += pass.ms;
      }
      EXPECT_GT(ms, 0);
      EXPECT_EQ(names.front(), "prepare");
    }
  }
}

TEST_F(Driver, begins_a_list_at_its_beginning_behind_a_pass_that_was_cut) {
  gpu::DeviceOptions limited = options();
  const auto expected = ao_on(limited, settings_of(0.4));
  limited.submission_ms = 10;
  gpu::Device device(limited);
  gpu::Recorder recorder(device);
  fake.slow_ticks = std::uint64_t(15e6 / device.nanoseconds_per_tick());
  ao_of(recorder, settings_of(0.1));  // its results are not those below
  fake.submissions = fake.slices = 0;
  EXPECT_EQ(ao_of(recorder, settings_of(0.4)), expected);
  EXPECT_GT(fake.slices, 0) << "passes of 15 ms, each cut in two";
  EXPECT_LT(fake.submissions, int(recorder.passes().size())) << "short passes share the last slice's submission";
}

TEST(Kernels, do_not_count_the_workgroups_of_a_dispatch_which_may_be_a_slice) {
  int kernels = 0;
  for (const auto& entry : fs::recursive_directory_iterator(ALCOVE_SOURCE_DIR "/kernels")) {
    if (entry.path().extension() != ".comp") continue;
    kernels++;
    const auto code = gpu::kernel_code(entry.path().stem().string());
    for (std::size_t at = 5; at < code.size(); at += code[at] >> spv::WordCountShift) {
      const bool is_builtin = (code[at] & spv::OpCodeMask) == spv::OpDecorate && code[at + 2] == spv::DecorationBuiltIn;
      EXPECT_FALSE(is_builtin && code[at + 3] == spv::BuiltInNumWorkgroups) << entry.path();
    }
  }
  EXPECT_GE(kernels, 20);
}

TEST_F(Driver, gets_a_frame_of_short_passes_at_once_when_they_are_measured) {
  gpu::DeviceOptions limited = options();
  limited.submission_ms = 60000;
  gpu::Device device(limited);
  gpu::Recorder recorder(device);
  ao_of(recorder, settings_of(0.4));
  EXPECT_EQ(fake.submissions, int(recorder.passes().size()));
  fake.submissions = 0;
  ao_of(recorder, settings_of(0.4));
  EXPECT_EQ(fake.submissions, 1);
}

TEST_F(Driver, of_a_cpu_gets_a_frame_at_once_unless_it_is_very_long) {
  gpu::Device device(options());
  gpu::Recorder recorder(device);
  ao_of(recorder, settings_of(0.4));
  EXPECT_EQ(fake.submissions, 1);
  fake.submissions = 0;
  ao_of(recorder, exact_settings(40));
  const int passes = int(recorder.passes().size());
  EXPECT_GE(passes, 80);
  // So that whoever waits is told how far it is, but far fewer than passes.
  EXPECT_THAT(fake.submissions, AllOf(testing::Ge(passes / 32), testing::Le(passes / 10)));
}

TEST_F(Driver, that_refuses_a_part_leaves_the_recorder_usable) {
  gpu::DeviceOptions limited = options();
  limited.submission_ms = 1e-6;
  gpu::Device device(limited);
  gpu::Recorder recorder(device);
  const auto expected = ao_of(recorder, settings_of(0.4));
  for (const int failing : {1, 2, 9}) {
    fake.failing_submission = failing;
    EXPECT_THROW(ao_of(recorder, settings_of(0.4)), gpu::OutOfMemory);
    recorder.abandon();
    EXPECT_EQ(ao_of(recorder, settings_of(0.4)), expected) << failing;
  }
}

TEST_F(Driver, that_hangs_is_lost_and_not_waited_for_unless_it_is_a_cpu) {
  gpu::DeviceOptions impatient = options();
  impatient.lost_ms = 1;
  const auto expected = ao_on(impatient, settings_of(0.4));
  fake.hangs = true;
  EXPECT_EQ(ao_on(impatient, settings_of(0.4)), expected) << "a CPU takes the time that it takes";
  impatient.submission_ms = 1e-6;
  fake.is_discrete = true;
  fake.idle_waits = 0;
  try {
    ao_on(impatient, settings_of(0.4));
    ADD_FAILURE() << "a device that hangs is no lost one";
  } catch (const gpu::DeviceLost& error) {
    EXPECT_THAT(error.what(), HasSubstr("has finished nothing for 0 s"));
  }
  EXPECT_EQ(fake.idle_waits, 0);
}

// Whole runs.

using Runs = CommandLine;

TEST_F(Runs, in_memory_of_the_devices_own_give_the_bits_of_shared_memory_in_tiles_too) {
  const test::Launch own_memory{.environment = {{"ALCOVE_FAKE_MEMORY", "1"}}, .preload = ALCOVE_FAKE_DRIVER};
  const auto outputs = [&](const std::string& more, const test::Launch& launch) {
    const Finished finished =
        run_program(joined({"run", frame, "-o", ao, "--camera", camera, "--composite", folder / "c.exr"},
                           typed("--radius 0.05 --type float --device cpu --aov ao,normal,depth,confidence " + more)),
                    launch);
    EXPECT_EQ(finished.code, 0) << finished;
    return read_bytes(ao) + read_bytes(folder / "c.exr");
  };
  const auto expect_same = [&](const Window& data, const Window& display, const std::string& memory) {
    FrameFile file = wall_frame(data, display);
    add_beauty(file);
    file.write(frame);
    write_bytes(camera, wall_camera(display).dump());
    EXPECT_TRUE(outputs(memory, own_memory) == outputs("", {})) << memory;
  };
  expect_same({-6, -3, 173, 121}, {0, 0, 160, 112}, "");
  // So large that it does not fit as a whole.
  expect_same({-6, -3, 613, 571}, {0, 0, 600, 562}, "--memory 312M");
}

TEST_F(Driver, that_cannot_list_extensions_has_none_and_leaves_no_instance) {
  fake.lists_no_extensions = true;
  const auto devices = gpu::list_devices();
  ASSERT_THAT(devices, Not(IsEmpty()));
  EXPECT_EQ(devices[0].unusable, "") << "none is needed";
  EXPECT_EQ(fake.live_instances, 0);
}

TEST_F(Driver, is_not_asked_for_another_device_when_what_runs_on_a_lane_fails) {
  const gpu::DeviceOptions of_lanes = options();
  const int before = fake.live_instances;
  Lanes lanes(of_lanes, 1);
  const auto fails = [&] {
    const Lanes::Lease lease(lanes);
    throw Error(ErrorKind::device, "no memory");
  };
  EXPECT_THROW(fails(), Error);
  const Lanes::Lease lease(lanes);
  EXPECT_EQ(fake.live_instances, before + 1);
}

}  // namespace
}  // namespace alcove::driver_test
