// Both ways of keeping tags against a model that keeps lists.
#include "a2rt/timing/tag_store.h"

#include <gtest/gtest.h>

#include <list>
#include <random>
#include <vector>

#include "a2rt/base/error.h"

namespace a2rt::timing {
namespace {

// LRU as one would write it down: a list per set, the most recent line first.
class ListModel {
 public:
  ListModel(std::size_t sets, std::size_t ways) : ways_(ways), sets_(sets) {}

  SectorMask touch(std::uint64_t line, SectorMask wanted) {
    auto& set = sets_[line % sets_.size()];
    for (auto it = set.begin(); it != set.end(); ++it) {
      if (it->line == line) {
        const auto found = static_cast<SectorMask>(it->valid & wanted);
        if (found != 0) {
          set.splice(set.begin(), set, it);
        }
        return found;
      }
    }
    return 0;
  }
  SectorMask valid(std::uint64_t line) const {
    for (const Line& l : sets_[line % sets_.size()]) {
      if (l.line == line) {
        return l.valid;
      }
    }
    return 0;
  }
  std::optional<Victim> insert(std::uint64_t line, SectorMask sectors, Traffic kind, bool dirty) {
    auto& set = sets_[line % sets_.size()];
    auto it = set.begin();
    while (it != set.end() && it->line != line) {
      ++it;
    }
    std::optional<Victim> victim;
    if (it == set.end()) {
      if (set.size() == ways_) {
        victim = Victim{set.back().line, set.back().dirty, set.back().kinds};
        count(set.back(), -1);
        set.pop_back();
      }
      set.push_front({line, 0, 0, {}});
    } else {
      set.splice(set.begin(), set, it);
    }
    Line& front = set.front();
    count(front, -1);
    front.kinds.set(sectors, kind);
    front.valid |= sectors;
    front.dirty |= dirty ? sectors : SectorMask{0};
    count(front, 1);
    return victim;
  }
  // Sectors held, by kind.
  const SectorResidence::Totals& held() const { return held_; }

 private:
  struct Line {
    std::uint64_t line;
    SectorMask valid, dirty;
    SectorKinds kinds;
  };
  void count(const Line& line, int sign) {
    for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
      if (line.valid >> s & 1) {
        held_[static_cast<std::size_t>(line.kinds[s])] += static_cast<std::uint64_t>(sign);
      }
    }
  }
  std::size_t ways_;
  std::vector<std::list<Line>> sets_;
  SectorResidence::Totals held_{};
};

struct Shape {
  std::uint64_t sets;
  std::uint32_t ways;
};
void PrintTo(const Shape& s, std::ostream* out) { *out << s.sets << " sets of " << s.ways; }

// insert() in two steps; the line must be where that says.
std::optional<Victim> enter(TagStore& uut, Cycles now, Address line, SectorMask sectors,
                            Traffic kind, bool dirty) {
  const Held before = uut.look(line);
  const Entered entered = uut.enter(now, before, line, sectors, kind, dirty);
  EXPECT_EQ(uut.look(line).place, entered.place);
  EXPECT_TRUE(before.valid == 0 || before.place == entered.place);
  return entered.victim;
}

class Tags : public ::testing::TestWithParam<Shape> {};

TEST_P(Tags, hits_victims_and_what_is_held_are_those_of_a_list_per_set) {
  constexpr std::uint64_t kSteps = 60'000;
  const auto [sets, ways] = GetParam();
  TagStore uut(Bytes{sets * ways * kLineBytes}, ways, "test");
  ListModel model(sets, ways);
  std::mt19937_64 random(ways);
  std::uniform_int_distribution<std::uint64_t> many(0, sets * ways * 2), few(0, sets * ways / 2);
  std::uniform_int_distribution<unsigned> masks(1, 15), kinds(1, 7), dice(0, 9);
  SectorResidence::Totals total{};
  for (std::uint64_t now = 0; now < kSteps; ++now) {
    // For long times everything fits, so that no line is evicted.
    const bool fits = now / 5'000 % 2 == 1;
    // Lines far apart share a set with near ones.
    const std::uint64_t line = fits                ? few(random)
                               : dice(random) == 0 ? many(random) + (std::uint64_t{1} << 56)
                                                   : many(random);
    const auto sectors = static_cast<SectorMask>(masks(random));
    const Address address{line * kLineBytes};
    const unsigned what = dice(random);
    if (what < 3) {
      ASSERT_EQ(uut.touch(address, sectors), model.touch(line, sectors)) << "step " << now;
    } else if (what < 6) {
      const Held held = uut.look(address);
      ASSERT_EQ(held.valid, model.valid(line)) << "step " << now;
      ASSERT_LE(held.place, uut.places());
      if (const auto found = static_cast<SectorMask>(held.valid & sectors); found != 0) {
        uut.use(address, held.place);
      }
      model.touch(line, sectors);
    } else {
      const auto kind = static_cast<Traffic>(kinds(random));
      const bool filled = what < 8, dirty = !filled && dice(random) < 3;
      const auto fresh = filled ? static_cast<SectorMask>(sectors & ~model.valid(line)) : sectors;
      const auto got = filled             ? uut.fill(Cycles{now}, address, sectors, kind)
                       : dice(random) < 5 ? uut.insert(Cycles{now}, address, sectors, kind, dirty)
                                          : enter(uut, Cycles{now}, address, sectors, kind, dirty);
      const auto want = fresh == 0 ? std::nullopt : model.insert(line, fresh, kind, dirty);
      ASSERT_EQ(got.has_value(), want.has_value()) << "step " << now;
      if (got) {
        ASSERT_EQ(got->line, want->line) << "step " << now;
        ASSERT_EQ(got->dirty, want->dirty) << "step " << now;
        for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
          if (got->dirty >> s & 1) {
            ASSERT_EQ(got->kinds[s], want->kinds[s]) << "step " << now;
          }
        }
      }
      ASSERT_EQ(uut.valid(address), model.valid(line)) << "step " << now;
    }
    for (std::size_t k = 0; k < total.size(); ++k) {
      total[k] += model.held()[k];
    }
  }
  EXPECT_EQ(uut.residence(Cycles{kSteps}), total);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Tags,
                         ::testing::Values(Shape{8, 1}, Shape{8, 2}, Shape{8, 3}, Shape{8, 15},
                                           Shape{8, 16}, Shape{8, 17}, Shape{8, 64}, Shape{3, 24},
                                           Shape{1, 17}, Shape{1, 512}));

TEST(Tags, a_capacity_that_is_no_whole_number_of_sets_is_refused) {
  EXPECT_THROW(TagStore(Bytes{100}, 1, "test"), UserError);
  EXPECT_THROW(TagStore(Bytes{kLineBytes * 5}, 2, "test"), UserError);
}

}  // namespace
}  // namespace a2rt::timing
