// Command recording: one kernel after the other, a full barrier behind each, two timestamps around each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/gpu/recorder.h"

#include "core/base/error.h"

namespace alcove::gpu {
namespace {

// of one frame: an exact search of 64 slices, four directions each, at eight radii, has 4096
constexpr std::uint32_t kMostPasses = 4608;

}  // namespace

Recorder::Recorder(Device& device) : device_(device) {
  VkCommandPoolCreateInfo pool_info{};
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.queueFamilyIndex = device.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(device.handle(), &pool_info, nullptr, &pool), "vkCreateCommandPool");
  pool_ = {device.handle(), pool};

  VkCommandBufferAllocateInfo buffer_info{};
  buffer_info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  buffer_info.commandPool = pool;
  buffer_info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device.handle(), &buffer_info, &commands_), "vkAllocateCommandBuffers");

  VkQueryPoolCreateInfo query_info{};
  query_info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
  query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  query_info.queryCount = 2 * kMostPasses;
  VkQueryPool queries = VK_NULL_HANDLE;
  check(vkCreateQueryPool(device.handle(), &query_info, nullptr, &queries), "vkCreateQueryPool");
  queries_ = {device.handle(), queries};

  VkFenceCreateInfo fence_info{};
  fence_info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence fence = VK_NULL_HANDLE;
  check(vkCreateFence(device.handle(), &fence_info, nullptr, &fence), "vkCreateFence");
  fence_ = {device.handle(), fence};
}

Buffer& Recorder::buffer(std::string_view name, std::size_t bytes, Use use) {
  auto found = buffers_.find(name);
  if (found != buffers_.end() && found->second.bytes() == bytes && found->second.use() == use) return found->second;
  if (found != buffers_.end()) {
    if (recording_) replaced_.push_back(std::move(found->second));
    buffers_.erase(found);
  }
  return buffers_.emplace(std::string(name), Buffer(device_, bytes, use)).first->second;
}

void Recorder::begin() {
  if (recording_) return;
  check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
  vkCmdResetQueryPool(commands_, queries_, 0, 2 * kMostPasses);
  recorded_.clear();
  recording_ = true;
}

void Recorder::barrier() {
  VkMemoryBarrier memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  const VkPipelineStageFlags stages =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT;
  vkCmdPipelineBarrier(commands_, stages, stages | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, 0, 1, &memory, 0, nullptr, 0,
                       nullptr);
}

std::size_t Recorder::bytes() const {
  std::size_t sum = 0;
  for (const auto& [name, buffer] : buffers_) sum += buffer.bytes();
  return sum;
}

void Recorder::clear(const Buffer& buffer) {
  begin();
  const VkDescriptorBufferInfo bound = buffer.bound();
  vkCmdFillBuffer(commands_, bound.buffer, bound.offset, buffer.bytes(), 0);
  barrier();
}

void Recorder::upload(const Buffer& buffer) {
  if (!buffer.staging()) return;
  begin();
  const VkBufferCopy region{0, 0, buffer.bytes()};
  vkCmdCopyBuffer(commands_, buffer.staging(), buffer.handle(), 1, &region);
  barrier();
}

void Recorder::download(const Buffer& buffer) {
  if (!buffer.staging()) return;
  begin();
  const VkBufferCopy region{0, 0, buffer.bytes()};
  vkCmdCopyBuffer(commands_, buffer.handle(), buffer.staging(), 1, &region);
  barrier();
}

void Recorder::dispatch_bytes(const std::string& stem, std::span<const std::byte> params,
                              std::span<const Binding> bindings, Extent extent,
                              const std::vector<std::uint32_t>& specialization) {
  begin();
  if (recorded_.size() == kMostPasses) fail(ErrorKind::device, "more than {} passes in one frame", kMostPasses);
  const Kernel& kernel = device_.kernel(stem, specialization);
  std::set<std::uint32_t> slots;
  std::vector<VkDescriptorBufferInfo> infos;
  std::vector<VkWriteDescriptorSet> writes;
  infos.reserve(bindings.size());
  for (const auto& binding : bindings) {
    slots.insert(binding.slot);
    infos.push_back(binding.buffer.bound());
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstBinding = binding.slot;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &infos.back();
    writes.push_back(write);
  }
  kernel.require(params.size(), slots);

  const auto query = std::uint32_t(2 * recorded_.size());
  const auto groups = [](std::uint32_t count, std::uint32_t size) { return (count + size - 1) / size; };
  if (device_.has_timestamps()) vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, query);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  device_.push_descriptors(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, std::uint32_t(writes.size()),
                           writes.data());
  vkCmdPushConstants(commands_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, std::uint32_t(params.size()),
                     params.data());
  if (extent.group_count)
    vkCmdDispatchIndirect(commands_, extent.group_count->bound().buffer, extent.group_count->bound().offset);
  else
    vkCmdDispatch(commands_, groups(extent.x, kernel.reflection().group[0]),
                  groups(extent.y, kernel.reflection().group[1]), 1);
  if (device_.has_timestamps())
    vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, query + 1);
  barrier();
  PassTime pass{stem};
  for (const auto& binding : bindings) {
    if (kernel.reflection().read.contains(binding.slot)) pass.bytes_read += binding.buffer.bytes();
    if (kernel.reflection().written.contains(binding.slot)) pass.bytes_written += binding.buffer.bytes();
  }
  recorded_.push_back(pass);
}

void Recorder::run() {
  begin();
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  recording_ = false;
  VkSubmitInfo submit{};
  submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands_;
  const VkFence fence = fence_;
  check(vkResetFences(device_.handle(), 1, &fence), "vkResetFences");
  device_.submit(submit, fence);
  check(vkWaitForFences(device_.handle(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  for (const auto& [name, buffer] : buffers_)
    if (!buffer.guards_hold()) fail(ErrorKind::device, "something was written beside the buffer \"{}\"", name);
  replaced_.clear();
  passes_ = std::move(recorded_);
  if (!device_.has_timestamps() || passes_.empty()) return;
  std::vector<std::uint64_t> ticks(2 * passes_.size());
  check(vkGetQueryPoolResults(device_.handle(), queries_, 0, std::uint32_t(ticks.size()), ticks.size() * 8,
                              ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  for (std::size_t i = 0; i < passes_.size(); i++) {
    const std::uint64_t elapsed = (ticks[2 * i + 1] - ticks[2 * i]) & device_.timestamp_mask();
    passes_[i].ms = double(elapsed) * device_.nanoseconds_per_tick() * 1e-6;
  }
}

}  // namespace alcove::gpu
