// Command recording: one kernel after the other, a barrier before each, two timestamps around each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/recorder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/base/error.h"

namespace alcove::gpu {
namespace {

/// The most dispatches of one submission. A frame of an exact search with 64 slices and eight radii has 4096. Progress
/// is reported per submission, so long frames need several; a submission costs little.
constexpr std::uint32_t kMostDispatches = 24;

/// The most workgroups of a slice of a pass that has not been measured. They are half a million pixels. With 8192
/// samples per pixel (64 slices with 64 steps to each side), an integrated GPU takes some 0.4 s for them, at the 10^10
/// samples per second that such GPUs reach.
constexpr double kUnmeasuredGroups = 8192;

/// The most slices of a pass: each slice costs a barrier.
constexpr double kMostSlices = 256;

/// The factor on the slices of a list. A list that is a quarter full has all its work in the first quarter of its
/// workgroups.
constexpr double kListSlices = 4;

/// The workgroups of a pass, and of each of its slices, in x and y.
struct Cut {
  std::uint32_t x, y, slice_x, slice_y;

  double slices() const { return std::ceil(double(x) / slice_x) * std::ceil(double(y) / slice_y); }
};

/// Cuts a pass into about so many slices, of whole rows if there are enough of them.
Cut cut_into(double slices, std::uint32_t x, std::uint32_t y) {
  const double wanted = std::clamp(std::ceil(slices), 1.0, kMostSlices);
  const double slices_per_row = std::max(1.0, std::min(std::ceil(wanted / y), double(x)));
  const double rows = std::max(1.0, std::floor(y / wanted));
  return {x, y, std::uint32_t(std::ceil(x / slices_per_row)), std::uint32_t(rows)};
}

/// The buffers for the kernel's blocks, in their order; `absent` stands in for null bindings.
std::vector<const Buffer*> buffers_of(const Kernel& kernel, std::span<const Binding> bindings, const Buffer& absent) {
  const auto& blocks = kernel.reflection().blocks;
  std::vector<const Buffer*> buffers;
  for (const auto& block : blocks) {
    const auto binding = std::ranges::find(bindings, block.name, &Binding::block);
    if (binding != bindings.end()) buffers.push_back(binding->buffer ? binding->buffer : &absent);
  }
  if (buffers.size() != blocks.size() || buffers.size() != bindings.size()) {
    const auto names = [](const auto& list, auto name) {
      std::set<std::string_view> sorted;
      for (const auto& entry : list) sorted.insert(entry.*name);
      return fmt::format("{}", fmt::join(sorted, ", "));
    };
    fail(ErrorKind::device, "kernel {} has the blocks {}, and the host binds {}", kernel.stem(),
         names(blocks, &Block::name), names(bindings, &Binding::block));
  }
  return buffers;
}

/// The bytes of the largest of them.
std::size_t most_bytes_of(std::span<const Binding> bindings) {
  std::size_t most = 0;
  for (const Binding& binding : bindings) most = std::max(most, binding.buffer ? binding.buffer->bytes() : 0);
  return most;
}

PassTime pass_of(const Kernel& kernel, std::span<const Buffer* const> buffers) {
  PassTime pass{kernel.stem()};
  for (std::size_t i = 0; i < buffers.size(); i++) {
    const Block& block = kernel.reflection().blocks[i];
    if (block.is_read) pass.bytes_read += buffers[i]->bytes();
    if (block.is_written) pass.bytes_written += buffers[i]->bytes();
  }
  return pass;
}

/// A measure of a pass's work that is known before it runs, and grows with the frame.
double work_of(const PassTime& pass) {
  return double(std::max<std::uint64_t>(pass.bytes_read + pass.bytes_written, 1));
}

}  // namespace

Binding::Binding(std::string_view name, const Buffer* bound) : block(name), buffer(bound) {
  if (!bound) fail(ErrorKind::device, "block {} of a kernel has no buffer", name);
}

Recorder::Recorder(Device& device) : device_(&device) {
  auto pool_info = structure<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool_info.queueFamilyIndex = device.queue_family();
  make(pool_, device.handle(), vkCreateCommandPool, pool_info, "vkCreateCommandPool");
}

Recorder::~Recorder() {
  if (device_ && device_->hangs())  // see Device::hangs()
    new auto(std::make_tuple(std::move(pool_), std::move(submissions_), std::move(buffers_), std::move(replaced_)));
}

Recorder::Submission Recorder::make_submission() {
  const VkDescriptorPoolSize descriptors[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kMostDispatches * kMostBlocks},
                                              {VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, kMostDispatches * kMostBlocks}};
  auto sets_info = structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  sets_info.maxSets = kMostDispatches;
  sets_info.poolSizeCount = std::uint32_t(std::size(descriptors));
  sets_info.pPoolSizes = descriptors;
  Submission submission;
  make(submission.sets, device_->handle(), vkCreateDescriptorPool, sets_info, "vkCreateDescriptorPool");

