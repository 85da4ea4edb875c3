#include "embedded/embedded.h"

#include <map>

#include "a2rt/base/error.h"

namespace a2rt::embedded {
namespace {

struct Entry {
  std::string sentence;
  std::function<scene::Scene()> make;
};

// Filled by the RegisterScene objects before main starts, only read afterwards.
std::map<std::string, Entry>& entries() {
  static std::map<std::string, Entry> all_entries;
  return all_entries;
}

}  // namespace

RegisterScene::RegisterScene(const std::string& name, const std::string& sentence,
                             std::function<scene::Scene()> make) {
  A2RT_CHECK(entries().emplace(name, Entry{sentence, std::move(make)}).second,
             "two embedded scenes are called '" + name + "'");
}

std::vector<Description> all() {
  std::vector<Description> list;
  for (const auto& [name, entry] : entries()) {
    list.push_back({name, entry.sentence});
  }
  return list;
}

bool exists(const std::string& name) { return entries().contains(name); }

scene::Scene make(const std::string& name) {
  const auto it = entries().find(name);
  if (it == entries().end()) {
    std::string known;
    for (const auto& entry : entries()) {
      known += (known.empty() ? "" : ", ") + entry.first;
    }
    throw UserError("no embedded scene '" + name + "'; known: " + known +
                    "; or name a .gltf or .glb file");
  }
  scene::Scene scene = it->second.make();
  scene.name = name;
  return scene;
}

}  // namespace a2rt::embedded
