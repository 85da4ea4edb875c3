// Workgroup sizes that only computing with specialization constants tells, as compilers other than
// glslang write them: a product, and a vector put together in a way that few modules use.
#include <algorithm>

#include "harness/query_dispatch.h"

namespace {
using namespace foreign;

constexpr std::uint32_t kDecorate = 71, kSpecConstant = 50, kComposite = 51, kOperation = 52;
constexpr std::uint32_t kMultiply = 132, kInsert = 82;
constexpr std::uint32_t kBuiltIn = 11, kWorkgroupSize = 25;

using Words = std::vector<std::uint32_t>;

// Position of the first instruction of `op` from the first on that `matches`.
template <class Matches>
std::size_t find(const Words& words, std::uint32_t op, Matches matches) {
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    if ((words[at] & 0xffff) == op && matches(at)) {
      return at;
    }
  }
  throw std::runtime_error("the shader has no such instruction");
}

void insert(Words& words, std::size_t at, const Words& operands) {
  const Words head{static_cast<std::uint32_t>(operands.size() + 1) << 16 | kOperation};
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), operands.begin(), operands.end());
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), head.begin(), head.end());
}

// Where query.comp declares its size: type, result, x, y, z after the first word.
std::size_t size_of(const Words& words) {
  const std::size_t decoration = find(words, kDecorate, [&](std::size_t at) {
    return words[at + 2] == kBuiltIn && words[at + 3] == kWorkgroupSize;
  });
  return find(words, kComposite,
              [&](std::size_t at) { return words[at + 2] == words[decoration + 1]; });
}

// x is x times z, and z is 1.
void multiply(Words& words) {
  const std::size_t at = size_of(words);
  const std::size_t x =
      find(words, kSpecConstant, [&](std::size_t i) { return words[i + 2] == words[at + 3]; });
  const std::uint32_t product = words[3]++;
  const Words operation{words[x + 1], product, kMultiply, words[at + 3], words[at + 5]};
  words[at + 3] = product;
  insert(words, at, operation);
}

// The vector with its own x put into it.
void put_together(Words& words) {
  const std::size_t at = size_of(words);
  const std::uint32_t vector = words[3]++;
  const Words operation{words[at + 1], words[at + 2], kInsert, words[at + 3], vector, 0};
  words[at + 2] = vector;
  insert(words, at + (words[at] >> 16), operation);
}

void draw(App& app, void (*edit)(Words&)) {
  const Structure grid = app.blas({app.triangles(wavy_grid(12), 0)});
  const VkDescriptorSet set = app.make_set(app.tlas({App::instance(grid, translation(0, 0, 0))}));
  const auto original = shader_words("query.comp");
  Words words(original.begin(), original.end());
  edit(words);
  VkShaderModuleCreateInfo module{};
  module.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module.codeSize = words.size() * sizeof(std::uint32_t);
  module.pCode = words.data();
  VkPipelineShaderStageCreateInfo stage{};
  stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  stage.pName = "main";
  check(vkCreateShaderModule(app.device(), &module, nullptr, &stage.module), "a module");
  run_query(app, stage, 0, set, [](VkCommandBuffer commands) {
    vkCmdDispatch(commands, kWidth / kGroupWidth, kHeight / kGroupHeight, 1);
  });
  vkDestroyShaderModule(app.device(), stage.module, nullptr);
}

const Program by_product("query_product_size", [](App& app) { draw(app, multiply); });
const Program by_parts("query_opaque_size", [](App& app) { draw(app, put_together); });
}  // namespace
