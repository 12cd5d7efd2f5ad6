// The Vulkan layer: reflection, checks between host and kernel, staging, and errors that name what is wrong.
// SPDX-License-Identifier: BSD-3-Clause
#include <spirv/unified1/spirv.hpp>

#include "kernels/estimate/estimate.h"
#include "kernels/geometry/geometry.h"
#include "kernels/results/results.h"
#include "tests/support/chain.h"
#include "tests/support/device.h"

namespace alcove::gpu_test {
namespace {

using namespace test;

/// The text of the Error that `work` throws, or "" when it throws none.
template <class Work>
std::string error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> block_names(std::span<const std::uint32_t> code) {
  std::vector<std::string> names;
  for (const auto& block : gpu::reflect(code).blocks) names.push_back(block.name);
  return names;
}

TEST(Reflection, of_a_twin_has_the_same_parameters_and_bindings) {
  const auto all = gpu::reflect(gpu::kernel_code("horizon")), usual = gpu::reflect(gpu::kernel_code("horizon_usual"));
  EXPECT_THAT(usual.constants, ElementsAre(testing::Key(0), testing::Key(1), testing::Key(3)));
  EXPECT_EQ(usual.parameter_bytes, all.parameter_bytes);
  ASSERT_GT(usual.blocks.size(), 5);
  for (const auto& block : usual.blocks) {
    const auto same = std::ranges::find(all.blocks, block.name, &gpu::Block::name);
    ASSERT_NE(same, all.blocks.end()) << block.name;
    EXPECT_EQ(same->binding, block.binding) << block.name;
  }
}

TEST(Reflection, tells_blocks_that_are_read_from_blocks_that_are_written) {
  const std::set<std::string> read{"Bounds", "Changes", "Depth", "Needed", "Blocks"};
  for (const auto& block : gpu::reflect(gpu::kernel_code("classify")).blocks) {
    EXPECT_EQ(block.is_written, !read.contains(block.name)) << block.name;
    EXPECT_EQ(block.is_read, !block.is_written || block.name == "Counts") << block.name;
  }
}

/// The blocks of a kernel that may be buffers of texels.
std::map<std::string, VkFormat> texels_of(const char* stem) {
  std::map<std::string, VkFormat> texels;
  for (const auto& block : gpu::reflect(gpu::kernel_code(stem)).blocks)
    if (block.texel != VK_FORMAT_UNDEFINED) texels[block.name] = block.texel;
  return texels;
}

TEST(Reflection, tells_arrays_of_words_that_are_read_without_atomics) {
  constexpr VkFormat kFloats = VK_FORMAT_R32_SFLOAT, kUints = VK_FORMAT_R32_UINT;
  EXPECT_THAT(texels_of("classify"),
              UnorderedElementsAre(testing::Pair("Depth", kFloats), testing::Pair("Changes", kUints),
                                   testing::Pair("Needed", kUints), testing::Pair("Blocks", kUints)))
      << "Bounds is of vectors, Counts a struct, and the others are only written";
  EXPECT_THAT(texels_of("interpolate"), AllOf(Contains(testing::Key("Ao")), Not(Contains(testing::Key("Runs")))))
      << "Runs has atomics";
  EXPECT_THAT(texels_of("reconstruct"), ElementsAre(testing::Pair("Depth", kFloats), testing::Pair("Normal", kUints)))
      << "Normal is written too";
  EXPECT_THAT(texels_of("fit_blocks"), Contains(testing::Pair("Planes", VK_FORMAT_R32G32B32A32_SFLOAT)));
}

/// The number of a kernel's variables of that class.
int variables(std::span<const std::uint32_t> code, spv::StorageClass of_class) {
  int count = 0;
  for (std::size_t at = 5; at < code.size(); at += code[at] >> spv::WordCountShift)
    count += (code[at] & spv::OpCodeMask) == spv::OpVariable && code[at + 3] == std::uint32_t(of_class);
  return count;
}

TEST(Texels, take_the_place_of_storage_buffers_that_may_be_such_and_of_nothing_else) {
  for (const char* stem : {"classify", "reconstruct", "exact", "fit_blocks"}) {
    const auto code = gpu::kernel_code(stem);
    const auto blocks = gpu::reflect(code).blocks;
    const auto edited = gpu::with_texels(code, blocks);
    const int texels = int(texels_of(stem).size());
    EXPECT_EQ(variables(edited, spv::StorageClassUniformConstant), texels) << stem;
    EXPECT_EQ(variables(edited, spv::StorageClassStorageBuffer), int(blocks.size()) - texels) << stem;
  }
}

TEST(Device, reads_texels_where_the_driver_is_slow_with_storage_buffers) {
  EXPECT_TRUE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 22.3.6 (LLVM 15.0.6)"));
  EXPECT_TRUE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 24.0.9-0ubuntu0.3"));
  EXPECT_FALSE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 25.0.7-2 (LLVM 19.1.7)"));
  EXPECT_FALSE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa of tomorrow"));
  EXPECT_FALSE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_LLVMPIPE, ""));
  EXPECT_FALSE(gpu::is_fast_with_texels(VK_DRIVER_ID_MESA_RADV, "Mesa 22.3.6"));
  EXPECT_FALSE(gpu::is_fast_with_texels(VK_DRIVER_ID_GOOGLE_SWIFTSHADER, ""));
}

