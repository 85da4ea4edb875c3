#include "a2rt/bvh/address_space.h"

#include <bit>

#include "a2rt/base/error.h"

namespace a2rt::bvh {

// Address 0 stays free so that a zero address in an event is recognisably wrong.
AddressSpace::AddressSpace(Bytes alignment) : alignment_(alignment.value), next_(1U << 28) {
  if (!std::has_single_bit(alignment_) || alignment_ > next_) {
    throw UserError("region alignment " + std::to_string(alignment_) +
                    " is not a power of two of at most 2^28");
  }
}

Address AddressSpace::reserve(const std::string& name, Bytes bytes) {
  const Address base{next_};
  regions_.push_back({name, base, bytes});
  next_ = (next_ + bytes.value + alignment_ - 1) / alignment_ * alignment_;
  return base;
}

}  // namespace a2rt::bvh