  auto query_info = structure<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  query_info.queryCount = 2 * kMostDispatches;
  make(submission.queries, device_->handle(), vkCreateQueryPool, query_info, "vkCreateQueryPool");

  auto fence_info = structure<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  make(submission.done, device_->handle(), vkCreateFence, fence_info, "vkCreateFence");

  auto buffer_info = structure<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  buffer_info.commandPool = pool_;
  buffer_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device_->handle(), &buffer_info, &submission.commands), "vkAllocateCommandBuffers");
  return submission;
}

Buffer& Recorder::buffer(std::string_view name, std::size_t bytes, Use use) {
  auto found = buffers_.find(name);
  if (found != buffers_.end()) {
    auto& [pooled, recording] = found->second;
    // No recorded command has it at its present size, and memory is not short.
    const bool may_resize = recording != recordings_ && !is_short_;
    if (pooled.use() == use && (pooled.bytes() == bytes || (may_resize && pooled.suits(bytes)))) {
      pooled.resize(bytes);
      recording = recordings_;
      return pooled;
    }
    // Commands of this recording have it only where this recording has asked for it.
    if (!device_ || (recording_ && recording == recordings_)) replaced_.emplace_back(name, std::move(pooled));
    buffers_.erase(found);
  }
  try {
    PooledBuffer made{device_ ? Buffer(*device_, bytes, use) : Buffer(bytes, use), recordings_};
    return buffers_.emplace(std::string(name), std::move(made)).first->second.buffer;
  } catch (const OutOfMemory&) {
    is_short_ = true;
    throw;
  }
}

std::size_t Recorder::bytes() const {
  std::size_t sum = 0;
  for (const auto& [name, pooled] : buffers_) sum += pooled.buffer.capacity() * (pooled.buffer.staging() ? 2 : 1);
  for (const auto& [name, buffer] : replaced_) sum += buffer.capacity() * (buffer.staging() ? 2 : 1);
  return sum;
}

std::size_t Recorder::largest_bytes() const {
  std::size_t most = 0;
  for (const auto& [name, pooled] : buffers_) most = std::max(most, pooled.buffer.bytes());
  for (const auto& [name, buffer] : replaced_) most = std::max(most, buffer.bytes());
  return most;
}

void Recorder::begin() {
  if (recording_) return;
  check(vkResetCommandPool(device_->handle(), pool_, 0), "vkResetCommandPool");
  used_ = 0;
  touched_.clear();
  uploaded_.clear();
  recorded_.clear();
  next_submission();
  recording_ = true;
}

void Recorder::next_submission() {
  if (used_ == submissions_.size()) submissions_.push_back(make_submission());
  Submission& next = submissions_[used_];
  check(vkResetDescriptorPool(device_->handle(), next.sets, 0), "vkResetDescriptorPool");
  next.timed.clear();
  next.ms = 0;
  auto info = structure<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(next.commands, &info), "vkBeginCommandBuffer");
  if (device_->has_timestamps()) vkCmdResetQueryPool(next.commands, next.queries, 0, 2 * kMostDispatches);
  used_++;
}