TEST(Reflection, refuses_what_is_no_spirv) {
  const std::uint32_t words[] = {1, 2, 3, 4, 5, 6};
  EXPECT_THAT(error_of([&] { gpu::reflect(words); }), HasSubstr("no SPIR-V"));
  const auto code = gpu::kernel_code("shape");
  EXPECT_THAT(error_of([&] { gpu::reflect(code.first(6)); }), HasSubstr("cut short"));
}

TEST(Reflection, is_the_same_of_code_that_keeps_nan) {
  const auto code = gpu::kernel_code("horizon");
  const auto edited = gpu::with_preserved_nan(code);
  EXPECT_EQ(edited.size(), code.size() + 6);
  EXPECT_EQ(block_names(edited), block_names(code));
  EXPECT_EQ(gpu::reflect(edited).parameter_bytes, gpu::reflect(code).parameter_bytes);
  EXPECT_THAT(error_of([&] { gpu::with_preserved_nan(code.first(5)); }), HasSubstr("no entry point"));
}

TEST(Kernel, refuses_parameters_bindings_and_constants_that_are_not_its_own) {
  auto& gpu = test::recorder();
  auto& buffer = gpu.buffer("test", 256, gpu::Use::device);
  const auto dispatch = [&](const auto& params, const std::vector<gpu::Binding>& bindings) {
    return error_of([&] { gpu.dispatch("shape", params, bindings, {8, 8}, {0}); });
  };
  EXPECT_THAT(dispatch(PrepareParams{}, {{"Ao", buffer}, {"Shaped", buffer}}), HasSubstr("kernel shape takes"));
  const ShapeParams params{};
  EXPECT_THAT(
      dispatch(params, {{"Ao", buffer}}),
      HasSubstr("kernel shape has the blocks Ao, Counts, Depth, Material, Matte, Shaped, and the host binds Ao"));
  const gpu::Buffer* const forgotten = nullptr;
  EXPECT_THAT(error_of([&] { gpu::Binding("Depth", forgotten); }), HasSubstr("block Depth of a kernel has no buffer"));
  const gpu::Optional none(nullptr);
  std::vector<gpu::Binding> bindings{{"Ao", buffer},     {"Shaped", buffer}, {"Depth", none},
                                     {"Material", none}, {"Matte", none},    {"Counts", none}};
  for (const char* further : {"Nosuch", "Ao"}) {
    bindings.emplace_back(further, buffer);
    EXPECT_THAT(dispatch(params, bindings), HasSubstr("the host binds"));
    bindings.pop_back();
  }
  gpu.abandon();
  EXPECT_THAT(error_of([] { test::device().kernel("horizon", {1}); }), HasSubstr("specialization constants"));
  EXPECT_THAT(error_of([] { test::device().kernel("nosuch", {}); }), HasSubstr("there is no kernel nosuch"));
}

TEST(Buffer, refuses_more_than_the_device_can_bind) {
  const std::size_t too_many = std::size_t(test::device().info().buffer_bytes) + 1;
  EXPECT_THAT(error_of([&] { gpu::Buffer(test::device(), too_many, gpu::Use::device); }), HasSubstr("takes"));
}

// Memory types, as drivers list them.

constexpr VkMemoryPropertyFlags kDevice = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                kWritten = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                kCached = kWritten | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
constexpr VkMemoryPropertyFlags kIncoherent = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
constexpr VkMemoryPropertyFlags kAmdCoherent =
    VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD | VK_MEMORY_PROPERTY_DEVICE_UNCACHED_BIT_AMD;

struct DeviceMemory {
  const char* device;
  std::vector<VkMemoryPropertyFlags> types;
  std::uint32_t for_kernels, for_host;
  bool is_shared;  // the host maps what kernels use
};

