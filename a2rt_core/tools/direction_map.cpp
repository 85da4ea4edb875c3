// direction-map: wrong box decisions over the ray's direction, against exact arithmetic (the A2RT
// paper's figure 6), and the zoom to directions almost parallel to an axis.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "a2rt/arith/aqb8_arith.h"
#include "a2rt/arith/oracle.h"
#include "a2rt/arith/qbox.h"
#include "a2rt/arith/slab.h"
#include "a2rt/base/error.h"
#include "a2rt/base/text_file.h"
#include "a2rt/rt/a2rt_precision.h"
#include "a2rt/rt/unit.h"
#include "a2rt/workload/synthetic.h"
#include "command.h"
#include "progress.h"
#include "unit_option.h"

namespace a2rt::tools {
namespace {

// Smallest and largest exponent of the small component in the near-axis zoom.
constexpr int kLeastLog2 = -30, kMostLog2 = 0;

struct Options {
  std::vector<std::string> units{"a2rt", "aqb8"};
  std::uint32_t bins = 24;
  std::uint64_t pairs = 200000, seed = 1;
  std::string output;
};

struct Case {
  Box group, child;
  Vec3 origin, direction;
};

// Does the unit say that the ray meets the child? The ray meets the group.
using Judge = std::function<bool(const Case&)>;

struct Counts {
  std::uint64_t tests = 0, exact_hits = 0, exact_misses = 0, redundant = 0, missed = 0;

  void add(bool truth, bool said) {
    ++tests;
    ++(truth ? exact_hits : exact_misses);
    redundant += !truth && said ? 1 : 0;
    missed += truth && !said ? 1 : 0;
  }
};

bool a2rt_says(const Case& c, const arith::A2rtPrecision& precision) {
  const bool literal = precision.origin == arith::OriginDesign::kLiteral;
  const arith::SlabRay slab = arith::make_slab_ray(c.origin, c.direction, 0);
  const arith::SlabHit entry = literal ? arith::slab_test_plain(slab, c.group, Box::kInf)
                                       : arith::slab_test(slab, c.group, Box::kInf);
  if (!entry.hit) {
    return false;
  }
  const arith::GroupFrame frame = arith::make_group_frame(c.group, precision);
  const arith::QuantizedBox stored = arith::quantize_box(c.child, c.group, frame, precision);
  const arith::RayQuantizer quantizer(precision);
  arith::GroupRay local;
  const auto how = quantizer.enter(arith::make_quantizer_ray(c.origin, c.direction), frame,
                                   entry.t_entry, local);
  if (how == arith::GroupEntry::kEscaped) {
    const Box box = arith::dequantize_box(stored, frame, precision);
    return arith::slab_test(slab, box, Box::kInf).hit;
  }
  const float left = quantizer.remaining(Box::kInf, entry.t_entry);
  return arith::QBoxReference(precision).test(local, stored, left).hit;
}

bool aqb8_says(const Case& c, arith::Aqb8Rounding rounding) {
  const arith::Aqb8Anchor anchor = arith::make_aqb8_anchor(c.group);
  const arith::Aqb8Ray ray = arith::make_aqb8_ray(c.origin, c.direction, 0);
  const arith::Aqb8Entry entry = arith::aqb8_anchor_test(ray, anchor, Box::kInf);
  if (!entry.hit) {
    return false;
  }
  const arith::Aqb8Local local = arith::aqb8_enter(ray, anchor, entry.y_ref, Box::kInf, rounding);
  return arith::aqb8_test(ray, local, arith::quantize_aqb8(c.child, anchor)).hit;
}

// As the unit's configuration says.
arith::A2rtPrecision precision_of(const std::string& unit) {
  return rt::read_a2rt_precision(choose_unit(unit, "", {}).section, rt::default_origin(unit));
}

bool is_a2rt(const std::string& unit) { return unit == "a2rt" || unit == "a2rt-literal"; }

Judge judge_of(const std::string& unit) {
  using Rounding = arith::Aqb8Rounding;
  if (is_a2rt(unit)) {
    return [precision = precision_of(unit)](const Case& c) { return a2rt_says(c, precision); };
  }
  if (unit == "aqb8" || unit == "aqb8-nearest") {
    const Rounding rounding = unit == "aqb8" ? Rounding::kFloorCeil : Rounding::kNearestEven;
    return [rounding](const Case& c) { return aqb8_says(c, rounding); };
  }
  throw UserError("--units " + unit + ": use a2rt, a2rt-literal, aqb8 or aqb8-nearest");
}

nlohmann::json precision_json(const arith::A2rtPrecision& precision) {
  return {{"box_bits", precision.box_bits},
          {"origin", arith::name_of(precision.origin)},
          {"origin_bits", precision.effective_origin_bits()},
          {"direction", arith::name_of(precision.direction)}};
}

class Sampler {
 public:
  explicit Sampler(std::uint64_t seed) : random_(seed) {}

