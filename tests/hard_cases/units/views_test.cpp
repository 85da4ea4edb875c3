// The pictures of the failures show what they are named for.
#include "a2rt/hard/views.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace a2rt::hard {
namespace {

TEST(Views, EachShowsPixelsThatItsMechanismLoses) {
  for (const View& view : views()) {
    const Picture picture = draw(view, 41);
    EXPECT_GT(picture.hit_pixels, picture.shade.size() / 5) << view.key;
    ASSERT_TRUE(picture.lost_by_mechanism.contains(view.mechanism)) << view.key;
    const auto named = static_cast<std::ptrdiff_t>(picture.lost_by_mechanism.at(view.mechanism));
    EXPECT_EQ(std::count(picture.kind.begin(), picture.kind.end(), 'L') +
                  std::count(picture.kind.begin(), picture.kind.end(), 'F'),
              named)
        << view.key;
    EXPECT_GE(picture.lost + picture.farther, static_cast<std::uint64_t>(named)) << view.key;
    EXPECT_EQ(picture.kind.size(), picture.shade.size());
  }
}

TEST(Views, ACameraAlongAnAxisLosesItsMiddleRowAndColumnInAqb8) {
  const Picture picture = draw(views()[0], 41);
  ASSERT_EQ(picture.side, 41U);
  std::uint64_t cross = 0;
  for (std::size_t i = 0; i < picture.kind.size(); ++i) {
    const bool middle = i / 41 == 20 || i % 41 == 20;
    cross += middle && picture.kind[i] == 'L' ? 1U : 0U;
    EXPECT_TRUE(middle || picture.kind[i] == '.') << i;
  }
  EXPECT_GT(cross, 60U);
}

}  // namespace
}  // namespace a2rt::hard
