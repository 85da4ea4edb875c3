#include "a2rt/timing/calendar.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {
namespace {

constexpr auto kLater = [](const auto& a, const auto& b) {
  return a.when != b.when ? a.when > b.when : a.order > b.order;
};

}  // namespace

void Calendar::add_node() {
  free_ = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({});
}

void Calendar::push_far(Cycles when, Appointment appointment) {
  A2RT_CHECK(when >= now_, "an appointment was made in the past");
  far_.push_back({when, far_order_++, appointment});
  std::push_heap(far_.begin(), far_.end(), kLater);
}

void Calendar::pull_far() {
  while (!far_.empty() && far_.front().when.value - now_.value < kWheel) {
    std::pop_heap(far_.begin(), far_.end(), kLater);
    const Far far = far_.back();
    far_.pop_back();
    place(far.when.value % kWheel, far.appointment);
  }
}

std::uint64_t Calendar::distance_to_next_bucket() const {
  const std::size_t start = now_.value % kWheel;
  const std::size_t first_word = start / 64;
  for (std::size_t i = 0; i <= occupied_.size(); ++i) {
    const std::size_t word = (first_word + i) % occupied_.size();
    std::uint64_t bits = occupied_[word];
    if (i == 0) {
      bits &= ~std::uint64_t{0} << (start % 64);
    } else if (i == occupied_.size()) {
      bits &= ~(~std::uint64_t{0} << (start % 64));
    }
    if (bits != 0) {
      const std::size_t bucket = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      return (bucket + kWheel - start) % kWheel;
    }
  }
  return kWheel;
}

bool Calendar::step() {
  if (pending_ == 0) {
    return false;
  }
  serve(next());
  return true;
}

}  // namespace a2rt::timing
