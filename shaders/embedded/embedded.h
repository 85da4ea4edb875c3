// Scenes that the program makes itself: one .cpp each, which registers its name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace a2rt::embedded {

struct RegisterScene {
  // `sentence` says in one line what the scene shows.
  RegisterScene(const std::string& name, const std::string& sentence,
                std::function<scene::Scene()> make);
};

struct Description {
  std::string name, sentence;
};
std::vector<Description> all();
bool exists(const std::string& name);
// Throws UserError naming the known scenes if there is none of that name.
scene::Scene make(const std::string& name);

}  // namespace a2rt::embedded