void Recorder::end_submission() { check(vkEndCommandBuffer(commands()), "vkEndCommandBuffer"); }

void Recorder::make_room_for(double ms) {
  const Submission& current = submissions_[used_ - 1];
  const bool is_full = current.timed.size() == kMostDispatches;
  const bool is_too_long = !current.timed.empty() && current.ms + ms > device_->submission_ms();
  if (is_full || is_too_long) {
    end_submission();
    next_submission();
  }
  submissions_[used_ - 1].ms += ms;
}

void Recorder::barrier() {
  auto memory = structure<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  const VkPipelineStageFlags stages =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT;
  vkCmdPipelineBarrier(commands(), stages | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                       stages | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, 0, 1, &memory, 0, nullptr, 0, nullptr);
  touched_.clear();
}

/// Waits for earlier commands on a buffer. Buffers that nothing has touched since the last barrier need no barrier, so
/// all clears before a pass share one with it, and so do all downloads behind the last pass.
void Recorder::wait_for(VkBuffer buffer) {
  if (std::ranges::find(touched_, buffer) != touched_.end()) barrier();
  touched_.push_back(buffer);
}

void Recorder::clear(const Buffer& buffer) {
  if (!device_) return;
  begin();
  wait_for(buffer.handle());
  vkCmdFillBuffer(commands(), buffer.handle(), buffer.bound().offset, buffer.bytes(), 0);
}

void Recorder::write_bytes(const Buffer& buffer, std::span<const std::byte> value) {
  if (value.size() > buffer.bytes())
    fail(ErrorKind::device, "a value of {} bytes is written to a buffer of {}", value.size(), buffer.bytes());
  if (!device_) return;
  begin();
  wait_for(buffer.handle());
  vkCmdUpdateBuffer(commands(), buffer.handle(), buffer.bound().offset, value.size(), value.data());
}

void Recorder::upload(const Buffer& buffer) {
  if (!buffer.staging()) return;
  begin();
  wait_for(buffer.staging());
  wait_for(buffer.handle());
  const VkBufferCopy region{0, 0, buffer.bytes()};
  vkCmdCopyBuffer(commands(), buffer.staging(), buffer.handle(), 1, &region);
}

void Recorder::download(const Buffer& buffer) {
  if (!device_) return;
  buffer.make_staging(*device_);
  if (!buffer.staging()) return;
  begin();
  wait_for(buffer.handle());
  wait_for(buffer.staging());
  const VkBufferCopy region{0, 0, buffer.bytes()};
  vkCmdCopyBuffer(commands(), buffer.handle(), buffer.staging(), 1, &region);
}

/// The longest time of the pass so far, scaled to its present work; nullopt if it was never measured.
std::optional<double> Recorder::measured_ms(const RecordedPass& pass) const {
  const auto measured = ms_per_byte_.find(pass.kernel);
  if (measured == ms_per_byte_.end()) return std::nullopt;
  return measured->second * work_of(pass.time);
}

/// The number of slices that make each slice of a pass short.
double Recorder::slices_of(std::optional<double> ms, double groups, bool is_list) const {
  const double most_ms = device_->submission_ms();
  if (std::isinf(most_ms)) return 1;
  if (!ms) return groups / kUnmeasuredGroups;
  return *ms <= most_ms ? 1 : *ms / most_ms * (is_list ? kListSlices : 1);
}

