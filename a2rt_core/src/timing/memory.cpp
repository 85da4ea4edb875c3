#include "a2rt/timing/memory.h"

#include "a2rt/timing/memory_system.h"
#include "a2rt/timing/reserved_memory.h"

namespace a2rt::timing {

Cycles Memory::stretch(const MachineConfig& config) {
  return config.model == Model::kReserved ? ReservedMemory::kStretch
                                          : MemorySystem::stretch(config);
}

std::unique_ptr<Memory> make_memory(const MachineConfig& config, Calendar& calendar,
                                    Calendar& dram_calendar) {
  if (config.model == Model::kReserved) {
    return std::make_unique<ReservedMemory>(config);
  }
  return std::make_unique<MemorySystem>(config, calendar, dram_calendar);
}

}  // namespace a2rt::timing