  double uniform() { return static_cast<double>(random_.bits() >> 11) * 0x1p-53; }

  // A group of random size and shape, a child in it, and a ray that meets the group: it passes
  // through a random point of it, from up to four diagonals away.
  Case draw(const Vec3& direction) {
    Case c;
    c.direction = direction;
    double target[3], extent[3];
    double diagonal = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double lo = uniform() * 20 - 10;
      extent[axis] = std::exp2(uniform() * 6 - 3);
      const double a = uniform(), b = uniform();
      c.group.lo[axis] = static_cast<float>(lo);
      c.group.hi[axis] = static_cast<float>(lo + extent[axis]);
      c.child.lo[axis] = between(c.group, axis, std::min(a, b));
      c.child.hi[axis] = between(c.group, axis, std::max(a, b));
      target[axis] = lo + uniform() * extent[axis];
      diagonal += extent[axis] * extent[axis];
    }
    const double back = uniform() * 4 * std::sqrt(diagonal);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      c.origin[axis] = static_cast<float>(target[axis] - back * direction[axis]);
    }
    return c;
  }

 private:
  static float between(const Box& box, std::size_t axis, double share) {
    const double lo = box.lo[axis], hi = box.hi[axis];
    return std::min(box.hi[axis], static_cast<float>(lo + share * (hi - lo)));
  }

  synthetic::Random random_;
};

Vec3 direction_of(double theta, double phi) {
  return {static_cast<float>(std::sin(theta) * std::cos(phi)),
          static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta))};
}

using Tally = std::map<std::string, std::vector<Counts>>;

void judge(const Case& c, const std::map<std::string, Judge>& units, std::size_t bin,
           Tally& tally) {
  const bool truth =
      arith::ray_meets_box(arith::OracleRay(c.origin, c.direction, 0), c.child, Box::kInf);
  for (const auto& [name, says] : units) {
    tally[name][bin].add(truth, says(c));
  }
}

Tally empty_tally(const std::map<std::string, Judge>& units, std::size_t bins) {
  Tally tally;
  for (const auto& [name, says] : units) {
    tally[name].resize(bins);
  }
  return tally;
}

Tally map_octant(const Options& o, const std::map<std::string, Judge>& units, Progress& progress) {
  Tally tally = empty_tally(units, std::size_t{o.bins} * o.bins);
  Sampler sampler(o.seed);
  const double step = std::numbers::pi / 2 / o.bins;
  const std::uint64_t each = std::max<std::uint64_t>(1, o.pairs / (std::uint64_t{o.bins} * o.bins));
  for (std::uint32_t row = 0; row < o.bins; ++row) {
    for (std::uint32_t column = 0; column < o.bins; ++column) {
      for (std::uint64_t i = 0; i < each; ++i) {
        const double theta = (row + sampler.uniform()) * step;
        const double phi = (column + sampler.uniform()) * step;
        judge(sampler.draw(direction_of(theta, phi)), units, std::size_t{row} * o.bins + column,
              tally);
      }
    }
    progress.show(0.8 * (row + 1) / o.bins, "directions of an octant");
  }
  return tally;
}

