// Both ways of keeping tags against a model that keeps lists.
#include "a2rt/timing/tag_store.h"

#include <gtest/gtest.h>

#include <list>
#include <random>
#include <vector>

#include "a2rt/base/error.h"

namespace a2rt::timing {
namespace {

constexpr std::uint64_t kSets = 8;

// LRU as one would write it down: a list per set, the most recent line first.
class ListModel {
 public:
  explicit ListModel(std::size_t ways) : ways_(ways), sets_(kSets) {}

  SectorMask touch(std::uint64_t line, SectorMask wanted) {
    auto& set = sets_[line % kSets];
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
  std::optional<Victim> insert(std::uint64_t line, SectorMask sectors, Traffic kind, bool dirty) {
    auto& set = sets_[line % kSets];
    auto it = set.begin();
    while (it != set.end() && it->line != line) {
      ++it;
    }
    std::optional<Victim> victim;
    if (it == set.end()) {
      if (set.size() == ways_) {
        victim = Victim{set.back().line, set.back().dirty, set.back().kinds};
        set.pop_back();
      }
      set.push_front({line, 0, 0, {}});
    } else {
      set.splice(set.begin(), set, it);
    }
    Line& front = set.front();
    for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
      if (sectors >> s & 1) {
        front.kinds[s] = kind;
      }
    }
    front.valid |= sectors;
    front.dirty |= dirty ? sectors : SectorMask{0};
    return victim;
  }
  // Sectors held, by kind.
  std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)> held() const {
    std::array<std::uint64_t, static_cast<std::size_t>(Traffic::kCount)> all{};
    for (const auto& set : sets_) {
      for (const Line& line : set) {
        for (std::uint32_t s = 0; s < kSectorsPerLine; ++s) {
          all[static_cast<std::size_t>(line.kinds[s])] += line.valid >> s & 1;
        }
      }
    }
    return all;
  }

 private:
  struct Line {
    std::uint64_t line;
    SectorMask valid, dirty;
    SectorKinds kinds;
  };
  std::size_t ways_;
  std::vector<std::list<Line>> sets_;
};

class Tags : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(Tags, hits_victims_and_what_is_held_are_those_of_a_list_per_set) {
  const std::uint32_t ways = GetParam();
  TagStore uut(Bytes{kSets * ways * kLineBytes}, ways, "test");
  ListModel model(ways);
  std::mt19937_64 random(ways);
  std::uniform_int_distribution<std::uint64_t> lines(0, kSets * ways * 2);
  std::uniform_int_distribution<unsigned> masks(1, 15), kinds(1, 7), dice(0, 9);
  SectorResidence::Totals total{};
  for (std::uint64_t now = 0; now < 20'000; ++now) {
    // Lines far apart share a set with near ones.
    const std::uint64_t line = lines(random) + (dice(random) == 0 ? std::uint64_t{1} << 40 : 0);
    const auto sectors = static_cast<SectorMask>(masks(random));
    const Address address{line * kLineBytes};
    if (dice(random) < 6) {
      ASSERT_EQ(uut.touch(address, sectors), model.touch(line, sectors)) << "step " << now;
    } else {
      const auto kind = static_cast<Traffic>(kinds(random));
      const bool dirty = dice(random) < 3;
      const auto got = uut.insert(Cycles{now}, address, sectors, kind, dirty);
      const auto want = model.insert(line, sectors, kind, dirty);
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
    }
    const auto held = model.held();
    for (std::size_t k = 0; k < total.size(); ++k) {
      total[k] += held[k];
    }
  }
  EXPECT_EQ(uut.residence(Cycles{20'000}), total);
}

INSTANTIATE_TEST_SUITE_P(Ways, Tags, ::testing::Values(1u, 2u, 3u, 15u, 16u, 17u, 64u));

TEST(Tags, a_capacity_that_is_no_whole_number_of_sets_is_refused) {
  EXPECT_THROW(TagStore(Bytes{100}, 1, "test"), UserError);
  EXPECT_THROW(TagStore(Bytes{kLineBytes * 5}, 2, "test"), UserError);
}

}  // namespace
}  // namespace a2rt::timing