void Recorder::dispatch_bytes(const std::string& stem, std::span<const std::byte> params,
                              std::span<const Binding> bindings, Extent extent,
                              const std::vector<std::uint32_t>& specialization) {
  const Buffer& absent = buffer("absent", sizeof(std::uint32_t));
  if (!device_) {
    rehearsed_.emplace_back(stem, specialization);
    return;
  }
  begin();
  const Kernel& kernel = device_->kernel(stem, specialization, most_bytes_of(bindings));
  if (params.size() != kernel.reflection().parameter_bytes)
    fail(ErrorKind::device, "kernel {} takes {} bytes of parameters, and the host sends {}", stem,
         kernel.reflection().parameter_bytes, params.size());
  const auto buffers = buffers_of(kernel, bindings, absent);
  recorded_.push_back({pass_of(kernel, buffers), &kernel});
  for (const Buffer* buffer : buffers)
    if (buffer->use() == Use::upload && uploaded_.insert(buffer->handle()).second) upload(*buffer);

  const auto& group = kernel.reflection().group;
  const auto groups = [](std::uint32_t count, std::uint32_t size) { return (count + size - 1) / size; };
  const std::uint32_t x = extent.group_count ? extent.x : groups(extent.x, group[0]);
  const std::uint32_t y = extent.group_count ? extent.y : groups(extent.y, group[1]);
  const std::optional<double> ms = measured_ms(recorded_.back());
  const double slices = slices_of(ms, double(x) * y, extent.group_count);
  // An unmeasured pass counts as a full submission, so that it gets one of its own.
  const double unmeasured_ms = device_->submission_ms();
  if (extent.group_count && (slices <= 1 || x == 0)) {
    make_room_for(ms.value_or(unmeasured_ms));
    record_slice(kernel, params, buffers, [&](VkCommandBuffer commands) {
      const VkDescriptorBufferInfo count = extent.group_count->bound();
      vkCmdDispatchIndirect(commands, count.buffer, count.offset);
      touched_.push_back(count.buffer);
    });
    return;
  }
  const Cut cut = cut_into(slices, x, y);
  const double slice_ms = ms ? *ms / cut.slices() : unmeasured_ms;
  for (std::uint32_t row = 0; row < cut.y; row += cut.slice_y)
    for (std::uint32_t column = 0; column < cut.x; column += cut.slice_x) {
      make_room_for(slice_ms);
      record_slice(kernel, params, buffers, [&](VkCommandBuffer commands) {
        vkCmdDispatchBase(commands, column, row, 0, std::min(cut.slice_x, cut.x - column),
                          std::min(cut.slice_y, cut.y - row), 1);
      });
    }
  // Nothing follows a last slice in its submission: lavapipe (Mesa 22) begins an indirect dispatch where the last
  // direct one of the same commands began.
  Submission& last = submissions_[used_ - 1];
  if (cut.slices() > 1) last.ms = std::max(last.ms, device_->submission_ms());
}

/// A descriptor set of the current submission that holds the buffers of the kernel's blocks.
VkDescriptorSet Recorder::bind(const Kernel& kernel, std::span<const Buffer* const> buffers) {
  const VkDescriptorSetLayout layout = kernel.set_layout();
  auto info = structure<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = submissions_[used_ - 1].sets;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(vkAllocateDescriptorSets(device_->handle(), &info, &set), "vkAllocateDescriptorSets");
  std::vector<VkDescriptorBufferInfo> infos(buffers.size());
  std::vector<VkBufferView> views(buffers.size());
  std::vector<VkWriteDescriptorSet> writes;
  for (std::size_t i = 0; i < buffers.size(); i++) {
    const Block& block = kernel.reflection().blocks[i];
    infos[i] = buffers[i]->bound();
    if (block.texel != VK_FORMAT_UNDEFINED) views[i] = buffers[i]->texels(*device_, block.texel);
    auto write = structure<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.dstSet = set;
    write.dstBinding = block.binding;
    write.descriptorCount = 1;
    write.descriptorType = descriptor_of(block);
    write.pBufferInfo = &infos[i];       // or, of a buffer of texels,
    write.pTexelBufferView = &views[i];  // its view
    writes.push_back(write);
  }
  vkUpdateDescriptorSets(device_->handle(), std::uint32_t(writes.size()), writes.data(), 0, nullptr);
  return set;
}

