#include "a2rt/rt/unit.h"

namespace a2rt {

UnitRegistry& unit_registry() {
  static UnitRegistry registry;
  return registry;
}

RegisterUnit::RegisterUnit(const std::string& name, UnitRegistry::Factory factory) {
  unit_registry().add(name, std::move(factory));
}

}  // namespace a2rt
