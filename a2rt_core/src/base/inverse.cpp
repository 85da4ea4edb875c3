#include "a2rt/base/inverse.h"

#include <cstddef>

namespace a2rt {

Affine inverse(const Affine& map) {
  const auto m = [&](std::size_t r, std::size_t c) {
    return static_cast<double>(map.m[r % 3][c % 3]);
  };
  double det = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    det += m(0, c) * (m(1, c + 1) * m(2, c + 2) - m(1, c + 2) * m(2, c + 1));
  }
  Affine out;
  for (std::size_t r = 0; r < 3; ++r) {
    double shift = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double cofactor = m(c + 1, r + 1) * m(c + 2, r + 2) - m(c + 1, r + 2) * m(c + 2, r + 1);
      out.m[r][c] = static_cast<float>(cofactor / det);
      shift -= cofactor / det * static_cast<double>(map.m[c][3]);
    }
    out.m[r][3] = static_cast<float>(shift);
  }
  return out;
}

}  // namespace a2rt