template <class Dispatch>
void Recorder::record_slice(const Kernel& kernel, std::span<const std::byte> params,
                            std::span<const Buffer* const> buffers, const Dispatch& dispatch) {
  if (!touched_.empty()) barrier();
  for (const Buffer* buffer : buffers) touched_.push_back(buffer->handle());
  const VkDescriptorSet set = bind(kernel, buffers);
  Submission& submission = submissions_[used_ - 1];
  const auto query = std::uint32_t(2 * submission.timed.size());
  const auto stamp = [&](std::uint32_t number) {
    if (!device_->has_timestamps()) return;
    vkCmdWriteTimestamp(submission.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, submission.queries, number);
  };
  stamp(query);
  vkCmdBindPipeline(submission.commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  vkCmdBindDescriptorSets(submission.commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(submission.commands, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, std::uint32_t(params.size()),
                     params.data());
  dispatch(submission.commands);
  stamp(query + 1);
  submission.timed.push_back(recorded_.size() - 1);
}

/// Waits for the submissions one by one, in the order of their ends.
void Recorder::wait(const std::function<void(double)>& watch) const {
  std::size_t total = 0, done = 0;
  for (std::size_t i = 0; i < used_; i++) total += submissions_[i].timed.size();
  for (std::size_t i = 0; i < used_; i++) {
    device_->wait_for(submissions_[i].done, submissions_[i].ms);
    done += submissions_[i].timed.size();
    if (watch && total > 0) watch(double(done) / double(total));
  }
}

void Recorder::run(const std::function<void(double)>& watch) {
  begin();
  if (!touched_.empty()) barrier();
  end_submission();
  recording_ = false;
  recordings_++;
  std::vector<VkCommandBuffer> submissions;
  std::vector<VkFence> fences;
  for (std::size_t i = 0; i < used_; i++) {
    submissions.push_back(submissions_[i].commands);
    fences.push_back(submissions_[i].done);
  }
  check(vkResetFences(device_->handle(), std::uint32_t(fences.size()), fences.data()), "vkResetFences");
  device_->submit(submissions, fences);
  wait(watch);
  check_guards();
  replaced_.clear();
  if (device_->has_timestamps()) read_times();
  learn();
  passes_.clear();
  for (auto& pass : recorded_) passes_.push_back(std::move(pass.time));
  recorded_.clear();
}

void Recorder::check_guards() const {
  const auto check_guards_of = [](const std::string& name, const Buffer& buffer) {
    if (!buffer.guards_hold()) fail(ErrorKind::device, "something was written beside the buffer \"{}\"", name);
  };
  for (const auto& [name, pooled] : buffers_) check_guards_of(name, pooled.buffer);
  for (const auto& [name, buffer] : replaced_) check_guards_of(name, buffer);
}

void Recorder::abandon() {
  recording_ = false;
  recordings_++;
  replaced_.clear();
}

/// Reads the time of each pass, the sum over its slices. Work of other recorders between slices does not count.
void Recorder::read_times() {
  for (std::size_t i = 0; i < used_; i++) {
    const auto& [commands, sets, queries, fence, timed, ms] = submissions_[i];
    if (timed.empty()) continue;
    std::vector<std::uint64_t> ticks(2 * timed.size());
    check(vkGetQueryPoolResults(device_->handle(), queries, 0, std::uint32_t(ticks.size()), ticks.size() * 8,
                                ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "vkGetQueryPoolResults");
    for (std::size_t slice = 0; slice < timed.size(); slice++) {
      const std::uint64_t elapsed = (ticks[2 * slice + 1] - ticks[2 * slice]) & device_->timestamp_mask();
      recorded_[timed[slice]].time.ms += double(elapsed) * device_->nanoseconds_per_tick() * 1e-6;
    }
  }
}

/// Keeps the largest measured time per byte. Without timestamps it keeps none, and every pass stays a submission of its
/// own.
void Recorder::learn() {
  if (!device_->has_timestamps()) return;
  for (const auto& [time, kernel] : recorded_) {
    double& most = ms_per_byte_[kernel];
    most = std::max(most, time.ms / work_of(time));
  }
}

}  // namespace alcove::gpu
