// Self-registration of plug-ins: one .cpp per component, nothing else touched. A duplicate name is
// fatal, because silently keeping one of two components would change results.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "a2rt/base/error.h"

namespace a2rt {

// Factories of Interface by name; Args are the constructor arguments every factory takes.
template <class Interface, class... Args>
class Registry {
 public:
  using Factory = std::function<std::unique_ptr<Interface>(Args...)>;

  // Throws InternalError if the name is taken.
  void add(const std::string& name, Factory factory) {
    A2RT_CHECK(factories_.emplace(name, std::move(factory)).second,
               "two components are registered under the name '" + name + "'");
  }
  // Throws UserError naming the known components if there is none of that name.
  std::unique_ptr<Interface> create(const std::string& name, Args... args) const {
    const auto it = factories_.find(name);
    if (it == factories_.end()) {
      std::string known;
      for (const auto& entry : factories_) {
        known += (known.empty() ? "" : ", ") + entry.first;
      }
      throw UserError("no component named '" + name + "'; known: " + known);
    }
    return it->second(args...);
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : factories_) {
      all.push_back(entry.first);
    }
    return all;
  }

 private:
  std::map<std::string, Factory> factories_;
};

}  // namespace a2rt
