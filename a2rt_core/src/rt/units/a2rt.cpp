// A2RT: FP32 group nodes on accurate units, quantized sub nodes on approximate ones (A2RT paper,
// sections III and IV), and `a2rt-literal`, the same as printed, without what makes it
// conservative.
#include "a2rt/rt/a2rt_precision.h"
#include "a2rt/rt/a2rt_unit.h"
#include "a2rt/rt/tree_unit.h"

namespace a2rt::rt {
namespace {

const RegisterUnit kConservative("a2rt", [](const config::Section& section) {
  return std::make_unique<TreeUnit<A2rtUnit>>(
      A2rtUnit(section, "a2rt", "A2RT, conservative", default_origin("a2rt")));
});
const RegisterUnit kLiteral("a2rt-literal", [](const config::Section& section) {
  return std::make_unique<TreeUnit<A2rtUnit>>(
      A2rtUnit(section, "a2rt-literal", "A2RT as printed", default_origin("a2rt-literal")));
});

}  // namespace
}  // namespace a2rt::rt