std::optional<gpu::MemoryType> chosen(const std::vector<VkMemoryPropertyFlags>& types, std::uint32_t allowed,
                                      gpu::MemoryUse use) {
  VkPhysicalDeviceMemoryProperties memory{};
  for (const auto flags : types) memory.memoryTypes[memory.memoryTypeCount++].propertyFlags = flags;
  return gpu::choose_memory(memory, allowed, use);
}

TEST(Memory, of_kernels_is_the_devices_own_and_of_the_host_is_cached) {
  const DeviceMemory devices[] = {
      {"lavapipe", {kDevice | kCached}, 0, 0, true},
      {"NVIDIA, with a window", {0, kDevice, kWritten, kCached, kDevice | kWritten}, 1, 3, false},
      {"AMD, discrete (RADV)",
       {kDevice, kDevice, kWritten, kDevice | kWritten, kDevice | kWritten, kCached, kCached, kDevice | kAmdCoherent,
        kWritten | kAmdCoherent, kDevice | kWritten | kAmdCoherent, kCached | kAmdCoherent},
       0,
       5,
       false},
      {"AMD, first types that need a feature",
       {kDevice | kAmdCoherent, kCached | kAmdCoherent, kDevice | kWritten, kDevice, kCached},
       3,
       4,
       false},
      {"Intel, integrated", {kDevice | kCached}, 0, 0, true},
      {"Intel, integrated, without a shared cache",
       {kDevice, kDevice | kWritten, kDevice | kIncoherent, kDevice | kCached},
       3,
       3,
       true},
      {"Intel, discrete", {kDevice, kCached, kDevice | kWritten}, 0, 1, false},
      {"Apple", {kDevice, kDevice | kCached, kDevice | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT}, 1, 1, true},
      {"all behind a window", {kDevice | kWritten, kCached}, 0, 1, false},
      {"protected first", {kDevice | VK_MEMORY_PROPERTY_PROTECTED_BIT, kDevice, kCached}, 1, 2, false},
      {"nothing cached", {kDevice, kWritten}, 0, 1, false},
  };
  for (const auto& device : devices) {
    const auto kernels = chosen(device.types, ~0u, gpu::MemoryUse::kernels);
    const auto host = chosen(device.types, ~0u, gpu::MemoryUse::host);
    ASSERT_TRUE(kernels && host) << device.device;
    EXPECT_EQ(kernels->index, device.for_kernels) << device.device;
    EXPECT_EQ(kernels->is_cached, device.is_shared) << device.device;
    EXPECT_EQ(host->index, device.for_host) << device.device;
  }
}

TEST(Memory, is_of_a_type_that_the_buffer_may_lie_in) {
  const std::vector<VkMemoryPropertyFlags> types{kDevice, kDevice, kCached, kCached};
  EXPECT_EQ(chosen(types, 0b1010, gpu::MemoryUse::kernels)->index, 1u);
  EXPECT_EQ(chosen(types, 0b1010, gpu::MemoryUse::host)->index, 3u);
  EXPECT_EQ(chosen(types, 0b1010, gpu::MemoryUse::both)->index, 3u);
  EXPECT_FALSE(chosen(types, 0b0011, gpu::MemoryUse::host));
  EXPECT_FALSE(chosen(types, 0b0011, gpu::MemoryUse::both)) << "which no test may take for guarded";
}

/// The device of the tests with memory that the host does not see, and so without guards.
gpu::DeviceOptions staged_options() {
  gpu::DeviceOptions options = test::device().options();
  options.map_memory = false;
  options.guard_bytes = 0;
  return options;
}

TEST(Buffer, keeps_its_place_in_the_pool_while_it_suits) {
  gpu::Device device(staged_options());
  gpu::Recorder gpu(device);
  constexpr std::size_t kLarge = 8 << 20;
  // The bytes that the pool takes when it is asked for so many.
  const auto taken_for = [&](std::size_t bytes) {
    const gpu::Buffer& buffer = gpu.buffer("pooled", bytes, gpu::Use::upload);
    EXPECT_EQ(buffer.bytes(), bytes);
    EXPECT_EQ(buffer.host().size(), bytes);
    EXPECT_EQ(buffer.bound().range, bytes);
    gpu.run();
    return gpu.bytes();
  };
  EXPECT_EQ(taken_for(kLarge), 2 * kLarge) << "its staging twin counts";
  EXPECT_EQ(taken_for(kLarge - 4), 2 * kLarge);
  EXPECT_EQ(taken_for(kLarge / 2), 2 * kLarge);
  EXPECT_EQ(taken_for(kLarge), 2 * kLarge);
  EXPECT_EQ(taken_for(kLarge / 2 - 4), kLarge - 8) << "a buffer that is far too large goes";
  EXPECT_EQ(taken_for(kLarge), 2 * kLarge);
}

