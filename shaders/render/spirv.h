// The compiled shaders, embedded at build time.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace a2rt::render {

// SPIR-V of glsl/<file>, e.g. "pt.rgen". Throws UserError naming the known shaders of that stage.
std::span<const std::uint32_t> spirv(const std::string& file);

}  // namespace a2rt::render