// One component is 2^e, the other two share the rest of the unit vector.
Tally map_near_axis(const Options& o, const std::map<std::string, Judge>& units) {
  const std::size_t bins = kMostLog2 - kLeastLog2;
  Tally tally = empty_tally(units, bins);
  Sampler sampler(o.seed + 1);
  const std::uint64_t each = std::max<std::uint64_t>(1, o.pairs / 8 / bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    for (std::uint64_t i = 0; i < each; ++i) {
      const double small = std::exp2(kLeastLog2 + static_cast<double>(bin) + sampler.uniform());
      const double rest = std::sqrt(std::max(0.0, 1 - small * small));
      const double angle = sampler.uniform() * std::numbers::pi / 2;
      std::array<double, 3> d{rest * std::cos(angle), rest * std::sin(angle), small};
      std::rotate(d.begin(), d.begin() + static_cast<int>(i % 3), d.end());
      judge(sampler.draw(
                {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])}),
            units, bin, tally);
    }
  }
  return tally;
}

using Field = std::uint64_t Counts::*;
constexpr std::array<std::pair<const char*, Field>, 5> kFields{
    {{"tests", &Counts::tests},
     {"exact_hits", &Counts::exact_hits},
     {"exact_misses", &Counts::exact_misses},
     {"redundant", &Counts::redundant},
     {"missed", &Counts::missed}}};

// Rows of `width`; a single row is written flat.
nlohmann::json field_json(const std::vector<Counts>& counts, Field field, std::size_t width) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t first = 0; first < counts.size(); first += width) {
    nlohmann::json row = nlohmann::json::array();
    for (std::size_t i = first; i < first + width; ++i) {
      row.push_back(counts[i].*field);
    }
    rows.push_back(row);
  }
  return counts.size() == width ? rows[0] : rows;
}

nlohmann::json tally_json(const Tally& tally, std::size_t width) {
  nlohmann::json units = nlohmann::json::object();
  for (const auto& [name, counts] : tally) {
    for (const auto& [key, field] : kFields) {
      units[name][key] = field_json(counts, field, width);
    }
  }
  return units;
}

int run(const Options& o) {
  nlohmann::json json;
  std::map<std::string, Judge> units;
  for (const std::string& name : o.units) {
    units.emplace(name, judge_of(name));
    if (is_a2rt(name)) {
      json["precision"][name] = precision_json(precision_of(name));
    }
  }
  {
    Progress progress;
    json["units"] = tally_json(map_octant(o, units, progress), o.bins);
    json["near_axis"]["units"] =
        tally_json(map_near_axis(o, units), static_cast<std::size_t>(kMostLog2 - kLeastLog2));
  }
  for (std::uint32_t i = 0; i < o.bins; ++i) {
    const double centre = (i + 0.5) * std::numbers::pi / 2 / o.bins;
    json["theta"].push_back(centre);
    json["phi"].push_back(centre);
  }
  for (int e = kLeastLog2; e < kMostLog2; ++e) {
    json["near_axis"]["log2_d"].push_back(e + 0.5);
  }
  write_text_file(o.output, json.dump() + "\n");
  return 0;
}

const RegisterCommand kCommand(
    "direction-map", "Wrong box decisions over the ray's direction, against exact arithmetic",
    "  a2rt-core direction-map -o map.json\n"
    "  a2rt-core direction-map --units a2rt,aqb8,aqb8-nearest --pairs 1000000 -o map.json\n",
    [](cli::Options& app) {
      auto options = std::make_shared<Options>();
      app.add("--units", options->units, "a2rt, a2rt-literal, aqb8, aqb8-nearest").delimiter(',');
      app.add("--bins", options->bins, "Bins of each angle").check(cli::in_range(2, 512));
      app.add("--pairs", options->pairs, "Ray-box pairs over the octant");
      app.add("--seed", options->seed, "Seed of the pairs");
      app.add("-o,--output", options->output, "JSON file to write").required();
      return [options] { return run(*options); };
    });

}  // namespace
}  // namespace a2rt::tools