TEST(Buffer, that_was_recorded_is_not_taken_for_another_size) {
  gpu::Device device(staged_options());
  gpu::Recorder gpu(device);
  gpu::Buffer* buffer = &gpu.buffer("counted", 8, gpu::Use::device);
  const VkBuffer recorded = buffer->handle();
  gpu.clear(*buffer);
  EXPECT_NE(gpu.buffer("counted", 4, gpu::Use::device).handle(), recorded);
  gpu.run();
}

/// Records that `target` gets so many values of `source`.
void record_copy(gpu::Recorder& gpu, const gpu::Buffer& source, const gpu::Buffer& target, int count) {
  ShapeParams params{};
  params.size = {count, 1};
  params.intensity = params.power = params.planes = 1;
  gpu.dispatch("shape", params,
               {{"Ao", source},
                {"Shaped", target},
                {"Depth", gpu::Optional(nullptr)},
                {"Material", gpu::Optional(nullptr)},
                {"Matte", gpu::Optional(nullptr)},
                {"Counts", gpu::Optional(nullptr)}},
               {std::uint32_t(count), 1}, {0});
}

/// Records a copy of 64 values, 0.5 each, from the buffer "source" of so many to one of so many.
const gpu::Buffer& record_copy_of_64(std::size_t from, std::size_t to) {
  auto& gpu = test::recorder();
  auto &source = gpu.buffer("source", from * sizeof(float), gpu::Use::upload),
       &copy = gpu.buffer("copy", to * sizeof(float), gpu::Use::device);
  std::ranges::fill(source.as<float>(), 0.5f);
  gpu.upload(source);
  record_copy(gpu, source, copy, 64);
  gpu.download(copy);
  return copy;
}

std::span<const float> copied_64(std::size_t from, std::size_t to) {
  const gpu::Buffer& copy = record_copy_of_64(from, to);
  test::recorder().run();
  return copy.as<const float>();
}

TEST(Recorder, tells_which_share_of_a_long_recording_is_done) {
  auto& gpu = test::recorder();
  for (int i = 0; i < 60; i++) record_copy_of_64(64, 64);
  std::vector<double> shares;
  gpu.run([&](double share) { shares.push_back(share); });
  EXPECT_GE(shares.size(), 3u);
  EXPECT_TRUE(std::ranges::is_sorted(shares)) << testing::PrintToString(shares);
  EXPECT_LT(shares.front(), 0.5);
  EXPECT_EQ(shares.back(), 1);
}

TEST(Guards, who_writes_beside_a_buffer_fails_the_run_by_its_name) {
  EXPECT_EQ(error_of([] { copied_64(64, 64); }), "");
  EXPECT_THAT(error_of([] { copied_64(64, 60); }), HasSubstr("beside the buffer \"copy\""));
}

TEST(Guards, hold_for_buffers_too_that_were_replaced_before_the_run) {
  auto& gpu = test::recorder();
  record_copy_of_64(64, 60);
  gpu.buffer("copy", 64 * sizeof(float), gpu::Use::device);
  EXPECT_THAT(error_of([&] { gpu.run(); }), HasSubstr("beside the buffer \"copy\""));
  gpu.abandon();
}

TEST(Guards, what_is_read_behind_a_buffer_is_no_number) {
  const auto values = copied_64(60, 64);
  for (std::size_t i = 0; i < 64; i++) EXPECT_EQ(std::isnan(values[i]), i >= 60) << i;
}

TEST(Buffer, that_is_replaced_lives_until_what_was_recorded_has_run) {
  auto& gpu = test::recorder();
  const gpu::Buffer& copy = record_copy_of_64(64, 64);
  for (std::size_t floats = 60; floats < 64; floats++)
    std::ranges::fill(gpu.buffer("source", floats * sizeof(float), gpu::Use::upload).as<float>(), 0.25f);
  gpu.run();
  for (const float value : copy.as<const float>()) ASSERT_EQ(value, 0.5f);
}

