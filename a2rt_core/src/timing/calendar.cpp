#include "a2rt/timing/calendar.h"

#include <algorithm>
#include <bit>

namespace a2rt::timing {
namespace {

constexpr auto kLater = [](const auto& a, const auto& b) {
  return a.when != b.when ? a.when > b.when : a.order > b.order;
};

}  // namespace

void Calendar::add_place() {
  A2RT_CHECK(appointments_.size() < kNil, "more appointments than a calendar has room for");
  free_ = static_cast<std::uint32_t>(appointments_.size());
  appointments_.push_back({nullptr, 0, kNil << kWhatBits});
}

void Calendar::number(Component& who, std::uint32_t what, std::uint32_t count) {
  A2RT_CHECK(numbered_ == nullptr && count <= kNoNumber, "numbers are one component's and 16 bits");
  numbered_ = &who;
  numbered_what_ = what;
  numbers_.assign(kWheel, kNoNumber);
  next_number_.resize(count);
}

void Calendar::push_far(Cycles when, Component* who, std::uint32_t what, std::uint32_t value) {
  A2RT_CHECK(when >= now_, "an appointment was made in the past");
  far_.push_back({when, made_, who, what, value});
  std::push_heap(far_.begin(), far_.end(), kLater);
}

// Everything that has come near goes to the wheel before anything else can be made for its cycle.
void Calendar::pull_far() {
  while (!far_.empty() && far_.front().when.value - now_.value < kWheel) {
    std::pop_heap(far_.begin(), far_.end(), kLater);
    const Far far = far_.back();
    far_.pop_back();
    if (far.who == numbered_ && far.what == numbered_what_) {
      place_number(far.when.value % kWheel, static_cast<std::uint16_t>(far.value));
    } else {
      place(far.when.value % kWheel, far.who, far.what, far.value);
    }
  }
}

Cycles Calendar::next_in_other_words() const {
  const std::size_t start = now_.value % kWheel / 64;
  // Last of all the present word again: what is left of it lies a whole turn ahead.
  for (std::size_t i = 1; i <= occupied_.size(); ++i) {
    const std::uint64_t bits = occupied_[(start + i) % occupied_.size()];
    if (bits != 0) {
      return Cycles{(now_.value / 64 + i) * 64 +
                    static_cast<std::uint64_t>(std::countr_zero(bits))};
    }
  }
  return far_.empty() ? kNever : std::min(far_.front().when, now_ + Cycles{kWheel});
}

bool Calendar::step() {
  const Cycles at = next();
  if (at == kNever) {
    return false;
  }
  serve(at);
  return true;
}

}  // namespace a2rt::timing