TEST(Buffer, that_an_earlier_recording_asked_for_goes_as_soon_as_another_takes_its_place) {
  constexpr std::size_t kBytes = 4 << 20;
  gpu::Recorder gpu(device());
  gpu.clear(gpu.buffer("first", kBytes));
  gpu.clear(gpu.buffer("second", kBytes));
  gpu.run();
  gpu.clear(gpu.buffer("first", 3 * kBytes));
  gpu.clear(gpu.buffer("second", 3 * kBytes));
  EXPECT_EQ(gpu.bytes(), 6 * kBytes);
  gpu.run();
}

TEST(Recorder, writes_small_values_in_the_order_of_what_is_recorded) {
  gpu::Device staged(staged_options());
  for (gpu::Device* device : {&test::device(), &staged}) {
    gpu::Recorder gpu(*device);
    auto& word = gpu.buffer("word", sizeof(float), gpu::Use::device);
    auto& first = gpu.buffer("first", sizeof(float), gpu::Use::device);
    auto& second = gpu.buffer("second", sizeof(float), gpu::Use::device);
    gpu.write(word, 0.25f);
    record_copy(gpu, word, first, 1);
    gpu.write(word, 0.75f);
    record_copy(gpu, word, second, 1);
    for (const auto* result : {&first, &second}) gpu.download(*result);
    gpu.run();
    EXPECT_EQ(first.as<float>()[0], 0.25f);
    EXPECT_EQ(second.as<float>()[0], 0.75f);
    EXPECT_THAT(error_of([&] { gpu.write(word, std::array<float, 2>{}); }), HasSubstr("buffer of 4"));
    gpu.abandon();
  }
}

TEST(Recorder, downloads_any_buffer_and_clears_in_order) {
  gpu::Device staged(staged_options());
  for (gpu::Device* device : {&test::device(), &staged}) {
    gpu::Recorder gpu(*device);
    auto& word = gpu.buffer("word", sizeof(float), gpu::Use::device);
    auto& copy = gpu.buffer("copy", sizeof(float), gpu::Use::device);
    gpu.write(word, 0.25f);
    gpu.clear(word);
    gpu.write(copy, 0.5f);
    record_copy(gpu, word, copy, 1);
    gpu.clear(word);
    gpu.write(word, 0.75f);
    for (const auto* result : {&word, &copy, &word}) gpu.download(*result);
    gpu.run();
    EXPECT_EQ(word.as<float>()[0], 0.75f);
    EXPECT_EQ(copy.as<float>()[0], 0.0f);
  }
}

TEST(Staging, gives_the_bits_that_mapped_memory_gives) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = 0.5;
  settings.power = 2;  // one more pass, so that a result is handed on
  const auto mapped = compute_ao(test::recorder(), test::furnished_room(33, 21).frame, settings);
  gpu::Device device(staged_options());
  gpu::Recorder recorder(device);
  const auto staged = compute_ao(recorder, test::furnished_room(33, 21).frame, settings);
  EXPECT_EQ(mapped.ao, staged.ao);
  EXPECT_LT(*std::min_element(mapped.ao.begin(), mapped.ao.end()), 0.9f);
  EXPECT_EQ(device.validation_messages(), 0);
}

TEST(Recorder, times_every_pass_by_its_stem) {
  EstimatorSettings settings = test::plain_settings();
  settings.radius = 0.5;
  settings.intensity = 1.5;
  compute_ao(test::recorder(), test::furnished_room(33, 21).frame, settings);
  std::vector<std::string> names;
  double ms = 0;
  for (const auto& pass : test::recorder().passes()) {
    names.push_back(pass.name);
    ms += pass.ms;
  }
  EXPECT_EQ(ms > 0, test::device().has_timestamps());
  EXPECT_LT(ms, 60000);
  EXPECT_THAT(names, ElementsAre("prepare", "reconstruct", "classify", "horizon", "shape"));
}

TEST(Device, is_found_by_index_name_and_uuid) {
  const auto devices = gpu::list_devices();
  ASSERT_FALSE(devices.empty());
  for (const auto& choice : {std::to_string(devices[0].index), devices[0].name, devices[0].uuid}) {
    gpu::DeviceOptions options;
    options.choice = choice;
    EXPECT_EQ(gpu::Device(options).info().uuid, devices[0].uuid) << choice;
  }
}

TEST(Device, names_what_there_is_when_the_choice_fits_none) {
  gpu::DeviceOptions options;
  options.choice = "no such device";
  EXPECT_THAT(error_of([&] { gpu::Device device(options); }), HasSubstr(gpu::list_devices()[0].name));
}

}  // namespace
}  // namespace alcove::gpu_test
